"""FMI 1.0 and 2.0 say more of a step that was not done: how far it got, and that it asks for the end."""

from __future__ import annotations

import ctypes
import math
from typing import Any

import pytest

from evcosim.master.fmi.step_status import asked_end, beside


class Answering:
    """A library with some functions, which write a value and return a status."""

    def __init__(self, **answers: tuple[int, float]) -> None:
        self.answers = answers
        self.kinds: list[int] = []

    def has(self, name: str) -> bool:
        return name in self.answers

    def function(self, name: str) -> Any:
        def answer(component: Any, kind: ctypes.c_int, place: Any) -> int:
            status, value = self.answers[name]
            self.kinds.append(kind.value)
            place._obj.value = value
            return status

        return answer


def clause(status: int, fmi: str = "fmi2", **answers: tuple[int, float]) -> str:
    library: Any = Answering(**answers)
    return beside(status, fmi, library, None)


@pytest.mark.parametrize("status", [0, 1, 3, 4])
def test_for_any_other_status_nothing_is_known(status: int) -> None:
    assert clause(status, fmi2GetRealStatus=(0, 0.25)) == ""


def test_a_pending_step_is_not_supported() -> None:
    assert clause(5) == ": it computes the step asynchronously, which is not supported"


def test_a_discarded_step() -> None:
    assert clause(2) == ""
    assert clause(2, fmi2GetRealStatus=(0, 0.25)) == ": it got to t = 0.25 s"
    assert clause(2, fmi2GetRealStatus=(2, 0.25)) == ""  # it does not know either


def test_fmi_1_has_the_time_alone() -> None:
    answers = {"fmiGetRealStatus": (0, 1.5), "fmi2GetBooleanStatus": (0, 1)}
    assert clause(2, "fmi", **answers) == ": it got to t = 1.5 s"


def asked(status: int, **answers: tuple[int, float]) -> float | None:
    library: Any = Answering(**answers)
    return asked_end(status, library, None)


def test_a_discarded_step_after_which_the_unit_asks_for_the_end() -> None:
    both = {"fmi2GetRealStatus": (0, 0.25), "fmi2GetBooleanStatus": (0, 1)}
    assert asked(2, **both) == 0.25
    assert [asked(status, **both) for status in (0, 1, 3, 4, 5)] == [None] * 5
    assert asked(2, fmi2GetRealStatus=(0, 0.25)) is None
    assert asked(2, fmi2GetRealStatus=(0, 0.25), fmi2GetBooleanStatus=(0, 0)) is None
    assert asked(2, fmi2GetRealStatus=(0, 0.25), fmi2GetBooleanStatus=(3, 1)) is None  # it does not know


def test_an_end_at_an_unknown_time() -> None:
    for answers in ({}, {"fmi2GetRealStatus": (2, 0.25)}):
        assert math.isnan(asked(2, fmi2GetBooleanStatus=(0, 1), **answers) or 0.0)


def test_what_is_looked_up_is_the_end_and_the_last_successful_time() -> None:
    library: Any = Answering(fmi2GetRealStatus=(0, 0.25), fmi2GetBooleanStatus=(0, 1))
    asked_end(2, library, None)
    assert library.kinds == [3, 2]  # fmi2Terminated, fmi2LastSuccessfulTime
