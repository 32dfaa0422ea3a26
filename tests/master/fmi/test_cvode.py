"""The solver beside closed forms: derivatives, sign changes of indicators, and what it raises."""

from __future__ import annotations

import ctypes
import math
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import pytest

from evcosim.master.fmi.cvode import Cvode, SolverError

Rates = Callable[[float, Sequence[float]], Sequence[float]]


def function(rates: Rates, states: int) -> Any:
    """`rates` as the solver calls it."""

    def evaluated(time: float, x: ctypes.c_void_p, answer: ctypes.c_void_p) -> int:
        values = rates(time, (ctypes.c_double * max(1, states)).from_address(x.value or 0)[:states])
        target = (ctypes.c_double * len(values)).from_address(answer.value or 0)
        target[:] = list(values)
        return 0

    return evaluated


@pytest.fixture
def solver() -> Iterator[Callable[..., Cvode]]:
    """Makes solvers, which are closed at the end."""
    made: list[Cvode] = []

    def make(
        x: Sequence[float], rates: Rates, roots: Rates | None = None, count: int = 0, tolerance: float = 1e-8
    ) -> Cvode:
        n = len(x)
        solver = Cvode(
            n,
            count,
            function(rates, n) if n else None,
            function(roots, n) if roots is not None else None,
            tolerance,
        )
        made.append(solver)
        solver.x[:n] = list(x)
        solver.absolute[:] = [1e-10] * max(1, n)
        solver.restart(0.0)
        return solver

    yield make
    for each in made:
        each.close()


def advance(solver: Cvode, stop: float) -> bool:
    """Step to `stop`, or to a sign change before: True for that."""
    while solver.time < stop:
        if solver.step(stop):
            return True
    return False


def test_a_decay_and_an_oscillator(solver: Callable[..., Cvode]) -> None:
    decay = solver([1.0], lambda t, x: [-x[0]])
    assert not advance(decay, 2.0)
    assert decay.time == 2.0
    assert decay.x[0] == pytest.approx(math.exp(-2.0), rel=1e-6)
    turn = solver([1.0, 0.0], lambda t, x: [x[1], -x[0]])
    advance(turn, math.pi)
    assert list(turn.x) == pytest.approx([-1.0, 0.0], abs=1e-6)


def test_no_step_goes_beyond_the_stop(solver: Callable[..., Cvode]) -> None:
    """The rates beyond it may be others: they are never looked at."""
    seen: list[float] = []

    def rates(time: float, x: Sequence[float]) -> Sequence[float]:
        seen.append(time)
        return [1.0]

    advance(solver([0.0], rates), 0.75)
    assert max(seen) <= 0.75


def test_a_smaller_tolerance_gives_a_smaller_error(solver: Callable[..., Cvode]) -> None:
    errors = []
    for tolerance in (1e-3, 1e-6, 1e-9):
        decay = solver([1.0], lambda t, x: [-x[0]], tolerance=tolerance)
        advance(decay, 1.0)
        errors.append(abs(decay.x[0] - math.exp(-1.0)))
    assert errors[0] > 10 * errors[1] > 100 * errors[2]


def test_a_sign_change_is_met_to_rounding(solver: Callable[..., Cvode]) -> None:
    falling = solver([1.0, 0.0], lambda t, x: [x[1], -9.81], lambda t, x: [x[0]], 1)
    assert advance(falling, 2.0)
    assert falling.time == pytest.approx(math.sqrt(2.0 / 9.81), rel=1e-7)
    assert abs(falling.x[0]) < 1e-9


def test_without_states_indicators_are_followed_over_time(solver: Callable[..., Cvode]) -> None:
    wave = solver([], lambda t, x: [], lambda t, x: [math.sin(math.pi * (t + 0.5))], 1)
    found = []
    for stop in (0.1 * k for k in range(1, 31)):  # one step of the solver, which sees one change at the most
        while wave.time < stop:
            if wave.step(stop):
                found.append(wave.time)
    assert found == pytest.approx([0.5, 1.5, 2.5], abs=1e-12)


def test_after_a_restart_nothing_of_before_is_left(solver: Callable[..., Cvode]) -> None:
    once = solver([1.0], lambda t, x: [-x[0]])
    advance(once, 1.0)
    first = once.x[0]
    once.x[0] = 1.0
    once.restart(0.0)
    assert once.time == 0.0
    advance(once, 1.0)
    assert once.x[0] == first


def test_an_error_of_a_function_is_raised_here(solver: Callable[..., Cvode]) -> None:
    def rates(time: float, x: Sequence[float]) -> Sequence[float]:
        if time > 0.5:
            raise ZeroDivisionError("in the model")
        return [1.0]

    with pytest.raises(ZeroDivisionError, match="in the model"):
        advance(solver([0.0], rates), 1.0)


def test_what_cannot_be_computed_ends_with_a_reason(solver: Callable[..., Cvode]) -> None:
    infinite = solver([1.0], lambda t, x: [x[0] ** 2])  # x = 1/(1 - t)
    with pytest.raises(SolverError):
        advance(infinite, 2.0)
    assert infinite.time == pytest.approx(1.0, abs=1e-3)


def test_the_last_derivatives_are_those_of_the_last_point(solver: Callable[..., Cvode]) -> None:
    decay = solver([1.0], lambda t, x: [-3.0 * x[0]])
    assert decay.last_derivatives() == [0.0]  # nothing was evaluated yet
    advance(decay, 1.0)
    assert decay.last_derivatives()[0] == pytest.approx(-3.0 * math.exp(-3.0), rel=1e-4)
