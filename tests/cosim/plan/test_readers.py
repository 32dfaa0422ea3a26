"""Who receives a message, and in which step."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from evcosim.cosim.plan.readers import Reader, readers
from evcosim.cosim.plan.turns import turn_from
from evcosim.cosim.plan.unit_plan import Route
from evcosim.master.simulation import Simulation


@pytest.mark.parametrize("algorithm", ["gauss_seidel", "jacobi"])
def test_the_receivers_of_the_scooter(algorithm):
    with Simulation("scooter", algorithm=algorithm, isolation="none") as simulation:
        plan = simulation.plan
    found = {m.message.name: own for m, own in zip(plan.messages, readers(plan), strict=True)}
    assert found["EMD_Status"] == (Reader("ecu", 1, 0, False),)
    assert found["VCU_Request"] == (Reader("vehicle", 1, 0, False),)
    assert found["VCU_State"] == ()


@pytest.mark.parametrize(
    ("after", "timed", "later"), [(None, False, 0), (0, False, 1), (1, False, 2), (1, True, 0)]
)
def test_who_has_had_its_turn_takes_a_message_in_the_next_one(after, timed, later):
    units = [SimpleNamespace(name=n, every=2, first=i, routes=[Route(10 + i, i)]) for i, n in enumerate("ab")]
    routes = [SimpleNamespace(sinks=((10, None), (11, None), (10, None)))]
    message = SimpleNamespace(arrivals=(), routes=routes, after=after, timed=timed)
    (found,) = readers(SimpleNamespace(units=units, messages=[message]))
    assert found == (Reader("a", 2, 0, later > 0), Reader("b", 2, 1, later > 1))


@pytest.mark.parametrize("later", [False, True])
@pytest.mark.parametrize(("every", "first"), [(1, 0), (4, 2), (3, 7)])
def test_the_next_turns_are_those_of_a_unit(every, first, later):
    turns = Reader("u", every, first, later).turns(np.arange(20))
    assert turns.tolist() == [turn_from(k + later, every, first) for k in range(20)]
    assert Reader("u", 4, 2, True).turns(np.arange(8)).tolist() == [2, 2, 6, 6, 6, 6, 10, 10]
