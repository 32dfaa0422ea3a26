"""Protection of a frame: counter and checksum filled when it is sent, judged when it is received.

`watch` is called once a cycle, where a frame should have come: what did not come has a status too, and after
some cycles without a frame that was taken its receivers get what stands in for it.
"""

from __future__ import annotations

from ..protection.counters import judged, nothing_new, taken
from ..protection.profiles import P1C, P5, checksum, modulus
from . import tables as T
from .off import is_deaf
from .payload import low_bits, put
from .tables import Wire

_IDS = 16  # data IDs of a message


def protect(w: Wire, i: int) -> None:
    """Fill counter and checksum of the frame at hand, of message i, if it is protected."""
    m = w.messages
    profile, counter = m[i, T.PROFILE], m[i, T.COUNTER]
    if profile == 0:
        return
    put(w.frame, m[i, T.COUNTER_LITTLE], m[i, T.COUNTER_START], m[i, T.COUNTER_BITS], counter, 0)
    if profile == P1C:
        put(w.frame, m[i, T.NIBBLE_LITTLE], m[i, T.NIBBLE_START], 4, w.ids[_IDS * i] >> 8 & 15, 0)
    crc = checksum(profile, w.frame, 0, m[i, T.LENGTH], m[i, T.CRC_AT], counter, w.ids, _IDS * i)
    w.frame[m[i, T.CRC_AT]] = crc & 255
    if profile == P5:
        w.frame[m[i, T.CRC_AT] + 1] = crc >> 8
    m[i, T.COUNTER] = (counter + 1) % modulus(profile)


def accepted(w: Wire, i: int) -> int:
    """Judge the frame at hand, of message i; return 1 if its values reach the receivers, else 0."""
    m = w.messages
    m[i, T.FRESH] = 1
    if m[i, T.PROFILE]:
        counter = low_bits(w.frame, m[i, T.COUNTER_LITTLE], m[i, T.COUNTER_START], m[i, T.COUNTER_BITS])
        status, m[i, T.LAST], m[i, T.GAP] = judged(
            m[i, T.PROFILE], is_right(w, i, counter), counter, m[i, T.LAST], m[i, T.GAP], m[i, T.MAX_DELTA]
        )
        show(w, i, status)
        if not taken(status):
            m[i, T.REJECTED] += 1
            return 0
    elif m[i, T.STATUSES]:
        show(w, i, 0)
    m[i, T.TAKEN], m[i, T.TIMED_OUT] = 1, 0
    return 1


def is_right(w: Wire, i: int, counter: int) -> bool:
    """Return True if the checksum of the frame at hand, of message i with this counter, fits its bytes."""
    m = w.messages
    profile, at = m[i, T.PROFILE], m[i, T.CRC_AT]
    if counter >= modulus(profile):
        return False
    if profile == P1C:
        nibble = low_bits(w.frame, m[i, T.NIBBLE_LITTLE], m[i, T.NIBBLE_START], 4)
        if nibble != w.ids[_IDS * i] >> 8 & 15:
            return False
    crc = checksum(profile, w.frame, 0, m[i, T.LENGTH], at, counter, w.ids, _IDS * i)
    found = w.frame[at] | w.frame[at + 1] << 8 if profile == P5 else w.frame[at]
    return bool(found == crc)


def watch(w: Wire, i: int) -> None:
    """Look, once a cycle, whether frames of message i came and were taken."""
    m = w.messages
    if m[i, T.PROFILE] and not m[i, T.FRESH]:
        status, m[i, T.GAP] = nothing_new(m[i, T.PROFILE], m[i, T.GAP], m[i, T.MAX_DELTA])
        show(w, i, status)
    m[i, T.MISSED] = 0 if m[i, T.TAKEN] else m[i, T.MISSED] + 1
    m[i, T.FRESH], m[i, T.TAKEN] = 0, 0
    if m[i, T.TIMEOUT] and m[i, T.MISSED] >= m[i, T.TIMEOUT] and not m[i, T.TIMED_OUT]:
        m[i, T.TIMED_OUT] = 1
        m[i, T.TIMEOUTS] += 1
        if m[i, T.PROFILE] == 0 and m[i, T.STATUSES]:
            show(w, i, 1)
        fall_back(w, i)


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
