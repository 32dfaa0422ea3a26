"""Texts across the socket: each once, and nothing that the child claims is taken unseen."""

from __future__ import annotations

import math
from typing import Any

import pytest

from evcosim.cosim.texts import Texts
from evcosim.master.isolation import framing
from evcosim.master.isolation.texts import TextExchange, part_of
from evcosim.master.unit import UnitError


class Child:
    """The methods of a child's server, and the requests that came."""

    def __init__(self) -> None:
        self.texts, self.requests = Texts(), 0

    def __call__(self, name: str, *arguments: Any) -> Any:
        self.requests += 1
        if name == "learn_text":
            return self.texts.number(*arguments)
        return part_of(self.texts.since(*arguments))


def test_a_text_crosses_once_in_each_direction() -> None:
    here, child = Texts(), Child()
    exchange = TextExchange("a", here, child)
    numbers = [exchange.to_child(here.number(text)) for text in ("x", "y", "x", "")]
    assert [child.texts.text(number) for number in numbers] == ["x", "y", "x", ""]
    assert child.requests == 2
    back = [exchange.from_child(child.texts.number(text)) for text in ("z", "x", "z", "")]
    assert [here.text(number) for number in back] == ["z", "x", "z", ""]
    assert child.requests == 3


def test_more_texts_than_an_answer_holds_come_in_parts() -> None:
    here, child = Texts(), Child()
    long = [str(i) * (framing.LONGEST // 40) for i in range(5)]
    numbers = [child.texts.number(text) for text in long]
    exchange = TextExchange("a", here, child)
    assert here.text(exchange.from_child(numbers[-1])) == long[-1]
    assert child.requests > 1
    with pytest.raises(UnitError, match=r"a text of \d+ characters; an isolated unit passes on \d+"):
        part_of(["x" * framing.LONGEST])


@pytest.mark.parametrize("number", [5.0, -1.0, math.nan, math.inf])
def test_a_number_that_no_text_has_is_an_error(number: float) -> None:
    exchange = TextExchange("a", Texts(), Child())
    with pytest.raises(UnitError, match=r"unit 'a': its process wrote .*, which no text has"):
        exchange.from_child(number)


@pytest.mark.parametrize("answer", [None, "x", {"a": 1}, [1], []])
def test_an_answer_that_is_none_is_an_error(answer: Any) -> None:
    texts = Texts()
    exchange = TextExchange("a", texts, lambda *_: answer)
    with pytest.raises(UnitError):
        exchange.from_child(1.0)
    with pytest.raises(UnitError):
        exchange.to_child(texts.number("x"))
