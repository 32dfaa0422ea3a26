"""The trial of an FMU in the place of a unit: all probes in order, within a time limit."""

from __future__ import annotations

import contextlib
import dataclasses
import math
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

from ....cosim.analysis.signs import Pair, turned
from ....cosim.errors import ConfigError, RunError
from ....cosim.row_store import Array
from ....cosim.swap.swap_file import Proposal
from ....cosim.system.scenario import Scenario
from ....cosim.system.system import System, UnitEntry
from ...isolation.unit import IsolatedUnit
from ...warned import warnings_text
from . import probes
from .bench import Bench, Deadline, InputCourses, OutOfTime, largest
from .levels import Level, levels
from .probes import Columns, Finding, Reaction

_FINER = (1, 2, 5, 10)  # steps in a period: of 10, 5, 2 and 1 ms in one of 10 ms
_SPEED = 0.3  # s that measuring the speed takes
_NAMED = 3
_MOVED = ("Real", "Integer")


@dataclasses.dataclass(frozen=True)
class Trial:
    """The findings of a trial of `duration` [s], and its proposal for the swap file."""

    duration: float
    findings: tuple[Finding, ...]
    proposal: Proposal

    @property
    def passed(self) -> bool:
        """True if no finding is a problem."""
        return all(finding.verdict != "problem" for finding in self.findings)


def try_unit(
    system: System,
    scenario: Scenario,
    unit: str,
    entry: UnitEntry,
    names: Iterable[str],
    duration: float = 5.0,
    limit: float = 120.0,
    answer: float = 10.0,
) -> Trial:
    """Try the FMU of `entry` alone, beside the present unit of the system, both driven alike.

    `names` are the variables of the unit that the system needs. Every run of the FMU is in a process of its
    own and `duration` [s] long; all of them together take `limit` [s] at most, a call of the FMU `answer`
    [s]. Any failure of the FMU is a finding. Raises ConfigError if the system itself cannot run.
    """
    if not (duration > 0.0 and math.isfinite(duration)):
        raise ConfigError(f"--try {duration:g}: a trial takes some seconds")
    present = system.file.units[unit]
    step_size = scenario.file.experiment.step_size or system.file.experiment.step_size
    duration = _whole_turns(duration, step_size, (present, entry))
    ours = Bench(system, scenario, unit, present, None, tuple(names), duration)
    given = levels(system, unit, (v for v in ours.interface.of_causality("input") if v.type in _MOVED))
    trial = _TrialRun(ours, given, Deadline(time.monotonic() + limit, answer))
    try:
        theirs = Bench(system, scenario, unit, entry, ours.interface, tuple(names), duration)
        trial.work(theirs)
    except OutOfTime:
        trial.found("time", "problem", f"ended after {limit:g} s; what is not told was not tried")
    except (ConfigError, RunError) as error:
        trial.findings.append(probes.failed("start", error))
    findings = tuple(trial.findings)
    return Trial(ours.duration, findings, dataclasses.replace(trial.proposal, remarks=_remarks(findings)))


def _whole_turns(duration: float, step_size: float, entries: Iterable[UnitEntry]) -> float:
    """Return a duration [s] of whole periods of all entries: no last step is shorter than the others."""
    periods = (entry.period or step_size for entry in entries)
    turn = step_size * math.lcm(*(max(1, round(period / step_size)) for period in periods))
    return max(1, round(duration / turn)) * turn


def _remarks(findings: Sequence[Finding]) -> tuple[str, ...]:
    """Return the lines above a mapping that was tried: all findings that are not good."""
    lines = [f"{f.verdict}: {f.what}: {f.text}" for f in findings if f.verdict != "good"]
    return ("A trial found:", *lines) if lines else ("A trial found nothing wrong.",)


