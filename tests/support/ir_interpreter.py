"""A program of typed functions run by Python's own arithmetic: what its C must compute."""

from __future__ import annotations

import cmath
import functools
import math
import operator
import re
from collections.abc import Callable
from typing import Any

from evcosim.fmus.native import ir
from evcosim.fmus.native.values import (
    BOOLEAN,
    COMPLEX,
    INTEGER,
    REAL,
    ArrayType,
    EnumType,
    ListType,
    StructType,
)


class Failed(Exception):
    """An exception of the model: its class's name, its text, file and line."""


def _index(kind: str) -> Callable[[int, int], int]:
    def checked(index: int, length: int) -> int:
        if not -length <= index < length:
            raise IndexError(f"{kind} index out of range")
        return range(length)[index]

    return checked


FUNCTIONS: dict[str, Callable[..., Any]] = {
    "py_float_div": operator.truediv,
    "py_float_floordiv": operator.floordiv,
    "py_float_divmod_floordiv": lambda a, b: divmod(a, b)[0],
    "py_float_mod": operator.mod,
    "py_float_pow": operator.pow,
    "py_float_max": max,
    "py_float_min": min,
    "py_float_abs": abs,
    "py_float_int": int,
    "py_float_round": round,
    "py_int_add": operator.add,
    "py_int_sub": operator.sub,
    "py_int_mul": operator.mul,
    "py_int_neg": operator.neg,
    "py_int_abs": abs,
    "py_int_floordiv": operator.floordiv,
    "py_int_mod": operator.mod,
    "py_int_pow": operator.pow,
    "py_int_div": operator.truediv,
    "py_int_lshift": operator.lshift,
    "py_int_rshift": operator.rshift,
    "py_int_and": operator.and_,
    "py_int_or": operator.or_,
    "py_int_xor": operator.xor,
    "py_int_invert": operator.invert,
    "py_int_max": max,
    "py_int_min": min,
    "py_int_eq_float": operator.eq,
    "py_int_lt_float": operator.lt,
    "py_int_le_float": operator.le,
    "py_int_gt_float": operator.gt,
    "py_int_ge_float": operator.ge,
    "py_list_index": _index("list"),
    "py_list_set_index": _index("list assignment"),
    "py_tuple_index": _index("tuple"),
    "py_complex_of": complex,
    "py_complex_add": operator.add,
    "py_complex_sub": operator.sub,
    "py_complex_mul": operator.mul,
    "py_complex_div": operator.truediv,
    "py_complex_neg": operator.neg,
    "py_complex_pow": operator.pow,
    "py_complex_abs": abs,
    "py_complex_conjugate": lambda z: z.conjugate(),
    "py_math_hypot2": math.hypot,
    "py_math_hypot3": math.hypot,
}


def function_named(name: str) -> Callable[..., Any]:
    """Return a function of python_arithmetic.h as Python has it."""
    if name in FUNCTIONS:
        return FUNCTIONS[name]
    kind, _, of = name.removeprefix("py_").partition("_")
    found: Callable[..., Any] = getattr({"math": math, "cmath": cmath}[kind], of)
    return found


class Interpreter:
    """A program with one set of parameters, each of its functions as one of Python."""

    def __init__(self, program: ir.Program, parameters: object) -> None:
        self.program = program
        self.parameters = {name: _plain(getattr(parameters, name)) for name, _ in program.parameters.fields}
        self.derived: dict[str, Any] = {}
        self.memory: dict[str, tuple[Any, Any]] = {}
        self.scope = dict(_compiled(program))
        self.scope.update(derive=self._derive, remembered=self._remembered)
        for name, function in _code(program).items():
            exec(function, self.scope)
            assert callable(self.scope[name])

    def initial(self, u: object) -> Any:
        """Return x_0."""
        return self._call(self.program.initial, self.parameters, _fields(u))

    def step(self, x: dict[str, Any], u: object, dt: float) -> Any:
        """Return the state after a step."""
        return self._call(self.program.step, self.parameters, x, _fields(u), dt)

    def outputs(self, x: dict[str, Any], u: object) -> Any:
        """Return the outputs."""
        function = next(f for f in self.program.functions if f.name == self.program.outputs)
        more = [_fields(u)] if len(function.arguments) == 3 else []
        return self._call(self.program.outputs, self.parameters, x, *more)

    def notice(self, before: dict[str, Any], after: dict[str, Any], u: object) -> Any:
        """Return the sentence."""
        assert self.program.notice is not None
        return self._call(self.program.notice, self.parameters, before, after, _fields(u))

    def _call(self, name: str, *arguments: Any) -> Any:
        function = next(f for f in self.program.functions if f.name == name)
        result = self.scope[f"f_{name}"](*arguments)
        assert function.returns is None or _fits(result, function.returns), (name, result)
        return result

    def _derive(self, p: Any, name: str) -> Any:
        type_, function = self.program.parameters.derived[name]
        if name not in self.derived:
            self.derived[name] = self.scope[f"f_{function}"](p)
            assert _fits(self.derived[name], type_), name
        return self.derived[name]

    def _remembered(self, name: str, *arguments: Any) -> Any:
        key = [a for a in arguments if a is not self.parameters]
        if name not in self.memory or self.memory[name][0] != key:
            self.memory[name] = (key, self.scope[f"again_{name}"](*arguments))
        return self.memory[name][1]


