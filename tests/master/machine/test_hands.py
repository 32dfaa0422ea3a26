"""The handover as machine code needs it: an isolated unit has one, and no other unit does."""

from __future__ import annotations

from pathlib import Path

import pytest

from evcosim.master.isolation.unit import IsolatedUnit
from evcosim.master.machine import tables as L
from evcosim.master.machine.hands import POSSIBLE, HandedOver
from evcosim.master.simulation import Simulation
from support.mocks import clock
from support.pairs import pair


@pytest.mark.skipif(not POSSIBLE, reason="a handover needs futexes and the order of stores of x86")
def test_an_isolated_unit_has_a_hand_with_the_spans_of_its_values(tmp_path: Path) -> None:
    with Simulation(pair(tmp_path, 0), engine="python") as simulation:
        unit, ours = simulation.units["a"], simulation.units["rider"]
        assert isinstance(unit, IsolatedUnit) and isinstance(unit, HandedOver)
        assert not isinstance(ours, HandedOver) and not isinstance(clock(), HandedOver)
        hand = unit.hand
        assert hand is not None
        assert set(hand.row) == {L.SLOTS, L.SOCKET, L.TURN}
        assert sum(length for *_, length in hand.inputs) == 3  # u, count_in, switch_in
        assert sum(length for *_, length in hand.outputs) == 3  # y, count, switch: not the text
        assert hand.texts_in is None and hand.texts_out is not None
        assert len({target for _, target, _ in (*hand.inputs, *hand.outputs)}) == 6
