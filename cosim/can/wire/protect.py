"""Protection of a frame: counter and checksum filled when it is sent, judged when it is received.

`watch` is called once a cycle, where a frame should have come: what did not come has a status too, and after
some cycles without a frame that was taken its receivers get what stands in for it.
"""

from __future__ import annotations

from ..protection.counters import judged, nothing_new, taken
from ..protection.profiles import MAKER, P1C, P5, checksum, modulus
from . import tables as T
from .off import is_deaf
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
    """Judge the frame at hand, of message i; return 1 if its values reach the receivers, else 0.

    -1: the maker's function raised an error.
    """
    m = w.messages
    profile, head = m[i, T.PROFILE], i - m[i, T.PAGE]
    m[head, T.FRESH] = 1
    if profile:
        counter = 0
        if modulus(profile):
            counter = low_bits(w.frame, m[i, T.COUNTER_LITTLE], m[i, T.COUNTER_START], m[i, T.COUNTER_BITS])
        right = is_right(w, i, counter, k)
        if right < 0:
            return -1
        status, m[head, T.LAST], m[head, T.GAP] = judged(
            profile, right > 0, counter, m[head, T.LAST], m[head, T.GAP], m[i, T.MAX_DELTA]
        )
        show(w, i, status)
        if not taken(status):
            m[i, T.REJECTED] += 1
            return 0
    elif m[i, T.STATUSES]:
        show(w, i, 0)
    m[head, T.TAKEN], m[head, T.TIMED_OUT] = 1, 0
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
    """Look, once a cycle, whether frames of message i came and were taken."""
    m, h = w.messages, i - w.messages[i, T.PAGE]
    if m[h, T.PROFILE] and not m[h, T.FRESH]:
        status, m[h, T.GAP] = nothing_new(m[h, T.PROFILE], m[h, T.GAP], m[h, T.MAX_DELTA])
        show(w, i, status)
    m[h, T.MISSED] = 0 if m[h, T.TAKEN] else m[h, T.MISSED] + 1
    m[h, T.FRESH], m[h, T.TAKEN] = 0, 0
    if m[h, T.TIMEOUT] and m[h, T.MISSED] >= m[h, T.TIMEOUT] and not m[h, T.TIMED_OUT]:
        m[h, T.TIMED_OUT] = 1
        m[h, T.TIMEOUTS] += 1
        if m[h, T.PROFILE] == 0 and m[h, T.STATUSES]:
            show(w, i, 1)
        for page in range(h, h + m[h, T.PAGES]):
            fall_back(w, page)


def show(w: Wire, i: int, status: int) -> None:
    """Count a status of message i, and write it to the inputs that get it: no new data to one off the bus."""
    w.verdicts[i, status] += 1
    first = w.messages[i, T.FIRST_STATUS]
    for s in range(first, first + w.messages[i, T.STATUSES]):
        w.memory[w.statuses[2 * s]] = 1.0 if is_deaf(w, w.statuses[2 * s + 1]) else float(status)


def fall_back(w: Wire, i: int) -> None:
    """Give the receivers of message i what stands in for its values; NaN: they keep the last ones."""
    first = w.messages[i, T.FIRST_SIGNAL]
    for j in range(first, first + w.messages[i, T.SIGNALS]):
        start = w.signals[j, T.FIRST_SINK]
        for s in range(start, start + w.signals[j, T.SINKS]):
            if w.fallback[s] == w.fallback[s]:
                w.memory[w.sinks[s, T.SLOT]] = w.fallback[s]
