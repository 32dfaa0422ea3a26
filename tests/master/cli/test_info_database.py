"""`evcosim info FILE.dbc`: messages, signals, what cannot be used and why, and the load of the bus."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path

import jsonschema
import pytest

from evcosim.cosim.can.dbc import load_dbc
from evcosim.cosim.errors import ConfigError
from evcosim.master.cli import info_database
from evcosim.master.cli.info_database import described
from evcosim.master.cli.json_info import INFO_DATABASE
from support.databases import EV, HEAD

CAR = f"""{HEAD}
BO_ 256 Fast: 8 A
 SG_ Page M : 0|4@1+ (1,0) [0|3] "" B
 SG_ Speed : 8|16@1- (0.1,-5) [0|255] "km/h" B
 SG_ P1 m1 : 32|8@1+ (1,0) [0|255] "Spannung" B
 SG_ P2 m2 : 32|8@1+ (1,0) [0|255] "" B
 SG_ Q : 40|2@1+ (1,0) [0|3] "" B
BO_ 257 Big: 10 A
 SG_ Byte : 0|8@1+ (1,0) [0|255] "" B
 SG_ Flag : 3|1@1+ (1,0) [0|1] "" B
 SG_ Odd : eight|8@1+ (1,0) [0|0] "" B
BA_DEF_ BO_ "GenMsgCycleTime" INT 0 65535;
BA_DEF_DEF_ "GenMsgCycleTime" 0;
BA_ "GenMsgCycleTime" BO_ 256 10;
VAL_ 256 Q 3 "SNA" ;
"""


@pytest.fixture
def car(tmp_path: Path) -> Path:
    path = tmp_path / "car.dbc"
    path.write_text(CAR)
    return path


@pytest.mark.parametrize("arguments", [(), ("Fast",), (None, 500_000), (None, 500_000, 2_000_000)])
def test_the_report_is_what_its_schema_says(car, arguments):
    for path in (car, EV):
        about = described(path, *(arguments if path == car else arguments[1:] and (None, *arguments[1:])))
        jsonschema.Draft202012Validator(INFO_DATABASE).validate(about)
        assert list(about) == list(INFO_DATABASE["properties"])


def test_the_load_is_that_of_all_cyclic_frames(car):
    """A classic frame: 44 + 8 n bits, 3 between frames, stuff bits up to (34 + 8 n - 1) / 4 (Davis 2007)."""
    about = described(car, None, 500_000)
    least, most = (44 + 64 + 3) / 500_000 / 0.01, (44 + 64 + 3 + 24) / 500_000 / 0.01
    fast, big = about["messages"]
    assert fast["load"] == pytest.approx([least, most]) == about["load"]
    assert big["load"] is None  # it has no cycle time
    assert described(car, "Fast", 250_000)["load"] == pytest.approx([2 * least, 2 * most])


def test_the_load_of_a_frame_of_can_fd_is_that_of_its_length(tmp_path):
    """9 bytes are sent as 12."""
    loads = []
    for length in (9, 12):
        path = tmp_path / f"{length}.dbc"
        path.write_text(f'VERSION ""\nBU_: A\nBO_ 1 M: {length} A\n SG_ S : 0|8@1+ (1,0) [0|0] "" A\n')
        message = dataclasses.replace(load_dbc(path).messages["M"], cycle_time=0.01, fd=True)
        loads.append(info_database._load(message, 500_000, 2_000_000))
    assert loads[0] == loads[1]


def test_the_load_of_the_project_s_own_database():
    """Davis' bound: every frame with all its stuff bits, at 500 kbit/s."""
    own = sum(
        (44 + 8 * m.length + 3 + (34 + 8 * m.length - 1) // 4) / 500_000 / (m.cycle_time or 1.0)
        for m in load_dbc(EV).messages.values()
    )
    least, most = described(EV, None, 500_000)["load"]
    assert most == pytest.approx(own)
    page = (Path(__file__).parents[3] / "docs" / "bus.md").read_text(encoding="utf-8")
    assert f"take {least:.2%}"[:-1] in page and f"and {most:.2%}"[:-1] in page


def test_what_cannot_be_used_and_why(car):
    fast, big = described(car)["messages"]
    refused = {s["name"]: s["refused"] for m in (fast, big) for s in m["signals"] if s["refused"]}
    assert refused == {name: f"line 14: Big.{name}: 'Byte' and 'Flag' overlap in bit 3".replace("14", line)
                       for name, line in (("Byte", "13"), ("Flag", "14"))}  # fmt: skip # two lines of a file
    assert "line 15: not valid in a DBC file" in big["unread"]["Odd"]
    assert {s["name"]: s["unit_known"] for s in fast["signals"] if not s["unit_known"]} == {"P1": False}
    assert next(s["note"] for s in fast["signals"] if s["name"] == "Q").startswith("its maximum 3")


def test_a_message_alone_has_its_own_flaws(car):
    assert described(car, "Fast")["flaws"] == []
    assert len(described(car, "Big")["flaws"]) == 3  # one of a signal that cannot be read
    assert len(described(car)["flaws"]) == 3
    with pytest.raises(ConfigError, match=r"car.dbc: no message 'Fats' \(did you mean 'Fast'\?\)"):
        described(car, "Fats")


def test_what_is_printed(car, evcosim):
    answer = evcosim("info", str(car), "--bitrate", "500000").out
    assert "2, 1 of them without a cycle time" in answer and "8, of which 6 can be used" not in answer
    assert "7, of which 5 can be used" in answer
    said = " ".join(answer.split())
    assert "2.2 % to 2.7 % at 500000 bit/s, by the stuff bits, without the 1 that have no cycle" in said
    assert "Big 0x101 10 in 12 CAN FD" in said
    assert "not known: Spannung" in answer and "3 flaws" in answer
    answer = evcosim("info", str(car), "Fast").out
    said = " ".join(answer.split())
    assert "P1 32|8 1 [0, 255] Spannung (?) Page 1 B" in said
    assert "Speed 8|16 signed 0.1 - 5 [0, 255] km/h B" in said
    assert "note: Q: its maximum 3 would be sent as raw 3" in said


def test_limits_that_no_frame_holds_are_listed(car, evcosim):
    car.write_text(CAR.replace("Speed : 8|16@1- (0.1,-5) [0|255]", "Speed : 8|16@1- (0.1,-5) [0|9999]"))
    said = " ".join(evcosim("info", str(car)).out.split())
    assert "2 notes Fast.Speed: its limits [0, 9999] km/h mean raw 50 to 100040, and 16 signed bits" in said
    assert "3271.7 arrives for 9999" in said and "Fast.Q: its maximum 3 would be sent as raw 3" in said
    about = json.loads(evcosim("info", str(car), "Fast", "--json").out)
    (note,) = [s["note"] for s in about["messages"][0]["signals"] if s["name"] == "Speed"]
    assert "3271.7 arrives for 9999" in note


def test_many_notes_are_cut_short(car, evcosim):
    more = "".join(f'BO_ {300 + i} N{i}: 8 A\n SG_ S{i} : 0|8@1+ (1,0) [0|999] "" B\n' for i in range(25))
    car.write_text(CAR.replace("BA_DEF_ BO_", f"{more}BA_DEF_ BO_", 1))
    said = " ".join(evcosim("info", str(car)).out.split())
    assert "26 notes" in said and "N18.S18: its limits" in said and "N19" not in said.split("26 notes")[1]
    assert "and 6 more" in said


def test_json_and_options_of_others(car, evcosim):
    assert json.loads(evcosim("info", str(car), "Fast", "--json").out)["messages"][0]["name"] == "Fast"
    for arguments in (
        ("Scooter", "EMD_Status"),
        ("Scooter", "--bitrate", "5"),
        ("scooter", "--bitrate", "5"),
    ):
        answer = evcosim("info", *arguments)
        assert answer.code == 2
        assert "are for a CAN database (.dbc .kcd .sym .arxml)" in answer.err
    assert evcosim("info", str(car), "--search", "x").code == 2


def test_a_message_alone_has_the_flaws_of_its_lines_and_attributes(tmp_path):
    path = tmp_path / "x.dbc"
    tail = 'BA_DEF_ BO_ "GenMsgCycleTime" FLOAT 0 0;\nBA_ "GenMsgCycleTime" BO_ 1 1e20;\n'
    path.write_text(
        f'{HEAD}\nBO_ 1 M: 8 A\n SG_ S : 0|8@1+ (1,0) [0|0] "" B\n SG_ T : x|8@1+ (1,0) [0|0] "" B\n\n'
        f'BO_ 2 N: 8 A\n SG_ S : 0|8@1+ (1,0) [0|0] "" B\n\n{tail}'
    )
    assert described(path, "M")["flaws"] == described(path)["flaws"] and len(described(path)["flaws"]) == 2
    assert described(path, "N")["flaws"] == []


@pytest.mark.parametrize("option", ["--bitrate", "--data-bitrate"])
def test_a_bitrate_is_one_that_a_system_may_have(evcosim, option):
    assert evcosim("info", str(EV), option, "1000000000").code == 0
    refused = evcosim("info", str(EV), option, "1000000001")
    assert refused.code == 2 and "less than or equal to 1000000000" in refused.err
