"""Random draws on the bus: a hash of what is drawn for, so that neither engine, order nor chunks change them.

The same (seed, bus, message, instance, purpose) gives the same draw, and another message beside it changes
nothing. Written for numba too: products wrap at 64 bits there, of which the low 32 stay.
"""

from __future__ import annotations

_LOW = 0xFFFFFFFF


def mixed(state: int, value: int) -> int:
    """Return 32 bits that depend on 32 bits of a state and all 64 bits of a value.

    The finalizer of MurmurHash3 over the low and the high half, one after the other.
    """
    for half in (value & _LOW, value >> 32 & _LOW):
        state = (state ^ half) & _LOW
        state ^= state >> 16
        state = state * 0x85EBCA6B & _LOW
        state ^= state >> 13
        state = state * 0xC2B2AE35 & _LOW
        state ^= state >> 16
        state = (state * 5 + 0xE6546B64) & _LOW
    return state


def drawn(seed: int, bus: int, message: int, instance: int, purpose: int) -> float:
    """Return a number in [0, 1), a multiple of 2**-32."""
    state = mixed(mixed(0x9E3779B9, seed), bus << 32 | message)
    return mixed(mixed(state, instance), purpose) / 4294967296.0
