"""The tables of the frame path, and the meaning of their columns.

The functions of this package (but for `build`) are Python that numba compiles: numbers, 2-D tables and loops.
The python engine calls them as they are, the compiled engine in machine code, so that both do the same. All
tables are int64 but for those that are said to be float64. Times are picoseconds since the start of the run.

A raw value stands in two words, its low 32 bits and the rest, so that no number is beyond int64.
"""

from __future__ import annotations

from typing import Any, NamedTuple


class Wire(NamedTuple):
    """The tables, each a two-dimensional array (for Python a memoryview) but for those in one dimension.

    `reals`, `maps` and `chances` are float64. In one dimension: `memory`, the run's, float64, as
    `fallback`, which has a number for each row of sinks; `odds`, the probability of each fault;
    `ids`, 16 data IDs of each message; `statuses`, in pairs of an input's slot and its row of listeners;
    `frame`, the bytes of the frame at hand; `single` (float32) with its bits `single_bits` (int32), `double`
    (float64) with its bits `double_bits`, one number each; `state`. `helper` is what `ask` calls.
    """

    messages: Any
    signals: Any
    reals: Any
    sinks: Any
    maps: Any
    listeners: Any
    base: Any
    waiting: Any
    staged: Any
    kept: Any
    uses: Any
    faults: Any
    rings: Any
    flights: Any
    buses: Any
    nodes: Any
    chances: Any
    verdicts: Any
    log: Any
    replays: Any
    streams: Any
    fallback: Any
    memory: Any
    frame: Any
    ids: Any
    odds: Any
    statuses: Any
    single: Any
    single_bits: Any
    double: Any
    double_bits: Any
    state: Any
    helper: Any


# ---- columns of messages

(BUS, KEY, LENGTH, EXTENDED, FD, SWITCHED, FIRST_SIGNAL, SIGNALS, RING, EVERY, FIRST, LOGGED) = range(12)
"""KEY: of two messages the one with the lower key wins the bus; LENGTH in bytes; SWITCHED: 1 if the payload
has the data bit rate; SIGNALS rows of signals from FIRST_SIGNAL on; RING: the row of rings in which its
frames are under way, -1 where they arrive when they are sent."""
(NODE, ID, JITTER) = range(12, 15)
"""The row of nodes of its sender, its identifier, and the longest time by which it is queued later."""
(QUEUED, SINCE, SAMPLED, INSTANCE) = range(15, 19)
"""1 while a frame waits in `waiting`, from which time on it may start, the time of its values, and the number
of times that the message was sent."""
(SENT, REPLACED, CARRIED, ERRORS, ARRIVED, BUSY) = range(19, 25)
"""Counts of frames: that were sampled, replaced by a newer one while they waited, carried by the bus, ended
by a wire error, and that arrived; the time that the bus was busy with them."""
(LATENCY_LEAST, LATENCY_SUM, LATENCY_MOST, SEEN_LEAST, SEEN_SUM, SEEN_MOST) = range(25, 31)
"""Time from the sampling to the end of the frame; and to the communication point at which it is seen."""
(PAGE, PAGES) = range(31, 33)
"""Which of the pages of a multiplexed message it is, and the number of them; they have one buffer."""
(PROFILE, CRC_AT, COUNTER_START, COUNTER_BITS, COUNTER_LITTLE, NIBBLE_START, NIBBLE_LITTLE) = range(33, 40)
(MAX_DELTA, COUNTER, FIRST_LISTENER, LISTENERS, FIRST_VERDICT) = range(40, 45)
"""The profile of its protection (0: none), the byte of its checksum, the layouts of counter and of profile
1C's nibble; the greatest step of the counter, and the next one to send (what changes of a multiplexed
message has the row of its first page). LISTENERS rows of listeners from FIRST_LISTENER on judge its frames,
those of all its pages, and have as many rows of `verdicts` for each page, from FIRST_VERDICT on."""
(TIMEOUT, FIRST_STATUS, STATUSES) = range(45, 48)
"""Cycles without a frame that was taken until its receivers get `fallback`; STATUSES slots of inputs from
FIRST_STATUS of `statuses` on get the number of the last frame's status."""
(CHECK_START, CHECK_BITS, CHECK_LITTLE) = range(48, 51)
"""The layout of a maker's checksum."""
(LATENCY_HIGH, SEEN_HIGH) = range(51, 53)
"""Wholes of SUM that were taken out of LATENCY_SUM and SEEN_SUM."""
(KEPT, LOST, SILENCED, DELAYED, HELD, UNHEARD, REPLAYED) = range(53, 60)
"""1 once `kept` has the last payload that was sent; frames that a fault took from receivers, silenced, or
made late; those that were sampled while their node was off the bus, that arrived while a receiver was, and
that came from a log."""
(BABBLES, OWNED) = range(60, 62)
"""1 + the row of the fault whose frames they are, 0 for a message; 1 where a listener has an OWNER."""
(SEND_TYPE, INTERVAL, CYCLE, ASKED, NEXT_STEP, PHASE, ACTIVE, LOOKED) = range(62, 70)
"""Its send type, the least steps between two frames, its cycle in steps; 1 while a frame is wanted, the first
step at which it may be sent, the step at which it became active, 1 while it is, and once its values were
looked at."""
(FIRST_USE, USES) = range(70, 72)
"""USES rows of `uses` from FIRST_USE on: one for each unit that receives it."""
COVERED = 72
"""The bytes that the checksum of a profile covers: without those that the frame adds to its message."""
(STAGED, STAGED_SINCE, STAGED_SAMPLED) = range(73, 76)
"""1 while a frame stands in `staged` that is not queued yet, when it will be, and the time of its values."""
MESSAGE = 76
SUM = 2**62
CYCLIC, ON_CHANGE, MIXED, IF_ACTIVE, ON_WRITE = range(5)
VERDICTS = 0x41
"""Columns of `verdicts`, the number of frames by the number of the status that a listener gave them."""

