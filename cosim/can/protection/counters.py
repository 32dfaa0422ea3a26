"""The receiver's judgment of counters: the state machines of AUTOSAR's E2E checks, profiles 1, 2 and 5.

A check is called for each frame that arrives, and once a cycle in which none does. It keeps `last`, the
counter of the last frame that was taken (-1: none yet), and `gap`, the greatest difference that it took.
`gap` is `max_delta` after a frame that was taken and one more with each check: with max_delta = 1 the next
frame may be one or two counts on, and one more for each cycle without a frame.

    INITIAL          the first frame: nothing to compare its counter with
    OK               one count on
    OK_SOME_LOST     two to `gap` counts on: frames between were lost
    REPEATED         the same counter: a frozen sender, or a frame sent twice
    WRONG_SEQUENCE   more counts on than `gap`
    WRONG_CRC        the checksum is not that of the bytes, or the data ID's nibble is another
    NO_NEW_DATA      no frame arrived

The first three are taken, the others deliver nothing. With the next right checksum after a wrong sequence
`gap` has grown, so that a receiver finds back within a counter's round. The numbers are those of
E2E_P01CheckStatusType. Profile 5 has no growing gap: any counter with a right checksum is the one to
compare the next with. The state SYNC, which newer profiles leave to a state machine above them, is not
modeled. Written for numba too.
"""

from __future__ import annotations

from .profiles import P5, modulus

OK, NO_NEW_DATA, WRONG_CRC, INITIAL = 0x00, 0x01, 0x02, 0x04
REPEATED, OK_SOME_LOST, WRONG_SEQUENCE = 0x08, 0x20, 0x40

STATUSES = {
    OK: "ok",
    NO_NEW_DATA: "no_new_data",
    WRONG_CRC: "wrong_crc",
    INITIAL: "initial",
    REPEATED: "repeated",
    OK_SOME_LOST: "ok_some_lost",
    WRONG_SEQUENCE: "wrong_sequence",
}
"""The names of the statuses by their numbers."""


def taken(status: int) -> bool:
    """Return True for a frame of this status, whose values reach the receivers."""
    return status in (OK, OK_SOME_LOST, INITIAL)


def judged(
    profile: int, right: bool, counter: int, last: int, gap: int, max_delta: int
) -> tuple[int, int, int]:
    """Return (status, last, gap) after a frame with `counter`; `right`: its checksum is that of its bytes."""
    gap = grown(profile, gap, max_delta)
    if not right:
        return WRONG_CRC, last, gap
    if modulus(profile) == 0:  # a maker's, without a counter
        return INITIAL if last < 0 else OK, 0, max_delta
    if counter >= modulus(profile):
        return WRONG_SEQUENCE, last, gap  # 15 of a counter that goes to 14
    if last < 0:
        return INITIAL, counter, max_delta
    delta = (counter - last) % modulus(profile)
    if delta == 0:
        return REPEATED, last, gap
    if delta == 1:
        return OK, counter, max_delta
    if delta <= gap:
        return OK_SOME_LOST, counter, max_delta
    return WRONG_SEQUENCE, counter if profile == P5 else last, gap


def nothing_new(profile: int, gap: int, max_delta: int) -> tuple[int, int]:
    """Return (status, gap) after a cycle without a frame."""
    return NO_NEW_DATA, grown(profile, gap, max_delta)


def grown(profile: int, gap: int, max_delta: int) -> int:
    """Return the greatest difference that the next check takes."""
    if profile == P5:
        return max_delta
    return min(gap + 1, max(1, modulus(profile) - 1))
