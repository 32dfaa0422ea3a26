"""A file of another kind than is needed is named for what it is, with what is done with it."""

from __future__ import annotations

from pathlib import Path

import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.system.kinds import kind_of
from evcosim.cosim.system.scenario import load_scenario
from evcosim.cosim.system.system import load_system
from evcosim.cosim.system.toml import DATA

KINDS = [
    ("a.dbc", "a CAN database"),
    ("a.CSV", "a table of numbers"),
    ("a.ssp", "a package of SSP"),
    ("a.so", "a compiled library"),
    ("a.PNG", "a picture"),
    ("a.py", "Python code"),
    ("a.mo", "Modelica code"),
    ("a.slx", "a file of MATLAB or Simulink"),
    ("a.asc", "a log of CAN frames"),
    ("a.fmu", "an FMU"),
]


@pytest.mark.parametrize(("name", "what"), KINDS)
@pytest.mark.parametrize("folder", ["", "there/"])
def test_a_file_of_another_kind(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, what: str, folder: str
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "there").mkdir()
    with pytest.raises(ConfigError, match=rf"^{folder}{name}: there is no such (system )?file$"):
        load_system(folder + name)
    (tmp_path / folder / name).touch()
    with pytest.raises(ConfigError, match=rf"^{folder}{name}: is {what}.*, not a system; "):
        load_system(folder + name)
    with pytest.raises(ConfigError, match=rf"^{folder}{name}: is {what}.*, not a scenario; "):
        load_scenario(load_system("scooter"), folder + name)


def test_a_file_without_a_suffix_is_known_by_its_first_bytes(tmp_path: Path) -> None:
    for content, what in (
        (b"\x7fELF\2", "a compiled library"),
        (b"\x89PNG", "a picture"),
        (b'VERSION ""', "a CAN"),
    ):
        (tmp_path / "it").write_bytes(content)
        assert f"it: is {what}" in kind_of(tmp_path / "it", "system")
    (tmp_path / "it").write_bytes(b"name = 1")
    assert kind_of(tmp_path / "it", "system") == kind_of(tmp_path / "there is none", "system") == ""
    assert kind_of(Path("a\0b"), "system") == kind_of(Path("x" * 5000), "system") == ""


def test_a_folder_says_what_is_in_it(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"is a folder; a system is a file that ends in \.toml"):
        load_system(str(tmp_path))
    (tmp_path / "a.toml").write_text('name = "a"\n[units.u]\nfmu = "Battery"\n', encoding="utf-8")
    (tmp_path / "b.toml").write_text('leave_out = ["u"]\n', encoding="utf-8")
    assert kind_of(tmp_path, "system").endswith(f"is a folder; name a system in it: {tmp_path / 'a.toml'}")
    (tmp_path / "run.json").touch()
    assert "it has the results of a run" in kind_of(tmp_path, "system")


def test_a_scenario_and_a_swap_file_are_no_system(tmp_path: Path) -> None:
    fig8 = DATA / "scenarios" / "scooter" / "fig8.toml"
    with pytest.raises(ConfigError, match=r"fig8\.toml: is a scenario: 'evcosim run SYSTEM --scenario "):
        load_system(str(fig8))
    swap = tmp_path / "swap.toml"
    swap.write_text('fmu = "x.fmu"\n', encoding="utf-8")
    with pytest.raises(ConfigError, match=r"swap\.toml: is a swap file: 'evcosim run SYSTEM --swap UNIT="):
        load_system(str(swap))
