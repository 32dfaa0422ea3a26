"""The actions of a communication step in order: the one description that every engine follows.

Time is a count k, of which `clock` makes the time t_k. The stages of step k, under `gauss_seidel`:

1. the values of the stimuli at t_k are written to the slots of their inputs, and on buses with `timing =
   "frame"` the frames that ended by t_k reach the mailboxes, as do those of logs with a time up to t_k;
2. the messages that are due and carry outputs valid at t_k are sent;
3. each unit in written order, if it has its turn (each period, from its offset on): its inputs are taken,
   overrides and biases applied, it steps to t_k + period, and its outputs are read. They are visible to
   later units at once; those of a unit whose period is longer than a step, if they are not sampled, only
   from the communication point on at which they are valid. A message with a sampled output is sent right
   after its sender's turn;
4. row k is recorded: the inputs of this step, sampled outputs after it, the others valid at t_k;
5. the outputs after the step that are not sampled become the valid ones: at the end of the unit's period,
   and at the stop time if that cuts its last one short.

On buses with `timing = "frame"` a message that is sent waits for the bus; the arbitration up to t_k+1 is
resolved before row k is recorded. On other buses with a delay the values sent that long ago arrive at the
place where the message is sent.
Under `jacobi` all messages are sent and all inputs taken before any unit steps, so that every value takes
one communication step to arrive.
"""

from __future__ import annotations

import dataclasses
import math
from typing import Literal

from ...cosim.plan.plan import MessagePlan, Plan
from ...cosim.plan.turns import cut_short

Kind = Literal[
    "drive",
    "arrive",
    "replay",
    "deliver",
    "send",
    "watch",
    "take",
    "begin",
    "end",
    "contend",
    "record",
    "note",
    "publish",
]


@dataclasses.dataclass(frozen=True)
class Action:
    """An action that is due at the steps k with k >= first and (k - first) % every == 0.

    `index` is the place in the plan's drives, messages, units, timed buses or replays:

        drive     write the stimulus' value to its slot
        arrive    unpack the frames of the bus that have arrived
        replay    unpack the frames of the log that are seen by this step
        deliver   copy the values that the message sampled `delay` steps ago to the mailboxes, or unpack the
                  frame that was sent then
        send      sample the message and write its values to the mailboxes (with a delay: waiting slots too)
        watch     look whether a frame of the message came in this cycle
        take      write the unit's inputs from their routes
        begin     apply overrides and biases, set the unit's inputs, read the outputs with direct feedthrough,
                  and begin the step
        end       wait for the step, read the outputs, and refuse NaN and infinity
        contend   let the frames that wait have the bus, as many as start before the next step
        record    record the row of the step
        note      note the texts of the row, where texts are recorded
        publish   make the unit's outputs after its step, but for sampled ones, the valid ones
    """

    kind: Kind
    index: int = 0
    every: int = 1
    first: int = 0

    @property
    def always(self) -> bool:
        """True if the action is due at each step."""
        return self.every == 1 and self.first == 0

    def due(self, k: int) -> bool:
        """Return True if the action is due at step k."""
        return k >= self.first and (k - self.first) % self.every == 0


def schedule(plan: Plan) -> tuple[Action, ...]:
    """Return the actions of a communication step, in order."""
    units = range(len(plan.units))
    # 1. the stimuli at t_k
    drives = [Action("drive", i) for i in range(len(plan.drives))]
    # the frames that ended by t_k
    arrive = [Action("arrive", i) for i in range(len(plan.timed_buses))]
    # and those of logs up to then
    arrive += [Action("replay", i) for i in range(len(plan.replays))] + _early_watches(plan)
    # 2. and 3. messages and units, as the algorithm orders them
    steps = _gauss_seidel(plan) if plan.algorithm == "gauss_seidel" else _jacobi(plan)
    # the frames that start before t_k+1; all that were queued at t_k contend, whichever turn sent them
    contend = [Action("contend", i) for i in range(len(plan.timed_buses))]
    # 4. row k
    record = [Action("record"), *([Action("note")] if plan.text_columns else [])]
    # 5. the outputs valid at t_k+1; those of a unit with a longer period at the end of its turn
    publish = [action for i in units for action in _publish(plan, i)]
    return (*drives, *arrive, *steps, *contend, *record, *publish)