# ---- columns of signals

(SOURCE, KIND, SATURATES, FIRST_SINK, SINKS, START, BITS, LITTLE, SIGNED, LOW, HIGH, TIMES, FIRST_TIME) = (
    range(13)
)
"""The sender's slot; the rounding; 1 if a value out of range becomes the raw value BELOW or ABOVE; SINKS rows
of sinks from FIRST_SINK on; the layout: START is the least significant bit where LITTLE, else the place of
the most significant one counted from the first bit of the frame; the raw value at hand; the number of values
out of range, and the step of the first."""
(BEFORE_LOW, BEFORE_HIGH, IDLE_LOW, IDLE_HIGH) = range(13, 17)
"""The raw value at the last look, and the one at which the signal is not active."""
SIGNAL = 17
(IN_SCALE, IN_ADD, LEAST, GREATEST, SCALE, OFFSET, OUT_ADD, BELOW, ABOVE) = range(9)
REAL = 9
"""Columns of reals, one row a signal: the map to the bus' unit; the range of values; scale and offset of the
raw value; the offset of decoding, -0.0 where there is none."""
FLOAT64, FLOAT32, NEAREST, HALF_EVEN, TRUNCATE, EXACT = range(6)
"""Kinds of a signal: by format or rounding; EXACT: integers that no double holds, which Python computes."""

SLOT, LISTENER = range(2)
SINK = 2
FACTOR, ADDEND = range(2)
MAP = 2
"""Columns of sinks, the receiver's slot and its row of listeners, and of maps, from the bus' unit to the
receiver's."""

(OWNER, TAKES, LAST, GAP, MISSED, TIMED_OUT, TIMEOUTS, FRESH, TAKEN) = range(9)
LISTENING = 9
"""Columns of listeners, the receivers of a message that hear and judge its frames alike: the row of nodes of
their node (-1: none that could be off the bus); 1 if they take the frame at hand; the counter of the last
that they took, and the greatest step that they take at present (`protection.counters`); cycles so far without
a frame that they took, 1 while they have `fallback`, and how often that was; 1 if a frame came, and was
taken, since `watch` looked."""

BYTES = 64
"""Columns of `base`, `waiting` and `staged`, of a message's payload: what stands there unless a signal is
written, the frame that waits, and the one that is not queued yet."""

(TURN_EVERY, FIRST_TURN, LATER, USER, USED_AT, USE_SAMPLED, USE_COUNT, USE_LEAST, USE_SUM, USE_MOST) = range(
    10
)
USE_HIGH, USE = 10, 11
"""Columns of uses: period and offset of the receiver in steps, 1 if what arrives in its step comes after its
turn, and its row of listeners; the turn in which the last value is used (-1: none came), and when that was
sampled; the number of values that were used before, and least, sum and greatest time from sampling to turn,
and the wholes of SUM that were taken out of the sum."""

