"""Identification of G(s) = mu/(1 + s T) from any FMU or system: the experiment round `cosim.identification`.

    result = identify("scooter")                              # as its scenario `identification` says
    spec = IdentificationSpec(input="throttle", output="speed", unit="km/h", amplitude=1.0, at_input=[28.2])
    result = identify("Scooter", spec)                        # one FMU alone
    print(result.fit.gain, result.fit.pole, result.warnings)

The input is overridden, whatever drives it, and everything else runs as in any other run: over the bus, or
ideal. Four phases: the input that gives the working point is searched for; the output comes to rest; the
sweep; a square wave of the same amplitude, on which the fitted model is tested.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any, Unpack

import numpy as np

from ...cosim.analysis.first_order import Fit, Prediction, curvature, fit_first_order, flat_share, predict
from ...cosim.analysis.frequency_response import (
    FrequencyResponse,
    averaged,
    block_length,
    frequency_response,
    midpoints,
)
from ...cosim.analysis.sweep import Sweep, sweep_of
from ...cosim.errors import ConfigError, RunError, nearest
from ...cosim.interface import VariableInfo
from ...cosim.row_store import Array
from ...cosim.system.identification_spec import IdentificationSpec
from ...cosim.system.run_options import RunOptions
from ...cosim.system.scenario import load_scenario, scenario_names
from ...cosim.system.system import (
    Experiment,
    System,
    SystemFile,
    UnitEntry,
    load_system,
    system_names,
)
from ...cosim.units import Affine, conversion, defined
from ..builtin import builtin_names, fmu_file
from ..fmi.fmu import read_fmu
from ..simulation import Simulation

SCENARIO = "identification"
"""The scenario that a system is identified in where it has one of this name."""

UNIT = "fmu"
"""The name of the unit that an FMU alone is."""

PhaseProgress = Callable[[str, float], None]
"""Called with what is going on and how much of it is done, 0 to 1."""

_SETTLED = 1e-3  # change of the mean from one window to the next, as a share of the largest output seen
_WINDOWS = 60  # to wait for rest before giving up
_TRIES = 12  # inputs tried for a working point
_FLAT = 0.2  # periods at an extreme: of a sine it is 0.06, quantized to 20 levels 0.1
_BEND = 0.12  # of the swing: the scooter at 30 km/h and 20 % has 0.09, at 25 % it meets a limit and has 0.19
_PULSES = 6  # half periods of the square wave


@dataclasses.dataclass(frozen=True)
class Identification:
    """What was found at one working point. Inputs in `input_unit`, outputs in `output_unit`.

    `working_point` is an input and its steady output; `time` [s] since the start of the sweep, `u` and `y`
    are the block averages that were analyzed, shape (n,).
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

    @property
    def gain_unit(self) -> str:
        """The unit of the gain, as in `km/h per %`."""
        return f"{self.output_unit or '1'} per {self.input_unit or '1'}"

    def as_data(self) -> dict[str, Any]:
        """Everything but the signals (JSON-able)."""
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
            "response": {
                "frequency": response.frequency[kept].tolist(),
                "real": response.response.real[kept].tolist(),
                "imaginary": response.response.imag[kept].tolist(),
                "coherence": response.coherence[kept].tolist(),
            },
        }


def is_fmu(target: str) -> bool:
    """Whether `target` names an FMU rather than a system.

    Raises ConfigError with the nearest name where it names neither.
    """
    if target in builtin_names() or target.endswith(".fmu"):
        return True
    known = system_names()
    if target in known or target.endswith(".toml") or "/" in target or "\\" in target:
        return False
    names = [*known, *builtin_names()]
    raise ConfigError(
        f"there is no system or FMU '{target}'{nearest(target, names)}; systems: {', '.join(known)}; "
        f"FMUs: {', '.join(builtin_names())}"
    )


def one_unit_system(target: str, step_size: float | None = None) -> System:
    """A system of one FMU (a built-in name or a path) as the unit `fmu`.

    `step_size` [s]: default that of the FMU's DefaultExperiment, else 0.01.
    """
    path = fmu_file(target)
    experiment = getattr(read_fmu(path).description, "defaultExperiment", None)
    declared = getattr(experiment, "stepSize", None)
    step = step_size or (float(declared) if declared else 0.01)
    name = path.stem if target.endswith(".fmu") else target
    file = SystemFile(
        name=name if name.isidentifier() else UNIT,
        experiment=Experiment(step_size=step),
        units={UNIT: UnitEntry(fmu=str(path.resolve()))},
    )
    return System(Path(target), file)


