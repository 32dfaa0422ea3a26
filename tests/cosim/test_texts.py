"""The table of texts: each text has one number, from which it comes back."""

from __future__ import annotations

import math
import pickle

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evcosim.cosim.texts import Texts


@given(st.lists(st.text()))
def test_a_text_comes_back_from_its_number(written: list[str]) -> None:
    texts = Texts()
    numbers = [texts.number(text) for text in written]
    assert [texts.text(number) for number in numbers] == written
    assert len(set(numbers)) == len(set(written))
    assert len(texts) == len({"", *written})
    assert [texts.number(text) for text in written] == numbers  # nothing is added twice
    assert pickle.loads(pickle.dumps(texts)).since(0) == texts.since(0)


@pytest.mark.parametrize("number", [-1.0, 2.0, math.inf, math.nan])
def test_a_number_of_no_text_is_an_error(number: float) -> None:
    texts = Texts()
    assert texts.number("a") == 1.0 and texts.text(0.0) == ""
    with pytest.raises(IndexError):
        texts.text(number)
