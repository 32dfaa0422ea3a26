"""FMPy's simulate_ssp: the speed of the vehicle after 20 s."""

import sys

from fmpy.ssp.simulation import simulate_ssp

result = simulate_ssp(sys.argv[1], stop_time=20.0, step_size=0.01)
print("SPEED", repr(float(result["vehicle.speed"][-1])))
