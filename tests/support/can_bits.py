"""Frames as the bits of the wire, written and read by its own rules: an oracle for the lengths of frames.

`python tests/support/can_bits.py 100000` compares so many random frames: their bits are read back (destuffed,
with form, stuff bits and CRC checked), and counted against evcosim's lengths.
"""

from __future__ import annotations

import dataclasses
import random
import sys

CRC_15, CRC_17, CRC_21 = 0x4599, 0x1685B, 0x102899
LENGTHS = (*range(9), 12, 16, 20, 24, 32, 48, 64)


@dataclasses.dataclass(frozen=True)
class Frame:
    identifier: int
    extended: bool
    data: bytes
    fd: bool = False
    switch: bool = False


def bits_of(value: int, width: int) -> list[int]:
    return [int(c) for c in f"{value:0{width}b}"]


def number(bits: list[int]) -> int:
    return int("".join(map(str, bits)), 2)


def crc(bits: list[int], polynomial: int, width: int, start: int = 0) -> int:
    """Return the remainder, bit after bit, of a register that begins with `start`."""
    register = start
    for bit in bits:
        first = register >> (width - 1) & 1
        register = register << 1 & (1 << width) - 1
        if first != bit:
            register ^= polynomial & (1 << width) - 1
    return register


def stuffed(bits: list[int]) -> list[int]:
    """Return the bits with one of the other value after each five equal ones, stuff bits among them."""
    out: list[int] = []
    for bit in bits:
        if len(out) >= 5 and len(set(out[-5:])) == 1:
            out.append(1 - out[-1])
        out.append(bit)
    return out


def head(frame: Frame) -> list[int]:
    """Return the bits before the data field."""
    if frame.extended:
        ident = [0, *bits_of(frame.identifier >> 18, 11), 1, 1, *bits_of(frame.identifier & 0x3FFFF, 18), 0]
    else:
        ident = [0, *bits_of(frame.identifier, 11), 0, 0]
    if not frame.fd:
        return [*ident, *([0, 0] if frame.extended else [0]), *bits_of(len(frame.data), 4)]
    return [*ident, 1, 0, int(frame.switch), 0, *bits_of(LENGTHS.index(len(frame.data)), 4)]


def wire(frame: Frame) -> list[int]:
    """Return all bits from SOF to EOF."""
    content = [*head(frame), *(b for byte in frame.data for b in bits_of(byte, 8))]
    end = [1, 0, 1, *[1] * 7]  # CRC delimiter, acknowledged, delimiter, EOF
    if not frame.fd:
        sent = stuffed([*content, *bits_of(crc(content, CRC_15, 15), 15)])
        if len(set(sent[-5:])) == 1:
            sent.append(1 - sent[-1])
        return [*sent, *end]
    sent = stuffed(content)
    count = (len(sent) - len(content)) % 8
    gray = count ^ count >> 1
    field = [*bits_of(gray, 3), gray.bit_count() % 2]
    width, polynomial = (17, CRC_17) if len(frame.data) <= 16 else (21, CRC_21)
    field += bits_of(crc([*sent, *field], polynomial, width, 1 << (width - 1)), width)
    fixed: list[int] = []
    for i, bit in enumerate(field):
        if i % 4 == 0:
            fixed.append(1 - (fixed or sent)[-1])
        fixed.append(bit)
    return [*sent, *fixed, *end]


class FormError(Exception):
    """The bits are no frame."""


def read(bits: list[int]) -> Frame:
    """Return the frame that the bits from SOF to EOF are. Raises FormError."""
    reader = _Reader(bits)
    try:
        frame = reader.frame()
    except IndexError as error:
        raise FormError("ends early") from error
    if reader.at != len(bits):
        raise FormError("bits behind the end of frame")
    return frame


