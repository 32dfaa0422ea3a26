"""A hostile number at any field of a CAN database makes a run or a message, never a crash."""

from __future__ import annotations

import os
import re
from pathlib import Path

import pytest

from evcosim.cosim.can.dbc import load_dbc
from evcosim.master.simulation import Simulation
from support.forked import forked
from support.said import said_of
from support.small_bench import bench

NUMBERS = [
    "-1",
    "65",
    "1000000000",
    "1e308",
    "5e-324",
    "1e999999999",
    "nan",
    "9" * 5000,
    '"x"',
    "",
]
TYPES = ["INT", "FLOAT", "STRING", 'ENUM "a","b"', "HEX", "ODD", ""]
DATABASE = """VERSION ""
NS_ :
BS_:
BU_: VCU EMD

BO_ <256> VCU_Request: <8> VCU
 SG_ VCU_ThrottleRequest : <0>|<8>@<1>+ (<0.4>,<0>) [<0>|<100>] "%" EMD

BO_ 328 EMD_Status: 8 EMD
 SG_ EMD_VehicleSpeed : <7>|<16>@<0>- (<1>,<0>) [<0>|<254>] "km/h" VCU
 SG_ EMD_Power : <32>|<32>@1- (<1>,<0>) [<0>|<0>] "W" VCU

BA_DEF_ BO_ "GenMsgCycleTime" <<INT>> <0> <65535>;
BA_DEF_ BO_ "GenMsgStartDelayTime" <<INT>> <0> <65535>;
BA_DEF_ BO_ "GenMsgSendType" ENUM "Cyclic","Event";
BA_DEF_ BO_ "VFrameFormat" ENUM "StandardCAN","ExtendedCAN","StandardCAN_FD";
BA_DEF_ SG_ "GenSigStartValue" <<FLOAT>> <-1E9> <1E9>;
BA_DEF_ SG_ "GenSigSNA" <<INT>> <-32768> <65535>;
BA_DEF_ "Baudrate" <<INT>> 0 1000000;
BA_DEF_DEF_ "GenMsgCycleTime" <10>;
BA_DEF_DEF_ "GenMsgStartDelayTime" <0>;
BA_DEF_DEF_ "GenMsgSendType" "Cyclic";
BA_DEF_DEF_ "VFrameFormat" "StandardCAN";
BA_DEF_DEF_ "GenSigStartValue" <0>;
BA_DEF_DEF_ "GenSigSNA" <0>;
BA_DEF_DEF_ "Baudrate" <500000>;
BA_ "Baudrate" <500000>;
BA_ "GenMsgCycleTime" BO_ 256 <10>;
BA_ "GenMsgStartDelayTime" BO_ <328> <10>;
BA_ "GenMsgSendType" BO_ 328 <0>;
BA_ "VFrameFormat" BO_ 256 <0>;
BA_ "GenSigSNA" SG_ 328 EMD_VehicleSpeed <255>;
BA_ "GenSigStartValue" SG_ 256 VCU_ThrottleRequest <5>;
VAL_ <328> EMD_VehicleSpeed <255> "SNA" ;
SIG_VALTYPE_ 328 EMD_Power : <1>;
"""
"""A database in which `<x>` is a number and `<<x>>` a type, and without the brackets a good one."""

FIELD = re.compile(r"<(<?)([^<>\n]+)>>?")
LINES = [line for line in DATABASE.splitlines() if FIELD.search(line)]
SYSTEM = f"""{bench("a.dbc")}\
[[connect]]
from = "vehicle.power"
via = "can0.EMD_Status.EMD_Power"
[[connect]]
from = "ecu.throttle"
to = ["vehicle.throttle"]
via = "can0.VCU_Request.VCU_ThrottleRequest"
"""


def database(at: int = -1, value: str = "") -> str:
    """Return the database, with a value in the field that begins at a place."""
    return FIELD.sub(lambda found: value if found.start() == at else found[2], DATABASE)


def outcome(folder: Path, text: str, engine: str = "python") -> str:
    """Run the system over a database, write its frames, and return what was said, or "done"."""
    (folder / "a.dbc").write_text(text)

    def run() -> None:
        load_dbc(folder / "a.dbc")  # first, since it is quick and refuses most
        with Simulation(folder / "s.toml", log_frames=True, engine=engine) as simulation:
            simulation.run()
            simulation.write_can_log(folder / "can.log")

    return said_of(run)


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "s.toml").write_text(SYSTEM)
    return tmp_path


def test_the_database_runs_as_it_is(folder):
    assert outcome(folder, database()) == "done"
    assert len(FIELD.findall(DATABASE)) > 50


@pytest.mark.skipif(not hasattr(os, "fork"), reason="each line is tried in a child of this process")
@pytest.mark.parametrize("line", LINES, ids=lambda line: re.sub(r"[^A-Za-z_0-9]+", " ", line).strip())
def test_a_hostile_number_is_used_or_refused(line, folder):
    begin = DATABASE.index(line)
    fields = [begin + found.start() for found in FIELD.finditer(line)]
    cases = [(at, value) for at in fields for value in (TYPES if DATABASE.startswith("<<", at) else NUMBERS)]
    found = forked(lambda: [outcome(folder, database(at, value)) for at, value in cases], limit=120.0)
    assert not found.crash, found.crash
    for (at, value), said in zip(cases, found.value, strict=True):
        shown = f"{DATABASE[at : at + 8]} as {value[:40]}: {said}"
        assert said.startswith(("done", "refused", "ended")), shown
        assert said == "done" or "a.dbc" in said or "can0" in said or "EMD" in said, shown
        assert len(said) < 2000, shown
