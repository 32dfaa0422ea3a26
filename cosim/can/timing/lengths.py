"""The bits of a frame on the wire (ISO 11898-1:2015), exact for its content and at most.

A frame counts from its start of frame to its last bit of end of frame, stuff bits included; between two
frames there are INTERFRAME more bits. A receiver has the frame at the end of frame.

    classic   SOF, identifier and control (19 bits; extended 39), data, CRC 15, stuffed alike;
              CRC delimiter, ACK and its delimiter, 7 bits of EOF
    FD        SOF, identifier and control up to BRS (17 bits; extended 36), ESI, DLC and data, stuffed alike;
              stuff count and CRC 17 (over 16 bytes: CRC 21) with a fixed stuff bit before the first and after
              each fourth bit; then as above

A stuff bit follows five equal bits, of which an earlier stuff bit may be one. With `switch` (BRS recessive)
the bits of an FD frame from ESI to the CRC delimiter take the data bit rate. In truth both switches are at
the sample point of their bit; where the two rates have the same sample point, as they should, the sum is the
same.

All functions but the last five are written for numba too: integers, and a `payload` of bytes, of which the
frame's are those from place `at` on.
"""

from __future__ import annotations

from collections.abc import Sequence

INTERFRAME = 3
"""Bits of the interframe space, in which no frame may start."""
FD_LENGTHS = (0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64)
"""The numbers of bytes that a CAN FD frame can have, by DLC."""

_DELIMITERS = 10  # bits that are never stuffed: CRC delimiter, ACK slot and delimiter, EOF
_CLASSIC_HEAD, _CLASSIC_EXTENDED_HEAD = 19, 39  # bits before the data
_FD_HEAD, _FD_EXTENDED_HEAD = 17, 36  # bits up to BRS
_FD_CONTROL = 5  # bits of ESI and DLC
_CRC_17_FIELD, _CRC_21_FIELD = 27, 32  # bits of stuff count and CRC with fixed stuff bits


def stuffed(value: int, width: int, last: int, run: int, crc: int) -> tuple[int, int, int, int]:
    """Return (stuff bits, last bit, length of its run, CRC 15) after the `width` low bits of `value`.

    The last three are carried on from one field of a frame to the next; a frame begins with -1, 0, 0. After a
    run of five the stuff bit is due, and counts with the next field.
    """
    stuff = 0
    for place in range(width - 1, -1, -1):
        if run == 5:
            stuff += 1
            last, run = 1 - last, 1
        bit = value >> place & 1
        if bit == last:
            run += 1
        else:
            last, run = bit, 1
        top = crc >> 14 ^ bit
        crc = crc << 1 & 0x7FFF
        if top:
            crc ^= 0x4599
    return stuff, last, run, crc


def classic_bits(identifier: int, extended: int, payload: Sequence[int], at: int, length: int) -> int:
    """Return the bits of a classic data frame of `length` bytes."""
    if extended:
        # SOF, 11 bits, SRR and IDE recessive, 18 bits, RTR and two reserved bits dominant, DLC
        head = (identifier >> 18 << 2 | 3) << 18 | identifier & 0x3FFFF
        width = _CLASSIC_EXTENDED_HEAD
    else:
        # SOF, 11 bits, RTR, IDE and a reserved bit dominant, DLC
        head, width = identifier, _CLASSIC_HEAD
    count, last, run, crc = stuffed(head << 7 | length, width, -1, 0, 0)
    for i in range(at, at + length):
        more, last, run, crc = stuffed(payload[i], 8, last, run, crc)
        count += more
    more, last, run, crc = stuffed(crc, 15, last, run, crc)
    count += more + (run == 5)
    return width + 8 * length + 15 + count + _DELIMITERS


