"""Options that take one value are given once; those that collect values are given again and again."""

from __future__ import annotations

from typing import Any

import pytest

from evcosim.master.cli.app import command
from evcosim.master.cli.once import OnceCommand, takes_one_value


def verbs(group: Any) -> list[Any]:
    """Return the verbs of a group, and those of the groups in it."""
    found = group.commands.values()
    return [verb for each in found for verb in (verbs(each) if hasattr(each, "commands") else [each])]


OPTIONS = [
    pytest.param(verb, option, id=f"{verb.name} {option.opts[-1]}")
    for verb in verbs(command())
    for option in verb.params
    if option.param_type_name == "option" and not option.is_flag
]


@pytest.mark.parametrize(("verb", "option"), OPTIONS)
def test_an_option_is_given_once_or_collects_its_values(verb: Any, option: Any) -> None:
    assert isinstance(verb, OnceCommand)
    spellings = [option.opts[0], option.opts[-1]]  # -o and --output are one
    line = [f"{spellings[0]}=first" if spellings[0].startswith("--") else f"{spellings[0]}first"]
    context = verb.make_context(verb.name, [*line, "x", "y"], resilient_parsing=True)
    if not takes_one_value(option):
        verb._check_once(context, [*line, spellings[1], "second", "x"])
        return
    verb._check_once(context, [*line, "x"])
    with pytest.raises(Exception, match=r"takes one value") as refusal:
        verb._check_once(context, [*line, "x", spellings[1], "second"])
    name = next(text for text in option.opts if text.startswith("--"))
    assert str(refusal.value.message) == (  # type: ignore[attr-defined] # of a usage error
        f"{name} second: it is given already: {name} first; it takes one value"
    )


def test_those_that_collect_are_known():
    collect = {option.opts[-1] for verb in verbs(command()) for option in verb.params if option.multiple}
    assert {"--set", "--start", "--fmu", "--swap", "--input", "--record", "--signals"} <= collect
    assert not {"--output", "--stop-time", "--scenario", "--tolerance"} & collect


@pytest.mark.parametrize(
    "line",
    [
        ("run", "scooter", "--stop-time", "1", "--stop-time", "2"),
        ("run", "scooter", "-o", "a", "--output=b"),
        ("compare", "a", "b", "--tolerance", "1", "--tolerance", "1"),
        ("check", "scooter", "--engine", "python", "--try", "1s", "--try", "2s"),
    ],
)
def test_a_second_value_ends_the_command_before_anything_is_done(line, evcosim, tmp_path):
    answer = evcosim(*line)
    assert answer.code == 2
    assert "takes one value" in answer.err or "No such option" in answer.err
    assert list(tmp_path.iterdir()) == []


def test_a_flag_may_be_repeated_and_a_value_may_look_like_an_option(evcosim):
    assert evcosim("list", "--json", "--json").code == 0
    answer = evcosim("compare", "--stop-time", "--relative", "1", "--relative", "2")
    assert answer.code == 2
