"""Texts across the socket: each once, and nothing that the child claims is taken unseen."""

from __future__ import annotations

import math
from typing import Any

import pytest

from evcosim.cosim.texts import Texts
from evcosim.master.isolation import framing
from evcosim.master.isolation.texts import TextExchange, is_long, part_of, piece_of
from evcosim.master.unit import UnitError


class Child:
    """The methods of a child's server, and the requests that came."""

    def __init__(self) -> None:
        self.texts, self.requests = Texts(), 0

    def __call__(self, name: str, *arguments: Any) -> Any:
        self.requests += 1
        if name == "learn_text":
            return self.texts.number(*arguments)
        if name == "piece_of_text":
            number, start = arguments
            return piece_of(self.texts.text(number), start) if number < len(self.texts) else ""
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


def test_a_text_that_no_answer_holds_comes_in_pieces() -> None:
    here, child = Texts(), Child()
    longest = "\N{SNOWMAN}" * framing.LONGEST
    assert part_of([longest, "x"]) == [] and is_long(longest) and not is_long("x")
    numbers = [child.texts.number(text) for text in ("before", longest, "after")]
    exchange = TextExchange("a", here, child)
    assert [here.text(exchange.from_child(number)) for number in numbers] == ["before", longest, "after"]
    with pytest.raises(UnitError, match=r"its process wrote 4.0, which no text has"):
        exchange.from_child(4.0)


def test_a_text_without_an_end_is_an_error() -> None:
    def endless(name: str, *_: Any) -> Any:
        return [] if name == "texts_since" else "x" * (1 << 20)

    with pytest.raises(UnitError, match=r"sent a text of more than \d+ characters"):
        TextExchange("a", Texts(), endless).from_child(1.0)


def test_what_no_c_text_holds_is_taken_out() -> None:
    texts = Texts()
    exchange = TextExchange("a", texts, lambda *_: ["a\ud800b\0c"])
    assert texts.text(exchange.from_child(1.0)) == "a?b"


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
