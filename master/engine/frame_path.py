"""The messages of a run that are sent as frames: their tables, and what Python does for them.

The steps of a frame are functions of `cosim.can.wire`. The python engine calls them with the tables of this
module, the compiled engine has them in machine code.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from ...cosim.can.logs.frames import BusLog
from ...cosim.can.quantization import ChannelError, decode, quantize
from ...cosim.can.transmissions import FrameLog, frame_store
from ...cosim.can.wire import medium
from ...cosim.can.wire import tables as T
from ...cosim.can.wire.payload import low_bits, whole, words
from ...cosim.can.wire.values import set_raw
from ...cosim.plan.plan import FaultPlan, Plan, ReplayPlan
from ...cosim.plan.readers import Reader, readers
from .fault_tables import nodes_of
from .listener_tables import add_uses
from .schedule import Action
from .sender import Sender
from .wire_tables import ring_of_bus, views, wire_arrays


class FramePath:
    """The frames of those messages of `senders`, all of a run, that have a framing.

    `memory` is the run's, shape (size,), `step` [s] its step. With `logs` the frames are kept for `log_of`.
    `initial` are the values of mailboxes before the first frame, by slot, `receiving` their nodes that can be
    off the bus (`Plan.receiving_nodes`). `replays` are the logs whose frames are replayed, `receivers` the
    units that receive the messages.
    """

    def __init__(
        self,
        senders: Sequence[Sender],
        memory: NDArray[np.float64],
        step: float,
        logs: bool,
        initial: Mapping[int, float] | None = None,
        faults: Sequence[FaultPlan] = (),
        receiving: Mapping[int, tuple[str, str]] | None = None,
        replays: Sequence[ReplayPlan] = (),
        receivers: Sequence[Sequence[Reader]] = (),
    ) -> None:
        buses = list(dict.fromkeys(sender.plan.bus for sender in senders))
        framed = [i for i, sender in enumerate(senders) if sender.plan.framing is not None]
        framed.sort(key=lambda i: (buses.index(senders[i].plan.bus), senders[i].plan.message.priority))
        self._all = tuple(senders)
        self.senders = tuple(senders[i] for i in framed)
        self._rows = {i: row for row, i in enumerate(framed)}
        self.arrays = wire_arrays(
            self.senders, memory, step, logs, initial or {}, faults, receiving, len(replays)
        )
        self._replays, self._at = tuple(replays), [0] * len(replays)  # the next row of each recording
        self.receivers = [receivers[i] if i < len(receivers) else () for i in framed]
        add_uses(self.arrays, self.receivers)
        self.wire = views(self.arrays, self.help)
        self.nodes = nodes_of([sender.plan for sender in self.senders])
        self._signals = [(s, i) for s in self.senders for i in range(len(s.plan.routes))]
        framings = [s.plan.framing for s in self.senders]
        self._protections = [None if framing is None else framing.protection for framing in framings]
        self._makers = {
            row: protection.maker.loaded()
            for row, protection in enumerate(self._protections)
            if protection is not None and protection.maker is not None
        }
        self._kept = frame_store()

    def row_of(self, number: int) -> int | None:
        """Return the row of a message by its number in the plan; None where it is no frame."""
        return self._rows.get(number)

    def act(self, what: int, i: int, k: int) -> None:
        """Do an action of `wire.medium` in step k. Raises RunError for a value that cannot be sent."""
        medium.act(self.wire, what, i, k)

    def operation(self, action: Action) -> tuple[int, int] | None:
        """Return an action of the schedule as the first two arguments of `act`; None where it is none."""
        if action.kind in ("arrive", "contend"):
            bus = np.flatnonzero(self.arrays["buses"][:, T.TIMED])[action.index]
            return (
                (T.ARRIVE, ring_of_bus(self.arrays, bus))
                if action.kind == "arrive"
                else (T.CONTEND, int(bus))
            )
        if action.kind == "replay":
            return T.REPLAY, action.index
        if action.kind not in ("send", "deliver", "watch") or action.index not in self._rows:
            return None
        row = self._rows[action.index]
        if action.kind == "send":
            return T.SEND, row
        if action.kind == "watch":
            return T.WATCH, row
        return T.ARRIVE, int(self.arrays["messages"][row, T.RING])

    def help(self, what: int, i: int, k: int) -> int:
        """Do what no table holds (see `wire.values.ask`); return DONE.

        Raises RunError for a value that cannot be sent, and when the log's file cannot be written.
        """
        if what == T.FLUSH:
            self.flush()
        elif what == T.FILL:
            self._fill(i)
        elif what == T.RAW:
            self._set_raw(i, k)
        elif what == T.CHECKSUM:
            self._set_checksum(i)
        else:
            self._set_value(i)
        return T.DONE

    def _fill(self, stream: int) -> None:
        """Bring the next frames of a log into the tables, in place of those that were replayed."""
        rows, self._at[stream] = self._replays[stream].frames.block(self._at[stream])
        first = stream * T.REPLAY_ROWS
        place = self.arrays["replays"][first : first + len(rows)]
        place[:] = rows
        place[:, T.LOG_MESSAGE] = [self._rows[number] for number in rows[:, T.LOG_MESSAGE].tolist()]
        self.arrays["streams"][stream] = 0, len(rows), self._at[stream] < 0

    def _set_raw(self, row: int, k: int) -> None:
        sender, i = self._signals[row]
        operation, x = sender.channel.operations[i], self.wire.double[0]
        try:
            if operation.low <= x <= operation.high:
                raw = quantize(operation.signal, operation.settings.rounding, x)
            else:
                raw = sender.channel.out_of_range(i, x, k)
        except ChannelError as error:
            raise sender.failed(error) from error
        if operation.kind == "exact":
            self.wire.signals[row, T.LOW], self.wire.signals[row, T.HIGH] = words(int(raw))
        else:
            set_raw(self.wire, row, raw)

    def _set_value(self, row: int) -> None:
        sender, i = self._signals[row]
        signal = sender.channel.operations[i].signal
        low, high = self.wire.signals[row, T.LOW], self.wire.signals[row, T.HIGH]
        self.wire.double[0] = decode(signal, whole(low, high, signal.length, signal.signed))

    def _set_checksum(self, row: int) -> None:
        protection, found = self._protections[row], self.wire.messages
        assert protection is not None  # nobody else asks
        frame, length = self.wire.frame, found[row, T.LENGTH]
        counter = -1
        if found[row, T.COUNTER_BITS]:
            layout = (found[row, column] for column in (T.COUNTER_LITTLE, T.COUNTER_START, T.COUNTER_BITS))
            counter = low_bits(frame, *layout)
        payload = bytearray(frame[:length])
        for bit in protection.crc.bits:
            payload[bit // 8] &= ~(1 << bit % 8)
        message = self.senders[row].plan.message
        value = self._makers[row](bytes(payload), message.frame_id, counter, protection.crc.length)
        self.wire.double[0] = float(value)

    # ---- what was counted and kept

    def flush(self) -> None:
        """Hand the log and the counts of values out of range over: after each chunk of steps.

        Raises RunError when the log's temporary file cannot be written.
        """
        rows = int(self.arrays["state"][T.LOG_ROWS])
        if rows:
            self._kept.append(self.arrays["log"][:rows].copy().view(np.float64))
            self.arrays["state"][T.LOG_ROWS] = 0
        table = self.arrays["signals"]
        for row in np.flatnonzero(table[:, T.TIMES]).tolist():
            sender, i = self._signals[row]
            sender.channel.count(i, int(table[row, T.TIMES]), int(table[row, T.FIRST_TIME]))
        table[:, [T.TIMES, T.FIRST_TIME]] = 0

    def log_of(self, bus: str) -> BusLog:
        """Return the frames of a bus so far, also of messages without a framing, if they were kept.

        Raises RunError as `flush` does.
        """
        self.flush()
        values = [s.channel.log for s in self._all if s.plan.bus == bus and s.plan.framing is None]
        own = [(i, s.plan) for i, s in enumerate(self.senders) if s.plan.bus == bus]
        table = self._kept.table()
        made = [FrameLog({i: plan.message for i, plan in own if not plan.replayed}, table)]
        for replay in self._replays if any(plan.replayed for _, plan in own) else ():
            of_log = {self._rows[number] for number in replay.frames.messages.tolist()}
            made.append(FrameLog({i: plan.message for i, plan in own if i in of_log}, table, sent=False))
        settings = next((s.plan.settings for s in self._all if s.plan.bus == bus), None)
        switch = settings is not None and settings.data_bitrate is not None
        return BusLog(bus, values, tuple(made), switch)


def frames_of(plan: Plan, senders: Sequence[Sender], memory: NDArray[np.float64], logs: bool) -> FramePath:
    """Return the frames of a plan, whose messages are `senders`; the rest is as in `FramePath`."""
    more = plan.initial, plan.faults, plan.receiving_nodes, plan.replays, readers(plan)
    return FramePath(senders, memory, plan.clock.step, logs, *more)
