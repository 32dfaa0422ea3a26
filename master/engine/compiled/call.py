"""C functions and C memory by address, for code that numba compiles. Pointers and sizes are int64."""

# numba types the arguments of an intrinsic by itself, and has no types for what implements one
# mypy: disable-error-code="no-untyped-def, no-untyped-call, untyped-decorator"

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic

_INT, _LONG = ir.IntType(32), types.int64
_TRUE = ir.Constant(_INT, 1)


def _calling(kinds: list[Any], true_at: int = 0) -> tuple[Any, Any]:
    """Signature and code of a call: address, then arguments; the int 1 is put in at `true_at`, if not 0."""

    def implement(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        address, *arguments = values
        if true_at:
            arguments.insert(true_at, _TRUE)
        kind = ir.FunctionType(_INT, [a.type for a in arguments])
        return builder.call(builder.inttoptr(address, kind.as_pointer()), arguments)

    return types.int32(_LONG, *kinds), implement


@intrinsic
def transfer(typingctx, function, component, references, count, values):
    """function(component, references, count, values): get and set of FMI 1.0 and 2.0."""
    return _calling([_LONG] * 4)


@intrinsic
def transfer_3(typingctx, function, component, references, count, values):
    """function(component, references, count, values, count): get and set of FMI 3.0."""

    def implement(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        address, *arguments = values
        arguments.append(arguments[2])
        kind = ir.FunctionType(_INT, [a.type for a in arguments])
        return builder.call(builder.inttoptr(address, kind.as_pointer()), arguments)

    return types.int32(*[_LONG] * 5), implement


@intrinsic
def do_step(typingctx, function, component, time, step_size):
    """function(component, time, step_size, true): FMI 1.0 and 2.0."""
    return _calling([_LONG, types.float64, types.float64], true_at=3)


@intrinsic
def do_step_3(typingctx, function, component, time, step_size, event, ending, early, reached):
    """function(component, time, step_size, true, event, ending, early, reached): FMI 3.0."""
    return _calling([_LONG, types.float64, types.float64, *[_LONG] * 4], true_at=3)


@intrinsic
def call_2(typingctx, function, a, b):
    """function(a, b)."""
    return _calling([_LONG] * 2)


@intrinsic
def peek(typingctx, address, kind):
    """The number of a type, np.int8 for one, at an address."""
    found = kind.instance_type

    def implement(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        pointer = builder.inttoptr(values[0], context.get_value_type(found).as_pointer())
        return builder.load(pointer)

    return found(_LONG, kind), implement


@intrinsic
def poke(typingctx, address, value):
    """Put a number at an address, as what type it is."""

    def implement(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        address, number = values
        builder.store(number, builder.inttoptr(address, number.type.as_pointer()))
        return context.get_dummy_value()

    return types.void(_LONG, value), implement


def _reading(kind: Any) -> tuple[Any, Any]:
    def implement(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        pointer = builder.inttoptr(values[0], context.get_value_type(kind).as_pointer())
        return builder.load(builder.gep(pointer, [values[1]]))

    return kind(_LONG, _LONG), implement


def _writing(kind: Any) -> tuple[Any, Any]:
    def implement(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        pointer = builder.inttoptr(values[0], context.get_value_type(kind).as_pointer())
        builder.store(values[2], builder.gep(pointer, [values[1]]))
        return context.get_dummy_value()

    return types.void(_LONG, _LONG, kind), implement


@intrinsic
def word(typingctx, table, place):
    """The int64 at a place of the table at an address."""
    return _reading(_LONG)


@intrinsic
def number(typingctx, table, place):
    """The float64 at a place of the table at an address."""
    return _reading(types.float64)


@intrinsic
def put_word(typingctx, table, place, value):
    """Write an int64."""
    return _writing(_LONG)


@intrinsic
def put_number(typingctx, table, place, value):
    """Write a float64."""
    return _writing(types.float64)
