"""The checksums of AUTOSAR's end-to-end protection, profiles 1, 2 and 5 (E2E Protocol Specification, R22-11).

    profile   checksum                      counter          data ID
    1A        CRC-8, 0x1D, from 0, no XOR   4 bits, 0..14    both bytes, low first, before the data
    1B        as 1A                         as 1A            low byte if the counter is even, else high byte
    1C        as 1A                         as 1A            low byte, then 0; a nibble of the other is sent
    2         CRC-8, 0x2F, from and XOR     4 bits, 0..15    one byte of 16, by the counter, behind the data
              0xFF
    5         CRC-16, 0x1021, from 0xFFFF,  8 bits, 0..255   both bytes, low first, behind the data
              no XOR

0x1D is the polynomial of SAE J1850, 0x1021 that of CCITT. The checksum covers the whole payload but its own
bytes. Written for numba too: integers, and a `payload` of
bytes, of which the frame's are those from place `at` on; `ids` are 16 numbers from place `first` on, of
which only profile 2 uses more than one.
"""

from __future__ import annotations

from collections.abc import Sequence

P1A, P1B, P1C, P2, P5 = 1, 2, 3, 4, 5
MAKER = 1000
"""The code of a maker's own checksum, to which the number of values of its counter is added; 0: none."""

CODES = {"1A": P1A, "1B": P1B, "1C": P1C, "2": P2, "5": P5}
"""The profiles by the names that files give them."""


def modulus(profile: int) -> int:
    """Return the number of values of the profile's counter, which begins with 0; 0 if it has none."""
    if profile >= MAKER:
        return profile - MAKER
    if profile == P5:
        return 256
    return 16 if profile == P2 else 15


def crc_8_table(polynomial: int) -> tuple[int, ...]:
    """Return what a register of 8 bits is after each byte, the most significant bit first."""
    return tuple(_shifted(byte, 8, polynomial) for byte in range(256))


def crc_16_table(polynomial: int) -> tuple[int, ...]:
    """Return what a register of 16 bits is after each byte, the most significant bit first."""
    return tuple(_shifted(byte << 8, 16, polynomial) for byte in range(256))


def _shifted(register: int, bits: int, polynomial: int) -> int:
    for _ in range(8):
        register = register << 1 ^ (polynomial if register >> (bits - 1) & 1 else 0)
        register &= (1 << bits) - 1
    return register


J1850, H2F, CCITT = crc_8_table(0x1D), crc_8_table(0x2F), crc_16_table(0x1021)
"""The tables of the three registers: that after one more byte is `J1850[register ^ byte]`, so `H2F`, and for
16 bits `register << 8 & 0xFF00 ^ CCITT[register >> 8 ^ byte]`."""


def checksum(
    profile: int,
    payload: Sequence[int],
    at: int,
    length: int,
    place: int,
    counter: int,
    ids: Sequence[int],
    first: int,
) -> int:
    """Return the checksum of a payload of `length` bytes, whose own bytes begin with byte `place`.

    `counter` is that of the payload; it chooses among the data IDs, or their bytes.
    """
    if profile == P5:
        return _profile_5(payload, at, length, place, ids[first])
    if profile == P2:
        crc = 0xFF
        for i in range(length):
            if i != place:
                crc = H2F[crc ^ payload[at + i]]
        return H2F[crc ^ ids[first + counter]] ^ 0xFF
    low, high = ids[first] & 0xFF, ids[first] >> 8 & 0xFF
    if profile == P1B:
        crc = J1850[high if counter & 1 else low]
    else:
        crc = J1850[J1850[low] ^ (high if profile == P1A else 0)]
    for i in range(length):
        if i != place:
            crc = J1850[crc ^ payload[at + i]]
    return crc


def _profile_5(payload: Sequence[int], at: int, length: int, place: int, data_id: int) -> int:
    crc = 0xFFFF
    for i in range(length):
        if i != place and i != place + 1:
            crc = crc << 8 & 0xFF00 ^ CCITT[crc >> 8 ^ payload[at + i]]
    crc = crc << 8 & 0xFF00 ^ CCITT[crc >> 8 ^ data_id & 0xFF]
    return crc << 8 & 0xFF00 ^ CCITT[crc >> 8 ^ data_id >> 8 & 0xFF]
