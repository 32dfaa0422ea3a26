"""The formats of CAN databases: the same content makes the same records, as far as each format can say it."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import cantools
import pytest

from evcosim.cosim.can.database import Database
from evcosim.cosim.can.formats import SUFFIXES, load_database
from evcosim.cosim.errors import ConfigError

DBC = """VERSION ""
BS_:
BU_: A B
BO_ 256 M: 8 A
 SG_ Page M : 0|4@1+ (1,0) [0|15] "" B
 SG_ Speed : 15|12@0- (0.1,-5) [-50|100] "km/h" B
 SG_ P1 m1 : 32|16@1+ (1,0) [0|0] "" B
 SG_ P2 m2 : 40|16@1+ (2,0) [0|0] "" B
BO_ 2566844926 E: 4 B
 SG_ State : 0|2@1+ (1,0) [0|3] "" A
CM_ SG_ 256 Speed "From the resolver";
BA_DEF_ BO_ "GenMsgCycleTime" INT 0 65535;
BA_DEF_DEF_ "GenMsgCycleTime" 0;
BA_ "GenMsgCycleTime" BO_ 256 20;
VAL_ 2566844926 State 0 "Off" 1 "On" 3 "SNA" ;
"""
SYM = """FormatVersion=6.0 // by hand
Title="test"

{ENUMS}
Enum=VtState(0="Off", 1="On", 3="SNA")

{SENDRECEIVE}

[E]
ID=18FEF1FEh
Type=Extended
Len=4
Var=State unsigned 0,2 /min:0 /max:3 /e:VtState

