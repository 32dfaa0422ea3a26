"""The tables of the frame path as types of numba: an address, and what `Wire` says of it.

As arrays in a tuple each table is ten values, and a function of all of them hundreds, which take LLVM half a
minute to follow. Here a `Wire` is one address, that of a table of addresses and shapes, and each access reads
from there what it needs: three words that do not change while the machine code runs. Places are not looked
at: a negative one, or one beyond the table, is an access to other memory.
"""

# numba has no types
# mypy: disable-error-code="no-untyped-call, no-untyped-def, untyped-decorator"

from __future__ import annotations

import operator
from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.typing.templates import AbstractTemplate, AttributeTemplate, infer_getattr, infer_global
from numba.core.typing.templates import signature as signature_of
from numba.extending import intrinsic, lower_builtin, lower_getattr_generic, models, register_model

from ....cosim.can.wire.tables import Wire
from .addresses import WORDS

_INT = ir.IntType(64)
_PLACES = types.UniTuple(types.int64, 2)


class TableType(types.Type):  # type: ignore[misc] # numba's
    """A table of numbers of a kind, of one or two dimensions."""

    def __init__(self, kind: Any) -> None:
        self.kind = kind
        super().__init__(name=f"Table({kind})")


class WireType(types.Type):  # type: ignore[misc] # numba's
    """All tables, by the address of their addresses and shapes."""

    def __init__(self) -> None:
        super().__init__(name="Wire")


WIRE = WireType()
INTS = TableType(types.int64)
_REALS = TableType(types.float64)
TABLES: dict[str, TableType] = {
    **dict.fromkeys((name for name in Wire._fields if name != "helper"), INTS),
    **dict.fromkeys(("reals", "maps", "chances", "fallback", "memory", "odds", "double"), _REALS),
    "single": TableType(types.float32),
    "single_bits": TableType(types.int32),
}
"""The types of tables by their names in `Wire`."""
BY_ANNOTATION: dict[str, Any] = {
    "int": types.int64,
    "float": types.float64,
    "bool": types.boolean,
    "None": types.none,
    "Wire": WIRE,
    "Any": INTS,
    "Sequence[int]": INTS,
    "tuple[int, int]": types.UniTuple(types.int64, 2),
    "tuple[int, int, int]": types.UniTuple(types.int64, 3),
    "tuple[int, int, int, int]": types.UniTuple(types.int64, 4),
}
"""The types that annotations of functions of the frame path stand for: `Any` is a table of integers."""


@intrinsic
def wire_at(typingctx, address):
    """Return the tables whose addresses and shapes stand at an address."""

    def implement(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        return values[0]

    return WIRE(types.int64), implement


# ---- typing


@infer_getattr
class _TablesOfWire(AttributeTemplate):  # type: ignore[misc] # numba's
    key = WireType

    def generic_resolve(self, wire: WireType, name: str) -> Any:
        return types.int64 if name == "helper" else TABLES.get(name)


@infer_global(operator.getitem)
class _GetItem(AbstractTemplate):  # type: ignore[misc] # numba's
    def generic(self, args: Any, kws: Any) -> Any:
        if isinstance(args[0], TableType):
            return signature_of(args[0].kind, args[0], _place_type(args[1]))
        return None


@infer_global(operator.setitem)
class _SetItem(AbstractTemplate):  # type: ignore[misc] # numba's
    def generic(self, args: Any, kws: Any) -> Any:
        if isinstance(args[0], TableType):
            return signature_of(types.none, args[0], _place_type(args[1]), args[0].kind)
        return None


@infer_global(len)
class _Len(AbstractTemplate):  # type: ignore[misc] # numba's
    def generic(self, args: Any, kws: Any) -> Any:
        return signature_of(types.int64, args[0]) if isinstance(args[0], TableType) else None


def _place_type(given: Any) -> Any:
    """Return the type to which that of a place is converted: two integers, or one."""
    return _PLACES if isinstance(given, types.BaseTuple) else types.int64


# ---- code


@register_model(WireType)
class _WireModel(models.PrimitiveModel):  # type: ignore[misc] # numba's
    def __init__(self, manager: Any, kind: Any) -> None:
        super().__init__(manager, kind, _INT)


@register_model(TableType)
class _TableModel(models.StructModel):  # type: ignore[misc] # numba's
    def __init__(self, manager: Any, kind: Any) -> None:
        members = [("data", types.int64), ("rows", types.int64), ("columns", types.int64)]
        super().__init__(manager, kind, members)


@lower_getattr_generic(WireType)
def _get_table(context, builder, kind, wire, name):
    first = WORDS * Wire._fields.index(name)
    if name == "helper":
        return _constant_word(builder, wire, first)
    table = cgutils.create_struct_proxy(TABLES[name])(context, builder)
    table.data, table.rows, table.columns = (_constant_word(builder, wire, first + i) for i in range(WORDS))
    return table._getvalue()


def _constant_word(builder: Any, address: Any, place: int) -> Any:
    """Emit the reading of a word that does not change, which LLVM may read once or often."""
    pointer = builder.gep(builder.inttoptr(address, _INT.as_pointer()), [ir.Constant(_INT, place)])
    word = builder.load(pointer)
    word.set_metadata("invariant.load", builder.module.add_metadata([]))
    return word


@lower_builtin(operator.getitem, TableType, types.Any)
def _get_item(context, builder, signature, values):
    return builder.load(_pointer(context, builder, signature, values))


@lower_builtin(operator.setitem, TableType, types.Any, types.Any)
def _set_item(context, builder, signature, values):
    builder.store(values[2], _pointer(context, builder, signature, values))
    return context.get_dummy_value()


@lower_builtin(len, TableType)
def _rows(context, builder, signature, values):
    return cgutils.create_struct_proxy(signature.args[0])(context, builder, value=values[0]).rows


def _pointer(context: Any, builder: Any, signature: Any, values: Any) -> Any:
    """Emit the pointer to a place of a table."""
    kind, place = signature.args[0], values[1]
    table = cgutils.create_struct_proxy(kind)(context, builder, value=values[0])
    if signature.args[1] == _PLACES:
        row, column = cgutils.unpack_tuple(builder, place)
        place = builder.add(builder.mul(row, table.columns), column)
    data = builder.inttoptr(table.data, context.get_value_type(kind.kind).as_pointer())
    return builder.gep(data, [place])
