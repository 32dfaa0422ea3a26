"""States as bytes: the same from every Python, and nothing in them that could act."""

from __future__ import annotations

import pickletools

import pytest

from evcosim.fmus.messages import Refused
from evcosim.fmus.snapshot import Snapshot, from_bytes, to_bytes
from evcosim.models.bound_controller import ControllerState


def _snapshot() -> Snapshot:
    return Snapshot((0.1, -0.0, ControllerState.VELOCITY), ControllerState.ACCELERATION, True, False)


def test_bytes_name_the_class_of_an_item_and_nothing_else() -> None:
    """Python 3.11.2 (Debian 12) by itself would write builtins.getattr."""
    data = to_bytes(_snapshot(), "x").partition(b"\n")[2]
    words = {text for op, text, _ in pickletools.genops(data) if "UNICODE" in op.name}
    assert words == {"ControllerState", ControllerState.__module__}


def test_the_bytes_of_another_fmu_and_bytes_that_call_something_are_refused() -> None:
    with pytest.raises(Refused, match="a state of 'x', this FMU is 'y'"):
        from_bytes(to_bytes(_snapshot(), "x"), "y")
    with pytest.raises(Refused, match=r"does not contain builtins\.print"):
        from_bytes(b"x\ncbuiltins\nprint\n(tR.", "x")
