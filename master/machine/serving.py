"""The turns of an isolated unit in its process, in machine code: they come, are done, and are answered.

`run` is compiled in the master, whose bytes the process loads (see `flat` and `loaded`), since numba would
take longer to load there than all the rest.
"""

# numba compiles functions without annotations
# mypy: disable-error-code="no-untyped-def, no-untyped-call, untyped-decorator"

from __future__ import annotations

import numpy as np

from . import slots as S
from . import tables as L
from .access import call_2, number, put_number, put_word, word
from .calling import call, inlined, steps
from .handing import arrives, post


@inlined
def transfers(t, m, first, count):
    """Do `count` operations from row `first` of OPS on; return DONE or an error."""
    o = word(t, L.OPS) + 8 * L.OPERATION * first
    for _ in range(count):
        a = word(o, L.A)
        if word(o, L.KIND) == L.COPY:
            for j in range(word(o, L.C)):
                put_number(m, word(o, L.B) + j, number(m, a + j))
        elif word(o, L.KIND) == L.PYTHON_ACT:
            if call_2(word(word(t, L.STATE), L.PYTHON), word(o, L.C), 0) != 0:
                return L.RAISED
        else:
            result = call(t, m, a)
            if result != L.DONE:
                return result
        o += 8 * L.OPERATION
    return L.DONE


@inlined
def turn(t, m, h, slots):
    """Set the inputs, do the steps that are asked for, and get the outputs; return DONE or an error."""
    inputs, shown = word(h, L.INPUTS), word(h, L.SHOWN)
    result = transfers(t, m, 0, inputs)
    if result != L.DONE:
        return result
    if number(slots, S.KIND) == S.STEP_SHOWN:
        result = transfers(t, m, inputs, shown)
        if result != L.DONE:
            return result
    first, divisor = number(slots, S.STEPS), number(slots, S.STEPS + 2)
    result = steps(
        t, word(t, L.UNITS), np.int64(number(slots, S.STEPS + 3)), first / divisor, first,
        number(slots, S.STEPS + 1), divisor, number(slots, S.STEPS + 4), number(slots, S.STEPS + 5),
    )  # fmt: skip # in the order of FmuSteps
    if result != L.DONE:
        return result
    return transfers(t, m, inputs + shown, word(h, L.BACK))


def run(t):
    """Do turns as they come; return NOTHING_CAME, OTHER_REQUEST, WARNED or an error of a turn.

    The turn of the latter two is not answered yet.
    """
    m, h, state = word(t, L.MEMORY), word(t, L.HANDS), word(t, L.STATE)
    own, slots = word(h, L.TURN), word(h, L.SLOTS)
    while True:
        count = number(own, L.REQUESTS) + 1.0
        if not arrives(t, slots, S.REQUEST, S.CHILD_SLEEPS, count, number(slots, S.LOOK)):
            return L.NOTHING_CAME
        kind = number(slots, S.KIND)
        if kind != S.STEP and kind != S.STEP_SHOWN:
            return L.OTHER_REQUEST
        put_number(own, L.REQUESTS, count)
        put_word(state, L.CALLED, -1)
        result = turn(t, m, h, slots)
        if result != L.DONE:
            return result
        if word(state, L.NOTED):
            return L.WARNED
        put_number(slots, S.FRAME, 0.0)
        post(t, h, slots, S.ANSWER, S.MASTER_SLEEPS, count)
