"""Annotations behind a unit: "V DC", "psia", "% SOC", "bar(g)".

Some change nothing about the unit (an absolute pressure, a direct voltage, a share of a charge). Others say
that the number counts from another zero, or by another rule, which no factor converts: such a text is no
unit, and its message says why.
"""

from __future__ import annotations

import functools
import re

_ELECTRIC = r"[kmuμM]?[VA]|[Vv]olts?|[Aa]mps?"
_PRESSURE = r"(?i:psi|[mkMh]?bar)|[kMhm]?Pa"

_KINDS: tuple[tuple[str, str, str], ...] = (
    (_ELECTRIC, r"dc", ""),
    (
        _ELECTRIC,
        r"ac|rms|eff|pp|p-p|pk|peak",
        "the rms value or an amplitude of something that alternates",
    ),
    (_PRESSURE, r"a|abs|absolute", ""),
    (
        _PRESSURE,
        r"g|ga|gage|gauge|rel|ü",
        "a pressure above that of the air, which is to be added for an absolute one",
    ),
    (_PRESSURE, r"d|diff", "a difference of two pressures"),
    ("%", r"rh|r\.h\.|soc|soh|dod|pwm|duty", ""),
    ("%", r"fs|fso|f\.s\.|full[ _]scale", "a part of a full scale that it does not say"),
    ("%", r"vol|v/v|wt|w/w|m/m|mol", "a share of volume, mass or amount, which differ"),
)
_PATTERNS = [(re.compile(rf"({unit})[ _]?[(\[]?(?i:{mark})[)\]]?"), reason) for unit, mark, reason in _KINDS]
_SHARE = re.compile(r"(?i:vol\.?|wt\.?|mol|w/w|v/v|m/m)[ -]*(%)")
_SHARE_REASON = _KINDS[-1][2]


@functools.cache
def annotated(text: str) -> tuple[str, str] | None:
    """Return a text's unit without its annotation, and why that is open, or ""; None where it has none."""
    for pattern, reason in _PATTERNS:
        found = pattern.fullmatch(text)
        if found:
            return found[1], reason
    share = _SHARE.fullmatch(text)
    return (share[1], _SHARE_REASON) if share else None


def objection(text: str) -> str:
    """Return why an annotated text is no unit, as a sentence to append; "" for another text."""
    found = annotated(text)
    if found is None or not found[1]:
        return ""
    unit, reason = found
    return f": {text} is {reason}; where the number is to be taken as it is, write {unit}"
