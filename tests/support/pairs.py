"""A system of a unit that evcosim built and one in C, which does wrong in some way at t = 0.5 s."""

from __future__ import annotations

from pathlib import Path

from support.c_fmu import mixed_fmu

SYSTEM = """
name = "pair"
[experiment]
stop_time = 1.0
algorithm = "{algorithm}"
[units.rider]
fmu = "Rider"
[units.a]
fmu = "{fmu}"
start = {{ u = 1.0 }}
step_timeout = 1.0
[[connect]]
from = "a.y"
to = ["rider.speed"]
"""


def pair(folder: Path, behavior: int, fmi: int = 2, algorithm: str = "gauss_seidel") -> Path:
    """Write the system and its FMU into a folder, and return the system's file."""
    fmu = mixed_fmu(folder / "mixed.fmu", fmi, behavior)
    (folder / "pair.toml").write_text(SYSTEM.format(fmu=fmu, algorithm=algorithm))
    return folder / "pair.toml"
