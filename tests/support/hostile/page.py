"""docs/hostile.md: what is expected of each hostile FMU, and what came of it when the page was made."""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path

from support.hostile.case import WHOLE, Case
from support.hostile.cases import GROUPS
from support.hostile.runs import Outcome

PAGE = Path(__file__).parents[3] / "docs" / "hostile.md"
_LONGEST = 160  # characters of what a run said
_HEAD = """# Hostile FMUs

What a run says and keeps when a unit misbehaves. Each row is an FMU with one thing wrong, made of a good
one (a C library and a description) in one or more versions of FMI. It runs beside a good unit for {whole}
rows, in a process of its own, as FMUs do that evcosim did not build. `python -m support.hostile`, started
in `tests/`, runs all of them and writes this page. `tests/master/test_hostile.py` does the same runs, and
checks besides that the rows before the failure are those of the good FMU, and that the master is as it was:
no process, temporary file or open file is left, no signal, locale or rounding is changed.

*refused*: before any step, exit code 2. *n rows*: the run failed with so many rows kept, exit code 1.
*whole*: all rows are there, and what is said is among the warnings, or the unit failed to terminate.
`…` stands for anything. [Isolation and trust](isolation.md) says what is protected, and what is not.

{classes} classes, {count} FMUs, {right} as expected.
"""


Outcomes = dict[tuple[Case, int], Outcome]


def table(cases: Iterable[Case]) -> list[list[str]]:
    """The rows of the page as far as they are the same whenever it is made: class, FMI, expected."""
    return [
        [f"`{case.name}`: {_cell(case.what)}", ", ".join(map(str, case.versions)), _expected(case)]
        for case in cases
    ]


def as_expected(case: Case, outcome: Outcome) -> bool:
    """Whether a run ended as it should and said what it should."""
    return outcome.rows == case.rows and case.says(outcome.said) and not outcome.left


def written(outcomes: Outcomes) -> str:
    """The page."""
    right = sum(as_expected(case, outcome) for (case, _), outcome in outcomes.items())
    classes = sum(map(len, GROUPS.values()))
    parts = [_HEAD.format(whole=WHOLE, count=len(outcomes), classes=classes, right=right)]
    for title, group in GROUPS.items():
        parts.append(f"\n## {title}\n\n| class | FMI | expected | got | s |\n|---|---|---|---|---|\n")
        for case, row in zip(group, table(group), strict=True):
            parts.append(f"| {' | '.join(row + _got(case, outcomes))} |\n")
    return "".join(parts)


def read() -> list[list[str]]:
    """The rows of the page as it is: class, FMI, expected."""
    lines = [line for line in PAGE.read_text("utf-8").splitlines() if line.startswith("| `")]
    return [re.split(r"(?<!\\) \| ", line[2:-2])[:3] for line in lines]


def _expected(case: Case) -> str:
    return _ending(case.rows, case.expected)


def _got(case: Case, outcomes: Outcomes) -> list[str]:
    """What came of its first version, or of one that did not end as expected; the longest time."""
    found = [outcomes[case, fmi] for fmi in case.versions]
    shown = next((outcome for outcome in found if not as_expected(case, outcome)), found[0])
    return [_ending(shown.rows, _short(shown.said)), f"{max(outcome.seconds for outcome in found):.1f}"]


def _ending(rows: int | None, said: str) -> str:
    how = {None: "refused", WHOLE: "whole"}.get(rows, f"{rows} rows")
    return f"*{how}*" + (f" {_cell(said)}" if said else "")


def _short(said: str) -> str:
    text = re.sub(r"\S*/(?=(bad\.fmu|system\.toml))", "", " ".join(said.split()))
    return text if len(text) <= _LONGEST else text[:_LONGEST] + " …"


def _cell(text: str) -> str:
    """The text as it stands in a table."""
    return re.sub(r"([|*_<>`\[\]])", r"\\\1", text)