class _Reader:
    def __init__(self, bits: list[int]) -> None:
        self.bits, self.at, self.content, self.row = bits, 0, [], 0
        self.stuff = 0

    def take(self, count: int) -> list[int]:
        """Return the next bits without the stuff bits among them."""
        found = []
        for _ in range(count):
            self.destuff()
            bit = self.bits[self.at]
            self.step(bit)
            found.append(bit)
        self.content += found
        return found

    def step(self, bit: int) -> None:
        same = self.at > 0 and self.bits[self.at - 1] == bit
        self.row = self.row + 1 if same else 1
        self.at += 1

    def destuff(self) -> None:
        if self.row == 5:
            if self.bits[self.at] == self.bits[self.at - 1]:
                raise FormError("six equal bits")
            self.stuff += 1
            self.step(self.bits[self.at])

    def frame(self) -> Frame:
        if self.take(1) != [0]:
            raise FormError("no start of frame")
        identifier = number(self.take(11))
        self.take(1)  # RTR, RRS or SRR
        extended = self.take(1) == [1]
        if extended:
            identifier = identifier << 18 | number(self.take(18))
            self.take(1)  # RTR or RRS
        fd = self.take(1) == [1]
        switch = False
        if fd:
            self.take(1)
            switch = self.take(1) == [1]
            self.take(1)  # ESI
        elif extended:
            self.take(1)
        code = number(self.take(4))
        length = LENGTHS[code] if fd else min(code, 8)
        data = bytes(number(self.take(8)) for _ in range(length))
        self.fd_check(length) if fd else self.classic_check()
        if self.bits[self.at : self.at + 10] != [1, 0, 1, *[1] * 7]:
            raise FormError("delimiters or end of frame")
        self.at += 10
        return Frame(identifier, extended, data, fd, switch)

    def classic_check(self) -> None:
        expected = crc(self.content, CRC_15, 15)
        if number(self.take(15)) != expected:
            raise FormError("CRC")
        self.destuff()

    def fd_check(self, length: int) -> None:
        sent = self.bits[: self.at]
        width, polynomial = (17, CRC_17) if length <= 16 else (21, CRC_21)
        field = []
        for i in range(4 + width):
            if i % 4 == 0:
                if self.bits[self.at] == self.bits[self.at - 1]:
                    raise FormError("fixed stuff bit")
                self.at += 1
            field.append(self.bits[self.at])
            self.at += 1
        gray = number(field[:3])
        count = gray ^ gray >> 1 ^ gray >> 2
        if count != self.stuff % 8 or field[3] != gray.bit_count() % 2:
            raise FormError("stuff count")
        if number(field[4:]) != crc([*sent, *field[:4]], polynomial, width, 1 << (width - 1)):
            raise FormError("CRC")


def random_frame(draw: random.Random) -> Frame:
    """Return a frame of any kind; many have runs of equal bits."""
    extended, fd = draw.random() < 0.5, draw.random() < 0.5
    length = draw.choice(LENGTHS if fd else LENGTHS[:9])
    fill = draw.choice([lambda: 0, lambda: 255, lambda: draw.choice([0x3C, 0xF0, 0x0F, 0x83, 0x1F]), None])
    data = bytes(fill() if fill else draw.randrange(256) for _ in range(length))
    width = 29 if extended else 11
    identifier = draw.choice([draw.getrandbits(width), 0, (1 << width) - 1, draw.getrandbits(width) & 0x78])
    return Frame(identifier, extended, data, fd, fd and draw.random() < 0.5)


def main() -> None:
    """Compare as many random frames as the command line says."""
    from evcosim.cosim.can.timing.lengths import classic_bits, fd_bits

    draw = random.Random(1)
    for _ in range(int(sys.argv[1])):
        frame = random_frame(draw)
        bits = wire(frame)
        assert read(bits) == frame, frame
        arguments = (frame.identifier, int(frame.extended), frame.data, 0, len(frame.data))
        if frame.fd:
            assert sum(fd_bits(*arguments, int(frame.switch))) == len(bits), frame
        else:
            assert classic_bits(*arguments) == len(bits), frame
    print(f"{sys.argv[1]} frames: each was read back, and has as many bits as evcosim counts")


if __name__ == "__main__":
    main()
