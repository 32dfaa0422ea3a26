"""The calls of a unit in machine code: values in, a step, values out, as the tables say.

The kernel of the compiled engine and the process of an isolated unit follow the same rows. On an error a
function returns a code, and the caller repeats the check in Python, which raises the exception.

In all functions `t` is the address of the tables' addresses, `m` that of the memory; `c` is that of a row of
CALLS or UNITS.
"""

# numba compiles functions without annotations
# mypy: disable-error-code="no-untyped-def, no-untyped-call, untyped-decorator"

from __future__ import annotations

import numpy as np
from numba import njit

from ..fmi.types import LARGEST_WHOLE, REAL_CODES, WIDE_CODES
from . import tables as L
from .access import (  # fmt: skip # names
    call_2,
    do_step,
    do_step_3,
    number,
    peek,
    put_number,
    put_value,
    put_word,
    size_of,
    transfer,
    transfer_3,
    value_at,
    word,
)

WIDEST = float(LARGEST_WHOLE)

inlined = njit(forceinline=True, error_model="numpy")


@inlined
def clock(t):
    """Return the reading of the clock [s]."""
    state, seconds = word(t, L.STATE), word(t, L.NUMBERS)
    call_2(word(state, L.CLOCK), word(state, L.CLOCK_A), word(state, L.CLOCK_B))
    return np.float64(word(word(t, L.TICKS), 0)) * number(seconds, L.TICK_0) + np.float64(
        word(word(t, L.TICKS), 1)
    ) * number(seconds, L.TICK_1)


@inlined
def fill(t, m, c, kind):
    """Fill the buffer of call c from the memory; return the place of a value that does not fit, else -1."""
    at = word(c, L.VALUES)
    item = word(t, L.ITEMS) + 8 * L.ITEM * word(c, L.FIRST_ITEM)
    for j in range(word(c, L.COUNT)):
        value = number(m, word(item, L.SLOT))
        value = number(item, L.FACTOR) * value + number(item, L.ADDEND)
        if not number(item, L.LOW) <= value <= number(item, L.HIGH):
            return j
        if kind not in REAL_CODES and (value != np.floor(value) or not chosen(item, value)):
            return j
        at += put_value(at, kind, value)
        item += 8 * L.ITEM
    return -1


@inlined
def chosen(item, value):
    """Return True if a whole number is one of an enumeration's, where the item has gaps between them."""
    count = word(item, L.CHOICES)
    for j in range(count):
        if number(word(item, L.NUMBERS_OF), j) == value:
            return True
    return count == 0


@inlined
def take(t, m, c, kind):
    """Copy the buffer of call c to the memory; return the place of a value that no double holds, else -1."""
    at = word(c, L.VALUES)
    item = word(t, L.ITEMS) + 8 * L.ITEM * word(c, L.FIRST_ITEM)
    whole, size, wide = np.int64(WIDEST), size_of(kind), kind in WIDE_CODES
    for j in range(word(c, L.COUNT)):
        value = value_at(at, kind)
        # 2**53 + 1 is rounded to 2**53
        if wide and (abs(value) > WIDEST or (abs(value) == WIDEST and abs(peek(at, np.int64)) > whole)):
            return j
        at += size
        put_number(m, word(item, L.SLOT), number(item, L.FACTOR) * value + number(item, L.ADDEND))
        item += 8 * L.ITEM
    return -1


@inlined
def stopped(t, row, detail, result):
    """Note the row of the call at which the kernel stops, and the detail; return `result`."""
    put_word(word(t, L.STATE), L.CALLED, row)
    put_word(word(t, L.STATE), L.DETAIL, detail)
    return result


@inlined
def warned(t, c):
    """Count that the function in row c returned Warning."""
    put_word(c, L.WARNINGS, word(c, L.WARNINGS) + 1)
    put_word(word(t, L.STATE), L.NOTED, 1)


@inlined
def call(t, m, row):
    """Do the C call in a row, with its values converted before or after it; return DONE or an error."""
    c = word(t, L.CALLS) + 8 * L.CALL_WIDTH * row
    kind = word(c, L.FORMAT)
    if L.IN_PLACE < kind < L.GETS:
        place = fill(t, m, c, kind)
        if place >= 0:
            return stopped(t, row, place, L.NO_FIT)
    if word(c, L.TWICE):
        status = transfer_3(
            word(c, L.FUNCTION),
            word(c, L.COMPONENT),
            word(c, L.REFERENCES),
            word(c, L.COUNT),
            word(c, L.VALUES),
            word(c, L.COUNT),
        )
    else:
        status = transfer(
            word(c, L.FUNCTION),
            word(c, L.COMPONENT),
            word(c, L.REFERENCES),
            word(c, L.COUNT),
            word(c, L.VALUES),
        )
    if status:
        if status != 1:
            return stopped(t, row, np.int64(status), L.BAD_STATUS)
        warned(t, c)
    if kind > L.GETS:
        place = take(t, m, c, kind - L.GETS)
        if place >= 0:
            return stopped(t, row, place, L.NO_FIT)
    return L.DONE


@inlined
def step(t, c, k, now, time):
    """Do the steps of the turn at step k of the unit in row c; return DONE or an error.

    `time` [s] is t_k, where the first of them begins, and `now` its numerator.
    """
    advance, size = number(c, L.ADVANCE), number(c, L.STEP_SIZE)
    landing = size
    if k == word(c, L.LAST_TURN):
        advance, size = number(c, L.LAST_ADVANCE), number(c, L.LAST_SIZE)
        landing = number(c, L.LANDING_SIZE)
    first, divisor = now * number(c, L.TIME_FACTOR), number(c, L.DIVISOR)
    return steps(t, c, word(c, L.STEPS), time, first, advance, divisor, size, landing)


@inlined
def steps(t, c, count, time, first, advance, divisor, size, landing):
    """Do `count` steps of the unit in row c, which begins at `time` [s]; return DONE or an error.

    The others are those of `FmuSteps`; `size` and `landing` [s] are the sizes, the latter that of the last.
    """
    answers = word(c, L.ANSWERS)
    for j in range(count):
        if j > 0:
            time = (first + j * advance) / divisor
        if j == count - 1:
            size = landing
        if answers:
            status = do_step_3(
                word(c, L.FUNCTION), word(c, L.COMPONENT), time, size,
                word(c, L.EVENT), word(c, L.ENDING), word(c, L.EARLY), word(c, L.REACHED),
            )  # fmt: skip # as C has it
        else:
            status = do_step(word(c, L.FUNCTION), word(c, L.COMPONENT), time, size)
        if status:
            if status != 1:
                put_word(word(t, L.STATE), L.DETAIL, np.int64(status))
                return L.BAD_STATUS
            warned(t, c)
        if answers and (peek(word(c, L.ENDING), np.int8) != 0 or peek(word(c, L.EARLY), np.int8) != 0):
            return L.BAD_END
    return L.DONE
