"""What a communication step does, as a list in order: the one description that every engine follows.

Time is a count: t_k = start + k * step_size. What step k does, under `gauss_seidel`:

1. stimuli and the messages that are due and carry outputs valid at t_k are written to the inputs' side;
2. each unit in written order, if k is a multiple of its period: its inputs are taken, overrides and
   biases applied, it steps to t_k + period, and its outputs are read. They are visible to later units at
   once; the continuous ones of a unit whose period is longer than a step only from the communication
   point on at which they are valid. A message with discrete signals is sent right after its sender's turn.
   On a bus with a delay, what was sent that long ago arrives where a message would be sent;
3. row k is recorded: the inputs of this step, discrete outputs after it, continuous ones valid at t_k.

Under `jacobi` all messages are sent and all inputs taken before any unit steps, so that every value takes
one communication step to arrive.
"""

from __future__ import annotations

import dataclasses
from typing import Literal

from ...cosim.plan.plan import MessagePlan, Plan

Kind = Literal["drive", "deliver", "send", "take", "begin", "end", "record", "publish"]


@dataclasses.dataclass(frozen=True)
class Action:
    """Something that is done at the steps k with k >= first and (k - first) % every == 0.

    `index` counts the plan's drives, messages or units:

        drive     the stimulus' value is written to its slot
        deliver   what the message sampled `delay` steps ago reaches the mailboxes
        send      the message is sampled and sent: to the mailboxes, with a delay to where it waits
        take      the unit's inputs are written from their routes
        begin     overrides and biases act, the unit receives its inputs, shows what feeds through, and
                  begins to step
        end       its step is done, its outputs are read, and none may be NaN or infinite
        record    the row of the step
        publish   the unit's continuous outputs after its step become the valid ones
    """

    kind: Kind
    index: int = 0
    every: int = 1
    first: int = 0

    @property
    def always(self) -> bool:
        """Whether it is done at each step."""
        return self.every == 1 and self.first == 0


def schedule(plan: Plan) -> tuple[Action, ...]:
    """The actions of a step, in order."""
    units = range(len(plan.units))
    drives = [Action("drive", i) for i in range(len(plan.drives))]
    body = _gauss_seidel(plan) if plan.algorithm == "gauss_seidel" else _jacobi(plan)
    # what a unit with a longer period has computed is valid at the end of the period
    publish = [Action("publish", i, plan.units[i].every, plan.units[i].every - 1) for i in units]
    return (*drives, *body, Action("record"), *publish)


def _gauss_seidel(plan: Plan) -> list[Action]:
    actions = _messages(plan, None)
    for i in range(len(plan.units)):
        actions += [_of_unit(plan, kind, i) for kind in ("take", "begin", "end")]
        actions += _messages(plan, i)
    return actions


def _jacobi(plan: Plan) -> list[Action]:
    """All begin before any is waited for: units in processes of their own step side by side."""
    actions = [action for i in range(len(plan.messages)) for action in _message(plan, i)]
    for kind in ("take", "begin", "end"):
        actions += [_of_unit(plan, kind, i) for i in range(len(plan.units))]
    return actions


def _of_unit(plan: Plan, kind: Kind, index: int) -> Action:
    return Action(kind, index, plan.units[index].every)


def _messages(plan: Plan, after: int | None) -> list[Action]:
    return [a for i, m in enumerate(plan.messages) if m.after == after for a in _message(plan, i)]


def _message(plan: Plan, index: int) -> list[Action]:
    message = plan.messages[index]
    send = Action("send", index, message.every, message.first)
    if not message.delay:
        return [send]
    return [dataclasses.replace(send, kind="deliver", first=message.first + message.delay), send]


@dataclasses.dataclass(frozen=True)
class Waiting:
    """Where the values of a message with a delay wait: `rows` rows of `width` slots, used in turn.

    Transmission n (0, 1, ...) waits in row n % rows: it is delivered before the one that takes its place.
    """

    slot: int
    rows: int
    width: int

    def row(self, transmission: int) -> int:
        """The first slot of a transmission's values."""
        return self.slot + transmission % self.rows * self.width


def waiting(plan: Plan) -> tuple[dict[int, Waiting], int]:
    """For each message with a delay, by index, where its values wait behind the plan's own slots; and the
    size of the memory with them."""
    found, size = {}, plan.memory_size
    for i, message in enumerate(plan.messages):
        if message.delay:
            found[i] = Waiting(size, _under_way(message), len(message.arrivals))
            size += found[i].rows * found[i].width
    return found, size


def _under_way(message: MessagePlan) -> int:
    """How many transmissions can be under way at once."""
    return -(-message.delay // message.every)
