"""The databases of a system's buses, and how much of their flaws a run says."""

from __future__ import annotations

import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.plan.buses import open_buses
from evcosim.cosim.system.system import System, SystemFile
from support.databases import write

S = 'S : 0|8@1+ (1,0) [0|0] "" B'


def system(folder, **buses) -> System:
    file = SystemFile.model_validate({"name": "s", "units": {"a": {"fmu": "a.fmu"}}, "buses": buses})
    return System(folder / "s.toml", file)


def test_a_file_of_two_buses_says_its_flaws_once(tmp_path):
    write(tmp_path, S, tail="nonsense;\n")
    said: list[str] = []
    found = open_buses(system(tmp_path, one={"dbc": "test.dbc"}, two={"dbc": "test.dbc"}), said)
    assert list(found) == ["one", "two"] and list(found["one"].messages) == ["M"]
    (warning,) = said
    assert "test.dbc: line 17: not valid in a DBC file: 'nonsense'" in warning


def test_of_many_flaws_the_first_are_said_and_where_the_others_are(tmp_path):
    path = write(tmp_path, S, tail="nonsense;\n" * 9)
    said: list[str] = []
    open_buses(system(tmp_path, one={"dbc": "test.dbc"}), said)
    assert len(said) == 6
    assert said[-1] == f"{path}: 4 more of this kind; `evcosim info {path}` lists them"


def test_settings_of_no_message(tmp_path):
    write(tmp_path, S)
    one = {"dbc": "test.dbc", "messages": {"N": {"cycle_time": 0.1}}}
    with pytest.raises(ConfigError, match=r"s.toml: buses.one.messages: .*test.dbc: no message 'N'"):
        open_buses(system(tmp_path, one=one), [])
