"""The program of the kernel: the tables that `tables` describes, made from plan, schedule and units."""

from __future__ import annotations

import numpy as np

from ...fmi.instance import Instance
from ...fmi.transfer import Call, Copy, Transfer
from ...fmi.types import STRING
from ...machine import tables as L
from ...machine.hands import Hand, HandedOver
from ...machine.rows import CallRows, Cells, KernelTable, Recheck, direct, fill, table
from ...unit import Unit
from ..engine import Engine
from ..fault_tables import Arrays
from ..profile import Part, part_of
from ..routes import Act
from ..schedule import Action
from ..sender import Sender
from ..turn import Effect, Turn
from .codes import effect_kind
from .rows import mapped, signal_row, times_row

_NO_LOG = -1


class Program:
    """The tables of an engine whose units are initialized.

    `rechecks` and `actions` have an entry for each operation: the function that raises its errors, and the
    place of its action in the schedule; `call_rechecks` has a function for each row of CALLS. `acts` are what
    Python does, by the number in an operation: the actions of the schedule, then calls with texts.
    """

    def __init__(self, engine: Engine) -> None:
        self._engine = engine
        self._rows: dict[str, list[Cells]] = {
            name: [] for name in ("ops", "routes", "signals", "sinks", "waits", "arrivals", "hands", "spans")
        }
        self._units = units = CallRows(engine.view)
        self._rows |= {"calls": units.calls, "items": units.items, "units": units.units}
        self._apart = engine.profile is not None  # a profile measures parts that are else one operation
        self.rechecks: list[Recheck] = []
        self.call_rechecks = units.rechecks
        self.actions: list[int] = []
        self.effects: list[tuple[int, int, Turn]] = []  # operation, its first row of EFFECTS, and the unit
        self.signals: list[tuple[Sender, int]] = []  # the message of each row, and the signal's place in it
        self.logged: list[Sender] = []
        self.called, self.stepped = units.called, units.stepped  # the instances of CALLS and UNITS
        self.followed: list[Effect] = []  # the courses in the chunk, which stand behind the stimuli
        self._effect_rows = 0
        self._handed: dict[str, int] = {}  # rows of HANDS by unit
        self._waiting: dict[int, int] = {}
        self.acts: list[Act | None] = [
            None if action.kind in ("drive", "record") else engine.act(action) for action in engine.schedule
        ]
        for at, action in enumerate(engine.schedule):
            self._action(at, action)
        self.ops = table(self._rows["ops"], L.OPERATION)
        self.routes = table(self._rows["routes"], L.ROUTE)
        self.effect_table = table([{}] * self._effect_rows, L.EFFECT_WIDTH)
        self.calls = table(self._rows["calls"], L.CALL_WIDTH)
        self.items = table(self._rows["items"], L.ITEM)
        self.units = table(self._rows["units"], L.UNIT)
        self.signal_table = table(self._rows["signals"], L.SIGNAL)
        self.sinks = table(self._rows["sinks"], L.ROUTE)
        self.waits = table(self._rows["waits"], L.WAIT)
        self.arrivals = table(self._rows["arrivals"], 2)
        self.hands = table(self._rows["hands"], L.HAND)
        self.spans = table(self._rows["spans"], L.SPAN)
        self.columns = engine.columns.astype(np.int64)

    @property
    def frames(self) -> Arrays | None:
        """The tables of the frame path; None: the run has no frames."""
        return self._engine.frames.arrays if self._engine.frames.senders else None

    @property
    def holds_python(self) -> bool:
        """True if the kernel calls into this interpreter by itself: then it must hold Python's lock."""
        return any(instance.fmu.holds_python for instance in self.stepped)

    def chunk(self, k: int, count: int) -> tuple[KernelTable, list[int]]:
        """Return the operations that are due in steps k to k + count - 1, and their places in all of them.

        They are as `begin` sets them.
        """
        self.begin(k)
        busy = self.ops[:, L.DUE] < k + count
        for op, _, _ in self.effects:
            busy[op] &= self.ops[op, L.B] > 0
        places = np.flatnonzero(busy)
        return self.ops[places], places.tolist()

    def begin(self, k: int) -> None:
        """Set DUE of all operations to the first step from k on, and the present overrides and biases.

        `followed` are the courses among them.
        """
        first, every = self.ops[:, L.FIRST], self.ops[:, L.EVERY]
        passed = np.maximum(k - first, 0)
        due = first + -(-passed // every) * every
        self.ops[:, L.DUE] = due
        self.followed = []
        for op, row, turn in self.effects:
            self.ops[op, L.B] = len(turn.effects)
            for i, (slot, effect) in enumerate(turn.effects.items(), row):
                fill(self.effect_table, i, {L.SLOT: slot, L.EFFECT_KIND: effect_kind(effect)})
                fill(self.effect_table, i, {L.VALUE_OF: self._value_of(effect)})

    def _value_of(self, effect: Effect) -> float | int:
        """Return the value of an effect, or the row of its course among the stimuli of the chunk."""
        if effect.kind != "follow":
            return float(effect.value)
        self.followed.append(effect)
        return len(self._engine.plan.drives) + len(self.followed) - 1

    def parts(self) -> list[Part]:
        """Return the part of each operation, for a profile."""
        found = []
        for at, op in zip(self.actions, self.ops.tolist(), strict=True):
            action = self._engine.schedule[at]
            what = ""
            if action.kind == "begin" and (op[L.KIND], op[L.C]) != (L.PYTHON_ACT, at):
                what = "step" if op[L.KIND] == L.STEP else "set"
            found.append(part_of(action, self._engine.plan, what, self._engine.is_apart(action)))
        return found

    def units_of(self, places: list[int]) -> list[Unit | None]:
        """The unit that each of these operations calls; None for one that calls none."""
        actions = [self._engine.schedule[self.actions[place]] for place in places]
        return [
            self._engine.turns[action.index].unit if action.kind in ("begin", "end") else None
            for action in actions
        ]

    # ---- operations

    def _action(self, at: int, action: Action) -> None:
        """Add the operations of an action: primitives if the kernel can do it itself, else Python's act."""
        plan, i = self._engine.plan, action.index
        if action.kind == "drive":
            self._operation(at, action, L.DRIVE, plan.drives[i].sink, i)
        elif action.kind == "record":
            self._operation(at, action, L.RECORD, 0, len(self._engine.columns))
        elif action.kind == "note":
            self._operation(at, action, L.PYTHON_ACT, c=at)
        elif (framed := self._engine.frames.operation(action)) is not None:
            self._operation(at, action, L.WIRE_ACT, *framed)
        elif action.kind == "deliver":
            self._operation(at, action, L.DELIVER, self._wait(i))
        elif action.kind == "send":
            self._send(at, action)
        elif action.kind == "take":
            first = self._count("routes")
            for r in plan.units[i].routes:
                self._rows["routes"].append({L.SOURCE: r.source, L.SINK: r.sink} | mapped(r.map))
            self._operation(at, action, L.TAKE, first, len(plan.units[i].routes))
        elif action.kind == "publish":
            for group in self._engine.turns[i].continuous:
                self._operation(at, action, L.COPY, group.latest, group.slot, len(group.variables))
        else:
            self._turn(at, action, self._engine.turns[i])

    def _turn(self, at: int, action: Action, turn: Turn) -> None:
        instance, unit = direct(turn.unit), turn.unit
        if instance is None and isinstance(unit, HandedOver) and unit.hand is not None:
            self._hand(at, action, turn, unit.hand)
        elif instance is None:
            self._operation(at, action, L.PYTHON_ACT, c=at)
        elif action.kind == "begin":
            self._begin(at, action, turn, instance)
        else:
            self._end(at, action, turn, instance)

    def _hand(self, at: int, action: Action, turn: Turn, hand: Hand) -> None:
        """Add the operations of an isolated unit: the kernel hands its turn over, or takes it back."""
        if action.kind == "end":
            self._operation(at, action, L.COLLECT_TURN, self._handed[turn.plan.name], c=at)
            if hand.texts_out is not None:
                self._python(at, action, hand.texts_out)
            self._check(at, action, turn)
            return
        self._affect(at, action, turn)
        if hand.texts_in is not None:
            self._python(at, action, hand.texts_in)
        row = {**hand.row, **times_row(turn.times), L.FIRST_SPAN: self._count("spans")}
        row |= {L.SHOWN: int(turn.has_feedthrough), L.INPUTS: len(hand.inputs), L.BACK: len(hand.outputs)}
        if turn.times.last is not None:
            row[L.LAST_END] = turn.times.last.end
        self._operation(at, action, L.REQUEST_TURN, self._count("hands"), c=at)
        self._handed[turn.plan.name] = self._count("hands")
        self._rows["hands"].append(row)
        self._rows["spans"] += [
            {L.ORIGIN: origin, L.TARGET: target, L.LENGTH: length}
            for origin, target, length in (*hand.inputs, *hand.outputs)
        ]

    def _affect(self, at: int, action: Action, turn: Turn) -> None:
        """Add the operation of the unit's overrides and biases."""
        inputs = sum(len(b.variables) for b in turn.plan.groups if b.kind == "input")
        if inputs:
            op = self._operation(at, action, L.EFFECT, self._effect_rows)
            self.effects.append((op, self._effect_rows, turn))
            self._effect_rows += inputs

    def _check(self, at: int, action: Action, turn: Turn) -> None:
        """Add the operations that look for outputs that are not finite."""

        def recheck(result: int, detail: int) -> None:
            turn.check_finite()

        for check in _checks(turn):
            self._operation(at, action, L.CHECK, 0, *check, recheck=recheck)

    def _begin(self, at: int, action: Action, turn: Turn, instance: Instance) -> None:
        self._affect(at, action, turn)
        calls = self._count("calls")
        for transfer in (*instance.inputs, *instance.through):
            if isinstance(transfer, Copy):
                calls = self._calls(at, action, calls)
                self._operation(at, action, L.COPY, transfer.source, transfer.target, transfer.count)
            elif transfer.type.kind is STRING:
                calls = self._calls(at, action, calls)
                self._texts(at, action, instance, transfer)
            else:
                self._units.add_call(instance, transfer)
        if self._apart:
            calls = self._calls(at, action, calls)
        recheck = self._units.add_unit(instance, times_row(turn.times))
        count = self._count("calls") - calls
        self._operation(at, action, L.STEP, self._count("units") - 1, calls, count, recheck=recheck)

    def _end(self, at: int, action: Action, turn: Turn, instance: Instance) -> None:
        def recheck(result: int, detail: int) -> None:
            turn.check_finite()

        first = self._count("calls")
        for transfer in instance.outputs:
            if transfer.type.kind is STRING:
                first = self._calls(at, action, first)
                self._texts(at, action, instance, transfer)
            else:
                self._units.add_call(instance, transfer)
        checks = _checks(turn)
        if checks and self._count("calls") > first:  # with the last call goes the first check
            self._calls(at, action, first, self._count("calls") - 1)
            self._operation(at, action, L.CALL, self._count("calls") - 1, *checks.pop(0), recheck=recheck)
        else:
            self._calls(at, action, first)
        for check in checks:
            self._operation(at, action, L.CHECK, 0, *check, recheck=recheck)

    def _texts(self, at: int, action: Action, instance: Instance, transfer: Transfer) -> None:
        """Add an operation for a C call with texts, which Python makes."""
        self._python(at, action, instance.binding.calls([transfer]))

    def _python(self, at: int, action: Action, call: Call) -> None:
        """Add an operation for a call that Python makes in each step."""
        self._operation(at, action, L.PYTHON_ACT, c=len(self.acts))
        self.acts.append(lambda k: call())

    def _calls(self, at: int, action: Action, first: int, end: int | None = None) -> int:
        """Add an operation for each row of CALLS from `first` on; return the number of rows."""
        count = self._count("calls")
        for row in range(first, count if end is None else end):
            self._operation(at, action, L.CALL, row)
        return count

    # ---- the channel

    def _send(self, at: int, action: Action) -> None:
        sender = self._engine.senders[action.index]
        channel = sender.channel
        if any(operation.kind == "exact" for operation in channel.operations):
            self._operation(at, action, L.PYTHON_ACT, c=at)  # integers that no double holds
            return
        log = _NO_LOG
        if channel.logs:
            log = len(self.logged)
            self.logged.append(sender)
        self._operation(at, action, L.SEND, self._count("signals"), len(channel.routes), log)
        for i, (route, operation) in enumerate(zip(channel.routes, channel.operations, strict=True)):
            self._rows["signals"].append(signal_row(route, operation, self._count("sinks")))
            self._rows["sinks"] += [{L.SINK: slot} | mapped(affine) for slot, affine in route.sinks]
            self.signals.append((sender, i))
        if sender.waiting is not None:
            self._operation(at, action, L.KEEP, self._wait(action.index))

    def _wait(self, message: int) -> int:
        """Return the row of WAITS of a message with a delay; add it at the first call."""
        if message not in self._waiting:
            self._waiting[message] = self._count("waits")
            sender = self._engine.senders[message]
            waiting = sender.waiting
            assert waiting is not None  # it has a delay
            self._rows["waits"].append(
                {L.PLACE: waiting.slot, L.ROWS: waiting.rows, L.WIDTH: waiting.width,
                 L.ARRIVAL: self._count("arrivals")}
            )  # fmt: skip # a row
            self._rows["arrivals"] += [{0: slot, 1: mailbox} for slot, mailbox in sender.plan.arrivals]
        return self._waiting[message]

    # ---- rows

    def _operation(
        self,
        at: int,
        action: Action,
        kind: int,
        a: int = 0,
        b: int = 0,
        c: int = 0,
        recheck: Recheck | None = None,
    ) -> int:
        """Add an operation of action `at`, or extend the last one by it; return its row."""
        row: Cells = {L.KIND: kind, L.EVERY: action.every, L.FIRST: action.first, L.A: a, L.B: b, L.C: c}
        ops = self._rows["ops"]
        longer = _joined(ops[-1], row) if ops and not self._apart else None
        if longer is not None:
            ops[-1] = longer
        else:
            ops.append(row)
            self.actions.append(at)
            self.rechecks.append(recheck or _cannot_fail)
        return len(ops) - 1

    def _count(self, name: str) -> int:
        return len(self._rows[name])


def _joined(before: Cells, row: Cells) -> Cells | None:
    """Return two operations that follow each other as one; None if they cannot be joined."""
    if any(before[column] != row[column] for column in (L.KIND, L.EVERY, L.FIRST)):
        return None
    a, b, c = (int(before[column]) for column in (L.A, L.B, L.C))
    if row[L.KIND] == L.TAKE and row[L.A] == a + b:
        return {**before, L.B: b + int(row[L.B])}
    # all messages may be sampled before any is received: no output is a mailbox
    if row[L.KIND] == L.SEND and row[L.A] == a + b and c == row[L.C] == _NO_LOG:
        return {**before, L.B: b + int(row[L.B])}
    if row[L.KIND] == L.COPY and row[L.A] == a + c and row[L.B] == b + c:
        return {**before, L.C: c + int(row[L.C])}
    return None


def _cannot_fail(result: int, detail: int) -> None:
    """Do nothing: no value stops the operation."""


def _checks(turn: Turn) -> list[tuple[int, int]]:
    """Return first slot and number of the values of a unit that must be finite."""
    return [(b.latest if b.kind == "continuous" else b.slot, len(values)) for values, b in turn.read]
