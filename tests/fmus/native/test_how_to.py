"""docs/how-to/native.md: its model becomes native, its examples are taken, and refused, as it says."""

from __future__ import annotations

import importlib
import re
import sys
from pathlib import Path

import pytest

from evcosim.fmus.build import build_model
from evcosim.fmus.native.build import extracted_library
from evcosim.fmus.native.check import first_difference
from evcosim.fmus.native.errors import Unsupported
from evcosim.fmus.native.lower import lower
from support.needs import need_c_compiler, need_module
from support.small_model import small

PAGE = Path(__file__).parents[3] / "docs" / "how-to" / "native.md"
TEXT = PAGE.read_text(encoding="utf-8")


def marked(mark: str) -> list[str]:
    """Return the examples below a mark."""
    return re.findall(rf"<!-- {re.escape(mark)} -->\n```python\n(.*?)```", TEXT, re.DOTALL)


def test_the_tank_becomes_native_with_the_bits_of_python(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    need_c_compiler()
    (tmp_path / "tank.py").write_text(marked("write: tank.py")[0])
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.delitem(sys.modules, "tank", raising=False)
    model = importlib.import_module("tank").Tank
    path = build_model(model, tmp_path, native="require")
    token = need_module("fmpy").read_model_description(path).guid
    assert first_difference(model, extracted_library(path, tmp_path), token, 300) == ""


@pytest.mark.parametrize("body", marked("taken"))
def test_what_the_page_shows_is_taken(body: str) -> None:
    assert lower(small(body)).step == "step"


@pytest.mark.parametrize("body", marked("refused"))
def test_what_the_page_says_is_refused(body: str) -> None:
    with pytest.raises(Unsupported, match=r"small_\w+\.py:\d+: "):
        lower(small(body))


def test_the_page_has_examples_of_both() -> None:
    assert len(marked("taken")) >= 5 and len(marked("refused")) >= 5
