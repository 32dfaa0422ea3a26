"""`evcosim info` tells systems and FMUs apart, and refuses the options of the other."""

from __future__ import annotations

import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.master.builtin import fmu_file
from evcosim.master.cli.info import fmu_path
from support.answers import refused


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        (["scooter", "--causality", "input"], "--causality, --search and --strict are for an FMU"),
        (["scooter", "--search", "x"], "scooter is a system"),
        (["scooter", "--strict"], "scooter is a system"),
        (["scooter", "--diagram", "x.svg", "--json"], "--diagram draws and --json prints: give one of them"),
        (["Battery", "--diagram", "x.svg"], "--diagram draws a system; Battery is none"),
        (["Batery"], "there is no system or FMU 'Batery' (did you mean 'Battery'?)"),
    ],
)
def test_options_of_the_other_kind(evcosim, arguments, text):
    refused(evcosim("info", *arguments), text)


def test_the_diagram_of_a_system(evcosim, tmp_path):
    answer = evcosim("info", "scooter", "--diagram", "scooter.svg")
    assert (answer.code, answer.out) == (0, "scooter.svg\n")
    assert "<svg" in (tmp_path / "scooter.svg").read_text(encoding="utf-8")


def test_the_file_of_an_fmu(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert fmu_path("Battery") == fmu_file("Battery")
    own = tmp_path / "Battery"  # a file of the user's goes before a built-in name
    own.write_text("")
    assert fmu_path("Battery").resolve() == own
    with pytest.raises(ConfigError, match=r"none\.fmu: there is no such FMU file"):
        fmu_path("none.fmu")