@functools.cache
def _code(program: ir.Program) -> dict[str, Any]:
    """Return the functions of a program as Python's code."""
    return {f"f_{f.name}": compile(_function(f), f.name, "exec") for f in program.functions}


@functools.cache
def _compiled(program: ir.Program) -> dict[str, Any]:
    """Return what the functions of a program need: tables, and functions of python_arithmetic.h."""
    scope: dict[str, Any] = {f"t_{t.name}": eval(_e(t.value), {}) for t in program.tables}
    names = set(re.findall(r"\b(py_\w+)\(", "".join(_function(f) for f in program.functions)))
    checked = {re.sub("^py_", "checked_", name): _checked(function_named(name)) for name in names}
    return (
        scope
        | checked
        | {name: function_named(name) for name in names}
        | {"Failed": Failed, "shown": _shown, "at": _at}
    )


def _checked(function: Callable[..., Any]) -> Callable[..., Any]:
    def call(file: str, line: int, is_integer: bool, *arguments: Any) -> Any:
        try:
            result = function(*arguments)
        except Exception as error:
            raise Failed(type(error).__name__, str(error), file, line) from error
        if is_integer and not -(2**63) <= result < 2**63:
            raise Failed("OverflowError", "an int beyond 64 bits", file, line)
        assert type(result) in (float, int, complex)
        return result

    return call


def _at(of: Any, index: int) -> Any:
    assert 0 <= index < len(of), "an index that was not checked"
    return of[index]


def _shown(value: Any, spec: str) -> str:
    return repr(value) if spec == "!r" else format(value, spec)


# -- as Python -----------------------------------------------------------------------------------------------


def _function(f: ir.Function) -> str:
    arguments = ", ".join(f"v_{a.name}" for a in f.arguments)
    name = f"again_{f.name}" if f.remembers else f"f_{f.name}"
    lines = [f"def {name}({arguments}):", *_block(f.body)]
    if f.remembers:
        lines += [f"def f_{f.name}({arguments}):", f"    return remembered({f.name!r}, {arguments})"]
    return "\n".join(lines)


def _block(block: ir.Block) -> list[str]:
    return [f"    {line}" for s in block for line in _statement(s)] or ["    pass"]


