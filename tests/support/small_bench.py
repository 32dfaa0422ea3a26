"""A small system file with a bus, a metric and a budget, for tests that spoil one number at a time."""

SYSTEM = """
name = "bench"
experiment = { step_size = 0.01, stop_time = 0.03 }
units = { ecu = { fmu = "BoundController" }, vehicle = { fmu = "Scooter" } }
buses = { can0 = { dbc = "can/ev.dbc" } }
[[connect]]
from = "vehicle.speed"
to = ["ecu.speed_measured"]
via = "can0.EMD_Status.EMD_VehicleSpeed"
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
