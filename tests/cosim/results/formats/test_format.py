"""What a format may use of results, and what it returns."""

import inspect

import numpy as np

from evcosim.cosim.results.formats.format import Contents, Recording
from evcosim.cosim.results.results import Results, ResultVariable


def test_results_are_a_recording() -> None:
    """With the same arguments; mypy compares the types."""
    results = Results([0.0], [[1.0]], [ResultVariable("a.x")], {"system": "s"})
    offered = [name for name in vars(Recording) if name == "__len__" or not name.startswith("_")]
    assert {"variables", "names", "manifest", "pieces", "__len__"} <= set(offered)
    for name in offered:
        assert hasattr(results, name)
    wanted, given = (list(inspect.signature(each.pieces).parameters) for each in (Recording, Results))
    assert wanted == given


def test_contents_need_no_manifest() -> None:
    assert Contents(np.zeros(1), np.zeros((1, 0)), []).manifest == {}
