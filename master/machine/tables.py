"""The tables that the kernel follows, and the meaning of their columns.

A table is an array of 8-byte numbers with a fixed number of columns; a column holds int64 or float64. The
kernel receives one array of the tables' addresses. A slot is an index of the run's memory.
"""

from __future__ import annotations

STATE, NUMBERS, MEMORY, OPS, ROUTES, EFFECTS, CALLS, ITEMS, UNITS, SIGNALS, SINKS, RAWS, WAITS = range(13)
ARRIVALS, COLUMNS, ROWS_OF_RUN, DRIVES, LOGS, LOG, TICKS, TIMES_OF_OPS = range(13, 21)
HANDS, SPANS, BELL, NAP_TIME, WIRE = range(21, 26)
TABLES = 26
"""The tables, in the order of their addresses."""

# ---- operations: the actions of the schedule as primitives that the kernel executes without Python

KIND, DUE, EVERY, FIRST, A, B, C = range(7)
OPERATION = 7
"""Columns of OPS: done at step DUE, which then becomes DUE + EVERY; EVERY and FIRST are the action's."""

TAKE = 0  # B ROUTES from row A on
CALL = 1  # the C call in row A of CALLS, after which C slots from B on hold finite numbers
STEP = 2  # C C calls from row B of CALLS on, then the steps of the unit in row A of UNITS
CHECK = 3  # C slots from B on hold finite numbers
COPY = 4  # C slots from A on to those from B on
SEND = 5  # B SIGNALS from row A on; C: the message's place in LOGS, or -1
RECORD = 6  # B COLUMNS
DRIVE = 7  # slot A gets the value of stimulus B
EFFECT = 8  # B EFFECTS from row A on
KEEP = 9  # the values that the message in row A of WAITS has sent are copied to its waiting slots
DELIVER = 10  # and from there to the mailboxes
REQUEST_TURN = 11  # the turn of the isolated unit in row A of HANDS is requested; C: the action
COLLECT_TURN = 12  # and its outputs are taken when it is done; Python does action C where that takes long
WIRE_ACT = 14  # action A of the frame path on its row B
PYTHON_ACT = 13  # calls Python, which does action C as the python engine does, or moves texts

SOURCE, SINK, SCALE, ADD = range(4)
ROUTE = 4
"""Columns of ROUTES and SINKS: scale * x + add. An offset of 0 is -0.0, which changes no double."""

SLOT, EFFECT_KIND, VALUE_OF = range(3)
EFFECT_WIDTH = 3
ADD_TO, REPLACE, FOLLOW = range(3)
"""Columns of EFFECTS, and the kinds: the value is added to the one in the slot, or replaces it, or it is the
row of DRIVES whose value of the step replaces it."""

# ---- C calls

FUNCTION, COMPONENT, WARNINGS = range(3)
"""First columns of CALLS and UNITS: addresses, and the number of calls that returned Warning."""
REFERENCES, COUNT, VALUES, TWICE, FORMAT, FIRST_ITEM = range(3, 9)
CALL_WIDTH = 9
"""Columns of CALLS: addresses of the value references and the buffer, their count (TWICE: passed again after
the values, as FMI 3.0 requires), and the buffer's format with the row of ITEMS for its first value. A format
is the code of an FMI type in `fmi.types`."""
IN_PLACE = 0  # no format: the values are a part of the memory
GETS = 100  # added to the format where values are read

FACTOR, ADDEND, LOW, HIGH, CHOICES, NUMBERS_OF = range(1, 7)
ITEM = 7
"""Columns of ITEMS, after SLOT: the map of a value, the range that fits into the buffer, and of an
enumeration with gaps the count of its numbers and their address."""

STEPS, ANSWERS, EVENT, ENDING, EARLY, REACHED = range(3, 9)
TIME_FACTOR, DIVISOR, ADVANCE, STEP_SIZE, LAST_TURN, LAST_ADVANCE, LAST_SIZE, LANDING_SIZE = range(9, 17)
UNIT = 17
"""Columns of UNITS: FMU steps in a turn; the number of output arguments of FMI 3.0 (4, else 0), and their
addresses; the times of the steps, as in `plan.turns`, and their size [s]; the k of the turn before the stop
time, what is between its FMU steps, their size [s], and that of its last one."""

# ---- turns of isolated units

