"""What a reader of a format returns."""

import numpy as np

from evcosim.cosim.results.formats.format import Contents


def test_contents_need_no_manifest() -> None:
    assert Contents(np.zeros(1), np.zeros((1, 0)), []).manifest == {}
