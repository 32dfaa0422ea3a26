"""Calls of C functions and access to C memory by address, for numba. Pointers and sizes are int64."""

# numba types the arguments of an intrinsic by itself, and has no types for what implements one
# mypy: disable-error-code="no-untyped-def, no-untyped-call, untyped-decorator"

from __future__ import annotations

import ctypes
from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from ..fmi.types import BOOLEAN, BUFFERS, REAL, FmiType

_INT, _LONG = ir.IntType(32), types.int64
_TRUE = ir.Constant(_INT, 1)


def _calling(kinds: list[Any], true_at: int = 0, answer: Any = _INT) -> tuple[Any, Any]:
    """Return signature and code of a call: address, then arguments; int 1 is inserted at `true_at` > 0.

    `answer` is the type of what the C function returns.
    """

    def implement(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        address, *arguments = values
        if true_at:
            arguments.insert(true_at, _TRUE)
        kind = ir.FunctionType(answer, [a.type for a in arguments])
        return builder.call(builder.inttoptr(address, kind.as_pointer()), arguments)

    return (types.int32 if answer is _INT else _LONG)(_LONG, *kinds), implement


@intrinsic
def transfer(typingctx, function, component, references, count, values):
    """Call function(component, references, count, values): get and set of FMI 1.0 and 2.0."""
    return _calling([_LONG] * 4)


@intrinsic
def transfer_3(typingctx, function, component, references, count, values, values_count):
    """Call function(component, references, count, values, values_count): get and set of FMI 3.0."""
    return _calling([_LONG] * 5)


@intrinsic
def do_step(typingctx, function, component, time, step_size):
    """Call function(component, time, step_size, true): the step of FMI 1.0 and 2.0."""
    return _calling([_LONG, types.float64, types.float64], true_at=3)


@intrinsic
def do_step_3(typingctx, function, component, time, step_size, event, ending, early, reached):
    """Call function(component, time, step_size, true, event, ending, early, reached): that of FMI 3.0."""
    return _calling([_LONG, types.float64, types.float64, *[_LONG] * 4], true_at=3)


@intrinsic
def call_0(typingctx, function):
    """Call function()."""
    return _calling([])


@intrinsic
def call_for_word(typingctx, function):
    """Call function() and return what it returns, 8 bytes."""
    return _calling([], answer=ir.IntType(64))


@intrinsic
def call_1(typingctx, function, a):
    """Call function(a)."""
    return _calling([_LONG])


@intrinsic
def call_2(typingctx, function, a, b):
    """Call function(a, b)."""
    return _calling([_LONG] * 2)


@intrinsic
def call_3(typingctx, function, a, b, c):
    """Call function(a, b, c)."""
    return _calling([_LONG] * 3)


@intrinsic
def call_4(typingctx, function, a, b, c, d):
    """Call function(a, b, c, d)."""
    return _calling([_LONG] * 4)


@intrinsic
def call_6(typingctx, function, a, b, c, d, e, f):
    """Call function(a, b, c, d, e, f)."""
    return _calling([_LONG] * 6)


@intrinsic
def pointer(typingctx, address):
    """Return an address as a pointer, of which `numba.carray` makes an array."""

    def implement(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        return builder.inttoptr(values[0], context.get_value_type(types.voidptr))

    return types.voidptr(_LONG), implement


@intrinsic
def peek(typingctx, address, kind):
    """Return the number at an address, of the given type, np.int8 for one."""
    found = kind.instance_type

    def implement(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        pointer = builder.inttoptr(values[0], context.get_value_type(found).as_pointer())
        return builder.load(pointer)

    return found(_LONG, kind), implement


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
    """Return the int64 at a place of the table at an address."""
    return _reading(_LONG)


@intrinsic
def number(typingctx, table, place):
    """Return the float64 at a place of the table at an address."""
    return _reading(types.float64)


@intrinsic
def put_word(typingctx, table, place, value):
    """Write an int64 to a place of the table at an address."""
    return _writing(_LONG)


@intrinsic
def put_number(typingctx, table, place, value):
    """Write a float64 to a place of the table at an address."""
    return _writing(types.float64)


# ---- numbers that two processes share: float64, moved as the 8 bytes that they are


def _place(builder: Any, address: Any, place: Any) -> Any:
    return builder.gep(builder.inttoptr(address, ir.IntType(64).as_pointer()), [place])


@intrinsic
def seen(typingctx, table, place):
    """Return the float64 at a place, with all that was written before it."""

    def implement(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        found = builder.load_atomic(_place(builder, values[0], values[1]), "acquire", 8)
        return builder.bitcast(found, ir.DoubleType())

    return types.float64(_LONG, _LONG), implement


@intrinsic
def publish(typingctx, table, place, value):
    """Write a float64 to a place, after all that was written before it."""

    def implement(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        bits = builder.bitcast(values[2], ir.IntType(64))
        builder.store_atomic(bits, _place(builder, values[0], values[1]), "release", 8)
        return context.get_dummy_value()

    return types.void(_LONG, _LONG, types.float64), implement


@intrinsic
def exchange(typingctx, table, place, value):
    """Write a float64 to a place before anything is read that follows; return the one that stood there."""

    def implement(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        bits = builder.bitcast(values[2], ir.IntType(64))
        found = builder.atomic_rmw("xchg", _place(builder, values[0], values[1]), bits, "seq_cst")
        return builder.bitcast(found, ir.DoubleType())

    return types.float64(_LONG, _LONG, types.float64), implement


@intrinsic
def replace(typingctx, table, place, old, new):
    """Write `new` to a place where `old` stands, as one; return True if it did."""

    def implement(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        old, new = (builder.bitcast(value, ir.IntType(64)) for value in values[2:])
        at = _place(builder, values[0], values[1])
        found = builder.cmpxchg(at, old, new, "seq_cst", "seq_cst")
        return builder.extract_value(found, 1)

    return types.boolean(_LONG, _LONG, types.float64, types.float64), implement


@intrinsic
def fence(typingctx):
    """Let nothing that is read after it be read before what was written."""

    def implement(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        builder.fence("seq_cst")
        return context.get_dummy_value()

    return types.void(), implement


# ---- values of FMI types, by the codes of `fmi.types`


def _choosing(builder: Any, code: Any, made: Callable[[FmiType], Any]) -> Any:
    """Emit what `made` emits for the type of a code, and return its value. All codes stand in BUFFERS."""
    unknown, end = builder.append_basic_block("unknown"), builder.append_basic_block("end")
    switch = builder.switch(code, unknown)
    found = []
    for number, kind in BUFFERS.items():
        block = builder.append_basic_block(kind.name)
        switch.add_case(ir.Constant(code.type, number), block)
        builder.position_at_end(block)
        found.append((made(kind), builder.block))
        builder.branch(end)
    builder.position_at_end(unknown)
    builder.unreachable()
    builder.position_at_end(end)
    value = builder.phi(found[0][0].type)
    for each, block in found:
        value.add_incoming(each, block)
    return value


def _type_in_memory(kind: FmiType) -> Any:
    if kind.kind is REAL:
        return ir.DoubleType() if ctypes.sizeof(kind.c_type) == 8 else ir.FloatType()
    return ir.IntType(8 * ctypes.sizeof(kind.c_type))


def _from_double(builder: Any, kind: FmiType, value: Any) -> Any:
    """Emit the conversion of a double that fits into a type; for a Boolean any nonzero double is true."""
    target = _type_in_memory(kind)
    if kind.kind is BOOLEAN:
        return builder.zext(builder.fcmp_unordered("!=", value, ir.Constant(value.type, 0.0)), target)
    if kind.kind is REAL:
        return value if target == value.type else builder.fptrunc(value, target)
    return (builder.fptosi if kind.low < 0 else builder.fptoui)(value, target)


def _to_double(builder: Any, kind: FmiType, value: Any) -> Any:
    double = ir.DoubleType()
    if kind.kind is BOOLEAN:
        return builder.uitofp(builder.icmp_unsigned("!=", value, ir.Constant(value.type, 0)), double)
    if kind.kind is REAL:
        return value if value.type == double else builder.fpext(value, double)
    return (builder.sitofp if kind.low < 0 else builder.uitofp)(value, double)


@intrinsic
def size_of(typingctx, code):
    """Return the bytes of a value of the type of a code."""

    def implement(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        size = ir.IntType(64)
        return _choosing(builder, values[0], lambda kind: ir.Constant(size, ctypes.sizeof(kind.c_type)))

    return _LONG(_LONG), implement


@intrinsic
def value_at(typingctx, address, code):
    """Return the value at an address, of the type of a code, as a float64."""

    def implement(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        def read(kind: FmiType) -> Any:
            pointer = builder.inttoptr(values[0], _type_in_memory(kind).as_pointer())
            return _to_double(builder, kind, builder.load(pointer))

        return _choosing(builder, values[1], read)

    return types.float64(_LONG, _LONG), implement


@intrinsic
def put_value(typingctx, address, code, value):
    """Write a float64 that fits to an address, as a value of the type of a code; return the type's bytes."""

    def implement(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        def write(kind: FmiType) -> Any:
            number = _from_double(builder, kind, values[2])
            builder.store(number, builder.inttoptr(values[0], number.type.as_pointer()))
            return ir.Constant(ir.IntType(64), ctypes.sizeof(kind.c_type))

        return _choosing(builder, values[1], write)

    return _LONG(_LONG, _LONG, types.float64), implement
