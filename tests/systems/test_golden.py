"""Every figure's run against its golden file (golden/golden.toml says what may differ)."""

from __future__ import annotations

import numpy as np
import pytest

from support import golden


@pytest.mark.parametrize("name", list(golden.CASES))
def test_run_equals_its_golden_file(name):
    case = golden.CASES[name]
    header, expected = golden.read(name)
    assert header == ["time", *case["signals"]]
    rows = golden.thinned(golden.run(case), case)
    assert rows.shape == expected.shape
    worst = dict(zip(header, np.abs(rows - expected).max(axis=0), strict=True))
    too_far = {signal: change for signal, change in worst.items() if not change <= case["tolerance"]}
    assert not too_far
