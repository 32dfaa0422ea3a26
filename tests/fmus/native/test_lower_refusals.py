"""Constructs that have no native form: each is refused with its line, the rule, and what to write instead."""

from __future__ import annotations

import inspect
import re
from pathlib import Path

import pytest

from evcosim.fmus.native.lower import Unsupported, lower
from support.small_model import cases, small

CASES = cases(Path(__file__).with_name("refusals.txt"))


@pytest.mark.parametrize("name", CASES)
def test_a_construct_without_a_native_form_is_refused(name: str) -> None:
    case = CASES[name]
    with pytest.raises(Unsupported) as refused:
        lower(case.model())
    assert str(refused.value).endswith(case.refused), str(refused.value)
    assert re.match(r"small_\w+\.py:\d+: .+: .+; .+", str(refused.value))


def test_a_refusal_names_the_line_of_the_construct() -> None:
    body = "y = 1.0\nz = [\n    u.u,\n    sum((y, y)),\n]\nreturn Small.State(x.x)"
    model = small(body)
    with pytest.raises(Unsupported) as refused:
        lower(model)
    number = int(str(refused.value).split(":")[1])
    source = Path(inspect.getsourcefile(model) or "").read_text()
    assert "sum((y, y))" in source.splitlines()[number - 1]


def test_there_are_more_than_25_kinds() -> None:
    assert len({case.refused for case in CASES.values()}) > 60
