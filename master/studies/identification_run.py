"""The experiment of an identification: a simulation with its input overridden, in phases.

1. the input that gives the working point is searched for, by secants;
2. the output comes to rest: two windows in a row with the same mean;
3. the input is moved around the working point: the sweep;
4. after another rest a square wave tests the fitted model.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from ...cosim.analysis.first_order import Fit, Prediction, predict
from ...cosim.analysis.frequency_response import averaged, block_length, midpoints
from ...cosim.analysis.sweep import Sweep
from ...cosim.clock import LATEST
from ...cosim.errors import ConfigError, RunError, nearest
from ...cosim.interface import VariableInfo
from ...cosim.plan.plan import Plan
from ...cosim.row_store import Array
from ...cosim.system.identification_spec import IdentificationSpec
from ...cosim.units.conversion import conversion
from ...cosim.units.definition import defined
from ...cosim.units.measure import Affine
from ..simulation import Simulation
from ..single_fmu import UNIT

PhaseProgress = Callable[[str, float], None]
"""Called with the name of the phase and the share of it that is done, 0 to 1."""

_SETTLED = 1e-3  # change of the mean from one window to the next, as a share of the largest output seen
_WINDOWS = 60  # to wait for rest before giving up
_TRIES = 12  # inputs tried for a working point
_PULSES = 6  # half periods of the square wave
_REPORTED = 4096  # steps at most between two reports of progress


def longest(sweep: Sweep, step_size: float) -> float:
    """Return a stop time [s] that no phase goes beyond, a multiple of the step size [s].

    Raises ConfigError for a sweep that lasts longer than a run can.
    """
    settling = (_TRIES + 3) * _WINDOWS * _window(sweep)
    pulses = _PULSES / sweep.start
    together = settling + sweep.length + pulses
    if not together <= LATEST:
        raise ConfigError(
            f"{described(sweep)}: with all that belongs to it, it takes {together:.3g} s, and a run goes up "
            f"to {LATEST:g} s"
        )
    return step_size * math.ceil(together / step_size)


def described(sweep: Sweep) -> str:
    """Return the keys of a sweep that say how long it is."""
    return f"sweep from {sweep.start:g} Hz, repeats = {sweep.repeats}, a duration of {sweep.duration:g} s"


def _window(sweep: Sweep) -> float:
    """Return the time [s] over which the output is averaged to judge whether it rests.

    It is half a radian at the lowest frequency, which a well chosen sweep has below the pole.
    """
    return 0.5 / (2.0 * math.pi * sweep.start)


def real_variable(plan: Plan, name: str, role: str) -> VariableInfo:
    """Return a recorded Real variable, as an "input" or "output" of an identification.

    Raises ConfigError with the reason and the nearest name.
    """
    known = {c.name: c for c in plan.columns}
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
    return next(u for u in plan.units if u.name == unit).interface.variables[variable]


class IdentificationRun:
    """A simulation with one input overridden; outputs are converted to the unit that the spec names.

    `step` [s] is the step size, `block` the steps of a block average, `hold` the steps for which the input is
    held, `peak` the largest mean output seen. Raises ConfigError for an input or output that does not fit.
    """

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

    def _real(self, name: str, role: str) -> VariableInfo:
        return real_variable(self.simulation.plan, name, role)

    def _conversion(self, shown: VariableInfo, unit: str) -> Affine:
        owner = self.output.partition(".")[0]
        known = next(u for u in self.simulation.plan.units if u.name == owner).interface.units_of_measure
        try:
            given = defined(shown.unit, known)
            difference = shown.difference or given.difference
            return conversion(given, defined(unit, known), (difference, difference))
        except ConfigError as error:
            raise ConfigError(f"{self.spec.output} in unit {unit}: {error}") from error

    # ---- the working point

    def working_point(self) -> tuple[float, float]:
        """Search for the working point; return its input and the output that it holds.

        Raises ConfigError if the sweep around it leaves the input's range, RunError if there is none.
        """
        u, y = self._searched()
        self.sweep.check_range(u, self.variable.min, self.variable.max, self.input, self.variable.unit)
        return u, y

    def _searched(self) -> tuple[float, float]:
        if self.spec.at_input:
            u = self.spec.at_input[0]
            return u, self._rest(u)
        self.simulation.step()  # now the input shows what drives it
        u = self.simulation[self.input]
        if not self.spec.at:
            return u, self._rest(u)
        return self._found(u, self.spec.at[0])

    def _found(self, u: float, wanted: float) -> tuple[float, float]:
        """Find the input that holds the output at `wanted`, by secants from the input `u` on."""
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
                break  # the end of the input's range
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
        """Hold the input at `u` until the output rests, and return the output. Raises RunError."""
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
        """Do some steps and return the mean output, of a few dozen samples."""
        part = max(1, steps // 50)
        values = []
        for _ in range(max(1, steps // part)):
            self.simulation.step(part)
            values.append(self.convert(self.simulation[self.output]))
        return math.fsum(values) / len(values)

    # ---- sweep and test

    def swept(self, u_0: float) -> tuple[Array, Array, list[str]]:
        """Sweep around the input `u_0`.

        Return the input, shape (n,), the output, shape (n + 1,), and the bus signals that saturated.
        """
        before = self._saturations()
        u, y = self._driven(u_0, self.sweep, self.sweep.length, "sweep")
        return u, y, [s for s, n in self._saturations().items() if n > before.get(s, 0)]

    def tested(self, fit: Fit, u_0: float, y_0: float) -> Prediction:
        """Return the model beside the output in a square wave, after the output has come back to rest."""
        self._rest(u_0)
        half = min(4.0 * fit.model.time_constant, 0.5 / self.sweep.start)
        half = max(half, 4.0 * self.block * self.step)
        length = _PULSES * half

        def square(time: Array) -> Array:
            return np.where(np.floor(time / half) % 2 == 0, self.sweep.amplitude, -self.sweep.amplitude)

        u, y = self._driven(u_0, square, length, "test")
        part = max(1, min(self.block, round(fit.model.time_constant / (50.0 * self.step))))
        u, y = averaged(u, part), averaged(midpoints(y), part)
        return predict(fit.model, self.centers(len(u), part), u, y, (u_0, y_0))

    def centers(self, count: int, steps: int) -> Array:
        """Return the middle [s] of each of `count` stretches of `steps` steps, shape (count,)."""
        return np.asarray((np.arange(count) + 0.5) * steps * self.step, dtype=np.float64)

    def _driven(
        self, center: float, signal: Callable[[Array], Array], length: float, what: str
    ) -> tuple[Array, Array]:
        """Move the input by `signal` around `center` for `length` [s]; return input (n,), output (n + 1,)."""
        begin = len(self._column(self.input)) - 1
        count = max(1, round(length / (self.hold * self.step)))
        values = center + signal(self.centers(count, self.hold))
        self.simulation.follow(self.input, np.repeat(values, self.hold))
        part = max(1, _REPORTED // self.hold)
        for i in range(0, count, part):
            self.simulation.step(min(part, count - i) * self.hold)
            self.progress(what, i / count)
        u, y = self._column(self.input)[begin:-1], self._column(self.output)[begin:]
        return u, self.convert.scale * y + self.convert.offset

    def _column(self, name: str) -> Array:
        return self.simulation.results.column(name)

    def _saturations(self) -> dict[str, float]:
        return {name: about["count"] for name, about in self.simulation.saturations().items()}
