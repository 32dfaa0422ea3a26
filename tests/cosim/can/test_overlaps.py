"""The first overlaps of signals, beside a look at every pair."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from hypothesis import given, settings
from hypothesis import strategies as st

from evcosim.cosim.can.database import Signal
from evcosim.cosim.can.overlaps import Ranges, conditions, first_overlaps

BITS = 24


def together(signals: Mapping[str, Signal], one: str, other: str) -> bool:
    """Return True where no multiplexer that selects both does so by values of which none is the same."""
    of_one = dict(conditions(signals, one))
    return all(
        name not in of_one or any(a <= d and c <= b for a, b in of_one[name] for c, d in ranges)
        for name, ranges in conditions(signals, other)
    )


def pairs(signals: Mapping[str, Signal]) -> Iterator[tuple[str, str]]:
    """Yield each two signals that overlap, in the order that `first_overlaps` names."""
    names = [name for name, signal in signals.items() if not signal.problem]
    for i, name in enumerate(names):
        met = {
            other: None
            for bit in signals[name].bits
            for other in names[:i]
            if bit in signals[other].bits and together(signals, name, other)
        }
        yield from ((other, name) for other in met)


def first_of_pairs(signals: Mapping[str, Signal]) -> dict[str, tuple[str, str]]:
    found: dict[str, tuple[str, str]] = {}
    for pair in pairs(signals):
        for name in pair:
            found.setdefault(name, pair)
    return found


@st.composite
def ranges(draw: st.DrawFn) -> Ranges:
    ends = draw(st.lists(st.tuples(st.integers(0, 12), st.integers(0, 3)), min_size=1, max_size=3))
    return tuple((low, low + more) for low, more in ends)


@st.composite
def signals(draw: st.DrawFn) -> dict[str, Signal]:
    """Return signals of both byte orders, selected by some of those before and behind them, or by none."""
    found: dict[str, Signal] = {}
    count = draw(st.integers(1, 14))
    order = draw(st.permutations(range(count)))
    for number in order:
        length = draw(st.integers(1, 6))
        little = draw(st.booleans())
        first = draw(st.integers(0, BITS - length))
        start = first if little else 8 * (first // 8) + 7 - first % 8
        above = draw(st.one_of(st.none(), st.integers(0, number - 1) if number else st.none()))
        selected = {"multiplexer": f"s{above}", "multiplexer_ranges": draw(ranges())}
        problem = draw(st.sampled_from(["", "", "", "bad"])) if above is None else ""
        found[f"s{number}"] = Signal(
            f"s{number}", start, length, little, problem=problem, **(selected if above is not None else {})
        )
    return found


@settings(max_examples=300)
@given(signals())
def test_the_first_overlaps_are_those_of_all_pairs(found: dict[str, Signal]) -> None:
    assert first_overlaps(found) == first_of_pairs(found)


def test_pages_share_bits_and_a_signal_of_two_pages_overlaps_both() -> None:
    page = {"multiplexer": "m", "multiplexer_ranges": ((1, 1),)}
    found = {
        "m": Signal("m", 0, 8),
        "a": Signal("a", 8, 8, multiplexer="m", multiplexer_ranges=((0, 0),)),
        "b": Signal("b", 8, 8, **page),
    }
    assert first_overlaps(found) == {}
    found["both"] = Signal("both", 12, 8, multiplexer="m", multiplexer_ranges=((0, 1),))
    assert first_overlaps(found) == {"a": ("a", "both"), "b": ("b", "both"), "both": ("a", "both")}


def test_many_signals_of_one_message_are_not_compared_in_pairs(monkeypatch) -> None:
    """With 4000 signals there are eight million pairs: so many bits are never looked at."""
    looked_at = 0
    bits = Signal.bits.fget

    def counted(signal: Signal) -> tuple[int, ...]:
        nonlocal looked_at
        looked_at += 1
        return bits(signal)

    found = {"m": Signal("m", 0, 16)}
    for k in range(4000):
        ranges = ((k // 2, k // 2),)
        found[f"s{k}"] = Signal(f"s{k}", 16, 8, multiplexer="m", multiplexer_ranges=ranges)
    monkeypatch.setattr(Signal, "bits", property(counted))
    assert len(first_overlaps(found)) == 4000
    assert looked_at <= 2 * len(found)