def default_scenario(system: System, scenario: str | Path | None) -> str | Path | None:
    """The scenario asked for, else `identification` where the system has it, else (None) its default."""
    return SCENARIO if scenario is None and SCENARIO in scenario_names(system) else scenario


def spec_of(target: str, scenario: str | Path | None = None) -> IdentificationSpec | None:
    """The table `[identification]` of the scenario that `target` is identified in, if there is one."""
    if is_fmu(target):
        return None
    system = load_system(target)
    chosen = default_scenario(system, scenario)
    return load_scenario(system, None if chosen is None else str(chosen)).file.identification


def identify(
    target: str,
    spec: IdentificationSpec | None = None,
    scenario: str | Path | None = None,
    *,
    step_size: float | None = None,
    progress: PhaseProgress | None = None,
    **options: Unpack[RunOptions],
) -> Identification:
    """Identify `target` (a system, or an FMU alone) at the first working point of `spec`.

    Without a spec the scenario's is taken. Parameters of an FMU alone are named without a unit, and
    `step_size` [s] is for it alone; the other arguments are those of `Simulation`, but for `stop_time`.
    Raises ConfigError for input that does not fit, before the sweep; RunError for a run that fails, an
    output that does not come to rest or does not answer.
    """
    spec = spec or spec_of(target, scenario)
    if spec is None:
        raise ConfigError(f"{target}: which input and output? There is no [identification] in its scenario")
    if options.get("stop_time") is not None:
        raise ConfigError("an identification ends when it is done, so that 'stop_time' cannot be given")
    sweep = sweep_of(spec)
    alone = is_fmu(target)
    prefix = f"{UNIT}." if alone else ""
    system = one_unit_system(target, step_size) if alone else load_system(target)
    scenario = scenario if alone else default_scenario(system, scenario)
    if alone and scenario is not None:
        raise ConfigError(f"{target} is an FMU: it has no scenario '{scenario}'")
    if step_size is not None and not alone:
        raise ConfigError(f"{target} is a system: its step size stands in its file")
    options["parameters"] = {prefix + n: value for n, value in (options.get("parameters") or {}).items()}
    options["stop_time"] = _longest(sweep, system.file.experiment.step_size)
    with Simulation(system, scenario, **options) as simulation:
        bench = _Bench(simulation, spec, sweep, prefix, progress or (lambda what, share: None))
        return bench.identified(target)


def each_working_point(spec: IdentificationSpec) -> list[IdentificationSpec]:
    """A spec for each working point of `spec`; itself when it names one or none."""
    if spec.at and spec.at_input:
        raise ConfigError(
            "working points are given of the output (at) or of the input (at_input), not of both"
        )
    if spec.at_input:
        return [spec.model_copy(update={"at_input": [u]}) for u in spec.at_input]
    return [spec.model_copy(update={"at": [y]}) for y in spec.at] or [spec]


def _longest(sweep: Sweep, step_size: float) -> float:
    """A stop time [s] that no phase goes beyond, a multiple of the step."""
    settling = (_TRIES + 3) * _WINDOWS * _window(sweep)
    pulses = _PULSES / sweep.start
    return step_size * math.ceil((settling + sweep.length + pulses) / step_size)


def _window(sweep: Sweep) -> float:
    """Seconds over which the output is averaged to see whether it rests: half a radian at the lowest
    frequency, which is below the pole where it is chosen well."""
    return 0.5 / (2.0 * math.pi * sweep.start)


