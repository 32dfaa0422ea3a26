"""Matches between the needs of a system from a unit and the variables of an FMU for its place.

A variable of the same name is taken if its unit of measure converts. For the others each pair of a need and a
variable has a score from unit of measure, causality and likeness of name, and the assignment with the largest
sum of scores is taken; a pair whose score is low, or hardly above another one's, is the user's to choose.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from typing import Any, Literal

from ..errors import ConfigError
from ..interface import UnitInterface, VariableInfo
from ..shortage import require_scipy
from ..system.system import MapEntry, UnitEntry
from ..units.conversion import conversion
from ..units.definition import defined
from .name_likeness import likeness, unit_in
from .requirements import ROLES, Requirement, Role

Verdict = Literal["fits", "fits after conversion", "your choice", "missing", "unused"]

LIKENESS = 0.45
"""The score of a guess below which the unit of measure alone speaks for it."""

_MARGIN = 0.1  # by which a score is above all others of its need
_CANDIDATES = 4  # variables that are named beside the one that is taken
_CAUSALITIES: dict[Role, tuple[str, ...]] = {
    "input": ("input",),
    "output": ("output", "local"),
    "parameter": ("parameter",),
}


@dataclasses.dataclass(frozen=True)
class Match:
    """A need of the system and the FMU's variable for it, with a verdict and its reason.

    `need` is "" for a variable that nothing needs, `variable` "" for a need without one. `needed` says who
    gives, takes or sets it in the system. `candidates` are the variables that could be chosen, best first.
    `unit` is the unit of measure that stands in for one that the FMU does not declare ("": its own counts);
    `invert` is true where an existing mapping turns the sign, and `factor`, `offset` and `convert` are its.
    `likeness` is the score of a guess, from 0 to 1; None: a variable of the same name, or as mapped.
    """

    need: str
    role: Role
    variable: str
    verdict: Verdict
    reason: str
    needed: tuple[str, ...] = ()
    candidates: tuple[str, ...] = ()
    unit: str = ""
    invert: bool = False
    factor: float | None = None
    offset: float | None = None
    convert: bool | None = None
    likeness: float | None = None

    @property
    def others(self) -> list[str]:
        """The candidates that were not taken."""
        return [name for name in self.candidates if name != self.variable]


def matches(
    needs: Sequence[Requirement], offer: UnitInterface, entry: UnitEntry | None = None
) -> list[Match]:
    """Return a match for each need, then one for each input of the FMU that nothing drives.

    `offer` is the FMU's interface. What an existing mapping in `entry` maps is judged as it is.
    """
    mapped = entry.map.by_causality if entry else {}
    found: list[Match] = []
    for role in ROLES:
        wanted = [need for need in needs if need.role == role]
        found += _of_role(wanted, role, offer, mapped.get(role, {}), set(entry.absent if entry else ()))
        found += _mapped_only(mapped.get(role, {}), role, {need.name for need in wanted})
    used = {match.variable for match in found}
    for v in offer.of_causality("input"):
        if v.name not in used:
            start = "its start value" if v.start is None else f"{v.start} {v.unit}".strip()
            found.append(Match("", "input", v.name, "unused", f"nothing drives it: it keeps {start}"))
    return found


def _of_role(
    needs: Sequence[Requirement],
    role: Role,
    offer: UnitInterface,
    mapped: Mapping[str, MapEntry],
    absent: set[str],
) -> list[Match]:
    candidates = list(offer.of_causality(*_CAUSALITIES[role]))
    unmapped = [need for need in needs if need.name not in mapped and need.name not in absent]
    scores = {need.name: _scores(need, candidates, offer) for need in unmapped}
    chosen = _assigned(scores, candidates, {need.name for need in unmapped if need.optional})
    found = []
    for need in needs:
        if need.name in absent:
            found.append(Match(need.name, role, "", "fits", "absent, as the mapping says", need.needed))
        elif need.name in mapped:
            found.append(_as_mapped(need, mapped[need.name], offer))
        elif need.optional and need.name not in chosen:
            reason = "optional: the FMU has no variable of this name"
            found.append(Match(need.name, role, "", "fits", reason, need.needed))
        else:
            found.append(_judged(need, chosen.get(need.name), candidates, scores[need.name], offer))
    return found


def _mapped_only(mapped: Mapping[str, MapEntry], role: Role, needed: set[str]) -> list[Match]:
    """Return a match for each name that is mapped and that the system in this scenario does not need."""
    reason = "as mapped; nothing needs it in this scenario"
    return [
        Match(name, role, entry.variable, "unused", reason, **_as_written(entry))
        for name, entry in mapped.items()
        if name not in needed
    ]


def _as_mapped(need: Requirement, entry: MapEntry, offer: UnitInterface) -> Match:
    """Return the match that a mapping declares, judged by type and unit of measure alone."""
    found = offer.variables.get(entry.variable)
    if found is None:
        verdict: Verdict = "missing"
        reason = offer.unusable.get(entry.variable, "the FMU has no variable of this name")
    else:
        known = found if entry.unit is None else dataclasses.replace(found, unit=entry.unit)
        verdict, said, _ = _converts(need, known, offer)
        words = [*(["inverted"] if entry.invert else []), *([entry.in_words] if entry.written else [])]
        reason = f"{', '.join(['as mapped', *words])}: {said}"
    return Match(need.name, need.role, entry.variable, verdict, reason, need.needed, **_as_written(entry))


def _as_written(entry: MapEntry) -> dict[str, Any]:
    """Return the fields of a match that repeat what a mapping says."""
    given = entry.model_dump(include={"unit", "invert", "factor", "offset", "convert"})
    return given | {"unit": entry.unit or ""}


def _assigned(
    scores: Mapping[str, Sequence[float]], candidates: Sequence[VariableInfo], optional: set[str]
) -> dict[str, VariableInfo]:
    """Return the variable for each need, by its name: that of the same name, else by the best assignment of
    all needs together. A need that no variable can be for is left out.

    `scores` has for each need that of every candidate. One of the `optional` needs is taken by its own name
    only: a guess would take another need's variable.
    """
    same = {name: candidates[row.index(2.0)] for name, row in scores.items() if 2.0 in row}
    names = [name for name in scores if name not in same and name not in optional]
    left = [j for j, v in enumerate(candidates) if v.name not in same]
    if not names or not left:
        return same
    import numpy as np

    require_scipy()
    from scipy.optimize import linear_sum_assignment  # 0.2 s, and a report alone needs it

    table = np.array([[scores[name][j] for j in left] for name in names])
    pairs = zip(*linear_sum_assignment(table, maximize=True), strict=True)
    return same | {names[i]: candidates[left[j]] for i, j in pairs if table[i, j] > 0.0}


def _scores(need: Requirement, candidates: Sequence[VariableInfo], offer: UnitInterface) -> list[float]:
    """Return how well each variable suits a need: 0 it cannot be, up to 1 by likeness, 2 the same name."""
    possible: dict[tuple[str, str, str, bool], bool] = {}  # a large FMU has few types and units of measure
    scores = []
    for v in candidates:
        key = v.type, v.unit, v.unit or unit_in(v.name), v.difference
        if key not in possible:
            possible[key] = _converts(need, v, offer)[0] != "missing"
        scores.append(_score(need, v) if possible[key] else 0.0)
    return scores


def _score(need: Requirement, v: VariableInfo) -> float:
    """Return how well a variable suits a need whose unit of measure fits, as `_scores` does."""
    if v.name == need.name:
        return 2.0
    alike = likeness(need.name, need.variable.description, v.name, v.description)
    same = 0.3 if v.unit and need.variable.unit else 0.0
    return min(1.0, 0.7 * alike + same) * (0.8 if v.causality == "local" else 1.0)


def _converts(need: Requirement, v: VariableInfo, offer: UnitInterface) -> tuple[Verdict, str, str]:
    """Return a verdict by type and unit of measure alone, its reason, and the unit of measure to assume where
    the FMU declares none ("": its own counts)."""
    if v.type != need.variable.type and "String" in (v.type, need.variable.type):
        return "missing", f"is a {v.type}, not a {need.variable.type}", ""
    wanted = need.variable.unit
    unit = v.unit or unit_in(v.name)
    if unit == wanted == v.unit or (wanted in ("", "1") and unit in ("", "1")):
        return "fits", f"[{unit}]" if unit else "no unit of measure on both sides", ""
    if not unit:
        return "your choice", f"declares no unit of measure; the system has [{wanted}]", wanted
    if not wanted:
        return "your choice", f"is in [{unit}]; the system declares no unit of measure", ""
    try:
        kinds = (v.difference, need.variable.difference)
        map_ = conversion(defined(unit, offer.units_of_measure), defined(wanted), kinds)
    except ConfigError:
        said = "" if v.unit else "its name says "
        return "missing", f"{said}[{unit}], no unit for what the system has in [{wanted}]", ""
    if not v.unit:
        reason = f"declares no unit of measure; its name says [{unit}], the system has [{wanted}]"
        return "your choice", reason, unit
    if map_.identity:
        return "fits", f"[{unit}] is [{wanted}]", ""
    shift = f" + {map_.offset:g}" if map_.offset else ""
    return "fits after conversion", f"1 [{unit}] is {map_.scale:g}{shift} [{wanted}]", ""


def _judged(
    need: Requirement,
    v: VariableInfo | None,
    candidates: Sequence[VariableInfo],
    scores: Sequence[float],
    offer: UnitInterface,
) -> Match:
    """Return the match of a need with the variable that was assigned to it, or with none.

    `scores` are those of the candidates for this need.
    """
    named_scores = zip(scores, (c.name for c in candidates), strict=True)
    scored = sorted(named_scores, key=lambda pair: -pair[0])
    named = tuple(name for score, name in scored[:_CANDIDATES] if score > 0.0)
    if v is None:
        reason = "no variable is left that could be it"
        if not named:
            reason = f"nothing has a unit of measure for [{need.variable.unit}]"
        return Match(need.name, need.role, "", "missing", reason, need.needed, named)
    verdict, reason, unit = _converts(need, v, offer)
    own = scores[candidates.index(v)]
    rival = max((score for score, name in scored if name != v.name), default=0.0)
    if v.name != need.name and own < LIKENESS:
        verdict, reason = (
            "your choice",
            f"only the unit of measure speaks for it (likeness {own:.2f}); {reason}",
        )
    elif v.name != need.name and own - rival < _MARGIN:
        verdict, reason = "your choice", f"others are as likely; {reason}"
    if v.causality == "local":
        reason += "; a local variable, read as an output"
    guessed = None if v.name == need.name else own
    return Match(need.name, need.role, v.name, verdict, reason, need.needed, named, unit, likeness=guessed)


def is_open(match: Match, likeness: float = LIKENESS) -> bool:
    """Return True for a guess of a lower likeness, which is the user's to confirm."""
    return bool(match.need and match.variable) and match.likeness is not None and match.likeness < likeness


def fits(found: Sequence[Match]) -> bool:
    """Return true where nothing is missing and nothing is left to choose."""
    return all(match.verdict not in ("missing", "your choice") for match in found)
