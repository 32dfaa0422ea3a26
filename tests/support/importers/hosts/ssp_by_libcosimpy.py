"""libcosim, which reads an SSP itself: the speed of the vehicle after 20 s."""

import sys

from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimObserver import CosimObserver

execution = CosimExecution.from_ssp_file(sys.argv[1], step_size=10_000_000)
observer = CosimObserver.create_last_value()
execution.add_observer(observer)
execution.step(2000)
index = execution.slave_index_from_instance_name("vehicle")
variables = execution.slave_variables(index)
reference = next(v.reference for v in variables if v.name == b"speed")
print("SPEED", repr(observer.last_real_values(index, [reference])[0]))