# ---- frames under way

(START_ROW, ROWS, HEAD, COUNT) = range(4)
RING_WIDTH = 4
"""Columns of rings: a ring has the ROWS rows of flights from START_ROW on; COUNT of them are in use, the
first is HEAD."""
(MESSAGE_OF, ARRIVAL, SAMPLE_TIME, PAYLOAD) = range(4)
FLIGHT = PAYLOAD + BYTES
"""Columns of flights: a message, the time at which its frame reaches receivers, and that of its values."""

(FREE_AT, PENDING, DELAY, TIMED, FIRST_MESSAGE, MESSAGES, BIT, DATA_BIT, SEED, NAME, NOISY) = range(11)
(BEGUN, STRIKES, OFF_NODES, TO_BABBLE, BEGUN_BY, NEXT_QUEUED) = range(11, 17)
BUS_WIDTH = 17
"""Columns of buses: the time from which on it is idle; the number of frames that wait, or are not queued yet;
what is added to the end of a frame; 1 if frames take time; MESSAGES rows of messages from FIRST_MESSAGE on,
in the order in which they win the bus; the times of a bit; the seed of its draws and a number of its name; 1
if bits may be wrong; the start of the last frame; faults to come that take a node off the bus, nodes that
are, and faults to come that babble; the message of the last frame; the time at which the next frame in
`staged` is queued.
Row i of `chances`, float64, has the probability that n bits on bus i are not all right in column n."""

(READY_AT, ERROR_COUNT, RECEIVE_COUNT, BUS_OF, BUS_OFFS) = range(5)
(OFF_SINCE, OFF_UNTIL, OFF_BY, RECOVERY, HEARD_AT) = range(5, 10)
NODE_WIDTH = 10
"""Columns of nodes: the time from which on it may send; the counters of errors as sender (TEC) and as
receiver (REC); its bus; and how often it was bus-off. It was so the last time from OFF_SINCE to before
OFF_UNTIL, by the fault of row OFF_BY - 1 (0: by its errors); while it is, RECOVERY times 11 recessive bits
are left to be heard, which count from HEARD_AT on."""

(LOG_STEP, LOG_TIME, LOG_MESSAGE, LOG_PAYLOAD) = range(4)
LOG_WIDTH = LOG_PAYLOAD + 8
"""Columns of the log: the step in which the frame was sent, the time of its end, the message (-1 - it for an
error frame that ended one of its frames), and the payload, eight bytes in each word."""

(NEXT, FILLED, OVER) = range(3)
STREAM_WIDTH = 3
REPLAY_ROWS = 1024
"""Columns of streams, the logs that are replayed: of the FILLED rows of `replays` from the stream's number
times REPLAY_ROWS on, the one whose frame comes next; 1 if there are no more. Rows have the columns of the
log, but for the step, which is that in which the frame is seen."""

STEP_TIME, LOG_ROWS, FAULTS = range(3)
STATE = 3
"""Places in state: the time of a step; rows of the log in use; the number of faults."""

(FAULT_KIND, FAULT_BUS, FAULT_KEY, FAULT_NODE, SINCE_TIME, UNTIL_TIME, LEFT, EACH, MET, HITS) = range(10)
(FAULT_SEED, BYTE, MASK, COUNTER_TOO, AMOUNT, FAULT_NUMBER) = range(10, 16)
FAULT_WIDTH = 16
"""Columns of faults: bus and key of the message, or the node; its time; frames that it may still hit (-1:
all) and each how many-th; those that it met, and hit; its seed; what it does to a byte; 1 if the counter is
frozen; how much later frames arrive, or the time between two that babble (0: back to back); its number among
those of one kind on one target, in draws. Of BUS_OFF and BABBLE, MET is 1 once they have begun."""
LOSE, SILENCE, CORRUPT, FREEZE, LATE, BUS_OFF, BABBLE = range(7)

# ---- what Python is asked for, and what comes back

RAW, VALUE, FLUSH, FILL, CHECKSUM = range(5)
"""The raw value of a signal for `double`; the value of a signal's raw value, in `double`; an empty log; the
next rows of a stream; a maker's checksum of the frame at hand, in `double`."""
DONE, RAISED = range(2)

SEND, ARRIVE, CONTEND, WATCH, REPLAY = range(5)
"""Actions of a step."""
