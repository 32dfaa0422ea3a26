"""Hostile CAN databases: each field of the messages that a system uses, and statements about them."""

from __future__ import annotations

import random
import re

from support.fuzzing.changes import NUMBERS, TEXTS, Input, encoded, mutated
from support.fuzzing.toml_files import SHORT, read

SMALL = """VERSION ""

NS_ :

BS_:

BU_: VCU EMD BMS

BO_ 256 VCU_Request: 8 VCU
 SG_ VCU_ThrottleRequest : 0|8@1+ (0.4,0) [0|100] "%" EMD

BO_ 328 EMD_Status: 8 EMD
 SG_ EMD_VehicleSpeed : 0|8@1+ (1,0) [0|254] "km/h" VCU
 SG_ EMD_Power : 8|16@1- (1,0) [-32000|32000] "W" VCU,BMS

BO_ 512 BMS_Status: 8 BMS
 SG_ BMS_PackVoltage : 7|16@0+ (0.1,0) [0|1000] "V" VCU,EMD
 SG_ BMS_PackCurrent : 16|16@1- (0.1,0) [-1500|1500] "A" VCU
 SG_ BMS_Soc : 32|32@1- (1,0) [0|100] "%" VCU

BO_ 528 VCU_State: 2 VCU
 SG_ VCU_ControllerState : 0|3@1+ (1,0) [0|3] "" EMD

CM_ BO_ 256 "asked";
CM_ SG_ 328 EMD_VehicleSpeed "255 = SNA";
BA_DEF_ BO_ "GenMsgCycleTime" INT 0 65535;
BA_DEF_ BO_ "GenMsgSendType" ENUM "Cyclic","Event","IfActive","NoMsgSendType";
BA_DEF_ BO_ "GenMsgStartDelayTime" INT 0 65535;
BA_DEF_ BO_ "VFrameFormat" ENUM "StandardCAN","ExtendedCAN","StandardCAN_FD";
BA_DEF_ SG_ "GenSigStartValue" FLOAT -1E+009 1E+009;
BA_DEF_ SG_ "GenSigSNA" INT -32768 65535;
BA_DEF_ "BusType" STRING ;
BA_DEF_DEF_ "GenMsgCycleTime" 10;
BA_DEF_DEF_ "GenMsgSendType" "Cyclic";
BA_DEF_DEF_ "GenMsgStartDelayTime" 0;
BA_DEF_DEF_ "VFrameFormat" "StandardCAN";
BA_DEF_DEF_ "GenSigStartValue" 0;
BA_DEF_DEF_ "GenSigSNA" 0;
BA_DEF_DEF_ "BusType" "CAN";
BA_ "BusType" "CAN";
BA_ "GenMsgCycleTime" BO_ 256 10;
BA_ "GenMsgStartDelayTime" BO_ 328 10;
BA_ "GenMsgSendType" BO_ 328 0;
BA_ "GenSigSNA" SG_ 328 EMD_VehicleSpeed 255;
BA_ "GenSigStartValue" SG_ 512 BMS_PackVoltage 480;
VAL_ 328 EMD_VehicleSpeed 255 "SNA" ;
VAL_ 528 VCU_ControllerState 2 "Velocity" 1 "Acceleration" 0 "Driver" ;
SIG_VALTYPE_ 512 BMS_Soc : 1;
"""
"""A database with every kind of statement about the messages of the scooter."""

SPOTS = {
    "frame": re.compile(r"(?<=^BO_ )\d+", re.M),
    "bytes": re.compile(r"(?<=: )\d+(?= \w+$)", re.M),
    "start": re.compile(r"(?<= : )\d+(?=\|)"),
    "length": re.compile(r"(?<=\|)\d+(?=@)"),
    "order": re.compile(r"(?<=@)[01](?=[+-])"),
    "scale": re.compile(r"(?<=\()[^,()]+(?=,[^()]*\) \[)"),
    "offset": re.compile(r"(?<=,)[^,()]+(?=\) \[)"),
    "minimum": re.compile(r"(?<=\[)[^|\]]+(?=\|)"),
    "maximum": re.compile(r"(?<=\|)[^|\]]+(?=\])"),
    "attribute": re.compile(r"(?<= )-?[\d.]+(?=;$)", re.M),
    "limits": re.compile(r"(?<= )-?[\d.E+]+(?=[ ;])"),
    "type": re.compile(r"\b(?:INT|FLOAT|ENUM|STRING)\b"),
    "choice": re.compile(r'(?<= )\d+(?= ")'),
    "float": re.compile(r"(?<= : )\d(?=;)"),
    "unit": re.compile(r'(?<=\] )"[^"]*"'),
}
"""The fields of a database, by name."""

_TYPES = ("INT", "FLOAT", "STRING", "ENUM", "HEX", "ODD", '"STRING"', "")
_SIZES = ("0", "1", "63", "64", "65", "512", "513", "1000000000", "4294967296", "99999999999999999999")


def changed(random: random.Random, text: str) -> bytes:
    """Return a database with changes of its fields or of its characters."""
    if random.random() < 0.3:
        return mutated(random, text, random.choice(("(", '"', "SG_ ", "BO_ 1 a: 8 a\n", "VAL_ 1 a 1 ")))
    for _ in range(random.choice((1, 1, 1, 2, 3))):
        name = random.choice(list(SPOTS))
        found = random.choice(list(SPOTS[name].finditer(text)) or [None])
        if found is None:
            continue
        choices = _TYPES if name == "type" else [f'"{t}"' for t in TEXTS] if name == "unit" else NUMBERS
        new = random.choice(_SIZES if name in ("start", "length", "bytes", "frame") else choices)
        text = text[: found.start()] + new + text[found.end() :]
    return encoded(random, text)


def a_database(random: random.Random) -> Input:
    """A CAN database, run, shown, or with its frames logged."""
    text = changed(random, SMALL if random.random() < 0.8 else read("can", "ev.dbc"))
    files = {"s.toml": read("systems", "scooter.toml").encode(), "can/ev.dbc": text}
    engine = random.choice(([], ["--engine", "python"]))
    command = random.choice(
        (
            ["info", "s.toml"],
            ["run", "s.toml", *SHORT, "--no-plot", *engine],
            ["run", "s.toml", *SHORT, "--no-plot", *engine],
            ["run", "s.toml", *SHORT, "--no-plot", "--can-log", "can.asc"],
            ["check", "Scooter", "--as", "s.toml.vehicle"],
        )
    )
    return Input("DBC", command, files)
