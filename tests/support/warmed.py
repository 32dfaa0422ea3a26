"""What a command of `evcosim` needs, imported and used once, for `support.warm`."""

from __future__ import annotations

import importlib
import io

from matplotlib.figure import Figure

from evcosim.master.cli.app import command
from evcosim.master.simulation import simulate

for _name in (
    "cantools.database",
    "scipy.linalg.cython_blas",
    "scipy.signal",
    "typer._adapters",
    "evcosim.cosim.figures.shown",
    "evcosim.cosim.report.page",
    "evcosim.cosim.results.compare",
    "evcosim.master.engine.compiled.engine",
    "evcosim.master.fmi.exchange",
    "evcosim.master.fmi.loading",
    "evcosim.master.isolation.child",
    "evcosim.master.isolation.machine_turns",
    "evcosim.master.machine.rows",
    "evcosim.master.simulation",
    "evcosim.master.single_fmu",
    "evcosim.master.studies.identification",
):
    importlib.import_module(_name)

list(command().commands.values())  # the modules of the verbs
for _name in ("scooter", "lane_keeping", "braking", "multi_drive"):
    simulate(_name, stop_time=0.02, engine="python")  # the models of its FMUs are imported
_figure = Figure(layout="constrained")
_axes = _figure.subplots()
_axes.plot([0.0, 1.0], label="$x$")
_axes.legend()
for _format in ("png", "svg"):  # matplotlib finds its fonts
    _figure.savefig(io.BytesIO(), format=_format)
