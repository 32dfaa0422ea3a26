"""The texts of a turn between the run's memory, which holds their numbers, and a unit."""

from __future__ import annotations

from ...cosim.texts import Texts
from .transfer import Call, Transfer
from .types import STRING


def moving_texts(
    transfer: Transfer, call: Call, memory: memoryview[float], texts: Texts, told: dict[str, str]
) -> Call:
    """Return `call`, the C call of a transfer of Strings, with what moves its texts.

    `told` are the texts that the unit was told by name of the variable; one that it was told nothing about
    has its start. Texts are set where one of them has changed: FMUs may read a file when they get a name.
    """
    return (
        _getting(transfer, call, memory, texts)
        if transfer.gets
        else _setting(transfer, call, memory, texts, told)
    )


def _setting(
    transfer: Transfer, call: Call, memory: memoryview[float], texts: Texts, told: dict[str, str]
) -> Call:
    values, items = transfer.values, transfer.items
    starts = [str(item.variable.default) for item in items]

    def set_texts() -> None:
        changed = False
        for item, start in zip(items, starts, strict=True):
            text = texts.text(memory[item.slot])
            values[item.place] = text.encode()
            changed |= told.get(item.variable.name, start) != text
            told[item.variable.name] = text
        if changed:
            call()

    return set_texts


def _getting(transfer: Transfer, call: Call, memory: memoryview[float], texts: Texts) -> Call:
    values, items = transfer.values, transfer.items

    def get_texts() -> None:
        call()
        for item in items:
            memory[item.slot] = texts.number(str(STRING.from_c(values[item.place])))

    return get_texts
