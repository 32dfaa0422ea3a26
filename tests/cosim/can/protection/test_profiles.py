"""Checksums of AUTOSAR's profiles: equal to those of autosar-e2e, and each flipped bit is seen."""

from __future__ import annotations

import random

import numpy as np
import pytest
from e2e import crc, p01, p02, p05

from evcosim.cosim.can.protection import profiles
from evcosim.cosim.can.protection.profiles import (
    CCITT,
    CODES,
    H2F,
    J1850,
    P1A,
    P1B,
    P1C,
    P2,
    P5,
    checksum,
    modulus,
)
from support.compiled import in_machine_code

MODES = {P1A: p01.E2E_P01_DATAID_BOTH, P1B: p01.E2E_P01_DATAID_ALT, P1C: p01.E2E_P01_DATAID_NIBBLE}
IDS = [(37 * i + 5) % 251 for i in range(16)]


def protected(profile: int, length: int, counter: int, draw: random.Random) -> tuple[bytes, list[int]]:
    """Return a payload with the library's checksum, and its data IDs."""
    data = bytearray(draw.randbytes(length))
    if profile == P5:
        data[2] = counter
        data_id = draw.getrandbits(16)
        p05.e2e_p05_protect(data, data_id, increment_counter=False)
        return bytes(data), [data_id] * 16
    data[1] = data[1] & 0xF0 | counter
    if profile == P2:
        p02.e2e_p02_protect(data, bytes(IDS), increment_counter=False)
        return bytes(data), IDS
    data_id = draw.getrandbits(12 if profile == P1C else 16)
    if profile == P1C:
        data[1] = (data_id >> 8) << 4 | counter
    p01.e2e_p01_protect(data, data_id, data_id_mode=MODES[profile], increment_counter=False)
    return bytes(data), [data_id] * 16


def sent(profile: int, data: bytes) -> int:
    return data[0] | data[1] << 8 if profile == P5 else data[0]


@pytest.mark.parametrize("profile", CODES.values(), ids=CODES)
def test_the_checksum_is_that_of_the_library(profile: int) -> None:
    draw = random.Random(profile)
    machine = in_machine_code(profiles)["checksum"]
    for _ in range(150):
        length = draw.randrange(3, 9) if profile != P5 else draw.choice([4, 8, 16, 64])
        counter = draw.randrange(modulus(profile))
        data, ids = protected(profile, length, counter, draw)
        assert checksum(profile, b"??" + data, 2, length, 0, counter, [0, *ids], 1) == sent(profile, data)
        arrays = np.frombuffer(data, dtype=np.uint8).astype(np.int64), np.array(ids, dtype=np.int64)
        assert machine(profile, arrays[0], 0, length, 0, counter, arrays[1], 0) == sent(profile, data)


@pytest.mark.parametrize("profile", [P1A, P1B])
def test_a_checksum_may_stand_behind_other_bytes(profile: int) -> None:
    draw = random.Random(3)
    for offset in range(1, 6):
        data = bytearray(draw.randbytes(8))
        data[offset + 1] = 4
        p01.e2e_p01_protect(data, 0x1234, data_id_mode=MODES[profile], offset=offset, increment_counter=False)
        assert checksum(profile, bytes(data), 0, 8, offset, 4, [0x1234], 0) == data[offset]


@pytest.mark.parametrize("profile", CODES.values(), ids=CODES)
def test_each_flipped_bit_of_a_payload_changes_the_checksum_or_is_the_checksums(profile: int) -> None:
    draw = random.Random(9)
    for _ in range(10):
        counter = draw.randrange(modulus(profile))
        data, ids = protected(profile, 8, counter, draw)
        for bit in range(64):
            changed = bytearray(data)
            changed[bit // 8] ^= 1 << bit % 8
            count = changed[2] if profile == P5 else changed[1] & 15
            if count >= modulus(profile):
                continue  # no counter: refused before its checksum
            assert checksum(profile, changed, 0, 8, 0, count, ids, 0) != sent(profile, changed)


def test_registers_have_the_published_check_values() -> None:
    """Of "123456789", as the catalogue of parametrised CRC algorithms lists them."""
    register = 0xFF
    for byte in b"123456789":
        register = J1850[register ^ byte]
    assert register ^ 0xFF == 0x4B == crc.calculate_crc8(b"123456789")
    register = 0xFF
    for byte in b"123456789":
        register = H2F[register ^ byte]
    assert register ^ 0xFF == 0xDF == crc.calculate_crc8_h2f(b"123456789")
    register = 0xFFFF
    for byte in b"123456789":
        register = register << 8 & 0xFF00 ^ CCITT[register >> 8 ^ byte]
    assert register == 0x29B1


def test_sizes_of_counters() -> None:
    assert [modulus(p) for p in CODES.values()] == [15, 15, 15, 16, 256]