SLOTS, SOCKET, TURN = range(3)
SHOWN, FIRST_SPAN, INPUTS, BACK, LAST_END = range(17, 22)
HAND = 22
"""Columns of HANDS, beside STEPS and the times of UNITS: addresses of the shared memory and of the side's own
numbers, the descriptor of its socket; the time [s] at which the last turn ends. For the master, SHOWN is 1 if
outputs feed through, and INPUTS rows of SPANS from FIRST_SPAN on take values there, the next BACK rows take
them back. For the process of the unit, INPUTS, SHOWN and BACK are the numbers of its OPS: those that set
inputs, show outputs that feed through, and get outputs."""
REQUESTS, PENDING, SHOWS, FRESH, LOOKING, PAUSE, PAUSES = range(7)
TURN_SIZE = 7
"""Places in the own numbers of a side: the number of the last request; 1 while it is not done, if it shows
outputs that feed through, and if its outputs are in the shared memory, but not yet in the run's; the time [s]
that the master looks for the answer, which the process could not be trusted with; how often more, and how
often after the last look, it sleeps at once."""

ORIGIN, TARGET, LENGTH = range(3)
SPAN = 3
"""Columns of SPANS: addresses, and the number of slots that are copied."""

# ---- the channel

FROM, MODE, SATURATES, TO, RECEIVERS, TIMES, FIRST_TIME = range(7)
IN_SCALE, IN_ADD, LEAST, GREATEST, RESOLUTION, OFFSET, OUT_ADD, BELOW, ABOVE = range(7, 16)
SIGNAL = 16
"""Columns of SIGNALS: the sender's slot; the rounding, by the codes of `can.wire.tables`; 1 if a value out
of range becomes the raw value BELOW or ABOVE; RECEIVERS rows of SINKS from TO on; the number of values out of
range, and the step of the first; the map to the bus' unit; the range of values; scale and offset of the raw
value; the offset of decoding."""

PLACE, ROWS, WIDTH, ARRIVAL = range(4)
WAIT = 4
"""Columns of WAITS: first slot, rows and width of a message's waiting slots, its first row in ARRIVALS (slot,
mailbox)."""

# ---- a chunk

WANTED, STEPS_DONE, START_STEP, OPERATIONS, ROOM, AT, CALLED, DETAIL, PYTHON = range(9)
CLOCK, CLOCK_A, CLOCK_B, NOTED, STOP_STEP, YIELD, SYSCALL, FUTEX, SEND_BELL, UNLOCK, LOCK = range(9, 20)
WIRE_CODE, OPERATE = range(20, 22)
STATE_SIZE = 22
"""Places in STATE: steps wanted and done, the first one, the number of OPS, the number of steps with values
of stimuli; the operation that the kernel is at, the row of CALLS within it (-1: none), and a detail;
addresses of the function of Python and of the clock, and the clock's arguments, one of which is the address
of TICKS; 1 if any column WARNINGS or TIMES is not 0; the step at the stop time; addresses of C functions that
give the core away, call the system, and send, and the number of the system call futex; functions of Python
that give its lock back while a side sleeps, and take it (0: the side does not hold it); the address of the
frame path's function, which gets that of the table WIRE: addresses and numbers of rows of its tables, in the
order of `cosim.can.wire.tables.Wire`; and that of the function that does one operation, for code that does
the others itself."""
CLOCK_FIRST, CLOCK_ADVANCE, CLOCK_STOP, CLOCK_DIVISOR, SECONDS, VALUE, TICK_0, TICK_1, NAP = range(9)
NUMBERS_SIZE = 9
"""Places in NUMBERS: the numbers of the run's clock, and its numerator at STOP_STEP; the longest duration of
a chunk, a value that Python converts, and the seconds in one unit of each number in TICKS; the time [s] after
which a side that sleeps on a word goes to sleep on its socket. NAP_TIME is the same as C has it."""

DONE, BAD_STATUS, BAD_END, NO_FIT, NOT_FINITE, RAISED, NOTHING_CAME, OTHER_REQUEST, WARNED = range(9)
"""Return values of the kernel, and of the turns in the process of a unit, where the last three are: no
request has come, one that is none of a turn, a turn is done with warnings and not yet answered. DETAIL is the
status of a call, or the place of a value that does not fit."""
