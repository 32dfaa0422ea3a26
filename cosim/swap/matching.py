"""Whether an FMU fits into the place of a unit: what the system needs, and what the FMU has for it.

A variable of the same name is taken if its unit of measure converts. For the others all pairs are weighed by
unit of measure, causality and likeness of name, and the best assignment of all together is taken; a pair that
is weak, or hardly better than another one, is the user's to choose.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from typing import Literal

from ..errors import ConfigError
from ..interface import UnitInterface, VariableInfo
from ..system.system import MapEntry, UnitEntry
from ..units import conversion, defined
from .name_likeness import likeness, unit_in
from .requirements import Requirement

Verdict = Literal["fits", "fits after conversion", "your choice", "missing", "unused"]

_WEAK, _MARGIN, _CANDIDATES = 0.45, 0.1, 4
_NOTHING = VariableInfo("")
_CAUSALITIES = {
    "input": ("input",),
    "output": ("output", "local"),
    "parameter": ("parameter",),
}


@dataclasses.dataclass(frozen=True)
class Row:
    """One line of a report: what the system needs ("" for what the FMU has beside it), the FMU's variable
    ("" for none), and the reason of the verdict.

    `needed` are who gives, takes or sets it in the system. `candidates` are the variables that could be
    chosen, the best first. `unit` is the unit of measure that stands in for one that the FMU does not declare
    ("": its own counts), `invert` whether a mapping that is there turns the sign.
    """

    need: str
    role: str
    variable: str
    verdict: Verdict
    reason: str
    needed: tuple[str, ...] = ()
    candidates: tuple[str, ...] = ()
    unit: str = ""
    invert: bool = False

    @property
    def others(self) -> list[str]:
        """The candidates that were not taken."""
        return [name for name in self.candidates if name != self.variable]


def fit(needs: Sequence[Requirement], offer: UnitInterface, entry: UnitEntry | None = None) -> list[Row]:
    """The rows for all needs, then one for each input of the FMU that nothing drives.

    `entry` is a mapping that is there already: what it maps is looked at as it is.
    """
    mapped = entry.map.by_causality if entry else {}
    rows: list[Row] = []
    for role in ("input", "output", "parameter"):
        wanted = [need for need in needs if need.role == role]
        rows += _of_role(wanted, role, offer, mapped.get(role, {}), set(entry.absent if entry else ()))
        rows += _beside(mapped.get(role, {}), role, {need.name for need in wanted})
    used = {row.variable for row in rows}
    for v in offer.of_causality("input"):
        if v.name not in used:
            start = "its start value" if v.start is None else f"{v.start} {v.unit}".strip()
            rows.append(Row("", "input", v.name, "unused", f"nothing drives it: it keeps {start}"))
    return rows


def _of_role(
    needs: Sequence[Requirement],
    role: str,
    offer: UnitInterface,
    mapped: Mapping[str, MapEntry],
    absent: set[str],
) -> list[Row]:
    candidates = list(offer.of_causality(*_CAUSALITIES[role]))
    given = [need for need in needs if need.name not in mapped and need.name not in absent]
    chosen = _assigned(given, candidates, offer)
    rows = []
    for need in needs:
        if need.name in absent:
            rows.append(Row(need.name, role, "", "fits", "absent, as the mapping says", need.why))
        elif need.name in mapped:
            rows.append(_as_mapped(need, mapped[need.name], offer))
        else:
            rows.append(_judged(need, chosen.get(need.name), candidates, offer))
    return rows


def _beside(mapped: Mapping[str, MapEntry], role: str, needed: set[str]) -> list[Row]:
    """What a mapping names and the system in this scenario does not need."""
    reason = "as mapped; nothing needs it in this scenario"
    return [
        Row(name, role, entry.variable, "unused", reason, unit=entry.unit or "", invert=entry.invert)
        for name, entry in mapped.items()
        if name not in needed
    ]


def _as_mapped(need: Requirement, entry: MapEntry, offer: UnitInterface) -> Row:
    found = offer.variables.get(entry.variable)
    unit, invert = entry.unit or "", entry.invert
    if found is None:
        verdict: Verdict = "missing"
        reason = offer.unusable.get(entry.variable, "the FMU has no variable of this name")
    else:
        known = found if entry.unit is None else dataclasses.replace(found, unit=entry.unit)
        verdict, told, _ = _converts(need, known, offer)
        reason = f"as mapped{', inverted' if invert else ''}: {told}"
    return Row(need.name, need.role, entry.variable, verdict, reason, need.why, unit=unit, invert=invert)


def _assigned(
    needs: Sequence[Requirement], candidates: Sequence[VariableInfo], offer: UnitInterface
) -> dict[str, VariableInfo]:
    """The variable for each need: that of its name, else the best one, all needs together; none where nothing
    is like it at all."""
    by_name = {v.name: v for v in candidates}
    same = {n.name: by_name[n.name] for n in needs if _score(n, by_name.get(n.name, _NOTHING), offer) == 2.0}
    needs = [need for need in needs if need.name not in same]
    candidates = [v for v in candidates if v.name not in same]
    if not needs or not candidates:
        return same
    import numpy as np
    from scipy.optimize import linear_sum_assignment  # 0.2 s, and a report alone needs it

    scores = np.array([[_score(need, v, offer) for v in candidates] for need in needs])
    pairs = zip(*linear_sum_assignment(scores, maximize=True), strict=True)
    return same | {needs[i].name: candidates[j] for i, j in pairs if scores[i, j] > 0.0}


def _score(need: Requirement, v: VariableInfo, offer: UnitInterface) -> float:
    """From 0 (cannot be) to 2 (the same name and a unit that converts)."""
    if _converts(need, v, offer)[0] == "missing":
        return 0.0
    if v.name == need.name:
        return 2.0
    alike = likeness(need.name, need.variable.description, v.name, v.description)
    same = 0.3 if v.unit and need.variable.unit else 0.0
    return min(1.0, 0.7 * alike + same) * (0.8 if v.causality == "local" else 1.0)


def _converts(need: Requirement, v: VariableInfo, offer: UnitInterface) -> tuple[Verdict, str, str]:
    """Whether the values of a variable can be those of a need, what happens to them, and the unit of measure
    to assume where the FMU declares none ("": its own counts)."""
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
        map_ = conversion(defined(unit, offer.units_of_measure), defined(wanted))
    except ConfigError:
        said = "" if v.unit else "its name says "
        return "missing", f"{said}[{unit}], no unit for what the system has in [{wanted}]", ""
    if not v.unit:
        told = f"declares no unit of measure; its name says [{unit}], the system has [{wanted}]"
        return "your choice", told, unit
    if map_.identity:
        return "fits", f"[{unit}] is [{wanted}]", ""
    shift = f" + {map_.offset:g}" if map_.offset else ""
    return "fits after conversion", f"1 [{unit}] is {map_.scale:g}{shift} [{wanted}]", ""


def _judged(
    need: Requirement, v: VariableInfo | None, candidates: Sequence[VariableInfo], offer: UnitInterface
) -> Row:
    scored = sorted(((_score(need, c, offer), c.name) for c in candidates), key=lambda pair: -pair[0])
    named = tuple(name for score, name in scored[:_CANDIDATES] if score > 0.0)
    if v is None:
        reason = "no variable is left that could be it"
        if not named:
            reason = f"nothing has a unit of measure for [{need.variable.unit}]"
        return Row(need.name, need.role, "", "missing", reason, need.why, named)
    verdict, reason, unit = _converts(need, v, offer)
    own = _score(need, v, offer)
    rival = max((score for score, name in scored if name != v.name), default=0.0)
    if v.name != need.name and own < _WEAK:
        verdict, reason = "your choice", f"only the unit of measure speaks for it; {reason}"
    elif v.name != need.name and own - rival < _MARGIN:
        verdict, reason = "your choice", f"others are as likely; {reason}"
    if v.causality == "local":
        reason += "; a local variable, read as an output"
    return Row(need.name, need.role, v.name, verdict, reason, need.why, named, unit)


def fits(rows: Sequence[Row]) -> bool:
    """Whether nothing is missing and nothing is left to choose."""
    return all(row.verdict not in ("missing", "your choice") for row in rows)