def fd_bits(
    identifier: int, extended: int, payload: Sequence[int], at: int, length: int, switch: int
) -> tuple[int, int]:
    """Return the bits of a CAN FD frame at the nominal and at the data bit rate; `length` is one of FD's."""
    if extended:
        # SOF, 11 bits, SRR and IDE recessive, 18 bits, RRS dominant, FDF recessive, a reserved bit, BRS
        head = (identifier >> 18 << 2 | 3) << 18 | identifier & 0x3FFFF
        width = _FD_EXTENDED_HEAD
    else:
        # SOF, 11 bits, RRS and IDE dominant, FDF recessive, a reserved bit, BRS
        head, width = identifier << 1, _FD_HEAD
    nominal, last, run, crc = stuffed(head << 4 | 4 | switch, width, -1, 0, 0)
    # ESI dominant: error active
    fast, last, run, crc = stuffed(fd_code(length), _FD_CONTROL, last, run, crc)
    for i in range(at, at + length):
        more, last, run, crc = stuffed(payload[i], 8, last, run, crc)
        fast += more
    # a stuff bit that is due now is not sent: the fixed one before the stuff count takes its place
    nominal += width
    fast += _FD_CONTROL + 8 * length + (_CRC_17_FIELD if length <= 16 else _CRC_21_FIELD)
    if switch:
        return nominal + _DELIMITERS - 1, fast + 1  # the CRC delimiter still takes the data bit rate
    return nominal + fast + _DELIMITERS, 0


def fd_code(length: int) -> int:
    """Return the DLC of a CAN FD frame with `length` bytes, one of FD_LENGTHS."""
    if length <= 8:
        return length
    if length <= 24:
        return 6 + length // 4
    return 11 + length // 16


def fd_length(length: int) -> int:
    """Return the bytes of the shortest CAN FD frame that holds `length` bytes; over 64 as they are."""
    return next((n for n in FD_LENGTHS if n >= length), length)


def least_bits(extended: bool, length: int, fd: bool = False, switch: bool = False) -> tuple[int, int]:
    """Return the bits at the nominal and at the data bit rate of a frame in which nothing is stuffed."""
    if not fd:
        head = _CLASSIC_EXTENDED_HEAD if extended else _CLASSIC_HEAD
        return head + 8 * length + 15 + _DELIMITERS, 0
    nominal = _FD_EXTENDED_HEAD if extended else _FD_HEAD
    fast = _FD_CONTROL + 8 * length + (_CRC_17_FIELD if length <= 16 else _CRC_21_FIELD)
    if switch:
        return nominal + _DELIMITERS - 1, fast + 1
    return nominal + fast + _DELIMITERS, 0


def most_bits(extended: bool, length: int, fd: bool = False, switch: bool = False) -> tuple[int, int]:
    """Return the bits at the nominal and at the data bit rate that no frame of its kind exceeds.

    Classic: Davis, Burns, Bril, Lukkien 2007. FD: the same count of stuff bits, of which those that the head
    can hold take the nominal bit rate.
    """
    nominal, fast = least_bits(extended, length, fd, switch)
    if not fd:
        head = _CLASSIC_EXTENDED_HEAD if extended else _CLASSIC_HEAD
        return nominal + (head + 15 + 8 * length - 1) // 4, 0
    head = _FD_EXTENDED_HEAD if extended else _FD_HEAD
    stuff = (head + _FD_CONTROL + 8 * length - 1) // 4
    if not switch:
        return nominal + stuff, 0
    in_head = (head - 1) // 4
    return nominal + in_head, fast + stuff - in_head


def bit_time(rate: int) -> int:
    """Return the time of a bit [ps] at a rate [bit/s]."""
    return round(10**12 / rate)


def frame_times(
    extended: bool, length: int, fd: bool, bitrate: int, data_bitrate: int | None
) -> tuple[int, int]:
    """Return the least and the longest time [ps] of a frame of `length` bytes with the interframe space.

    Rates are in bit/s; with a `data_bitrate` frames of CAN FD switch to it.
    """
    switch = fd and data_bitrate is not None
    bit, data_bit = bit_time(bitrate), bit_time(data_bitrate or bitrate)
    least, most = (
        (nominal + INTERFRAME) * bit + fast * data_bit
        for nominal, fast in (
            least_bits(extended, length, fd, switch),
            most_bits(extended, length, fd, switch),
        )
    )
    return least, most
