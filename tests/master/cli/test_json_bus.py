"""The schemas of a bus: what run.json has of it is what they say."""

from __future__ import annotations

import jsonschema

from evcosim.cosim.can.bus_settings import BusVariation
from evcosim.master.cli.json_bus import BUS_LOAD, FRAMES
from evcosim.master.simulation import simulate


def test_a_manifest_has_load_and_counts_of_each_bus():
    about = simulate("scooter", "fig8", stop_time=0.2, bus=BusVariation(timing="frame")).manifest
    jsonschema.Draft202012Validator(FRAMES).validate(about["frames"]["can0"])
    (load,) = about["bus_load"]
    jsonschema.Draft202012Validator(BUS_LOAD).validate(load)
    assert load["least"] <= about["frames"]["can0"]["load"] <= load["most"]
