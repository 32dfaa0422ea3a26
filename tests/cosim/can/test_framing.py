"""The settings of a framed message."""

from __future__ import annotations

from evcosim.cosim.can.framing import Framing


def test_a_framing_without_settings_is_equal_to_another():
    assert Framing() == Framing()
