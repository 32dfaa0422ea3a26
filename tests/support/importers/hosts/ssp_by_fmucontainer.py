"""fmucontainer, which makes a container of an SSP: the speed of the vehicle after 20 s."""

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from fmpy.simulation import simulate_fmu

with tempfile.TemporaryDirectory() as folder:
    shutil.copy(sys.argv[1], Path(folder, "system.ssp"))
    command = [Path(sys.executable).with_name("fmucontainer"), "-fmu-directory", folder, "-auto-local"]
    made = subprocess.run(
        [*command, "-container", "system.ssp:0.01"], cwd=folder, capture_output=True, text=True
    )
    containers = list(Path(folder).glob("*.fmu"))
    print(made.stdout, made.stderr, containers)
    result = simulate_fmu(
        str(max(containers, key=lambda file: file.stat().st_mtime)), stop_time=20.0, step_size=0.01
    )
    print(result.dtype.names)
    print("SPEED", repr(float(result["vehicle.speed"][-1])))