def _gauss_seidel(plan: Plan) -> list[Action]:
    # messages of outputs that are valid at t_k
    actions = _messages(plan, None)
    for i in range(len(plan.units)):
        # the unit with the newest values of those before it
        actions += [_of_unit(plan, kind, i) for kind in ("take", "begin", "end")]
        # messages of its sampled outputs
        actions += _messages(plan, i)
    return actions


def _jacobi(plan: Plan) -> list[Action]:
    # all messages, of outputs that are valid at t_k or sampled ones of the step before
    actions = [action for i in range(len(plan.messages)) for action in _message(plan, i)]
    # the inputs of all units; then all begin before any is waited for: isolated ones step side by side
    for kind in ("take", "begin", "end"):
        actions += [_of_unit(plan, kind, i) for i in range(len(plan.units))]
    return actions


def _of_unit(plan: Plan, kind: Kind, index: int) -> Action:
    return Action(kind, index, plan.units[index].every, plan.units[index].first)


def _publish(plan: Plan, index: int) -> list[Action]:
    every, first, steps = plan.units[index].every, plan.units[index].first, plan.clock.steps
    actions = [Action("publish", index, every, first + every - 1)]
    if cut_short(plan.clock, every, first):
        # at the last step, and only there: a run whose units are told the stop time does not go beyond it
        actions.append(Action("publish", index, steps, steps - 1))
    return actions


def _messages(plan: Plan, after: int | None) -> list[Action]:
    """Return the actions of the messages that are sent after the turn of a unit (None: before all)."""
    return [a for i, m in enumerate(plan.messages) if m.after == after for a in _message(plan, i)]


def _message(plan: Plan, index: int) -> list[Action]:
    message = plan.messages[index]
    if message.replayed:
        return []
    send = Action("send", index, message.every, message.first)
    watch = [Action("watch", index, message.cycle, message.first + message.delay)] if message.watched else []
    if message.timed:
        return [send]
    if not message.delay:
        # frames that a fault made late arrive at any step
        return [*([Action("deliver", index, 1, message.first)] if message.latest else []), send, *watch]
    deliver = dataclasses.replace(send, kind="deliver", first=message.first + message.delay)
    if message.latest:
        deliver = dataclasses.replace(deliver, every=1)
    return [deliver, *watch, send]


def _early_watches(plan: Plan) -> list[Action]:
    """Return the actions that look at messages whose frames take time, from one cycle after the first on.

    So do those that look at messages of logs, from the first on where frames take no time. Of P pages each is
    sent every P cycles, and looked at as often; those of a log are looked at once a cycle, by the first.
    """
    found = []
    looked_at = {i: m for i, m in enumerate(plan.messages) if m.watched and (m.timed or m.replayed)}
    names = [(message.bus, message.message.name) for message in looked_at.values()]
    for place, (i, message) in enumerate(looked_at.items()):
        if message.replayed and names.index(names[place]) < place:
            continue
        if not message.timed:
            found.append(Action("watch", i, message.every, message.first))
        else:
            late = math.ceil(message.settings.delay / plan.clock.step)
            cycle = message.cycle if message.replayed else message.cycle // names.count(names[place])
            found.append(Action("watch", i, message.cycle, message.first + cycle + late))
    return found


@dataclasses.dataclass(frozen=True)
class Waiting:
    """The slots in which the values of a message with a delay wait: `rows` rows of `width`, used in turn.

    Transmission n (0, 1, ...) waits in row n % rows: it is delivered before the one that takes its place.
    """

    slot: int
    rows: int
    width: int

    def row(self, transmission: int) -> int:
        """Return the first slot of a transmission's values."""
        return self.slot + transmission % self.rows * self.width


def waiting(plan: Plan) -> tuple[dict[int, Waiting], int]:
    """Return the waiting slots of each message with a delay, by index, and the size of the memory with them.

    They stand behind the plan's own slots.
    """
    found, size = {}, plan.memory_size
    for i, message in enumerate(plan.messages):
        if message.delay and message.framing is None:
            found[i] = Waiting(size, _under_way(message), len(message.arrivals))
            size += found[i].rows * found[i].width
    return found, size


def _under_way(message: MessagePlan) -> int:
    """Return the number of transmissions that can be under way at once."""
    return -(-message.delay // message.every)
