"""Texts of files and FMUs for people's eyes: what steers a terminal or hides something is shown as an escape.

A name, a description or a log message may hold control characters, which move the cursor and overwrite what
was printed, marks that turn the direction of writing, and characters without width, so that two names look
alike. Printed, `\\x1b`, `\\u202e` or `\\u200b` stands in their place. Files for machines keep the character,
in the escape that JSON or TOML has for it.
"""

from __future__ import annotations

import contextlib
import re
from collections.abc import Iterator
from typing import Any, TextIO, cast

_HIDING = (
    "\x00-\x09\x0b-\x1f\x7f-\x9f"  # controls: C0 but the line feed, DEL, C1
    "\xad\u034f\u061c\u070f\u115f\u1160\u17b4\u17b5\u180b-\u180f"  # no width, or blank letters
    "\u200b-\u200f\u2028-\u202e\u2060-\u206f"  # no width, ends of lines, directions
    "\u3164\ufe00-\ufe0f\ufeff\uffa0\ufff0-\ufffb"
    "\U0001bca0-\U0001bca3\U0001d173-\U0001d17a\U000e0000-\U000e0fff"
    "\ud800-\udfff"  # halves of characters: bytes of a name that are no text
)
_UNSAFE = re.compile(f"[{_HIDING}]")
_UNSAFE_IN_LINE = re.compile(f"[\n{_HIDING}]")
_LINES = re.compile("[\t\r\n]+")
_SHORT = {"\n": "\\n", "\r": "\\r", "\t": "\\t"}


def visible(text: str) -> str:
    """Return a text of one or more lines with escapes as Python has them: `\\x1b`, `\\u202e`, `\\r`."""
    return _UNSAFE.sub(_escape, text)


def on_one_line(text: str) -> str:
    """Return a text as `visible` does, and with `\\n` for a line feed: a name takes no line of its own."""
    return _UNSAFE_IN_LINE.sub(_escape, text)


def flowing(text: str) -> str:
    """Return a text as `visible` does, its lines joined by spaces: a description that is wrapped anew."""
    return visible(_LINES.sub(" ", text))


def visible_json(text: str) -> str:
    """Return JSON with JSON's own escapes in its texts, which are read back as they were."""
    return _UNSAFE.sub(_escape_of_json, text)


def visible_toml(text: str) -> str:
    """Return TOML with its own escapes; such characters may stand in its basic strings ("...") alone."""
    return _UNSAFE.sub(_escape_of_toml, text)


def visible_stream(stream: TextIO) -> TextIO:
    """Return a stream that writes to another one what `visible` makes of a text."""
    return stream if isinstance(stream, _VisibleStream) else cast(TextIO, _VisibleStream(stream))


def raw_stream(stream: TextIO) -> TextIO:
    """Return the stream under one of `visible_stream`, for our own colors and cursor movements."""
    return stream.stream if isinstance(stream, _VisibleStream) else stream


class _VisibleStream:
    """A stream for people, above `stream`; all but writing is that one's."""

    def __init__(self, stream: TextIO) -> None:
        self.stream = stream

    def write(self, text: str) -> int:
        with naming(self.stream):
            self.stream.write(visible(text))
        return len(text)

    def flush(self) -> None:
        with naming(self.stream):
            self.stream.flush()

    def writelines(self, lines: Any) -> None:
        for line in lines:
            self.write(line)

    def __getattr__(self, name: str) -> Any:
        return getattr(self.stream, name)


@contextlib.contextmanager
def naming(stream: TextIO) -> Iterator[None]:
    """Let an error of the system name the stream, as one of a file names that."""
    try:
        yield
    except OSError as error:
        name = str(getattr(stream, "name", ""))
        error.filename = {"<stdout>": "standard output", "<stderr>": "standard error"}.get(name, name)
        raise


def _escape(found: re.Match[str]) -> str:
    character = found[0]
    code = ord(character)
    long = f"\\x{code:02x}" if code < 0x100 else f"\\u{code:04x}" if code < 0x10000 else f"\\U{code:08x}"
    return _SHORT.get(character, long)


def _escape_of_json(found: re.Match[str]) -> str:
    code = ord(found[0])
    if code < 0x10000:
        return f"\\u{code:04x}"
    code -= 0x10000
    return f"\\u{0xD800 + (code >> 10):04x}\\u{0xDC00 + (code & 0x3FF):04x}"


def _escape_of_toml(found: re.Match[str]) -> str:
    code = ord(found[0])
    return f"\\u{code:04X}" if code < 0x10000 else f"\\U{code:08X}"
