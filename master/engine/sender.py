"""A message in the schedule: its values are sampled, and on a bus with a delay delivered later."""

from __future__ import annotations

from collections.abc import Mapping

from ...cosim.can.channel import MessageChannel
from ...cosim.can.quantization import ChannelError
from ...cosim.errors import RunError
from ...cosim.plan.plan import MessagePlan, Plan
from .schedule import Waiting


class Sender:
    """A message in the schedule: its actions; `waiting` has the slots of values on a bus with a delay."""

    def __init__(
        self, plan: MessagePlan, channel: MessageChannel, memory: memoryview[float], waiting: Waiting | None
    ) -> None:
        self.plan, self.channel, self.memory, self.waiting = plan, channel, memory, waiting

    def send(self, k: int) -> None:
        """Sample all signals. Raises RunError naming sender and signal if a value cannot be sent."""
        try:
            self.channel.transmit(self.memory, k)
        except ChannelError as error:
            raise self.failed(error) from error
        if self.waiting is not None:
            row = self.waiting.row((k - self.plan.first) // self.plan.every)
            for i, (slot, _) in enumerate(self.plan.arrivals, row):
                self.memory[i] = self.memory[slot]

    def failed(self, error: ChannelError) -> RunError:
        """Return the error of a run for one of the channel."""
        name = f"{self.plan.bus}.{self.plan.message.name}.{error.signal}"
        return RunError(f"{self.plan.senders.get(error.signal, '')} via {name}: {error.rule}")

    def deliver(self, k: int) -> None:
        """Copy the values sampled `delay` steps ago to the mailboxes."""
        assert self.waiting is not None  # only messages with a delay are delivered
        row = self.waiting.row((k - self.plan.first - self.plan.delay) // self.plan.every)
        for i, (_, mailbox) in enumerate(self.plan.arrivals, row):
            self.memory[mailbox] = self.memory[i]


def senders_of(
    plan: Plan, memory: memoryview[float], late: Mapping[int, Waiting], log_raw: bool
) -> list[Sender]:
    """Return the messages of a plan in the schedule, in their order, and behind them those that babble.

    `late` are the waiting slots of those with a delay; with `log_raw` the channels keep raw values, but for
    messages whose frames are kept.
    """
    return [
        Sender(
            m,
            MessageChannel(m.message, m.routes, m.settings, log_raw and m.framing is None),
            memory,
            late.get(i),
        )
        for i, m in enumerate((*plan.messages, *plan.babblers))
    ]
