"""Protection of a frame: counter and checksum filled when it is sent, judged when it is received.

`watch` is called once a cycle, where a frame should have come: what did not come has a status too, and after
some cycles without a frame that was taken its receivers get what stands in for it.
"""

from __future__ import annotations

from ..protection.counters import judged, nothing_new, taken
from ..protection.profiles import MAKER, P1C, P5, checksum, modulus
from . import tables as T
from .payload import low_bits, put
from .tables import Wire
from .values import ask

_IDS = 16  # data IDs of a message


def protect(w: Wire, i: int, k: int) -> int:
    """Fill counter and checksum of the frame at hand, of message i, if it is protected.

    Return DONE or RAISED.
    """
    m = w.messages
    profile, head = m[i, T.PROFILE], i - m[i, T.PAGE]
    if profile == 0:
        return T.DONE
    counter, values = m[head, T.COUNTER], modulus(profile)
    if values:
        put(w.frame, m[i, T.COUNTER_LITTLE], m[i, T.COUNTER_START], m[i, T.COUNTER_BITS], counter, 0)
        m[head, T.COUNTER] = (counter + 1) % values
    if profile >= MAKER:
        return fill(w, i, k)
    if profile == P1C:
        put(w.frame, m[i, T.NIBBLE_LITTLE], m[i, T.NIBBLE_START], 4, w.ids[_IDS * i] >> 8 & 15, 0)
    crc = checksum(profile, w.frame, 0, m[i, T.COVERED], m[i, T.CRC_AT], counter, w.ids, _IDS * i)
    w.frame[m[i, T.CRC_AT]] = crc & 255
    if profile == P5:
        w.frame[m[i, T.CRC_AT] + 1] = crc >> 8
    return T.DONE


def fill(w: Wire, i: int, k: int) -> int:
    """Write the maker's checksum of the frame at hand, of message i; return DONE or RAISED."""
    m = w.messages
    if ask(w, T.CHECKSUM, i, k) != T.DONE:
        return T.RAISED
    wipe(w, m[i, T.CHECK_LITTLE], m[i, T.CHECK_START], m[i, T.CHECK_BITS])
    put(w.frame, m[i, T.CHECK_LITTLE], m[i, T.CHECK_START], m[i, T.CHECK_BITS], int(w.double[0]), 0)
    return T.DONE


def wipe(w: Wire, little: int, start: int, bits: int) -> None:
    """Set bits of the frame at hand to 0."""
    for place in range(start, start + bits):
        bit = place & 7 if little else 7 - (place & 7)
        w.frame[place >> 3] &= ~(1 << bit)


def accepted(w: Wire, i: int, k: int) -> int:
    """Let the receivers that hear the frame at hand, of message i, judge it.

    Return the number of them that take it; -1: the maker's function raised an error.
    """
    m = w.messages
    counter, right, takers = 0, 1, 0
    if m[i, T.PROFILE]:
        if modulus(m[i, T.PROFILE]):
            counter = low_bits(w.frame, m[i, T.COUNTER_LITTLE], m[i, T.COUNTER_START], m[i, T.COUNTER_BITS])
        right = is_right(w, i, counter, k)
        if right < 0:
            return -1
    first = m[i, T.FIRST_LISTENER]
    for a in range(first, first + m[i, T.LISTENERS]):
        if m[i, T.OWNED] == 0 or w.listeners[a, T.TAKES]:
            w.listeners[a, T.TAKES] = judge(w, i, a, right, counter)
            takers += w.listeners[a, T.TAKES]
    return takers


def judge(w: Wire, i: int, a: int, right: int, counter: int) -> int:
    """Let receiver a judge the frame at hand, of message i; return 1 if it takes the frame, else 0."""
    m, r = w.messages, w.listeners
    r[a, T.FRESH] = 1
    if m[i, T.PROFILE]:
        status, r[a, T.LAST], r[a, T.GAP] = judged(
            m[i, T.PROFILE], right > 0, counter, r[a, T.LAST], r[a, T.GAP], m[i, T.MAX_DELTA]
        )
        show(w, i, a, status)
        if not taken(status):
            return 0
    elif m[i, T.STATUSES]:
        show(w, i, a, 0)
    r[a, T.TAKEN], r[a, T.TIMED_OUT] = 1, 0
    return 1


