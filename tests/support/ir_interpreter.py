"""A program of typed functions run by Python's own arithmetic: what its C must compute."""

from __future__ import annotations

import cmath
import math
import operator
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


class _Return(Exception):
    pass


class _Break(Exception):
    pass


class _Continue(Exception):
    pass


_OPERATIONS: dict[str, Callable[..., Any]] = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "/": operator.truediv,
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
    "==": operator.eq,
    "!=": operator.ne,
}


def _place(index: int, length: int) -> int:
    (0,) * length
    return range(length)[index]


def _index(kind: str) -> Callable[[int, int], int]:
    def checked(index: int, length: int) -> int:
        if not -length <= index < length:
            raise IndexError(f"{kind} index out of range")
        return range(length)[index]

    return checked


FUNCTIONS: dict[str, Callable[..., Any]] = {
    "py_float_div": operator.truediv,
    "py_float_floordiv": operator.floordiv,
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
    """A program with one set of parameters."""

    def __init__(self, program: ir.Program, parameters: object) -> None:
        self.program = program
        self.functions = {f.name: f for f in program.functions}
        self.tables = {t.name: self._constant(t.value) for t in program.tables}
        names = [name for name, _ in program.parameters.fields]
        self.parameters = {name: _plain(getattr(parameters, name)) for name in names}
        self.derived: dict[str, Any] = {}
        self.memory: dict[str, tuple[Any, Any]] = {}

    def initial(self, u: object) -> dict[str, Any]:
        """Return x_0."""
        return self._call(self.program.initial, [self.parameters, _fields(u)])

    def step(self, x: dict[str, Any], u: object, dt: float) -> dict[str, Any]:
        """Return the state after a step."""
        return self._call(self.program.step, [self.parameters, x, _fields(u), dt])

    def outputs(self, x: dict[str, Any], u: object) -> dict[str, Any]:
        """Return the outputs."""
        more = [_fields(u)] if len(self.functions[self.program.outputs].arguments) == 3 else []
        return self._call(self.program.outputs, [self.parameters, x, *more])

    def notice(self, before: dict[str, Any], after: dict[str, Any], u: object) -> str:
        """Return the sentence."""
        assert self.program.notice is not None
        return self._call(self.program.notice, [self.parameters, before, after, _fields(u)])

    # -- functions -----------------------------------------------------------------------------------------

    def _call(self, name: str, arguments: list[Any]) -> Any:
        function = self.functions[name]
        key = [a for a, local in zip(arguments, function.arguments, strict=True) if a is not self.parameters]
        if function.remembers and name in self.memory and self.memory[name][0] == key:
            return self.memory[name][1]
        env = {local.name: a for local, a in zip(function.arguments, arguments, strict=True)}
        known = {local.name for local in (*function.arguments, *function.locals)}
        assert len(known) == len(function.arguments) + len(function.locals), "two variables of one name"
        result = None
        try:
            self._run(function.body, env)
        except _Return as returned:
            result = returned.args[0]
        assert set(env) <= known, f"{name} uses {set(env) - known}"
        if function.remembers:
            self.memory[name] = (key, result)
        return result

    def _run(self, block: ir.Block, env: dict[str, Any]) -> None:
        for statement in block:
            self._statement(statement, env)

    def _statement(self, s: ir.Statement, env: dict[str, Any]) -> None:
        match s:
            case ir.Assign():
                env[s.target.name] = self._value(s.value, env)
            case ir.SetItem():
                env[s.list.name][self._value(s.index, env)] = self._value(s.value, env)
            case ir.Checked():
                arguments = [self._value(a, env) for a in s.arguments]
                env[s.target.name] = self._checked(s, arguments)
            case ir.Call():
                result = self._call(s.function, [self._argument(a, env) for a in s.arguments])
                if s.target is not None:
                    env[s.target.name] = result
            case ir.Derive():
                if s.name not in self.derived:
                    function = self.program.parameters.derived[s.name][1]
                    self.derived[s.name] = self._call(function, [self._value(s.parameters, env)])
                env[s.target.name] = self.derived[s.name]
            case ir.If():
                self._run(s.then if self._value(s.test, env) else s.otherwise, env)
            case ir.Return():
                raise _Return(None if s.value is None else self._value(s.value, env))
            case ir.Raise():
                raise Failed(s.exception, self._text(s.text, env), s.place.file, s.place.line)
            case ir.Say():
                raise _Return(self._text(s.text, env))
            case ir.For() | ir.While():
                self._loop(s, env)
            case ir.Break():
                raise _Break
            case ir.Continue():
                raise _Continue
            case _:
                raise AssertionError(s)

    @staticmethod
    def _checked(s: ir.Checked, arguments: list[Any]) -> Any:
        try:
            result = function_named(s.function)(*arguments)
        except Exception as error:
            raise Failed(type(error).__name__, str(error), s.place.file, s.place.line) from error
        if s.target.type is INTEGER and not -(2**63) <= result < 2**63:
            raise Failed("OverflowError", "an int beyond 64 bits", s.place.file, s.place.line)
        assert _fits(result, s.target.type), (s, result)
        return result

    def _loop(self, s: ir.For | ir.While, env: dict[str, Any]) -> None:
        if isinstance(s, ir.For):
            turns = iter(range(self._value(s.start, env), self._value(s.stop, env), s.step))
        while True:
            if isinstance(s, ir.For):
                k = next(turns, None)
                if k is None:
                    return
                env[s.local.name] = k
            else:
                self._run(s.before, env)
                if not self._value(s.test, env):
                    return
            try:
                self._run(s.body, env)
            except _Break:
                return
            except _Continue:
                pass

    def _text(self, text: ir.Text, env: dict[str, Any]) -> str:
        return "".join(piece if isinstance(piece, str) else self._shown(piece, env) for piece in text)

    def _shown(self, shown: ir.Shown, env: dict[str, Any]) -> str:
        value = self._value(shown.value, env)
        return repr(value) if shown.spec == "!r" else format(value, shown.spec)

    # -- expressions ---------------------------------------------------------------------------------------

    def _constant(self, e: ir.Literal | ir.Make) -> Any:
        return self._value(e, {})

    def _argument(self, e: ir.Expression, env: dict[str, Any]) -> Any:
        return env[e.name] if isinstance(e, ir.Local) else self._value(e, env)

    def _value(self, e: ir.Expression, env: dict[str, Any]) -> Any:
        value = self._computed(e, env)
        assert _fits(value, e.type), (e, value)
        return list(value) if isinstance(e.type, ListType) else value

    def _computed(self, e: ir.Expression, env: dict[str, Any]) -> Any:
        match e:
            case ir.Literal():
                return e.value
            case ir.Local():
                return env[e.name]
            case ir.TableItem():
                return self.tables[e.name]
            case ir.Field():
                of = self._argument(e.of, env)
                return (
                    getattr(of, {"re": "real", "im": "imag"}[e.name]) if e.of.type is COMPLEX else of[e.name]
                )
            case ir.Item():
                of, index = self._argument(e.of, env), self._value(e.index, env)
                assert 0 <= index < len(of), e
                return of[index]
            case ir.Operation():
                return self._operation(e, env)
            case ir.Apply():
                return function_named(e.function)(*(self._value(a, env) for a in e.arguments))
            case ir.Invoke():
                assert not self.functions[e.function].can_fail
                return self._call(e.function, [self._argument(a, env) for a in e.arguments])
            case ir.Select():
                return self._value(e.then if self._value(e.test, env) else e.otherwise, env)
            case ir.Convert():
                value = self._value(e.value, env)
                return float(value) if e.type is REAL else int(value)
            case ir.Make():
                values = [self._value(item, env) for item in e.items]
                if isinstance(e.type, StructType):
                    names = [name for name, _ in e.type.fields]
                    return dict(zip(names, values, strict=True))
                return values if isinstance(e.type, ListType) else tuple(values)
        raise AssertionError(e)

    def _operation(self, e: ir.Operation, env: dict[str, Any]) -> Any:
        types = {operand.type for operand in e.operands}
        assert len(types) == 1, e
        if e.operator == "and":
            return self._value(e.operands[0], env) and self._value(e.operands[1], env)
        if e.operator == "or":
            return self._value(e.operands[0], env) or self._value(e.operands[1], env)
        values = [self._value(operand, env) for operand in e.operands]
        if e.operator == "not":
            return not values[0]
        if len(values) == 1:
            return -values[0]
        return _OPERATIONS[e.operator](*values)


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
    return {name: _plain(getattr(record, name)) for name in type(record).__dataclass_fields__}  # type: ignore[attr-defined]
