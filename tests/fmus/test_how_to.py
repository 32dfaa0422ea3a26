"""The example of docs/how-to/add-a-model.md works as it is printed."""

from __future__ import annotations

import importlib
import re
import sys
from pathlib import Path

import fmpy
import pytest
from fmpy.validation import validate_fmu

from evcosim.fmus.build import build_model

PAGE = Path(__file__).parents[2] / "docs" / "how-to" / "add-a-model.md"


def test_the_heater_is_a_valid_fmu_that_gets_warm(tmp_path, monkeypatch):
    example = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)[0]
    (tmp_path / "heater.py").write_text(example)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, "heater", raising=False)
    path = build_model(importlib.import_module("heater").Heater, tmp_path)
    assert validate_fmu(str(path)) == []
    result = fmpy.simulate_fmu(path, stop_time=100.0, step_size=1.0, start_values={"power": 1000.0})
    assert result["temperature"][0] == 5.0
    assert result["temperature"][-1] == pytest.approx(205.0 - 200.0 * 2.718281828459045**-0.025)
