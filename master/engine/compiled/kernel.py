"""The loop over the steps: one function of machine code, compiled by numba and kept in its cache.

It follows the tables that `tables` describes. Their operations are the actions of `schedule`, in its order:
primitives that the kernel executes without returning to Python. Each computes what the Python engine, the
units and the channel compute, bit for bit. On an error the kernel stops and returns a code and the
operation's index; Python repeats the check and raises the exception.

In all functions `t` is the address of the tables' addresses, `m` that of the memory; `c` is that of a row of
CALLS or UNITS, `o` of OPS; `k` is the step.
"""

# numba compiles functions without annotations
# mypy: disable-error-code="no-untyped-def, no-untyped-call, untyped-decorator"

from __future__ import annotations

import numpy as np

from ....cosim.can.wire import tables as T
from ...machine import tables as L
from ...machine.access import call_2, call_4, number, put_number, put_word, word
from ...machine.calling import call, clock, inlined, step
from ...machine.handing import collect, request

LARGEST = 1.7976931348623157e308
LOOK = 32  # steps at most between two readings of the clock


@inlined
def check(m, first, count):
    """Return DONE if `count` values from slot `first` on are finite, else NOT_FINITE."""
    for j in range(first, first + count):
        if not abs(number(m, j)) <= LARGEST:
            return L.NOT_FINITE
    return L.DONE


# ---- the channel


@inlined
def rounded(q, mode):
    """Round a raw value in range by the signal's mode; that of a float signal only to its format."""
    if mode == T.NEAREST or mode == T.TRUNCATE:
        # the greatest double below 0.5, since 0.5 itself would round 0.49999999999999994 up
        half = 0.49999999999999994 if mode == T.NEAREST else 0.0
        return np.floor(q + half) if q >= 0.0 else 0.0 - np.floor(half - q)
    if mode == T.HALF_EVEN:
        # doubles from 2**52 on are whole, so the sum is rounded to a whole number, a half to the even one
        return q + 6755399441055744.0 - 6755399441055744.0
    if mode == T.FLOAT32:
        return np.float64(np.float32(q))
    return q


@inlined
def out_of_range(t, i, s, x, k):
    """Return the raw value for x, out of range of signal i in row s, and False if Python raised an error."""
    if word(s, L.SATURATES) and x == x:
        if word(s, L.TIMES) == 0:
            put_word(s, L.FIRST_TIME, k)
        put_word(s, L.TIMES, word(s, L.TIMES) + 1)
        put_word(word(t, L.STATE), L.NOTED, 1)
        return number(s, L.ABOVE) if x > number(s, L.GREATEST) else number(s, L.BELOW), True
    numbers = word(t, L.NUMBERS)
    put_number(numbers, L.VALUE, x)
    good = call_2(word(word(t, L.STATE), L.PYTHON), -1 - i, k) == 0
    return number(numbers, L.VALUE), good


@inlined
def send(t, m, first, count, log, k):
    """Sample `count` signals from row `first` on, then write the received values; return DONE or RAISED."""
    signals, raws = word(t, L.SIGNALS), word(t, L.RAWS)
    s = signals + 8 * L.SIGNAL * first
    for i in range(first, first + count):
        x = number(s, L.IN_SCALE) * number(m, word(s, L.FROM)) + number(s, L.IN_ADD)
        if number(s, L.LEAST) <= x <= number(s, L.GREATEST):
            raw = rounded((x - number(s, L.OFFSET)) / number(s, L.RESOLUTION), word(s, L.MODE))
        else:
            raw, good = out_of_range(t, i, s, x, k)
            if not good:
                return L.RAISED
        put_number(raws, i, raw)
        s += 8 * L.SIGNAL
    s = signals + 8 * L.SIGNAL * first
    for i in range(first, first + count):
        value = number(raws, i) * number(s, L.RESOLUTION) + number(s, L.OUT_ADD)
        sink = word(t, L.SINKS) + 8 * L.ROUTE * word(s, L.TO)
        for _ in range(word(s, L.RECEIVERS)):
            put_number(m, word(sink, L.SINK), number(sink, L.SCALE) * value + number(sink, L.ADD))
            sink += 8 * L.ROUTE
        s += 8 * L.SIGNAL
    if log >= 0:
        logs = word(t, L.LOGS)
        at = word(logs, log)
        put_number(word(t, L.LOG), at, np.float64(k))
        for i in range(count):
            put_number(word(t, L.LOG), at + 1 + i, number(raws, first + i))
        put_word(logs, log, at + 1 + count)
    return L.DONE


@inlined
def wait(t, m, o, k):
    """Copy the values that a message has sent to its waiting slots, or from there to the mailboxes."""
    w = word(t, L.WAITS) + 8 * L.WAIT * word(o, L.A)
    n = (k - word(o, L.FIRST)) // word(o, L.EVERY) % word(w, L.ROWS)
    row = word(w, L.PLACE) + n * word(w, L.WIDTH)
    arrival = word(t, L.ARRIVALS) + 16 * word(w, L.ARRIVAL)
    for j in range(word(w, L.WIDTH)):
        if word(o, L.KIND) == L.KEEP:
            put_number(m, row + j, number(m, word(arrival, 0)))
        else:
            put_number(m, word(arrival, 1), number(m, row + j))
        arrival += 16


# ---- a step


@inlined
def numerator(t, k):
    """Return the numerator of t_k, from its count."""
    numbers = word(t, L.NUMBERS)
    if k == word(word(t, L.STATE), L.STOP_STEP):
        return number(numbers, L.CLOCK_STOP)
    return number(numbers, L.CLOCK_FIRST) + k * number(numbers, L.CLOCK_ADVANCE)


