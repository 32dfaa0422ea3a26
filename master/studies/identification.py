"""Identification of G(s) = mu/(1 + s T) from any FMU or system.

    result = identify("scooter")                              # as its scenario `identification` says
    spec = IdentificationSpec(input="throttle", output="speed", unit="km/h", amplitude=1.0, at_input=[28.2])
    result = identify("Scooter", spec)                        # one FMU alone
    print(result.fit.gain, result.fit.pole, result.warnings)

The input is overridden, whatever drives it; what else the scenario moves is held where it starts, its events
are left out, and the result says so. The rest runs as in any other run: over the bus, or ideal.
`identification_run` does the experiment, `cosim.analysis` the computation.
"""

from __future__ import annotations

import contextlib
import dataclasses
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Unpack

import numpy as np

from ...cosim.analysis.first_order import Fit, Prediction, curvature, fit_first_order, flat_share
from ...cosim.analysis.frequency_response import FrequencyResponse, averaged, frequency_response, midpoints
from ...cosim.analysis.sweep import Sweep, sweep_of
from ...cosim.clock import Clock
from ...cosim.errors import ConfigError, RunError
from ...cosim.plan.resolve import step_size_of
from ...cosim.row_store import Array
from ...cosim.system.identification_spec import IdentificationSpec
from ...cosim.system.run_options import RunOptions, check_options, in_floats
from ...cosim.system.scenario import load_scenario
from ...cosim.system.system import load_system
from ..prepare import prepare
from ..simulation import Simulation
from ..single_fmu import UNIT
from .identification_run import IdentificationRun, PhaseProgress, described, longest, real_variable
from .identification_target import default_scenario, held, is_fmu, one_unit_system, spec_of

_FLAT = 0.2  # periods at an extreme: of a sine it is 0.06, quantized to 20 levels 0.1
_BEND = 0.12  # of the swing: the scooter at 30 km/h and 20 % has 0.09, at 25 % it meets a limit and has 0.19


@dataclasses.dataclass(frozen=True)
class Identification:
    """The result at one working point. Inputs are in `input_unit`, outputs in `output_unit`.

    `working_point` is an input and its steady output; `time` [s] since the start of the sweep, and the
    analyzed block averages `u` and `y`, have shape (n,).
    """

    target: str
    scenario: str
    ideal: bool
    input: str
    output: str
    input_unit: str
    output_unit: str
    working_point: tuple[float, float]
    sweep: Sweep
    fit: Fit
    response: FrequencyResponse
    time: Array
    u: Array
    y: Array
    prediction: Prediction
    warnings: tuple[str, ...]
    switched_off: tuple[str, ...] = ()
    """Sentences on the events that were left out and the stimuli that were held; they are warnings too."""

    @property
    def gain_unit(self) -> str:
        """The unit of the gain, as in `km/h per %`."""
        return f"{self.output_unit or '1'} per {self.input_unit or '1'}"

    def as_data(self) -> dict[str, Any]:
        """Return everything but the signals (JSON-able)."""
        fit, response = self.fit, self.response
        kept = (response.frequency >= self.sweep.start) & (response.frequency <= self.sweep.stop)
        return {
            "target": self.target,
            "scenario": self.scenario,
            "ideal": self.ideal,
            "input": {"name": self.input, "unit": self.input_unit, "value": self.working_point[0]},
            "output": {"name": self.output, "unit": self.output_unit, "value": self.working_point[1]},
            "sweep": dataclasses.asdict(self.sweep),
            "band": list(fit.band),
            "points": fit.points,
            "confidence": fit.confidence,
            "gain": dataclasses.asdict(fit.gain) | {"unit": self.gain_unit},
            "pole": dataclasses.asdict(fit.pole) | {"unit": "Hz"},
            "gain_times_pole": dataclasses.asdict(fit.product) | {"unit": f"({self.gain_unit}) Hz"},
            "time_constant": {"value": fit.model.time_constant, "unit": "s"},
            "correlation": fit.correlation,
            "separable": fit.separable,
            "residual": fit.residual,
            "coherence": fit.coherence,
            "mean_esr": {"value": self.prediction.mean_esr, "unit": "%"},
            "warnings": list(self.warnings),
            "switched_off": list(self.switched_off),
            "response": {
                "frequency": response.frequency[kept].tolist(),
                "real": response.response.real[kept].tolist(),
                "imaginary": response.response.imag[kept].tolist(),
                "coherence": response.coherence[kept].tolist(),
            },
        }


def identify(
    target: str,
    spec: IdentificationSpec | None = None,
    scenario: str | Path | None = None,
    *,
    progress: PhaseProgress | None = None,
    **options: Unpack[RunOptions],
) -> Identification:
    """Identify `target` (a system, or an FMU alone) at the first working point of `spec`.

    Without a spec the scenario's is taken. Parameters and start values of an FMU alone are named without a
    unit; the options are those of `Simulation`, except `stop_time` and `record`.
    Raises ConfigError for input that does not fit, before the sweep; RunError if the run fails, or the
    output does not come to rest or does not react.
    """
    check_options(options)
    options = in_floats(options)
    options["units"] = options.get("units") or "auto"
    spec = spec or spec_of(target, scenario)
    if spec is None:
        raise ConfigError(f"{target}: which input and output? There is no [identification] in its scenario")
    if options.get("stop_time") is not None:
        raise ConfigError("an identification ends when it is done, so that 'stop_time' cannot be given")
    if options.get("record"):
        raise ConfigError("an identification keeps no results, so that 'record' cannot be given")
    each_working_point(spec)  # refuses two kinds of them
    sweep = sweep_of(spec)
    alone = is_fmu(target)
    prefix = f"{UNIT}." if alone else ""
    if alone:
        system = one_unit_system(target, options.get("step_size"), options["units"])
    else:
        system = load_system(target)
    scenario = scenario if alone else default_scenario(system, scenario)
    if alone and scenario is not None:
        raise ConfigError(f"{target} is an FMU: it has no scenario '{scenario}'")
    options["parameters"] = {prefix + n: value for n, value in (options.get("parameters") or {}).items()}
    options["start"] = {prefix + n: value for n, value in (options.get("start") or {}).items()}
    driven = load_scenario(system, None if scenario is None else str(scenario))
    step_size = step_size_of(system, driven, options)
    options["stop_time"] = stop_time = longest(sweep, step_size)
    clock = Clock.counted(system.file.experiment.start_time, step_size, round(stop_time / step_size))
    driven, changes = held(driven, spec.input, clock)
    with _as_long_as(sweep), Simulation(system, driven, **options) as simulation:
        run = IdentificationRun(simulation, spec, sweep, prefix, progress or (lambda what, share: None))
        return _identified(run, target, changes)


