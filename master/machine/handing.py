"""The handover of a turn to the process of a unit and back, in machine code (see `isolation.handover`).

In all functions `t` is the address of the tables' addresses, and `slots` that of the shared memory.
"""

# numba compiles functions without annotations
# mypy: disable-error-code="no-untyped-def, no-untyped-call, untyped-decorator"

from __future__ import annotations

from . import slots as S
from . import tables as L
from .access import (  # fmt: skip # names
    call_0,
    call_1,
    call_4,
    call_6,
    call_for_word,
    exchange,
    fence,
    number,
    publish,
    put_number,
    replace,
    seen,
    word,
)
from .calling import clock, inlined

_MOST_PAUSES = 1023.0  # times that a side sleeps at once after it looked in vain
_FUTEX_WAIT, _FUTEX_WAKE = 0, 1  # linux/futex.h
_NOT_WAITING = 0x4040  # MSG_NOSIGNAL | MSG_DONTWAIT
_BELL_BYTES = 4


@inlined
def post(t, h, slots, mine, they_sleep, count):
    """Write a number, when all that belongs to it stands in the memory, and wake a side that sleeps."""
    publish(slots, mine, count)
    fence()
    state = word(t, L.STATE)
    if seen(slots, they_sleep) == S.ON_SOCKET:
        # what cannot be sent fails again, and is reported, where the other side is waited for
        call_4(word(state, L.SEND_BELL), word(h, L.SOCKET), word(t, L.BELL), _BELL_BYTES, _NOT_WAITING)
    elif replace(slots, they_sleep, S.ON_WORD, S.AWAKE):  # as one, since it may just be going elsewhere
        at = slots + 8 * they_sleep + S.WORD
        call_6(word(state, L.SYSCALL), word(state, L.FUTEX), at, _FUTEX_WAKE, 1, 0, 0)


@inlined
def looks(t, slots, theirs, count, look):
    """Look for a number for `look` [s] at most; return if it came, and if it did in that time.

    A side gives its core away between two looks, so that more processes than cores do not stop each other.
    """
    end = clock(t) + look
    while True:
        call_0(word(word(t, L.STATE), L.YIELD))
        came, late = seen(slots, theirs) == count, clock(t) >= end
        if came or late:
            return came, not late


@inlined
def sleeps(t, slots, theirs, i_sleep, count):
    """Sleep until a number has come; return False if that has not been in the time of a nap."""
    state, at = word(t, L.STATE), slots + 8 * i_sleep + S.WORD
    end = clock(t) + number(word(t, L.NUMBERS), L.NAP)
    while True:
        # until the flag changes, which the other side does after it has written its number
        exchange(slots, i_sleep, S.ON_WORD)
        if seen(slots, theirs) != count:
            thread = call_for_word(word(state, L.UNLOCK)) if word(state, L.UNLOCK) else 0
            call_6(
                word(state, L.SYSCALL), word(state, L.FUTEX), at, _FUTEX_WAIT, S.ON_WORD_BITS,
                word(t, L.NAP_TIME), 0,
            )  # fmt: skip # as C has it
            if word(state, L.LOCK):
                call_1(word(state, L.LOCK), thread)
        came = seen(slots, theirs) == count
        if came or clock(t) >= end:
            put_number(slots, i_sleep, S.AWAKE)
            return came


@inlined
def arrives(t, slots, theirs, i_sleep, count, look):
    """Wait for a number; return False if it has not come while this side looked, and then slept."""
    if seen(slots, theirs) == count or (look > 0.0 and looks(t, slots, theirs, count, look)[0]):
        return True
    return sleeps(t, slots, theirs, i_sleep, count)


@inlined
def answered(t, own, slots, count):
    """Wait for the answer; return False if it has not come while the master looked, and then slept.

    Where the master gets its core back too late for the answer, since others want it too, it sleeps at once
    the next time, and the next 3, 7 ... times if looking is in vain again: one that sleeps is woken before
    those that compute.
    """
    if seen(slots, S.ANSWER) == count:
        return True
    pause = number(own, L.PAUSE)
    if pause > 0.0:
        put_number(own, L.PAUSE, pause - 1.0)
        return sleeps(t, slots, S.ANSWER, S.MASTER_SLEEPS, count)
    came, in_time = looks(t, slots, S.ANSWER, count, number(own, L.LOOKING))
    pauses = 0.0 if in_time else min(2.0 * number(own, L.PAUSES) + 1.0, _MOST_PAUSES)
    put_number(own, L.PAUSES, pauses)
    put_number(own, L.PAUSE, pauses)
    return came or sleeps(t, slots, S.ANSWER, S.MASTER_SLEEPS, count)


@inlined
def copy_spans(t, first, count):
    """Copy what `count` rows of SPANS from `first` on say."""
    s = word(t, L.SPANS) + 8 * L.SPAN * first
    for _ in range(count):
        origin, target = word(s, L.ORIGIN), word(s, L.TARGET)
        for j in range(word(s, L.LENGTH)):
            put_number(target, j, number(origin, j))
        s += 8 * L.SPAN


@inlined
def request(t, o, k, now, end):
    """Request the turn of the isolated unit of operation o at step k; return False where Python has to.

    `now` is the numerator of t_k, `end` [s] the time at which the turn ends.
    """
    h = word(t, L.HANDS) + 8 * L.HAND * word(o, L.A)
    turn, slots = word(h, L.TURN), word(h, L.SLOTS)
    if number(turn, L.PENDING) != 0.0:
        return False
    copy_spans(t, word(h, L.FIRST_SPAN), word(h, L.INPUTS))
    advance, size = number(h, L.ADVANCE), number(h, L.STEP_SIZE)
    landing = size
    if k == word(h, L.LAST_TURN):
        advance, size = number(h, L.LAST_ADVANCE), number(h, L.LAST_SIZE)
        landing, end = number(h, L.LANDING_SIZE), number(h, L.LAST_END)
    put_number(slots, S.STEPS, now * number(h, L.TIME_FACTOR))
    put_number(slots, S.STEPS + 1, advance)
    put_number(slots, S.STEPS + 2, number(h, L.DIVISOR))
    put_number(slots, S.STEPS + 3, float(word(h, L.STEPS)))
    put_number(slots, S.STEPS + 4, size)
    put_number(slots, S.STEPS + 5, landing)
    put_number(slots, S.STEPS + 6, end)
    put_number(slots, S.KIND, S.STEP_SHOWN if word(h, L.SHOWN) else S.STEP)
    count = number(turn, L.REQUESTS) + 1.0
    put_number(turn, L.REQUESTS, count)
    put_number(turn, L.PENDING, 1.0)
    put_number(turn, L.SHOWS, float(word(h, L.SHOWN)))
    post(t, h, slots, S.REQUEST, S.CHILD_SLEEPS, count)
    return True


@inlined
def collect(t, o):
    """Wait for the turn of the isolated unit of operation o and take its outputs; False: Python has to."""
    h = word(t, L.HANDS) + 8 * L.HAND * word(o, L.A)
    turn, slots = word(h, L.TURN), word(h, L.SLOTS)
    if not answered(t, turn, slots, number(turn, L.REQUESTS)):
        return False
    if number(slots, S.FRAME) != 0.0 or number(slots, S.ASKS_END) != 0.0:
        return False
    put_number(turn, L.PENDING, 0.0)
    put_number(turn, L.SHOWS, 0.0)
    copy_spans(t, word(h, L.FIRST_SPAN) + word(h, L.INPUTS), word(h, L.BACK))
    return True
