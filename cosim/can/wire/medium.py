"""The way of a frame from its sender to its receivers."""

from __future__ import annotations

from ..timing.draws import drawn
from ..timing.lengths import INTERFRAME
from . import tables as T
from .arbitration import contend, number_of
from .babble import begin, go_on
from .buffers import admit, enter, stage
from .faults import hit, spoil, spoil_logged
from .log import log, log_error
from .off import hear, is_off, note_hit, strike
from .protect import accepted, protect, watch
from .requests import wanted
from .tables import Wire
from .uses import note, use
from .values import ask, pack, sample, unpack

_JITTER = 1  # what is drawn for


def send(w: Wire, i: int, k: int) -> int:
    """Sample and pack message i in step k, and send the frame if it is due; return DONE or RAISED."""
    m, b, now = w.messages, w.buses, k * w.state[T.STEP_TIME]
    bus, spontaneous = m[i, T.BUS], m[i, T.SEND_TYPE] != T.CYCLIC
    if spontaneous:
        if sample(w, i, k) != T.DONE:
            return T.RAISED
        if not wanted(w, i, k):
            return T.DONE
    if hit(w, T.SILENCE, i, now) >= 0:
        m[i, T.SILENCED] += 1
        return T.DONE
    if not spontaneous and sample(w, i, k) != T.DONE:
        return T.RAISED
    pack(w, i)
    done = spoil(w, i, now, k) if w.state[T.FAULTS] else protect(w, i, k)
    if done != T.DONE:
        return T.RAISED
    m[i, T.SENT] += 1
    m[i, T.INSTANCE] += 1
    if b[bus, T.STRIKES]:
        strike(w, bus, now)
    off = is_off(w, m[i, T.NODE], now)
    if off:
        m[i, T.HELD] += 1
        note_hit(w, m[i, T.NODE])
    if b[bus, T.TIMED]:
        queue(w, i, now)
        return T.DONE
    if off:
        return T.DONE
    if log(w, i, k, now) != T.DONE:
        return T.RAISED
    m[i, T.CARRIED] += 1
    if m[i, T.RING] < 0:
        return deliver(w, i, k, now, now)
    push(w, m[i, T.RING], i, arrival_of(w, i, now, now), now)
    return T.DONE if b[bus, T.DELAY] else arrive(w, m[i, T.RING], k)


def arrival_of(w: Wire, i: int, end: int, sampled: int) -> int:
    """Return when the frame of message i that ended at a time reaches its receivers."""
    time: int = end + w.buses[w.messages[i, T.BUS], T.DELAY]
    late = hit(w, T.LATE, i, sampled) if w.state[T.FAULTS] else -1
    if late >= 0:
        w.messages[i, T.DELAYED] += 1
        time += w.faults[late, T.AMOUNT]
    return time


def queue(w: Wire, i: int, now: int) -> None:
    """Let the frame at hand, of message i, wait for the bus: from now on, or by its jitter from later on."""
    m, bus = w.messages, w.messages[i, T.BUS]
    if m[i, T.JITTER]:
        purpose = _JITTER | m[i, T.PAGE] << 8
        draw = drawn(w.buses[bus, T.SEED], w.buses[bus, T.NAME], number_of(w, i), m[i, T.INSTANCE], purpose)
        stage(w, i, now, now + int(draw * m[i, T.JITTER]))
        return
    enter(w, i, now, now)
    for byte in range(m[i, T.LENGTH]):
        w.waiting[i, byte] = w.frame[byte]


def run_bus(w: Wire, bus: int, k: int) -> int:
    """Let the frames that wait have the bus, as many as start before the next step; return DONE or RAISED."""
    m, end = w.messages, (k + 1) * w.state[T.STEP_TIME]
    if w.buses[bus, T.TO_BABBLE]:
        begin(w, bus, end)
    while w.buses[bus, T.PENDING] > 0:
        i = contend(w, bus, end)
        if i == -1:
            break
        finish = w.buses[bus, T.FREE_AT] - INTERFRAME * w.buses[bus, T.BIT]
        if i < 0:
            if log_error(w, -2 - i, k, finish) != T.DONE:
                return T.RAISED
            continue
        note(m, i, T.LATENCY_LEAST, T.LATENCY_HIGH, finish - m[i, T.SAMPLED], m[i, T.CARRIED])
        m[i, T.CARRIED] += 1
        if log(w, i, k, finish) != T.DONE:
            return T.RAISED
        if m[i, T.BABBLES]:
            go_on(w, i)
        else:
            push(w, m[i, T.RING], i, arrival_of(w, i, finish, m[i, T.SAMPLED]), m[i, T.SAMPLED])
    if w.buses[bus, T.NEXT_QUEUED] < end:
        admit(w, bus, end - 1)
    if w.buses[bus, T.STRIKES]:
        strike(w, bus, end - 1)
    return T.DONE