@inlined
def end_of_turn(t, o, k):
    """Return the time [s] at which the turn that begins at step k ends."""
    return numerator(t, k + word(o, L.EVERY)) / number(word(t, L.NUMBERS), L.CLOCK_DIVISOR)


@inlined
def python_act(t, o, k):
    """Let Python do the action of operation o in step k; return DONE or RAISED."""
    return L.DONE if call_2(word(word(t, L.STATE), L.PYTHON), word(o, L.C), k) == 0 else L.RAISED


@inlined
def driven(t, row, s):
    """Return the value of a row of DRIVES in step s of the chunk."""
    return number(word(t, L.DRIVES), row * word(word(t, L.STATE), L.ROOM) + s)


@inlined
def operate(t, m, o, s, k, now, time):
    """Do the operation in row o, in step k (s of the chunk) at `time` [s], whose numerator is `now`."""
    kind, a, b = word(o, L.KIND), word(o, L.A), word(o, L.B)
    if kind == L.TAKE:
        r = word(t, L.ROUTES) + 8 * L.ROUTE * a
        for _ in range(b):
            put_number(
                m, word(r, L.SINK), number(r, L.SCALE) * number(m, word(r, L.SOURCE)) + number(r, L.ADD)
            )
            r += 8 * L.ROUTE
    elif kind == L.CALL:
        result = call(t, m, a)
        if result != L.DONE:
            return result
        return check(m, b, word(o, L.C))
    elif kind == L.STEP:
        for row in range(b, b + word(o, L.C)):
            result = call(t, m, row)
            if result != L.DONE:
                return result
        return step(t, word(t, L.UNITS) + 8 * L.UNIT * a, k, now, time)
    elif kind == L.CHECK:
        return check(m, b, word(o, L.C))
    elif kind == L.COPY:
        for j in range(word(o, L.C)):
            put_number(m, b + j, number(m, a + j))
    elif kind == L.SEND:
        return send(t, m, a, b, word(o, L.C), k)
    elif kind == L.RECORD:
        columns = word(t, L.COLUMNS)
        row = word(t, L.ROWS_OF_RUN) + 8 * b * s
        for j in range(b):
            put_number(row, j, number(m, word(columns, j)))
    elif kind == L.DRIVE:
        put_number(m, a, driven(t, b, s))
    elif kind == L.EFFECT:
        e = word(t, L.EFFECTS) + 8 * L.EFFECT_WIDTH * a
        for _ in range(b):
            slot = word(e, L.SLOT)
            if word(e, L.EFFECT_KIND) == L.REPLACE:
                put_number(m, slot, number(e, L.VALUE_OF))
            elif word(e, L.EFFECT_KIND) == L.FOLLOW:
                put_number(m, slot, driven(t, word(e, L.VALUE_OF), s))
            else:
                put_number(m, slot, number(m, slot) + number(e, L.VALUE_OF))
            e += 8 * L.EFFECT_WIDTH
    elif kind == L.KEEP or kind == L.DELIVER:
        wait(t, m, o, k)
    elif kind == L.REQUEST_TURN:
        if not request(t, o, k, now, end_of_turn(t, o, k)):
            return python_act(t, o, k)
    elif kind == L.COLLECT_TURN:
        if not collect(t, o):
            return python_act(t, o, k)
    elif kind == L.WIRE_ACT:
        if call_4(word(word(t, L.STATE), L.WIRE_CODE), word(t, L.WIRE), a, b, k) != 0:
            return L.RAISED
    else:
        return python_act(t, o, k)
    return L.DONE


@inlined
def follow(t, timed):
    """Do the steps of a chunk, or as many as its time allows; `timed`: add up the time of each operation."""
    state, numbers, m = word(t, L.STATE), word(t, L.NUMBERS), word(t, L.MEMORY)
    begin = last = moment = clock(t)
    look, interval = 1, 1
    for s in range(word(state, L.WANTED)):
        # the clock, at most every LOOK steps: a chunk ends when its time is over
        if s == look:
            now = clock(t)
            if now - begin > number(numbers, L.SECONDS):
                break
            interval = min(2 * interval, LOOK) if now - last < 0.001 else max(1, interval // 2)
            last, look = now, s + interval
        # the communication point t_k and its numerator, from its count
        k = word(state, L.START_STEP) + s
        now = numerator(t, k)
        time = now / number(numbers, L.CLOCK_DIVISOR)
        # the operations in order, each at the steps at which it is due
        o = word(t, L.OPS)
        if timed:
            moment = clock(t)
        for i in range(word(state, L.OPERATIONS)):
            if k == word(o, L.DUE):
                put_word(state, L.AT, i)
                put_word(o, L.DUE, k + word(o, L.EVERY))
                result = operate(t, m, o, s, k, now, time)
                if timed:
                    now = clock(t)
                    put_number(word(t, L.TIMES_OF_OPS), i, number(word(t, L.TIMES_OF_OPS), i) + now - moment)
                    moment = now
                if result != L.DONE:
                    return result
            o += 8 * L.OPERATION
        # the step is done: an error in a later one leaves its row
        put_word(state, L.STEPS_DONE, s + 1)
    return L.DONE


def run(t):
    """Follow the tables whose addresses stand at `t`; return DONE or an error of `tables`."""
    return follow(t, False)


def run_timed(t):
    """Follow the tables and add up the time of each operation, with that of reading the clock."""
    return follow(t, True)


def run_one(t, o, s, k):
    """Do the operation in row o, in step k (s of the chunk), as code of its own asks for it."""
    now = numerator(t, k)
    time = now / number(word(t, L.NUMBERS), L.CLOCK_DIVISOR)
    return operate(t, word(t, L.MEMORY), o, s, k, now, time)