def is_right(w: Wire, i: int, counter: int, k: int) -> int:
    """Return 1 if the checksum of the frame at hand, of message i with this counter, fits its bytes, else 0.

    -1: the maker's function raised an error.
    """
    m = w.messages
    profile, at = m[i, T.PROFILE], m[i, T.CRC_AT]
    if profile >= MAKER:
        if ask(w, T.CHECKSUM, i, k) != T.DONE:
            return -1
        sent = low_bits(w.frame, m[i, T.CHECK_LITTLE], m[i, T.CHECK_START], m[i, T.CHECK_BITS])
        return 1 if sent == int(w.double[0]) else 0
    if counter >= modulus(profile):
        return 0
    if profile == P1C:
        nibble = low_bits(w.frame, m[i, T.NIBBLE_LITTLE], m[i, T.NIBBLE_START], 4)
        if nibble != w.ids[_IDS * i] >> 8 & 15:
            return 0
    crc = checksum(profile, w.frame, 0, m[i, T.COVERED], at, counter, w.ids, _IDS * i)
    found = w.frame[at] | w.frame[at + 1] << 8 if profile == P5 else w.frame[at]
    return 1 if found == crc else 0


def watch(w: Wire, i: int) -> None:
    """Look, once a cycle, whether frames of message i came to each of its receivers, and were taken."""
    first = w.messages[i, T.FIRST_LISTENER]
    for a in range(first, first + w.messages[i, T.LISTENERS]):
        look(w, i, a)


def look(w: Wire, i: int, a: int) -> None:
    """Look whether frames of message i came to receiver a since it looked, and were taken."""
    m, r, head = w.messages, w.listeners, i - w.messages[i, T.PAGE]
    if m[i, T.PROFILE] and not r[a, T.FRESH]:
        status, r[a, T.GAP] = nothing_new(m[i, T.PROFILE], r[a, T.GAP], m[i, T.MAX_DELTA])
        show(w, i, a, status)
    r[a, T.MISSED] = 0 if r[a, T.TAKEN] else r[a, T.MISSED] + 1
    r[a, T.FRESH], r[a, T.TAKEN] = 0, 0
    if m[i, T.TIMEOUT] and r[a, T.MISSED] >= m[i, T.TIMEOUT] and not r[a, T.TIMED_OUT]:
        r[a, T.TIMED_OUT] = 1
        r[a, T.TIMEOUTS] += 1
        if m[i, T.PROFILE] == 0 and m[i, T.STATUSES]:
            show(w, i, a, 1)
        for page in range(head, head + m[i, T.PAGES]):
            fall_back(w, page, a)


def show(w: Wire, i: int, a: int, status: int) -> None:
    """Count a status of message i at receiver a, and write it to the inputs of that one that get it."""
    m = w.messages
    w.verdicts[m[i, T.FIRST_VERDICT] + a - m[i, T.FIRST_LISTENER], status] += 1
    for s in range(m[i, T.FIRST_STATUS], m[i, T.FIRST_STATUS] + m[i, T.STATUSES]):
        if w.statuses[2 * s + 1] == a:
            w.memory[w.statuses[2 * s]] = float(status)


def fall_back(w: Wire, i: int, a: int) -> None:
    """Give receiver a of message i what stands in for its values; NaN: it keeps the last ones."""
    first = w.messages[i, T.FIRST_SIGNAL]
    for j in range(first, first + w.messages[i, T.SIGNALS]):
        start = w.signals[j, T.FIRST_SINK]
        for s in range(start, start + w.signals[j, T.SINKS]):
            if w.sinks[s, T.LISTENER] == a and w.fallback[s] == w.fallback[s]:
                w.memory[w.sinks[s, T.SLOT]] = w.fallback[s]