def _statement(s: ir.Statement) -> list[str]:
    match s:
        case ir.Assign():
            copied = f"list({_e(s.value)})" if isinstance(s.target.type, ListType) else _e(s.value)
            return [f"v_{s.target.name} = {copied}"]
        case ir.SetItem():
            return [f"v_{s.list.name}[{_e(s.index)}] = {_e(s.value)}"]
        case ir.Checked():
            place = f"{s.place.file!r}, {s.place.line}, {s.target.type is INTEGER}"
            name = s.function.replace("py_", "checked_", 1)
            # py_ stands in the text so that the name is found
            return [f"v_{s.target.name} = {name}({place}, {_all(s.arguments)})  # {s.function}("]
        case ir.Call():
            target = "" if s.target is None else f"v_{s.target.name} = "
            return [f"{target}f_{s.function}({_all(s.arguments)})"]
        case ir.Derive():
            return [f"v_{s.target.name} = derive({_e(s.parameters)}, {s.name!r})"]
        case ir.If():
            return [f"if {_e(s.test)}:", *_block(s.then), "else:", *_block(s.otherwise)]
        case ir.For():
            turns = f"range({_e(s.start)}, {_e(s.stop)}, {s.step})"
            return [f"for v_{s.local.name} in {turns}:", *_block(s.body)]
        case ir.While():
            test = [f"    {line}" for before in s.before for line in _statement(before)]
            return ["while True:", *test, f"    if not {_e(s.test)}: break", *_block(s.body)]
        case ir.Return():
            return ["return" if s.value is None else f"return {_e(s.value)}"]
        case ir.Raise():
            place = f"{s.place.file!r}, {s.place.line}"
            return [f"raise Failed({s.exception!r}, {_text(s.text)}, {place})"]
        case ir.Say():
            return [f"return {_text(s.text)}"]
        case ir.Break():
            return ["break"]
        case ir.Continue():
            return ["continue"]
    raise AssertionError(s)


def _text(text: ir.Text) -> str:
    pieces = (repr(p) if isinstance(p, str) else f"shown({_e(p.value)}, {p.spec!r})" for p in text)
    return " + ".join(pieces) or "''"


def _all(arguments: tuple[ir.Expression, ...]) -> str:
    return ", ".join(_e(a) for a in arguments)


def _e(e: ir.Expression) -> str:
    """Return an expression as Python."""
    match e:
        case ir.Literal():
            return f"float({str(e.value)!r})" if isinstance(e.value, float) else repr(e.value)
        case ir.Local():
            return f"v_{e.name}"
        case ir.TableItem():
            return f"t_{e.name}"
        case ir.Field():
            name = {"re": "real", "im": "imag"}.get(e.name)
            return f"{_e(e.of)}.{name}" if e.of.type is COMPLEX else f"{_e(e.of)}[{e.name!r}]"
        case ir.Item():
            return f"at({_e(e.of)}, {_e(e.index)})"
        case ir.Length():
            return f"len({_e(e.of)})"
        case ir.Operation():
            if len(e.operands) == 1:
                return f"({e.operator} {_e(e.operands[0])})"
            return f"({_e(e.operands[0])} {e.operator} {_e(e.operands[1])})"
        case ir.Apply():
            return f"{e.function}({_all(e.arguments)})"
        case ir.Invoke():
            return f"f_{e.function}({_all(e.arguments)})"
        case ir.Select():
            return f"({_e(e.then)} if {_e(e.test)} else {_e(e.otherwise)})"
        case ir.Convert():
            return f"{'float' if e.type is REAL else 'int'}({_e(e.value)})"
        case ir.Make():
            items = [_e(item) for item in e.items]
            if isinstance(e.type, StructType):
                names = [name for name, _ in e.type.fields]
                return "{" + ", ".join(f"{n!r}: {x}" for n, x in zip(names, items, strict=True)) + "}"
            inner = ", ".join(items)
            return f"[{inner}]" if isinstance(e.type, ListType) else f"({inner},)"
    raise AssertionError(e)


def _fits(value: Any, type_: Any) -> bool:
    """Return True if a value is one of this type, in all its parts."""
    if type_ is REAL:
        return type(value) is float
    if type_ is BOOLEAN:
        return type(value) is bool
    if type_ is COMPLEX:
        return type(value) is complex
    if type_ is INTEGER or isinstance(type_, EnumType):
        return type(value) is int and -(2**63) <= value < 2**63
    if isinstance(type_, ArrayType):
        return len(value) == type_.length and all(_fits(item, type_.item) for item in value)
    if isinstance(type_, ListType):
        return len(value) <= type_.capacity and all(_fits(item, type_.item) for item in value)
    if isinstance(type_, StructType):
        return list(value) == [n for n, _ in type_.fields] and all(
            _fits(value[n], t) for n, t in type_.fields
        )
    return True


def _plain(value: Any) -> Any:
    return int(value) if isinstance(value, int) and not isinstance(value, bool) else value


def _fields(record: object) -> dict[str, Any]:
    if isinstance(record, dict):
        return record
    return {name: _plain(getattr(record, name)) for name in type(record).__dataclass_fields__}  # type: ignore[attr-defined] # a record
