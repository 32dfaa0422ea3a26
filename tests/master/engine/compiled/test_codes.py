"""Every word of the plan has a code of its own."""

from __future__ import annotations

from typing import get_args, get_type_hints

from evcosim.cosim.can.bus_settings import BusSettings, Rounding
from evcosim.cosim.can.database import Signal
from evcosim.cosim.can.quantization import operation
from evcosim.master.engine.compiled.codes import effect_kind, raw_mode
from evcosim.master.engine.engine import Effect
from support.channels import FREE


def test_kinds_of_effects_differ() -> None:
    kinds = get_args(get_type_hints(Effect)["kind"])
    assert len({effect_kind(Effect(kind, 1.0)) for kind in kinds}) == len(kinds)


def test_ways_of_rounding_and_floats_differ() -> None:
    whole = {raw_mode(operation(FREE, BusSettings(rounding=r))) for r in get_args(Rounding)}
    floats = {
        raw_mode(operation(Signal("F", 0, n, is_float=True), BusSettings(rounding=r)))
        for n in (32, 64)
        for r in get_args(Rounding)
    }
    assert (len(whole), len(floats)) == (len(get_args(Rounding)), 2)
    assert not whole & floats
