"""Files with a table for every numeric key: a system, a scenario of it, and a swap file for its vehicle.

A key that is not in them can be added to its table. The scenario runs in the built-in scooter too; what needs
frames that take time, and a log, it has in addition in `ON_FRAMES`.
"""

from __future__ import annotations

from . import small_bench

DATABASE = small_bench.DATABASE.replace(
    "BA_DEF_ BO_", 'BO_ 512 GRIP_Brake: 1 GRIP\n SG_ Force : 0|8@1+ (1,0) [0|250] "N" EMD\nBA_DEF_ BO_', 1
).replace("BU_: VCU EMD", "BU_: VCU EMD GRIP")
"""Of `SYSTEM`: that of the small bench, and a message that no unit sends."""
LOG = "".join(f"(0.{i}00000) can0 200#{i:02X}\n" for i in range(1, 4))
"""The log `bench.log`."""
_SHOWN = """[[figure.panels]]
signals = [{ name = "vehicle.speed", weight = 1.0 }]
unit = "km/h"
limits = [0.0, 30.0]
[figure.until]
signal = "vehicle.speed"
below = 0.0
unit = "km/h"
[[metrics]]
name = "above"
signal = "vehicle.speed"
reduce = "share_above"
threshold = 1.0
threshold_unit = "km/h"
after = 0.0
per = { signal = "vehicle.distance", reduce = "share_above", threshold = 1.0, after = 0.0 }
[[metrics]]
name = "equal"
signal = "ecu.state"
reduce = "share_equal"
value = 1
per = { signal = "ecu.state", reduce = "share_equal", value = 1 }
"""

SYSTEM = (
    """
name = "bench"
record = ["*"]
[experiment]
start_time = 0.0
stop_time = 0.03
step_size = 0.01
loop_tolerance = 1e-9
[units.ecu]
fmu = "BoundController"
parameters = { gain = 0.05 }
start = { speed_bound = 30.0 }
[units.ecu.map.inputs]
speed_measured = { variable = "speed_measured", factor = 1.0, offset = 0.0, convert = true }
[units.ecu.map.outputs]
throttle = { variable = "throttle", factor = 1.0, offset = 0.0, convert = true }
[units.ecu.map.parameters]
gain = { variable = "gain", factor = 1.0, offset = 0.0, convert = true }
[units.vehicle]
fmu = "Scooter"
period = 0.01
offset = 0.0
[buses.can0]
dbc = "bench.dbc"
timing = "frame"
[buses.can0.messages.EMD_Status]
cycle_time = 0.01
jitter = 0.001
timeout = 3
on_timeout = "initial"
initial = { EMD_VehicleSpeed = 1.0 }
[buses.can0.messages.VCU_Request]
send_type = "cyclic_and_on_change"
cycle_time = 0.02
min_interval = 0.01
start_delay = 0.0
[buses.can0.messages.EMD_Status.e2e]
profile = "2"
data_id = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16]
crc = "EMD_Crc"
counter = "EMD_Counter"
max_delta = 1
[[connect]]
from = "vehicle.speed"
to = ["ecu.speed_measured"]
via = "can0.EMD_Status.EMD_VehicleSpeed"
needed_where = { "ecu.gain" = 0.05 }
[[connect]]
from = "ecu.throttle"
to = ["vehicle.throttle"]
via = "can0.VCU_Request.VCU_ThrottleRequest"
initial = 0.0
"""
    + _SHOWN
    + """[budget]
metric = "above"
limit = 1.0
"""
)

SCENARIO = (
    """
[experiment]
stop_time = 0.03
step_size = 0.01
[parameters.ecu]
gain = 0.05
[start.ecu]
speed_bound = 20.0
[[stimulus]]
to = "ecu.throttle_request"
constant = 1.0
[[stimulus]]
to = "vehicle.road_grade"
table = [[0.0, 0.0], [0.02, 0.1]]
[[stimulus]]
to = "ecu.speed_bound"
sine = { amplitude = 1.0, period = 1.0, mean = 20.0, phase = 0.0, delay = 0.0 }
[[stimulus]]
to = "ecu.acceleration_bound"
ramp = { slope = 1.0, start = 0.0, end = 2.0, delay = 0.0 }
[[fault]]
action = "corrupt"
time = 0.01
duration = 0.01
message = "can0.EMD_Status"
count = 1
every = 1
probability = 0.5
seed = 1
byte = 0
mask = 1
[[fault]]
action = "delay"
time = 0.02
duration = 0.01
message = "can0.EMD_Status"
by = 0.01
[[fault]]
action = "bus_off"
time = 0.01
duration = 0.01
node = "can0.EMD"
[[event]]
action = "override"
time = 0.01
variable = "ecu.throttle_request"
value = 1.0
"""
    + _SHOWN
    + """[identification]
input = "ecu.throttle_request"
output = "vehicle.speed"
amplitude = 1.0
at = [1.0]
at_input = [1.0]
sweep = [0.1, 0.6]
duration = 100.0
repeats = 1
band = [0.1, 0.5]
"""
)
ON_FRAMES = (
    SCENARIO
    + """
[[stimulus]]
can_log = "bench.log"
bus = "can0"
time_offset = 0.1
channel = "can0"
to = { "vehicle.brake_force" = "GRIP_Brake.Force" }
[[fault]]
action = "babble"
time = 0.01
duration = 0.01
bus = "can0"
id = 1
length = 8
period = 0.001
"""
)
SWAP = """
fmu = "Scooter"
period = 0.01
offset = 0.0
[parameters]
mass = 200.0
[start]
brake_force = 0.0
[map.inputs]
throttle = { variable = "throttle", factor = 1.0, offset = 0.0, convert = true }
[map.outputs]
speed = { variable = "speed", factor = 1.0, offset = 0.0, convert = true }
[map.parameters]
mass = { variable = "mass", factor = 1.0, offset = 0.0, convert = true }
"""
