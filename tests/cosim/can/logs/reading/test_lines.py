"""Lines of a text in bulk, and the numbers in them."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.cosim.can.logs.reading import lines
from evcosim.cosim.can.logs.reading.lines import decimals, hexadecimals, lines_in_bulk, payloads, words
from evcosim.cosim.errors import ConfigError

WORDS = st.text("0123456789abcdefABCDEF xg", max_size=14)


def of(found: list[str]) -> lines.Lines:
    data = "".join(f"{text}\n" for text in found).encode()
    (made,) = lines_in_bulk(io.BytesIO(data), Path("x"))
    return made


@given(st.lists(st.text("ab \r\t", max_size=5), max_size=20), st.integers(1, 7), st.booleans())
def test_lines_are_those_of_the_file_however_it_is_read(texts: list[str], room: int, ended: bool) -> None:
    data = "\n".join(texts).encode() + b"\n" * ended
    expected = [line.decode().strip() for line in data.split(b"\n")]
    expected = expected[:-1] if not data or data.endswith(b"\n") else expected
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(lines, "_ROOM", room)
        found = list(lines_in_bulk(io.BytesIO(data), Path("x")))
    assert [part.line(i) for part in found for i in range(len(part))] == expected
    assert [part.first for part in found] == list(np.cumsum([1, *map(len, found)])[: len(found)])


@pytest.mark.parametrize("room", [1 << 10, 1 << 21])
@pytest.mark.parametrize("end", [b"", b"\nmore\n"])
def test_a_line_without_an_end_is_not_held_whole(
    room: int, end: bytes, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(lines, "_ROOM", room)
    with pytest.raises(ConfigError, match="x: line 2 has 65536 bytes or more"):
        list(lines_in_bulk(io.BytesIO(b"one\n" + b"1" * 70_000 + end), Path("x")))


@given(st.lists(WORDS, min_size=1, max_size=30), st.integers(1, 12))
def test_numbers_are_those_of_python_or_none(texts: list[str], most: int) -> None:
    made = of(texts)
    ways = ((decimals, 10, "0123456789"), (hexadecimals, 16, "0123456789abcdefABCDEF"))
    for function, base, digits in ways:
        values, good = function(made.text, made.starts, made.ends, most)
        for text, value, fine in zip(texts, values.tolist(), good.tolist(), strict=True):
            assert fine == (0 < len(text) <= most and set(text) <= set(digits))
            assert not fine or value == int(text, base)


@given(st.lists(st.tuples(WORDS, st.integers(0, 7)), min_size=1, max_size=30))
def test_payloads_are_bytes_of_two_digits(found: list[tuple[str, int]]) -> None:
    made = of([text.ljust(14, "x") for text, _ in found])
    counts, into = np.array([count for _, count in found]), np.zeros((len(found), 64), dtype=np.uint8)
    good = payloads(made.text, made.starts, counts, 2, into)
    for (text, count), fine, row in zip(found, good.tolist(), into, strict=True):
        digits = text.ljust(14, "x")[: 2 * count]
        assert fine == (set(digits) <= set("0123456789abcdefABCDEF"))
        assert not fine or row.tobytes() == bytes.fromhex(digits).ljust(64, b"\0")


def test_words_have_some_letters_and_no_white_space() -> None:
    made = of(["can0", "", "a b", "x" * 16, "x" * 17])
    found, good = words(made.text, made.starts, made.ends)
    assert good.tolist() == [True, False, False, True, False]
    assert found[good].tolist() == [b"can0", b"x" * 16]