def arrive(w: Wire, ring: int, k: int) -> int:
    """Bring the frames of a ring that have arrived by step k to their receivers; return DONE or RAISED."""
    r, now = w.rings, k * w.state[T.STEP_TIME]
    while r[ring, T.COUNT] > 0:
        row = r[ring, T.START_ROW] + r[ring, T.HEAD]
        if w.flights[row, T.ARRIVAL] > now:
            break
        r[ring, T.HEAD] = (r[ring, T.HEAD] + 1) % r[ring, T.ROWS]
        r[ring, T.COUNT] -= 1
        i = w.flights[row, T.MESSAGE_OF]
        for byte in range(w.messages[i, T.LENGTH]):
            w.frame[byte] = w.flights[row, T.PAYLOAD + byte]
        if deliver(w, i, k, w.flights[row, T.SAMPLE_TIME], w.flights[row, T.ARRIVAL]) != T.DONE:
            return T.RAISED
    return T.DONE


def push(w: Wire, ring: int, i: int, arrival: int, sampled: int) -> None:
    """Let the frame at hand, of message i, be under way until its arrival, after all that are not later."""
    r, behind = w.rings, w.rings[ring, T.COUNT]
    row = flight_of(w, ring, behind)
    while behind > 0 and w.flights[flight_of(w, ring, behind - 1), T.ARRIVAL] > arrival:
        before = flight_of(w, ring, behind - 1)
        for column in range(T.FLIGHT):
            w.flights[row, column] = w.flights[before, column]
        row = before
        behind -= 1
    r[ring, T.COUNT] += 1
    w.flights[row, T.MESSAGE_OF], w.flights[row, T.ARRIVAL] = i, arrival
    w.flights[row, T.SAMPLE_TIME] = sampled
    for byte in range(w.messages[i, T.LENGTH]):
        w.flights[row, T.PAYLOAD + byte] = w.frame[byte]


def replay(w: Wire, stream: int, k: int) -> int:
    """Bring the frames of a log that are seen by step k to their receivers; return DONE or RAISED."""
    s = w.streams
    while True:
        if s[stream, T.NEXT] == s[stream, T.FILLED]:
            if s[stream, T.OVER]:
                return T.DONE
            if ask(w, T.FILL, stream, k) != T.DONE:
                return T.RAISED
            continue
        row = stream * T.REPLAY_ROWS + s[stream, T.NEXT]
        if w.replays[row, T.LOG_STEP] > k:
            return T.DONE
        s[stream, T.NEXT] += 1
        i = w.replays[row, T.LOG_MESSAGE]
        for byte in range(w.messages[i, T.LENGTH]):
            w.frame[byte] = w.replays[row, T.LOG_PAYLOAD + (byte >> 3)] >> 8 * (byte & 7) & 255
        if pass_on(w, i, k, w.replays[row, T.LOG_TIME]) != T.DONE:
            return T.RAISED


def pass_on(w: Wire, i: int, k: int, time: int) -> int:
    """Let the frame at hand, of message i of a log, which it has at a time, be received; as `deliver`."""
    if hit(w, T.SILENCE, i, time) >= 0:
        w.messages[i, T.SILENCED] += 1
        return T.DONE
    if w.buses[w.messages[i, T.BUS], T.STRIKES]:
        strike(w, w.messages[i, T.BUS], time)
    if is_off(w, w.messages[i, T.NODE], time):
        w.messages[i, T.HELD] += 1
        note_hit(w, w.messages[i, T.NODE])
        return T.DONE
    if w.state[T.FAULTS] and spoil_logged(w, i, time, k) != T.DONE:
        return T.RAISED
    w.messages[i, T.REPLAYED] += 1
    if log(w, i, k, time) != T.DONE:
        return T.RAISED
    return deliver(w, i, k, time, time)


def flight_of(w: Wire, ring: int, n: int) -> int:
    """Return the row of flights of the n-th frame that is under way in a ring."""
    r = w.rings
    row: int = r[ring, T.START_ROW] + (r[ring, T.HEAD] + n) % r[ring, T.ROWS]
    return row


def deliver(w: Wire, i: int, k: int, sampled: int, time: int) -> int:
    """Give the frame at hand, of message i, which arrives at a time, to its receivers.

    Return DONE or RAISED.
    """
    m = w.messages
    note(m, i, T.SEEN_LEAST, T.SEEN_HIGH, k * w.state[T.STEP_TIME] - sampled, m[i, T.ARRIVED])
    m[i, T.ARRIVED] += 1
    if hit(w, T.LOSE, i, sampled) >= 0:
        m[i, T.LOST] += 1
        return T.DONE
    if m[i, T.OWNED] and hear(w, i, time) == 0:
        return T.DONE
    takers = accepted(w, i, k)
    if takers < 0:
        return T.RAISED
    if takers == 0:
        return T.DONE
    use(w, i, k, sampled)
    return unpack(w, i, k)


def act(w: Wire, what: int, i: int, k: int) -> int:
    """Do an action of step k: SEND or WATCH message i, REPLAY log i, let the frames of ring i ARRIVE or of
    bus i CONTEND.

    Return DONE or RAISED.
    """
    if what == T.SEND:
        return send(w, i, k)
    if what == T.ARRIVE:
        return arrive(w, i, k)
    if what == T.WATCH:
        watch(w, i)
        return T.DONE
    if what == T.REPLAY:
        return replay(w, i, k)
    return run_bus(w, i, k)
