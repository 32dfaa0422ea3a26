"""The first slots of the memory that the master shares with the process of an isolated unit.

Each is 8 bytes with a double. A side that waits sets its flag to say where it sleeps, and the other side,
when it has written its number, wakes it there.
"""

from __future__ import annotations

# the master's side; the two sides stand apart, so that a core that reads one is not disturbed by the other
REQUEST, KIND, MASTER_SLEEPS, SPIN, LOOK, STEPS = range(6)
STEPS_END = STEPS + 7
"""REQUEST: the number of the last request; SPIN, LOOK: the times [s] that the process looks for it before it
sleeps, in Python and in machine code; STEPS: the numbers of `FmuSteps`."""
# the process' side
ANSWER, FRAME, CHILD_SLEEPS, WARNINGS, MESSAGES, WARNED, ASKS_END, ASKED_END = range(16, 24)
"""ANSWER: the number of the last request that is done; FRAME: 1.0 if a frame follows it on the socket, and
ASKS_END if the unit asks for the end of the run, at the time ASKED_END [s]."""

CALL, STEP, STEP_SHOWN, OUTPUTS = 0.0, 1.0, 2.0, 3.0
"""Kinds of requests: the call in a frame; steps; steps after the outputs that feed through; outputs alone."""

AWAKE, ON_SOCKET, ON_WORD = 0.0, 1.0, 2.0
"""Values of the flags: awake, asleep until a bell rings on the socket, or until the flag itself changes."""
WORD, ON_WORD_BITS = 4, 0x40000000
"""The byte of a flag at which its upper half begins, and what stands there while it is ON_WORD."""
