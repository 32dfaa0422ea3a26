"""The errors, and what a failed run keeps."""

from __future__ import annotations

import inspect

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.cosim.errors import ConfigError, Recorded, RunError, counted, nearest
from evcosim.cosim.results.results import Results, ResultVariable

METHODS = ("__getitem__", "__len__", "__iter__", "__contains__", "to_csv", "write", "plot")


def test_results_offer_all_that_an_error_promises() -> None:
    """With the same arguments first; mypy compares the types."""
    public = {name for name in vars(Recorded) if not name.startswith("_")}
    assert public == {"time", "names", "to_csv", "write", "plot"}
    for name in (*public, *METHODS):
        assert inspect.getdoc(getattr(Recorded, name))
        assert hasattr(Results, name)
    for name in METHODS:
        promised, given = (list(inspect.signature(getattr(c, name)).parameters) for c in (Recorded, Results))
        assert given[: len(promised)] == promised


def test_what_was_recorded_is_reached_through_the_error() -> None:
    results = Results([0.0, 0.1], [[1.0], [2.0]], [ResultVariable("a.x", "V")])
    error = RunError("vehicle failed at 0.1 s")
    assert error.results is None
    error.results = results
    assert error.results["a.x"].tolist() == [1.0, 2.0]
    assert (len(error.results), error.results.names, "a.x" in error.results) == (2, ("a.x",), True)


def test_a_name_breaks_no_line_of_a_message() -> None:
    error = ConfigError("a.toml: no variable 'x\ny\r'", "there are: a\tb")
    assert error.lines == [r"a.toml: no variable 'x\ny\r'", r"there are: a\tb"]
    assert str(error) == "\n".join(error.lines)
    assert str(ConfigError("more:", *error.lines)) == f"more:\n{error}"
    assert str(ConfigError(f"in one: {ConfigError('x' + chr(10))}")) == r"in one: x\n"


@pytest.mark.parametrize(("kind", "base"), [(ConfigError, ValueError), (RunError, RuntimeError)])
def test_errors_are_those_that_python_would_raise(kind: type[Exception], base: type[Exception]) -> None:
    assert issubclass(kind, base)


@given(st.text(min_size=1), st.lists(st.text(), max_size=5))
def test_a_word_that_is_there_is_the_nearest(word: str, others: list[str]) -> None:
    assert nearest(word, [*others, word]) == f" (did you mean '{word}'?)"


def test_a_word_that_differs_by_case_alone_is_the_nearest() -> None:
    assert nearest("can0.a", ["can0.C", "can0.A", "can0.b"]) == " (did you mean 'can0.A'?)"
    assert nearest("A", ["a"]) == " (did you mean 'a'?)"


def test_nothing_is_nearest_where_nothing_is_similar() -> None:
    assert nearest("speed", ["mass", "grade"]) == nearest("speed", []) == ""


def test_counts_are_read_aloud() -> None:
    assert [counted(n, "value") for n in (0, 1, 2)] == ["0 values", "1 value", "2 values"]
