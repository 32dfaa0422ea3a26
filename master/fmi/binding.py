"""The transfers of an instance over the memory of a run, and the calls that do them.

The arguments of each C call are made once: value references, a count, and a buffer, which is a part of the
memory itself where the values are doubles and stand in the memory in order.
"""

from __future__ import annotations

import ctypes
from collections.abc import Iterable
from typing import TYPE_CHECKING, NoReturn

import numpy as np
from numpy.typing import NDArray

from ...cosim.interface import VariableInfo
from ...cosim.plan.unit_plan import SlotGroup
from ...cosim.texts import Texts
from ..unit import floats
from .text_transfer import moving_texts
from .transfer import Call, Copy, Item, Transfer, copying, moving, one_after_the_other
from .types import STRING, FmiType

if TYPE_CHECKING:
    from .instance import Instance

Place = tuple[int, VariableInfo]
"""A slot of the memory, and the variable whose value it holds."""


def _as_it_is(v: VariableInfo) -> bool:
    """Return True where the unit's own value is that of the system."""
    return not v.inverted and v.scaling.identity


class Binding:
    """Makes the transfers of an instance. `memory`, shape (size,), outlives them all."""

    def __init__(self, instance: Instance, memory: NDArray[np.float64], texts: Texts | None = None) -> None:
        self._instance, self._memory, self._texts = instance, memory, texts or Texts()
        self.view = floats(memory)

    def transfers(self, direction: str, places: Iterable[Place]) -> list[Transfer]:
        """Return what moves values between the unit and their slots; `direction` is "Get" or "Set".

        There is one for each function: what is one type in a plan may be several in FMI 3.0.
        """
        groups: dict[str, list[Place]] = {}
        types: dict[str, FmiType] = {}
        for slot, variable in places:
            kind = self._instance.type_of(variable)
            name = f"{self._instance.fmi}{direction}{kind.accessed}"
            groups.setdefault(name, []).append((slot, variable))
            types.setdefault(name, kind)
        return [self._transfer(name, types[name], members) for name, members in groups.items()]

    def _transfer(self, name: str, kind: FmiType, places: list[Place]) -> Transfer:
        n, first = len(places), places[0][0]
        references = (ctypes.c_uint * n)(*(self._instance.reference(v.name) for _, v in places))
        in_order = all(slot == first + i and _as_it_is(v) for i, (slot, v) in enumerate(places))
        in_place = kind.c_type is ctypes.c_double and in_order
        buffer = kind.c_type * n
        gets = "Get" in name
        maps = [v.from_fmu if gets else v.to_fmu for _, v in places]
        items = [
            Item(i, slot, map_.scale, map_.offset or -0.0, v)
            for i, ((slot, v), map_) in enumerate(zip(places, maps, strict=True))
        ]
        return Transfer(
            function=name,
            pointer=self._instance.function(name),
            references=references,
            values=buffer.from_buffer(self._memory[first : first + n].data) if in_place else buffer(),
            type=kind,
            gets=gets,
            items=() if in_place else tuple(items),
        )

    def feedthrough(self, group: SlotGroup) -> list[Transfer | Copy]:
        """Return what shows the outputs of a continuous group that depend on inputs at the same instant."""
        if not group.feedthrough:
            return []
        through = enumerate(group.variables[: group.feedthrough], group.latest)
        return [*self.transfers("Get", through), Copy(group.latest, group.slot, group.feedthrough)]

    def calls(self, transfers: Iterable[Transfer | Copy]) -> Call:
        """Return one call that does all of these. It raises UnitError as the unit reports or refuses."""
        return one_after_the_other(*(self._acting(transfer) for transfer in transfers))

    def _acting(self, transfer: Transfer | Copy) -> Call:
        if isinstance(transfer, Copy):
            return copying(self.view, transfer)

        def refuse(place: int, value: float) -> NoReturn:
            self._instance.refuse(transfer, place, value)

        if transfer.type.kind is STRING:
            told = self._instance.told_texts
            return moving_texts(transfer, self._caller(transfer), self.view, self._texts, told)
        return moving(transfer, self._caller(transfer), self.view, refuse)

    def _caller(self, transfer: Transfer) -> Call:
        function, judge = transfer.pointer, self._instance.judge_transfer
        references, values = transfer.references, transfer.values
        arguments = self._instance.arguments(references, len(references), values)

        def call() -> None:
            status = function(*arguments)
            if status:
                judge(transfer, status)

        return call