[M]
ID=100h
Len=8
CycleTime=20
Var=Speed signed 8,12 -m /u:km/h /f:0.1 /o:-5 /min:-50 /max:100 // From the resolver
Var=Other unsigned 32,16 /f:2
"""


def _tag(name: str, *parts: str, **attributes: str) -> str:
    """An element of ARXML."""
    given = "".join(f' {key}="{value}"' for key, value in attributes.items())
    return f"<{name}{given}>{''.join(parts)}</{name}>"


def _named(kind: str, name: str, *parts: str) -> str:
    return _tag(kind, _tag("SHORT-NAME", name), *parts)


def _wrapped(path: str, *parts: str) -> str:
    """Elements in one another, the outermost first."""
    text = "".join(parts)
    for name in reversed(path.split()):
        text = _tag(name, text)
    return text


def _to(name: str, kind: str, target: str) -> str:
    return _tag(name, f"/P/{target}", DEST=kind)


ARXML = (
    '<?xml version="1.0"?><AUTOSAR xmlns="http://autosar.org/schema/r4.0" xmlns:xsi='
    '"http://www.w3.org/2001/XMLSchema-instance" xsi:schemaLocation="http://autosar.org/schema/r4.0 '
    'AUTOSAR_4-2-2.xsd"><AR-PACKAGES>'
    + _named(
        "AR-PACKAGE",
        "P",
        _tag(
            "ELEMENTS",
            _named(
                "CAN-CLUSTER",
                "Bus",
                _wrapped(
                    "CAN-CLUSTER-VARIANTS CAN-CLUSTER-CONDITIONAL PHYSICAL-CHANNELS",
                    _named(
                        "CAN-PHYSICAL-CHANNEL",
                        "Channel",
                        _tag(
                            "FRAME-TRIGGERINGS",
                            _named(
                                "CAN-FRAME-TRIGGERING",
                                "Sent",
                                _to("FRAME-REF", "CAN-FRAME", "Status"),
                                _tag("CAN-ADDRESSING-MODE", "STANDARD"),
                                _tag("IDENTIFIER", "291"),
                            ),
                        ),
                    ),
                ),
            ),
            _named(
                "CAN-FRAME",
                "Status",
                _tag("FRAME-LENGTH", "8"),
                _wrapped(
                    "PDU-TO-FRAME-MAPPINGS",
                    _named("PDU-TO-FRAME-MAPPING", "Map", _to("PDU-REF", "I-SIGNAL-I-PDU", "Pdu")),
                ),
            ),
            _named(
                "I-SIGNAL-I-PDU",
                "Pdu",
                _tag("LENGTH", "8"),
                _wrapped(
                    "I-PDU-TIMING-SPECIFICATIONS I-PDU-TIMING TRANSMISSION-MODE-DECLARATION "
                    "TRANSMISSION-MODE-TRUE-TIMING CYCLIC-TIMING TIME-PERIOD VALUE",
                    "0.02",
                ),
                _wrapped(
                    "I-SIGNAL-TO-PDU-MAPPINGS",
                    _named(
                        "I-SIGNAL-TO-I-PDU-MAPPING",
                        "Map",
                        _to("I-SIGNAL-REF", "I-SIGNAL", "Speed"),
                        _tag("PACKING-BYTE-ORDER", "MOST-SIGNIFICANT-BYTE-LAST"),
                        _tag("START-POSITION", "8"),
                    ),
                ),
            ),
            _named(
                "I-SIGNAL",
                "Speed",
                _tag("LENGTH", "16"),
                _to("SYSTEM-SIGNAL-REF", "SYSTEM-SIGNAL", "SpeedOfAll"),
            ),
            _named(
                "SYSTEM-SIGNAL",
                "SpeedOfAll",
                _wrapped(
                    "PHYSICAL-PROPS SW-DATA-DEF-PROPS-VARIANTS SW-DATA-DEF-PROPS-CONDITIONAL",
                    _to("COMPU-METHOD-REF", "COMPU-METHOD", "Linear"),
                    _to("UNIT-REF", "UNIT", "Kmh"),
                ),
            ),
            _named(
                "COMPU-METHOD",
                "Linear",
                _tag("CATEGORY", "LINEAR"),
                _wrapped(
                    "COMPU-INTERNAL-TO-PHYS COMPU-SCALES COMPU-SCALE COMPU-RATIONAL-COEFFS",
                    _tag("COMPU-NUMERATOR", _tag("V", "-5"), _tag("V", "0.01")),
                    _tag("COMPU-DENOMINATOR", _tag("V", "1")),
                ),
            ),
            _named("UNIT", "Kmh", _tag("DISPLAY-NAME", "km/h")),
        ),
    )
    + "</AR-PACKAGES></AUTOSAR>"
)
"""A message with a signal, as a system description of AUTOSAR 4.2."""


def known(database: Database, *left: str) -> dict:
    """What is compared: all but what the format cannot say."""
    found = {}
    for message in database.messages.values():
        signals = {
            s.name: dataclasses.asdict(s) | {"note": bool(s.note), "line": 0, "receivers": ()}
            for s in message.signals.values()
        }
        whole = dataclasses.asdict(message) | {
            "signals": signals,
            "line": 0,
            "attributes": {},
            "file": "",
            "send_type": "",
        }
        for name in left:
            whole.pop(name)
        found[message.name] = whole
    return found


@pytest.fixture
def dbc(tmp_path: Path) -> Database:
    (tmp_path / "own.dbc").write_text(DBC)
    return load_database(tmp_path / "own.dbc")


def test_kcd(tmp_path, dbc):
    path = tmp_path / "m.kcd"
    path.write_text(cantools.database.load_string(DBC, "dbc").as_kcd_string())
    assert known(load_database(path)) == known(dbc)


def test_sym(tmp_path, dbc):
    path = tmp_path / "m.sym"
    path.write_text(SYM)
    database = load_database(path)
    assert database.nodes == () and not any(m.senders for m in database.messages.values())
    made = known(database, "senders")
    same = known(dbc, "senders")
    assert made["E"] == same["E"]
    assert made["M"]["signals"]["Speed"] == same["M"]["signals"]["Speed"]
    assert {k: v for k, v in made["M"].items() if k != "signals"} == {
        k: v for k, v in same["M"].items() if k != "signals"
    }


def test_arxml(tmp_path):
    path = tmp_path / "m.arxml"
    path.write_text(ARXML)
    (message,) = load_database(path).messages.values()
    assert (message.name, message.frame_id, message.length, message.fd) == ("Status", 0x123, 8, False)
    assert message.cycle_time == 0.02
    speed = message.require("Speed")
    assert (speed.start, speed.length, speed.little_endian, speed.signed) == (8, 16, True, False)
    assert (speed.scale, speed.offset, speed.unit) == (0.01, -5, "km/h")


@pytest.mark.parametrize("suffix", [s for s in SUFFIXES if s != ".dbc"])
@pytest.mark.parametrize("text", ["", "hello", "<xml/>"])
def test_a_file_that_is_none_of_its_format(tmp_path, suffix, text):
    path = tmp_path / f"bad{suffix}"
    path.write_text(text)
    with pytest.raises(ConfigError, match=rf"bad\{suffix}: not a valid {suffix[1:].upper()} file"):
        load_database(path)


@pytest.mark.parametrize("suffix", ["xlsx", "XLS", "dbf"])
def test_tables_are_refused_with_what_to_do(suffix: str) -> None:
    with pytest.raises(ConfigError, match=f"a.{suffix}: {suffix.upper()} is not read .* Export a DBC, KCD"):
        load_database(f"a.{suffix}")
