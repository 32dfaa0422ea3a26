"""The spellings that are read whatever their case."""

from __future__ import annotations

import pytest

from evcosim.cosim.units.grammar import plain
from evcosim.cosim.units.spellings import EXACT, meanings
from evcosim.cosim.units.words import WORDS


@pytest.mark.parametrize("spelling", [spelling for spelling, _, _ in WORDS])
def test_a_word_is_read_whatever_its_case(spelling):
    for text in (spelling.upper(), spelling.lower(), spelling.title()):
        if not any(text == exact for exact, _, _ in EXACT):
            assert meanings(plain(text)) == meanings(plain(spelling)), text
