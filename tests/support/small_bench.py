"""A small system with a bus, a metric and a budget, for tests that spoil one number at a time."""

from __future__ import annotations

from pathlib import Path

DATABASE = """VERSION ""
NS_ :
BS_:
BU_: VCU EMD
BO_ 256 VCU_Request: 2 VCU
 SG_ VCU_ThrottleRequest : 0|8@1+ (0.4,0) [0|100] "%" EMD
BO_ 328 EMD_Status: 8 EMD
 SG_ EMD_VehicleSpeed : 0|8@1+ (1,0) [0|254] "km/h" VCU
 SG_ EMD_Crc : 8|8@1+ (1,0) [0|255] "" VCU
 SG_ EMD_Counter : 16|4@1+ (1,0) [0|14] "" VCU
BA_DEF_ BO_ "GenMsgCycleTime" INT 0 65535;
BA_DEF_ SG_ "GenSigSNA" INT -32768 65535;
BA_DEF_DEF_ "GenMsgCycleTime" 10;
BA_DEF_DEF_ "GenSigSNA" 0;
BA_ "GenSigSNA" SG_ 256 VCU_ThrottleRequest 255;
BA_ "GenSigSNA" SG_ 328 EMD_VehicleSpeed 255;
VAL_ 256 VCU_ThrottleRequest 255 "SNA" ;
VAL_ 328 EMD_VehicleSpeed 255 "SNA" ;
"""
"""What of `can/ev.dbc` the bus carries: the whole of it takes longer to read than a short run."""


def bench(dbc: str = "bench.dbc", vehicle: str = "Scooter") -> str:
    """The system without a metric: two units, and the speed over a bus of this database."""
    return f"""
name = "bench"
experiment = {{ step_size = 0.01, stop_time = 0.03 }}
units = {{ ecu = {{ fmu = "BoundController" }}, vehicle = {{ fmu = "{vehicle}" }} }}
buses = {{ can0 = {{ dbc = "{dbc}" }} }}
[[connect]]
from = "vehicle.speed"
to = ["ecu.speed_measured"]
via = "can0.EMD_Status.EMD_VehicleSpeed"
"""


SYSTEM = f"""{bench()}\
[[connect]]
from = "ecu.throttle"
to = ["vehicle.throttle"]
[[metrics]]
name = "above"
signal = "vehicle.speed"
reduce = "share_above"
threshold = 1.0
[budget]
metric = "above"
limit = 1.0
"""


def write(folder: Path) -> Path:
    """Write the system, and the database beside it, and return the path of the system."""
    (folder / "bench.dbc").write_text(DATABASE)
    (folder / "s.toml").write_text(SYSTEM)
    return folder / "s.toml"