class _TrialRun:
    """A trial under way: its findings and proposal so far, and the outputs of runs by their drive.

    `ours` is the bench of the present unit, `theirs` that of the FMU.
    """

    def __init__(self, ours: Bench, given: Mapping[str, Level], deadline: Deadline) -> None:
        self.ours, self.given, self.deadline = ours, given, deadline
        self.findings: list[Finding] = []
        self.proposal = Proposal()
        self._seen: list[Columns] = []
        self._ours_seen: list[Columns] = []
        self._theirs_by_drive: dict[str, Columns] = {}
        self._ours_by_drive: dict[str, Columns] = {}
        self._runs = 0

    def found(self, what: str, verdict: probes.Verdict, text: str) -> None:
        """Keep a finding."""
        self.findings.append(Finding(what, verdict, text))

    def work(self, theirs: Bench) -> None:
        """Do all probes in order. Raises OutOfTime, and ConfigError or RunError outside a probe."""
        self.theirs = theirs
        self.moved = [name for name in self.given if name in theirs.inputs]
        self.shown = [name for name in theirs.outputs if self._is_number(theirs, name)]
        if not self._starts():
            return
        self._compare_steps()
        self._react()
        self.findings += probes.values(self._seen, self._ours_seen, theirs)
        self.findings += probes.input_ends(theirs, self.given)
        self._look_inside()
        warned = f", {warnings_text(theirs.warnings, theirs.kinds.counts)}" if theirs.warnings else ""
        text = f"{self._runs} runs of {theirs.duration:g} s{warned}"
        self.findings.insert(0, Finding("status", "note" if warned else "good", text))

    @staticmethod
    def _is_number(bench: Bench, name: str) -> bool:
        v = bench.interface.variables[name]
        return v.type in _MOVED and v.causality in ("output", "local")

    # ---- runs

    def _run(self, drive: InputCourses) -> Columns:
        """Return the FMU's outputs; the same inputs are run once. Raises ConfigError, RunError."""
        key = repr(sorted(drive.items()))
        known = self._theirs_by_drive
        if key not in known:
            known[key] = self.theirs.run(drive, self.deadline)
            self._runs += 1
            self._seen.append(known[key])
            self._ours_seen.append(self._run_ours(drive))
        return known[key]

    def _run_ours(self, drive: InputCourses) -> Columns:
        """Return the present unit's outputs; the same inputs are run once."""
        key, known = repr(sorted(drive.items())), self._ours_by_drive
        if key not in known:
            known[key] = self.ours.run(drive, self.deadline)
        return known[key]

    def _at(self, high: Sequence[str] = ()) -> dict[str, list[tuple[float, float]]]:
        """Return a drive with all inputs constant: at rest, those in `high` at their high value."""
        return {n: [(0.0, self.given[n].high if n in high else self.given[n].rest)] for n in self.moved}

    def _swept(self, base: InputCourses, name: str, way: float = 1.0) -> InputCourses:
        """Return a drive in which one input moves to its high value in 60 % of the time."""
        level = self.given[name]
        end = level.rest + way * (level.high - level.rest)
        return {**base, name: [(0.0, level.rest), (0.6 * self.ours.duration, end)]}

    @contextlib.contextmanager
    def _as_finding(self, what: str) -> Iterator[None]:
        """Turn a failure within the block into a finding."""
        try:
            yield
        except OutOfTime:
            raise
        except (ConfigError, RunError) as error:
            self.findings.append(probes.failed(what, error))

    # ---- the probes

    def _starts(self) -> bool:
        """Return True if the FMU runs with constant inputs, perhaps only with smaller steps."""
        with self._as_finding("constant inputs"):
            try:
                self._run(self._at())
            except OutOfTime:
                raise
            except RunError as error:  # it runs, and fails: smaller steps may help
                self.findings.append(probes.failed("constant inputs", error))
                return self._starts_finer(_FINER[-1])
            return True
        return self._ended()

    def _starts_finer(self, factor: int) -> bool:
        count = self.theirs.entry.substeps * factor
        self.theirs.entry = self.theirs.entry.model_copy(update={"substeps": count})
        try:
            self._run(self._at())
        except OutOfTime:
            raise
        except (ConfigError, RunError):  # as before, or worse
            return self._ended()
        step = 1000.0 * self.theirs.period / count
        why = f"it fails with steps of {step * factor:g} ms and runs with steps of {step:g} ms"
        self._go_on_with(count, why)
        self.found("steps", "problem", f"{why}: substeps = {count}")
        return True

    def _go_on_with(self, substeps: int, why: str) -> None:
        """Propose so many steps in a period, and do the following probes with them."""
        self.proposal = dataclasses.replace(self.proposal, substeps=substeps, why_substeps=why)
        self.theirs.entry = self.theirs.entry.model_copy(update={"substeps": substeps})
        self._theirs_by_drive = {}

    def _ended(self) -> bool:
        self.found("trial", "problem", "ended: reactions, steps, state and speed were not tried")
        return False

    def _react(self) -> None:
        """Compare the reactions of each output to each input with those of the present unit."""
        reactions: list[Reaction] = []
        for name in self.moved:
            with self._as_finding(f"{name} swept"):
                reactions += self._reactions_to(name)
        self.findings += [reaction.finding for reaction in reactions]
        self._propose_signs({r.pair: r.sign for r in reactions if r.sign})

    def _reactions_to(self, name: str) -> list[Reaction]:
        base = self._base_for(name)
        ours = _changes(self._run_ours(self._swept(base, name)), self._run_ours(base))
        theirs = _changes(self._run(self._swept(base, name)), self._run(base))
        expected = [n for n in self.shown if largest(ours[n]) > 0.0]
        dead = all(largest(theirs[n]) == 0.0 for n in expected)
        if expected and dead and (other := self._other_way(base, name, ours)):
            return other
        pairs = [
            probes.reaction((name, n), self.ours.interface.variables[n].unit, theirs[n], ours[n])
            for n in self.shown
        ]
        return [pair for pair in pairs if pair is not None]

    def _other_way(self, base: InputCourses, name: str, ours: Columns) -> list[Reaction]:
        """Return the reactions if the FMU reacts to the other sign of the input only, else []."""
        theirs = _changes(self._run(self._swept(base, name, -1.0)), self._run(base))
        found = []
        for n in self.shown:
            seen = probes.reaction((name, n), self.ours.interface.variables[n].unit, theirs[n], ours[n])
            if seen is not None and seen.sign:
                text = f"reacts to the other sign only: then it {seen.finding.text}"
                finding = dataclasses.replace(seen.finding, verdict="problem", text=text)
                found.append(dataclasses.replace(seen, finding=finding, sign=-seen.sign))
        return found

    def _base_for(self, name: str) -> InputCourses:
        """Return the constant inputs at which most outputs of the present unit react to an input.

        They are at rest, or one other is moved: a brake has no effect on a vehicle at standstill.
        """
        others: list[tuple[str, ...]] = [(), *((n,) for n in self.moved if n != name)]

        def shown(high: tuple[str, ...]) -> int:
            base = self._at(high)
            changes = _changes(self._run_ours(self._swept(base, name)), self._run_ours(base))
            return sum(largest(changes[n]) > 0.0 for n in self.shown)

        counts = [shown(high) for high in others]
        return self._at(others[counts.index(max(counts))])

    def _propose_signs(self, signs: Mapping[Pair, int]) -> None:
        """Propose the variables to invert so that all reactions have the present unit's sign."""
        if all(sign > 0 for sign in signs.values()):
            return
        found = turned(signs)
        if found is None:
            self.found("signs", "problem", "no choice of signs makes all reactions right")
            return
        inputs, outputs = found
        why = {("inputs", n): _why(signs, n, 0) for n in sorted(inputs)}
        why |= {("outputs", n): _why(signs, n, 1) for n in sorted(outputs)}
        self.proposal = dataclasses.replace(self.proposal, invert=why)
        names = ", ".join(f"{table}.{n}" for table, n in why)
        self.found("signs", "problem", f"with invert = true for {names} all would have the right one")

    def _compare_steps(self) -> None:
        """Compare smaller steps, all inputs moved up and down at the same time, each in its own rhythm."""
        own = self.theirs.entry.substeps
        drive = {n: self._waves(n, i) for i, n in enumerate(self.moved, 1)}

        def run(count: int) -> Columns:
            if count == own:
                return self._run(drive)
            self._runs += 1
            return self.theirs.run(drive, self.deadline, count)

        with self._as_finding("steps"):
            counts = [own * factor for factor in _FINER]
            finding, enough = probes.steps(run, counts, self.shown, self.theirs.period)
            self.findings.append(finding)
            if enough > own:
                self._go_on_with(enough, f"steps {finding.text.partition(': substeps')[0]}")

    def _waves(self, name: str, rhythm: int) -> list[tuple[float, float]]:
        level, n = self.given[name], 40
        times = [self.ours.duration * k / n for k in range(n + 1)]
        share = [0.5 - 0.5 * math.cos(2.0 * math.pi * rhythm * k / n) for k in range(n + 1)]
        return [(t, level.rest + s * (level.high - level.rest)) for t, s in zip(times, share, strict=True)]

    def _look_inside(self) -> None:
        """Probe state and speed of the unit, each after a quarter of a run."""
        bench = self.theirs
        step = bench.period / bench.entry.substeps
        looks: dict[str, tuple[int, Callable[[IsolatedUnit, float], Finding]]] = {
            "state": (probes.LONGEST_STATE, lambda unit, at: probes.state(unit, bench, at)),
            "speed": (probes.LONGEST_SPEED, lambda unit, at: probes.speed(unit, at, step, _SPEED)),
        }
        quarter = max(1, round(0.25 * bench.duration / bench.step_size))
        drive = next((self._swept(self._base_for(n), n) for n in self.moved), {})
        for what, (longer, look) in looks.items():
            with self._as_finding(what), bench.loaded(drive, self.deadline, longer=longer) as simulation:
                simulation.step(quarter)
                unit = simulation.units[bench.unit]
                assert isinstance(unit, IsolatedUnit)  # as the bench demands
                self.findings.append(look(unit, simulation.time))


def _changes(swept: Columns, base: Columns) -> dict[str, Array]:
    return {name: swept[name] - base[name] for name in swept}


def _why(signs: Mapping[Pair, int], name: str, place: int) -> str:
    """Return the reason to invert an input (`place` 0 of the pairs) or an output (1)."""
    wrong = [pair[1 - place] for pair, sign in signs.items() if pair[place] == name and sign < 0]
    others = ", ".join(wrong[:_NAMED]) + (", ..." if len(wrong) > _NAMED else "")
    if place == 0:
        return f"the reaction of {others} to it has the other sign"
    return f"its reaction to {others} has the other sign"
