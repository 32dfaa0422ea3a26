"""A database of signals that nothing fills: both byte orders, signed, floats, classic and CAN FD."""

from __future__ import annotations

_SIGNALS = """ SG_ Fed : 0|8@1+ (1,0) [0|254] "km/h" VCU
 SG_ Motorola : 15|12@0+ (0.5,0) [0|2000] "" VCU
 SG_ Signed : 28|10@1- (1,0) [-511|511] "" VCU
 SG_ Started : 38|5@1+ (2,10) [10|70] "" VCU
 SG_ Bare : 43|3@1+ (1,0) [0|7] "" VCU
 SG_ Flag : 46|2@1+ (1,0) [0|2] "" VCU
"""
DATABASE = f"""VERSION ""
NS_ :
BS_:
BU_: VCU EMD
BO_ 300 Short: 8 EMD
{_SIGNALS}
BO_ 301 Long: 20 EMD
{_SIGNALS} SG_ Wide : 71|40@0- (1,0) [0|0] "" VCU
 SG_ Real : 112|32@1- (1,0) [0|0] "" VCU

BA_DEF_ BO_ "GenMsgCycleTime" INT 0 65535;
BA_DEF_ SG_ "GenSigSNA" INT -32768 65535;
BA_DEF_ SG_ "GenSigStartValue" FLOAT -1E12 1E12;
BA_DEF_DEF_ "GenMsgCycleTime" 10;
BA_DEF_DEF_ "GenSigSNA" 0;
BA_DEF_DEF_ "GenSigStartValue" 0;
BA_ "GenSigSNA" SG_ 300 Motorola 4095;
BA_ "GenSigSNA" SG_ 301 Motorola 4095;
BA_ "GenSigStartValue" SG_ 300 Motorola 5;
BA_ "GenSigStartValue" SG_ 301 Motorola 5;
BA_ "GenSigSNA" SG_ 300 Signed -512;
BA_ "GenSigSNA" SG_ 301 Signed -512;
BA_ "GenSigStartValue" SG_ 300 Started 9;
BA_ "GenSigStartValue" SG_ 301 Started 9;
BA_ "GenSigStartValue" SG_ 301 Wide -77;
BA_ "GenSigStartValue" SG_ 301 Real -2.5;
VAL_ 300 Flag 3 "SNA" 0 "off" ;
VAL_ 301 Flag 3 "SNA" 0 "off" ;
VAL_ 301 Real 7 "SNA" ;
SIG_VALTYPE_ 301 Real : 1;
"""

EXPECTED: dict[str, tuple[float, str]] = {
    "Motorola": (4095, "not available"),
    "Signed": (-512, "not available"),
    "Started": (9, "start value"),
    "Bare": (0, "zero"),
    "Flag": (3, "not available"),
    "Wide": (-77, "start value"),
    "Real": (-2.5, "start value"),
}
"""Raw value and reason of the signals of `Long`; `Short` has all but the last two."""
