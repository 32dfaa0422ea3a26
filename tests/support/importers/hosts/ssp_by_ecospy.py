"""Ecos, which reads an SSP itself: the speed of the vehicle after 20 s."""

import sys

from ecospy import EcosLib, EcosSimulation

EcosLib.set_log_level("warn")
with EcosSimulation(ssp_path=sys.argv[1], step_size=0.01) as simulation:
    simulation.init()
    simulation.step(2000)
    print("SPEED", repr(simulation.get_real("vehicle::speed")))
    simulation.terminate()
