"""The table of everyday spellings: each means one thing that the SI defines, and says where it is met."""

from __future__ import annotations

import dataclasses

import pytest

from evcosim.cosim.units.definition import _units, by_text
from evcosim.cosim.units.grammar import parse, plain
from evcosim.cosim.units.spellings import EXACT, NO_UNIT, _key, meanings, says_none
from evcosim.cosim.units.symbols import symbol
from evcosim.cosim.units.words import WORDS

ROWS = [*WORDS, *EXACT]


@pytest.mark.parametrize(("spelling", "meaning", "source"), ROWS)
def test_a_spelling_means_what_the_table_says(spelling, meaning, source):
    assert source.strip()
    assert meanings(plain(spelling)) == tuple(part.strip() for part in meaning.split("|"))
    for part in meanings(plain(spelling)):
        ((*powers,),) = parse(part)
        assert all(symbol(name) is not None for name, _ in powers)  # a meaning needs no table of spellings
    unit = by_text(spelling)
    assert unit is not None and len(unit.readings) == len(meaning.split("|"))
    for reading, part in zip(unit.readings, meanings(plain(spelling)), strict=True):
        meant = _units(spelling, parse(part)[0], strict=True)
        assert [dataclasses.replace(reading, also=())] == meant


def test_no_spelling_stands_twice():
    words = [_key(spelling).casefold() for spelling, _, _ in WORDS]
    exact = [_key(spelling) for spelling, _, _ in EXACT]
    assert len(set(words)) == len(words) and len(set(exact)) == len(exact)


def test_texts_that_say_that_there_is_no_unit():
    assert all(by_text(text).bare for text in NO_UNIT)


@pytest.mark.parametrize("text", ["[-]", "[ - ]", "(-)", "[]", "()", "[none]", "(unitless)", " - "])
def test_no_unit_stands_in_brackets_too(text):
    assert says_none(text) and by_text(text).bare


@pytest.mark.parametrize("text", ["[m]", "(m)", "[", "-]", "(-", "[-)"])
def test_brackets_around_something_else_are_no_such_text(text):
    assert not says_none(text)