class _Bench:
    """A simulation with one input in our hands. Outputs are in the unit asked for."""

    def __init__(
        self,
        simulation: Simulation,
        spec: IdentificationSpec,
        sweep: Sweep,
        prefix: str,
        progress: PhaseProgress,
    ) -> None:
        self.simulation, self.spec, self.sweep, self.progress = simulation, spec, sweep, progress
        self.input, self.output = prefix + spec.input, prefix + spec.output
        self.variable = self._real(self.input, "input")
        shown = self._real(self.output, "output")
        self.output_unit, self.convert = shown.unit, Affine()
        if spec.unit is not None and spec.unit != shown.unit:
            self.output_unit, self.convert = spec.unit, self._conversion(shown, spec.unit)
        self.step = simulation.plan.experiment.step_size
        sweep.check_step(self.step)
        self.block = block_length(sweep.stop, self.step)
        self.hold = max(1, self.block // 4)
        self.peak = 0.0
        each_working_point(spec)  # refuses two kinds of working points

    def _real(self, name: str, role: str) -> VariableInfo:
        known = {c.name: c for c in self.simulation.plan.columns}
        offered = [
            n for n, c in known.items() if c.type == "Real" and (role == "output" or c.causality == "input")
        ]
        if name not in offered:
            why = "is no Real" if name in known and known[name].type != "Real" else "is not there"
            if name in known and role == "input" and known[name].causality != "input":
                why = f"is of causality {known[name].causality}"
            shown, short = [n.removeprefix(f"{UNIT}.") for n in offered], name.removeprefix(f"{UNIT}.")
            raise ConfigError(
                f"{role} {short}: it {why}{nearest(short, shown)}; "
                f"recorded Real {role}s: {', '.join(shown) or 'none'}"
            )
        unit, _, variable = name.partition(".")
        return next(u for u in self.simulation.plan.units if u.name == unit).interface.variables[variable]

    def _conversion(self, shown: VariableInfo, unit: str) -> Affine:
        owner = self.output.partition(".")[0]
        known = next(u for u in self.simulation.plan.units if u.name == owner).interface.units_of_measure
        try:
            return conversion(defined(shown.unit, known), defined(unit, known))
        except ConfigError as error:
            raise ConfigError(f"{self.spec.output} in unit {unit}: {error}") from error

    # ---- the phases

    def identified(self, target: str) -> Identification:
        """All phases, then the analysis."""
        u_0, y_0 = self._working_point()
        self.sweep.check_range(u_0, self.variable.min, self.variable.max, self.input, self.variable.unit)
        before = self._saturations()
        raw_u, raw_y = self._driven(u_0, self.sweep, self.sweep.length, "sweep")
        saturated = [s for s, n in self._saturations().items() if n > before.get(s, 0)]
        u, y = averaged(raw_u, self.block), averaged(midpoints(raw_y), self.block)
        rate = 1.0 / (self.block * self.step)
        time = self._centers(len(u), self.block)
        self._check_answer(y, y_0)
        segment = 1 << int(np.log2(max(self.sweep.duration * rate / 4.0, 1.0)))
        response = frequency_response(u, y, rate, segment)
        fit = fit_first_order(response, self.spec.fit_band)
        warnings = [
            *(f"{signal} saturates in the sweep: reduce the amplitude" for signal in saturated),
            *self._limits(time, u - u_0, y - y_0, fit, rate),
            *fit.warnings,
            *self.simulation.warnings,
        ]
        return Identification(
            target=target,
            scenario=self.simulation.plan.scenario,
            ideal=self.simulation.plan.ideal,
            input=self.spec.input,
            output=self.spec.output,
            input_unit=self.variable.unit,
            output_unit=self.output_unit,
            working_point=(u_0, y_0),
            sweep=self.sweep,
            fit=fit,
            response=response,
            time=time,
            u=u,
            y=y,
            prediction=self._tested(fit, u_0, y_0),
            warnings=tuple(dict.fromkeys(warnings)),
        )

    def _working_point(self) -> tuple[float, float]:
        """The input, and the output that it holds, at the working point."""
        if self.spec.at_input:
            u = self.spec.at_input[0]
            return u, self._rest(u)
        self.simulation.step()  # now the input shows what drives it
        u = self.simulation[self.input]
        if not self.spec.at:
            return u, self._rest(u)
        return self._found(u, self.spec.at[0])

    def _found(self, u: float, wanted: float) -> tuple[float, float]:
        """The input that holds the output at `wanted`: by secants, from the input `u` on."""
        y = self._rest(u)
        near = 0.005 * abs(wanted)
        following = self._inside(u + (self.sweep.amplitude if y < wanted else -self.sweep.amplitude))
        if following == u:
            following = self._inside(u + self.sweep.amplitude)
        for _ in range(_TRIES):
            if abs(y - wanted) <= near:
                return u, y
            before = (u, y)
            u = following
            y = self._rest(u)
            if u == before[0]:
                break  # the end of what the input may be
            slope = (y - before[1]) / (u - before[0])
            if slope == 0.0:  # a dead zone: twice as far
                following = self._inside(u + 2.0 * (u - before[0]))
            else:
                near = max(near, 0.02 * abs(slope) * self.sweep.amplitude)
                following = self._inside(u + (wanted - y) / slope)
        raise RunError(
            f"no steady {self.spec.output} = {wanted:g} {self.output_unit} was found: {self.spec.input} = "
            f"{u:.6g} {self.variable.unit} gives {y:.6g}; a working point of the input can be given instead"
        )

    def _inside(self, u: float) -> float:
        low, high = self.variable.min, self.variable.max
        return min(max(u, -math.inf if low is None else low), math.inf if high is None else high)

    def _rest(self, u: float) -> float:
        """Hold the input at `u` until the output rests, and return it."""
        steps = max(2, round(_window(self.sweep) / self.step))
        self.simulation.override(self.input, u)
        last, quiet = math.nan, 0
        for window in range(_WINDOWS):
            self.progress(f"waiting for rest at {self.spec.input} = {u:.4g}", window / _WINDOWS)
            mean = self._mean(steps)
            self.peak = max(self.peak, abs(mean))
            quiet = quiet + 1 if abs(mean - last) <= _SETTLED * self.peak else 0
            if quiet == 2:
                return mean
            change, last = mean - last, mean
        raise RunError(
            f"{self.spec.output} does not come to rest with {self.spec.input} = {u:.6g} "
            f"{self.variable.unit}: after {_WINDOWS * steps * self.step:.4g} s it changes by {change:.3g} "
            f"{self.output_unit} in {steps * self.step:.3g} s; an output that integrates has no steady state "
            "to be identified at"
        )

    def _mean(self, steps: int) -> float:
        """The mean output over some steps, from a few dozen samples."""
        part = max(1, steps // 50)
        values = []
        for _ in range(max(1, steps // part)):
            self.simulation.step(part)
            values.append(self.convert(self.simulation[self.output]))
        return math.fsum(values) / len(values)

    def _driven(
        self, center: float, signal: Callable[[Array], Array], length: float, what: str
    ) -> tuple[Array, Array]:
        """Input, shape (n,), and output, shape (n + 1,), while `signal` moves the input round `center`."""
        begin = len(self._column(self.input)) - 1
        count = max(1, round(length / (self.hold * self.step)))
        values = center + signal(self._centers(count, self.hold))
        for i, value in enumerate(values.tolist()):
            self.simulation.override(self.input, value)
            self.simulation.step(self.hold)
            if i % 64 == 0:
                self.progress(what, i / count)
        u, y = self._column(self.input)[begin:-1], self._column(self.output)[begin:]
        return u, self.convert.scale * y + self.convert.offset

    def _column(self, name: str) -> Array:
        return self.simulation.results.column(name)

    def _centers(self, count: int, steps: int) -> Array:
        """The middle of each of `count` stretches of `steps` steps [s]."""
        return np.asarray((np.arange(count) + 0.5) * steps * self.step, dtype=np.float64)

    def _tested(self, fit: Fit, u_0: float, y_0: float) -> Prediction:
        """The model beside the output in a square wave, after the output has come back to rest."""
        self._rest(u_0)
        half = min(4.0 * fit.model.time_constant, 0.5 / self.sweep.start)
        half = max(half, 4.0 * self.block * self.step)
        length = _PULSES * half

        def square(time: Array) -> Array:
            return np.where(np.floor(time / half) % 2 == 0, self.sweep.amplitude, -self.sweep.amplitude)

        u, y = self._driven(u_0, square, length, "test")
        part = max(1, min(self.block, round(fit.model.time_constant / (50.0 * self.step))))
        u, y = averaged(u, part), averaged(midpoints(y), part)
        return predict(fit.model, self._centers(len(u), part), u, y, (u_0, y_0))

    # ---- what may be wrong

    def _saturations(self) -> dict[str, float]:
        return {name: about["count"] for name, about in self.simulation.saturations().items()}

    def _check_answer(self, y: Array, y_0: float) -> None:
        if not np.ptp(y) > 1e-9 * max(abs(y_0), self.peak):
            raise RunError(
                f"{self.spec.output} does not answer to {self.spec.input}: it stays at {y_0:.6g} "
                f"{self.output_unit} in the whole sweep"
            )

    def _limits(self, time: Array, u: Array, y: Array, fit: Fit, rate: float) -> list[str]:
        """Signs that something was cut off; `u` and `y` are deviations from the working point."""
        said = []
        flat = flat_share(y, self.sweep.frequency(time), rate)
        if flat > _FLAT:
            said.append(
                f"{self.spec.output} stays at an extreme for {flat:.2f} periods of the sweep: it hits a "
                "limit, or its resolution is too coarse for this amplitude"
            )
        predicted = midpoints(fit.model.simulated(u, 1.0 / rate))
        bend = curvature(predicted, y)
        if bend > _BEND:
            said.append(
                f"{self.spec.output} bends by {100 * bend:.0f} % from a straight line in what a linear model "
                "gives: something saturates or is not linear at this amplitude; reduce it"
            )
        return said
