"""What metrics and writers of files may use of results."""

import inspect

import pytest

from evcosim.cosim.results.recording import Recording
from evcosim.cosim.results.results import Results, ResultVariable

OFFERED = [name for name in vars(Recording) if name == "__len__" or not name.startswith("_")]


@pytest.mark.parametrize("name", OFFERED)
def test_results_offer_all_of_a_recording(name: str) -> None:
    """With the same arguments; mypy compares the types."""
    results = Results([0.0], [[1.0]], [ResultVariable("a.x")], {"system": "s"})
    assert hasattr(results, name)
    if inspect.isfunction(getattr(Recording, name)):
        wanted, given = (list(inspect.signature(getattr(c, name)).parameters) for c in (Recording, Results))
        assert wanted == given