@contextlib.contextmanager
def _as_long_as(sweep: Sweep) -> Iterator[None]:
    """Let an error about the stop time, which nobody gave, name the sweep that it follows from."""
    try:
        yield
    except ConfigError as error:
        first, *lines = error.lines
        if not first.startswith("stop_time: "):
            raise
        raise ConfigError(first.replace("stop_time", described(sweep), 1), *lines) from error


def check_ends(target: str, spec: IdentificationSpec, scenario: str | Path | None = None) -> None:
    """Raise ConfigError for an input or output of `spec` that the target does not have; nothing is run."""
    alone = is_fmu(target)
    system = one_unit_system(target) if alone else load_system(target)
    chosen = None if alone else default_scenario(system, scenario)
    plan = prepare(system, load_scenario(system, None if chosen is None else str(chosen))).plan
    for name, role in ((spec.input, "input"), (spec.output, "output")):
        real_variable(plan, f"{UNIT}.{name}" if alone else name, role)


def each_working_point(spec: IdentificationSpec) -> list[IdentificationSpec]:
    """Return a spec for each working point of `spec`: `spec` itself if it names one or none.

    Raises ConfigError if working points of both input and output are given.
    """
    if spec.at and spec.at_input:
        raise ConfigError(
            "working points are given of the output (at) or of the input (at_input), not of both"
        )
    if spec.at_input:
        return [spec.model_copy(update={"at_input": [u]}) for u in spec.at_input]
    return [spec.model_copy(update={"at": [y]}) for y in spec.at] or [spec]


def _identified(run: IdentificationRun, target: str, changes: tuple[str, ...]) -> Identification:
    """Do all phases and the analysis. Raises RunError for a fit that says nothing.

    `changes` are sentences about what the scenario would have moved beside the input.
    """
    u_0, y_0 = run.working_point()
    raw_u, raw_y, saturated = run.swept(u_0)
    u, y = averaged(raw_u, run.block), averaged(midpoints(raw_y), run.block)
    _check_answer(run, y, y_0)
    rate = 1.0 / (run.block * run.step)
    time = run.centers(len(u), run.block)
    segment = 1 << int(np.log2(max(run.sweep.duration * rate / 4.0, 1.0)))
    response = frequency_response(u, y, rate, segment)
    fit = fit_first_order(response, run.spec.fit_band)
    if refusal := fit.refusal:
        raise RunError(
            f"{run.spec.input} to {run.spec.output} at {u_0:.6g} {run.variable.unit}: no gain and no pole: "
            f"{refusal}"
        )
    warnings = [
        *changes,
        *(f"{signal} saturates in the sweep: reduce the amplitude" for signal in saturated),
        *_limits(run, time, u - u_0, y - y_0, fit, rate),
        *fit.warnings,
        *run.simulation.warnings,
    ]
    return Identification(
        target=target,
        scenario=run.simulation.plan.scenario,
        ideal=run.simulation.plan.ideal,
        input=run.spec.input,
        output=run.spec.output,
        input_unit=run.variable.unit,
        output_unit=run.output_unit,
        working_point=(u_0, y_0),
        sweep=run.sweep,
        fit=fit,
        response=response,
        time=time,
        u=u,
        y=y,
        prediction=run.tested(fit, u_0, y_0),
        warnings=tuple(dict.fromkeys(warnings)),
        switched_off=changes,
    )


def _check_answer(run: IdentificationRun, y: Array, y_0: float) -> None:
    """Raise RunError if the output stayed at `y_0` in the whole sweep."""
    if not np.ptp(y) > 1e-9 * max(abs(y_0), run.peak):
        raise RunError(
            f"{run.spec.output} does not answer to {run.spec.input}: it stays at {y_0:.6g} "
            f"{run.output_unit} in the whole sweep"
        )


def _limits(run: IdentificationRun, time: Array, u: Array, y: Array, fit: Fit, rate: float) -> list[str]:
    """Return a warning for each sign that something was cut off.

    `time` [s] and the deviations `u` and `y` from the working point have shape (n,); `rate` [Hz] is theirs.
    """
    warnings = []
    flat = flat_share(y, run.sweep.frequency(time), rate)
    if flat > _FLAT:
        warnings.append(
            f"{run.spec.output} stays at an extreme for {flat:.2f} periods of the sweep: it hits a "
            "limit, or its resolution is too coarse for this amplitude"
        )
    predicted = midpoints(fit.model.simulated(u, 1.0 / rate))
    bend = curvature(predicted, y)
    if bend > _BEND:
        warnings.append(
            f"{run.spec.output} bends by {100 * bend:.0f} % from a straight line in what a linear model "
            "gives: something saturates or is not linear at this amplitude; reduce it"
        )
    return warnings
