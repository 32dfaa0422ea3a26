"""Likeness of two names of signals, in English and German, as Modelica, Simulink and C code write them.

A name is split (`VehFdbk.Body.Vel_mps`: path, words, unit of measure), each word stands for the quantities
that it may mean, and the likeness is the share of words that may mean the same.
"""

from __future__ import annotations

import difflib
import functools
import math
import re

_WORDS = {
    "speed": "speed spd velocity vel v vx geschwindigkeit tempo",
    "throttle": "throttle pedal accelerator u gas fahrpedal gaspedal pdl app",
    "acceleration": "acceleration accel acc a ax beschleunigung",
    "force": "force frc f kraft",
    "torque": "torque trq tau moment drehmoment",
    "power": "power pwr p pel leistung",
    "distance": "distance dist s position pos x weg wegstrecke strecke odometer",
    "displacement": "displacement offset y ablage abweichung",
    "mass": "mass m masse gewicht",
    "grade": "grade slope incline gradient steigung alpha",
    "angle": "angle ang delta theta winkel",
    "brake": "brake braking brk brems bremse",
    "current": "current i strom",
    "voltage": "voltage u spannung",
    "charge": "charge soc ladezustand ladung",
    "yaw": "yaw gier psi",
    "heading": "heading psi kurs",
    "rate": "rate rat",
    "steering": "steering steer str lenk lenkung",
    "lateral": "lateral lat y quer",
    "front": "front frnt f vorn vorne vorder",
    "rear": "rear r hinten hinter",
    "wheel": "wheel whl w reifen",
    "drive": "drive drv motor antrieb",
}
"""Quantities and places, each with the words, abbreviations and symbols that mean it."""

_EMPTY = {
    *("the", "of", "and", "to", "at", "in", "is", "der", "die", "das", "value", "input", "output", "out"),
    *("vehicle", "veh", "car", "fahrzeug", "signal", "sig", "bus"),
}
"""Words that say nothing of a signal."""

_DERIVATIVES = {"distance": "speed", "speed": "acceleration", "displacement": "speed"}
_UNITS = {
    "km_h": "km/h", "kmh": "km/h", "kmph": "km/h", "kph": "km/h", "mps": "m/s", "m_s": "m/s", "mph": "mph",
    "mps2": "m/s2", "mpss": "m/s2", "m_s2": "m/s2", "rpm": "rpm", "radps": "rad/s", "rad_s": "rad/s",
    "degps": "deg/s", "deg_s": "deg/s", "rad": "rad", "deg": "deg", "pct": "%", "percent": "%", "perc": "%",
    "nm": "N.m", "kw": "kW", "kg": "kg", "km": "km",
}  # fmt: skip # how code spells units of measure at the end of names; single letters mean too much else
_ENDING = re.compile(rf"(?:_|(?<=[a-z])(?=[A-Z]))((?i:{'|'.join(sorted(_UNITS, key=len, reverse=True))}))$")
_NUMBER = re.compile(r"(?<![A-Za-z])\d+|(?<=[A-Za-z])(?:\d\d+|[013-9])")
"""A number in a name, but for the 2 that may belong to a unit of measure (`accel_mps2`)."""
_COMPOUND = 4  # letters that a part of a compound word has at least

Meanings = frozenset[str]
"""The quantities that one word may mean, as keys of _WORDS; a word that is no key's stands for itself."""


def unit_in(name: str) -> str:
    """Return the unit of measure that a name ends in (`speed_kmh`: km/h); "" where there is none."""
    found = _ENDING.search(name)
    return _UNITS[found[1].lower()] if found else ""


def likeness(name: str, text: str, other: str, other_text: str) -> float:
    """Return the likeness, from 0 to 1, of a system's name and an FMU's `other` one, with their descriptions.

    It is the largest of three: by the words of the names, of which the last part of the FMU's path counts
    most; by the words of names and descriptions; by the letters.
    """
    by_words = _by_words(name, text, _NUMBER.sub("0", other), _NUMBER.sub("0", other_text))
    return max(by_words, 0.8 * _look(name.lower(), _last(other).lower(), by_words / 0.8))


