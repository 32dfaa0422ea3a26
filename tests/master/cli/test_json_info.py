"""The JSON schemas of what there is: the keys of a report are those of its schema, in its order."""

from __future__ import annotations

from evcosim.master.builtin import fmu_file
from evcosim.master.cli import info_fmu, info_system
from evcosim.master.cli.json_info import INFO_FMU, INFO_SYSTEM


def test_the_keys_of_the_reports() -> None:
    assert list(info_system.described("scooter")) == list(INFO_SYSTEM["properties"])
    assert list(info_fmu.described(fmu_file("Battery"), [], None)) == list(INFO_FMU["properties"])
