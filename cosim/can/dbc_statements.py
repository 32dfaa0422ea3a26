"""The statements of a DBC file, each with its line, so that one that nobody can read leaves the rest.

Strings are single tokens, so that no text of a comment is taken for a statement. A statement ends with its
semicolon; `BO_` and `SG_`, which have none, end where the next statement begins. One whose semicolon is
missing ends before the next line that begins as a statement does.
"""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Iterator

STRING = r'"(?:\\"|[^"])*"'
NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"

_OPEN = ("BO_", "SG_", "NS_", "BS_", "BU_", "VERSION")
_CLOSED = (
    "BA_DEF_DEF_REL_", "BA_DEF_REL_", "BA_DEF_DEF_", "BA_DEF_SGTYPE_", "BA_DEF_", "BA_REL_", "BA_SGTYPE_",
    "BA_", "BO_TX_BU_", "CAT_DEF_", "CAT_", "CM_", "ENVVAR_DATA_", "EV_DATA_", "EV_", "SGTYPE_VAL_",
    "SGTYPE_", "SG_MUL_VAL_", "SIGTYPE_VALTYPE_", "SIG_GROUP_", "SIG_TYPE_REF_", "SIG_VALTYPE_",
    "VAL_TABLE_", "VAL_",
)  # fmt: skip # a list of words
_WORDS = "|".join((*_CLOSED, *_OPEN))
_TOKEN = re.compile(
    rf"(?P<string>{STRING})|(?P<comment>//[^\n]*)|(?P<end>;)|(?<!\w)(?P<word>{_WORDS})(?!\w)"
    r"|[^\s;\"]|(?P<broken>\")"
)
_FIRST = {  # the beginnings that end a statement whose semicolon is missing, or the list of NS_
    "BO_": r"BO_\s+\d+\s+\w+\s*:",
    "SG_": r"SG_\s+\w+[^:\n]*:\s*\d+\s*\|",
    "BU_": r"BU_\s*:",
    "BS_": r"BS_\s*:",
    "NS_": r"NS_\s*:",
    "VERSION": r'VERSION\s*"',
    "EV_": r"EV_\s+\w+\s*:",
}
_FIRSTS = {word: re.compile(pattern) for word, pattern in _FIRST.items()}
_CONTENT = re.compile(r"[^\S\n]+\S")


@dataclasses.dataclass(frozen=True)
class Statement:
    """One statement: its keyword ("" where it begins with none), its text up to the semicolon, its line."""

    keyword: str
    text: str
    line: int

    @property
    def shown(self) -> str:
        """The text in one line, cut where it is long."""
        text = " ".join(self.text.split())
        return text if len(text) <= 80 else f"{text[:80]}..."


@dataclasses.dataclass
class _Open:
    """The statement that is being read: its keyword, and where it and its first token begin."""

    keyword: str
    start: int


def statements(text: str) -> Iterator[Statement]:
    """Yield the statements of a DBC file in their order."""
    lines, counted = 1, 0
    for keyword, start, end in _spans(text):
        lines, counted = lines + text.count("\n", counted, start), start
        yield Statement(keyword, _bare(text[start:end]), lines)


def _bare(text: str) -> str:
    """Return a statement without the comments between its lines."""
    if "//" not in text:
        return text.strip()
    return re.sub(rf"({STRING})|//[^\n]*", lambda found: found[1] or "", text).strip()


def _spans(text: str) -> Iterator[tuple[str, int, int]]:
    """Yield keyword, begin and end of each statement."""
    now: _Open | None = None
    for token in _TOKEN.finditer(text):
        if token["comment"]:
            continue
        word, start = token["word"] or "", token.start()
        if now is not None and word and _begins(text, now.keyword, word, start):
            yield now.keyword, now.start, start
            now = None
        if token["end"]:
            if now is not None:
                yield now.keyword, now.start, start
            now = None
        elif now is None:
            now = _Open(word, start)
    if now is not None:
        yield now.keyword, now.start, len(text)


def _begins(text: str, keyword: str, word: str, start: int) -> bool:
    """Return True where a keyword at `start` begins a statement, after one that is not closed yet."""
    pattern = _FIRSTS.get(word)
    if keyword == "NS_":  # the list of all keywords, each alone on its line
        if pattern is None:
            return _CONTENT.match(text, start + len(word)) is not None
        return pattern.match(text, start) is not None
    if keyword in _OPEN:
        return True
    first = not text[text.rfind("\n", 0, start) + 1 : start].strip()
    return first and (pattern is None or pattern.match(text, start) is not None)