@functools.cache  # the names of a large FMU differ by numbers, which are no words
def _by_words(name: str, text: str, other: str, other_text: str) -> float:
    path, last = _meanings(other), _meanings(_last(other))
    own = _meanings(name)
    by_name = 0.6 * _agreement(own, last) + 0.4 * _agreement(own, path)
    words, other_words = (*own, *_meanings(text)), (*path, *_meanings(other_text))
    by_text = _agreement(tuple(dict.fromkeys(words)), tuple(dict.fromkeys(other_words)))
    return max(by_name, 0.9 * by_text)


def _look(a: str, b: str, above: float) -> float:
    """Return the likeness of two texts by their letters; 0.0 where it is not larger than `above`."""
    if 2.0 * min(len(a), len(b)) <= above * (len(a) + len(b)):  # all letters of the shorter one are shared
        return 0.0
    return _ratio(a, _others_than(a).sub("\0", b))


@functools.cache
def _others_than(a: str) -> re.Pattern[str]:
    """Return the pattern of a character that does not occur in a text: which one it is counts for nothing."""
    return re.compile(f"[^{re.escape(a)}]" if a else ".", re.DOTALL)


@functools.cache
def _ratio(a: str, b: str) -> float:
    return difflib.SequenceMatcher(None, a, b).ratio()


def _agreement(a: tuple[Meanings, ...], b: tuple[Meanings, ...]) -> float:
    """Return the cosine of two sets of words, of which two are the same when they may mean the same."""
    if not a or not b:
        return 0.0
    shared = min(sum(any(x & y for y in b) for x in a), sum(any(x & y for x in a) for y in b))
    return shared / math.sqrt(len(a) * len(b))


def _last(name: str) -> str:
    """Return the last part of a path; of a derivative too, `der(v)` of `der(body.v)`."""
    inner = re.fullmatch(r"der\((.*)\)", name) if name.startswith("der(") else None
    return f"der({_last(inner[1])})" if inner else name.rpartition(".")[2]


@functools.cache
def _meanings(text: str) -> tuple[Meanings, ...]:
    """Return the meanings of each word of a name or a description, without repetitions."""
    inner = re.fullmatch(r"der\((.*)\)", text)
    derived = inner is not None or re.search(r"_?dot$", text, re.I) is not None
    plain = re.sub(r"_?dot$", "", inner[1] if inner else text, flags=re.I)
    words = re.findall(r"[A-Z]?[a-zäöüß]+|[A-ZÄÖÜ]+(?![a-z])", _ENDING.sub("", plain))
    parts = [part for word in words for part in _parts(word.lower()) if part not in _EMPTY]
    found = [_of_word(part) for part in parts]
    if derived and found:
        found[-1] = frozenset(_DERIVATIVES.get(m, f"derivative of {m}") for m in found[-1])
    return tuple(dict.fromkeys(found))


@functools.cache  # the names of a large FMU repeat a few words
def _parts(word: str) -> tuple[str, ...]:
    """Return the known words in a compound (`bremskraft`: brems, kraft), else the word itself."""
    known = _vocabulary()
    if word in known or word in _EMPTY:
        return (word,)
    inside = [w for w in known if len(w) >= _COMPOUND and w in word]
    longest = [w for w in inside if not any(w != other and w in other for other in inside)]
    return tuple(sorted(longest, key=word.index)) or (word,)


def _of_word(word: str) -> Meanings:
    return _vocabulary().get(word, frozenset({word}))


@functools.cache
def _vocabulary() -> dict[str, Meanings]:
    """Return the meanings of each known word."""
    found: dict[str, set[str]] = {}
    for meaning, words in _WORDS.items():
        for word in words.split():
            found.setdefault(word, set()).add(meaning)
    return {word: frozenset(meanings) for word, meanings in found.items()}
