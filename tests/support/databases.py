"""DBC files of one message, and what is said of them."""

from __future__ import annotations

from pathlib import Path

import pytest

from evcosim.cosim.can.dbc import load_dbc
from evcosim.cosim.errors import ConfigError
from evcosim.cosim.system.toml import DATA

EV = DATA / "can" / "ev.dbc"
"""The project's own database."""

HEAD = 'VERSION ""\nNS_ :\nBS_:\nBU_: A B\n'
CYCLE = (
    'BA_DEF_ BO_ "GenMsgCycleTime" INT 0 65535;\n'
    'BA_DEF_ BO_ "GenMsgStartDelayTime" INT 0 65535;\n'
    'BA_DEF_ SG_ "GenSigSNA" INT -32768 65535;\n'
    'BA_DEF_ SG_ "GenSigStartValue" FLOAT -1E9 1E9;\n'
    'BA_DEF_DEF_ "GenMsgCycleTime" 0;\n'
    'BA_DEF_DEF_ "GenMsgStartDelayTime" 0;\n'
    'BA_DEF_DEF_ "GenSigSNA" 0;\n'
    'BA_DEF_DEF_ "GenSigStartValue" 0;\n'
)


def write(folder: Path, *signals: str, tail: str = "", length: int = 8, encoding: str = "utf-8") -> Path:
    """A DBC file of one message M (id 1) with these signal lines."""
    lines = "".join(f" SG_ {s}\n" for s in signals)
    path = folder / "test.dbc"
    path.write_bytes(f"{HEAD}\nBO_ 1 M: {length} A\n{lines}\n{CYCLE}{tail}".encode(encoding))
    return path


def refusal(path: Path, signal: str | None = None) -> str:
    """The message of the ConfigError that loading (and asking for the signal) raises."""
    with pytest.raises(ConfigError) as caught:
        message = load_dbc(path).require("M", "scooter.toml")
        message.require(signal or "S", "scooter.toml")
    return str(caught.value)


WAY = """VERSION ""
NS_ :
BS_:
BU_: A B
BO_ 16 Way: 2 A
 SG_ Meters : 0|16@1+ (0.5,0) [0|1000] "" B
BA_DEF_ BO_ "GenMsgCycleTime" INT 0 65535;
BA_DEF_DEF_ "GenMsgCycleTime" 10;
BA_ "GenMsgCycleTime" BO_ 16 10;
"""
"""A database of one message, every 10 ms, with one signal in steps of 0.5."""
