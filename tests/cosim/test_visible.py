"""Texts for people's eyes: what steers a terminal or hides something is an escape, all else stays."""

from __future__ import annotations

import io
import json
import sys
import tomllib
import unicodedata
from collections.abc import Iterator

import pytest

from evcosim.cosim.visible import (
    flowing,
    on_one_line,
    raw_stream,
    visible,
    visible_json,
    visible_stream,
    visible_toml,
)

SIGNS = set(map(chr, (*range(0x600, 0x606), 0x6DD, 0x890, 0x891, 0x8E2, 0x110BD, 0x110CD)))
"""Format characters that are seen: they stand around or above digits."""


def every() -> Iterator[str]:
    """All characters of Unicode."""
    return map(chr, range(sys.maxunicode + 1))


def steers(character: str) -> bool:
    """Whether Unicode calls it a control, a format character, an end of a line or half a character."""
    kind = unicodedata.category(character)
    hieroglyphs = "\U00013430" <= character <= "\U0001345f"  # they join what is seen
    return kind in ("Cc", "Cf", "Cs", "Zl", "Zp") and character not in SIGNS and not hieroglyphs


def test_all_that_steers_or_hides_is_escaped_and_nothing_that_is_seen() -> None:
    escaped = {c for c in every() if visible(c) != c}
    assert {c for c in every() if steers(c)} - escaped == {"\n"}
    letters = {c for c in escaped if unicodedata.category(c)[0] in "LNPSZ" and not steers(c)}
    blank = {"\u115f", "\u1160", "\u3164", "\uffa0"}  # letters without a shape
    assert letters == blank
    assert all(visible(c).isascii() and visible(c).isprintable() for c in escaped)


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("\x1b[2J", "\\x1b[2J"),
        ("a\rb\tc\0", "a\\rb\\tc\\x00"),
        ("\x7f\x9b", "\\x7f\\x9b"),
        ("\u202egpj.exe", "\\u202egpj.exe"),
        ("spe\u200bed", "spe\\u200bed"),
        ("\udcff", "\\udcff"),
        ("\U000e0041", "\\U000e0041"),
        ("Größe µ 速度 скорость \N{RACING CAR} a\N{NO-BREAK SPACE}b $\\x1b", None),
    ],
)
def test_escapes_are_as_python_has_them(text: str, shown: str | None) -> None:
    assert visible(text) == (text if shown is None else shown)
    assert visible(visible(text)) == visible(text)


def test_a_line_feed_stays_in_a_text_and_not_in_a_name() -> None:
    assert visible("a\nb") == "a\nb"
    assert on_one_line("a\nb\x07") == "a\\nb\\x07"
    assert flowing("a\r\n\tb\x07") == "a b\\x07"


def test_files_for_machines_have_their_own_escapes() -> None:
    whole = "".join(c for c in every() if steers(c) and unicodedata.category(c) != "Cs") + "\u3164é\U000e0041"
    text = whole + "\udcff\udc80"  # bytes of a file's name that are no text
    written = visible_json(json.dumps({text: [text]}, ensure_ascii=False))
    assert visible(written) == written
    assert json.loads(written) == {text: [text]}
    basic = json.dumps(whole, ensure_ascii=False).replace("\x7f", "\\u007f")  # TOML lets no DEL stand
    written = visible_toml(f"a = {basic}\n")
    assert visible(written) == written
    assert tomllib.loads(written) == {"a": whole}


def test_a_stream_for_people() -> None:
    raw = io.StringIO()
    stream = visible_stream(raw)
    print("a\x1b", "b", sep="\u2028", file=stream)
    stream.writelines(["c\r\n", "d\n"])
    stream.flush()
    assert raw.getvalue() == "a\\x1b\\u2028b\nc\\r\nd\n"
    assert not stream.isatty()
    assert visible_stream(stream) is stream
    assert raw_stream(stream) is raw
    assert raw_stream(raw) is raw
