"""The arbitration: who of those that start at once goes on."""

from __future__ import annotations


def arbitration_key(identifier: int, extended: bool) -> int:
    """Return a number by which frames win the arbitration: the least of those that start at once.

    The bits of the arbitration field, dominant being 0: 11 of the identifier, then RTR and IDE, dominant in a
    standard frame, where an extended one has SRR and IDE, recessive, and 18 more bits. So a standard frame
    wins against an extended one of the same first 11 bits.
    """
    if extended:
        return (identifier >> 18 << 2 | 3) << 18 | identifier & 0x3FFFF
    return identifier << 20
