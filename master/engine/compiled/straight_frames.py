"""The frame path of known messages as straight-line code: its functions, written out for what is known.

The functions of `cosim.can.wire` are read as they stand. What the tables say of a message's layout,
protection and receivers is known when the code is written, so that loops over it are written out, its
branches decided, and the functions that it calls put in place; raw values, counters and statuses are numbers
of the code. What cannot be written out so stays with the kernel's function of the frame path.
"""

from __future__ import annotations

import ast
import functools
import inspect
from collections.abc import Callable
from types import FunctionType, ModuleType

from ....cosim.can.wire import medium, tables
from .known_frames import Frames
from .llvm_text import DOUBLE, INT, WORD
from .straight_cells import Cells
from .straight_numbers import BIT, Arithmetic, Either, Number, UnknownForm
from .straight_ways import AllTables, Table, Value, joined

_MOST_ROUNDS = 64  # of a loop whose end is a number of the code

State = tuple[dict[str, Value], dict[tuple[str, int], Either], dict[str, Number]]


class _Call:
    """A function under way: its variables, and where it is left with what."""

    def __init__(self, scope: dict[str, object], variables: dict[str, Value], end: str) -> None:
        self.scope, self.variables, self.end = scope, variables, end
        self.left: list[tuple[str, Value, State]] = []


class FramePath:
    """Writes actions of the frame path. `wire` is the name of the address of the tables' addresses."""

    def __init__(self, numbers: Arithmetic, frames: Frames, wire: str) -> None:
        self._n, self._f, self._wire = numbers, numbers.f, wire
        self._cells = Cells(numbers, frames, wire)
        self._calls: list[_Call] = []
        self._alive = True

    def act(self, what: int, i: int, k: str) -> Either:
        """Write an action on row i in step k; return what it returns. Raises UnknownForm."""
        self._cells.known, self._n.computed = {}, {}
        given: list[Value] = [AllTables(), what, i, Number(k, WORD)]
        entry = medium.act
        assert isinstance(entry, FunctionType)  # it is written in Python
        found = self._called(entry, given)
        if found is None or isinstance(found, tuple | Table | AllTables):
            raise UnknownForm("no number comes back")
        return found

    # ---- functions

    def _called(self, function: FunctionType, given: list[Value]) -> Value:
        """Return what a function returns, written in place of its call."""
        definition, scope = _definition(function), function.__globals__
        if len(self._calls) > 12:
            raise UnknownForm("functions that call each other")
        names = [argument.arg for argument in definition.args.args]
        call = _Call(scope, dict(zip(names, given, strict=True)), self._f.label())
        self._calls.append(call)
        self._block(definition.body)
        if self._alive:
            self._leave(None)
        self._calls.pop()
        self._f.place(call.end)
        self._alive = bool(call.left)
        if not call.left:
            return None
        found = joined(self._f, [(block, value) for block, value, _ in call.left])
        self._meet([(block, state) for block, _, state in call.left], with_variables=False)
        return found

    def _leave(self, value: Value) -> None:
        call = self._calls[-1]
        call.left.append((self._f.block, value, self._state()))
        self._f.do(f"br label %{call.end}")
        self._alive = False

    # ---- what is known at a place

    def _state(self) -> State:
        return dict(self._calls[-1].variables), dict(self._cells.known), dict(self._n.computed)

    def _set(self, state: State) -> None:
        self._calls[-1].variables, self._cells.known, self._n.computed = (dict(part) for part in state)  # type: ignore[assignment] # each of its kind

    def _meet(self, ways: list[tuple[str, State]], with_variables: bool = True) -> None:
        """Go on with what is known on all ways that lead here."""
        first = ways[0][1]
        cells = {
            key: joined(self._f, [(block, state[1][key]) for block, state in ways])
            for key in first[1]
            if all(key in state[1] for _, state in ways)
        }
        if with_variables:
            self._calls[-1].variables = {
                key: joined(self._f, [(block, state[0][key]) for block, state in ways])
                for key in first[0]
                if all(key in state[0] for _, state in ways)
            }
        self._cells.known = cells  # type: ignore[assignment] # numbers alone stand in tables
        self._n.computed = {
            text: value for text, value in first[2].items() if all(s[2].get(text) == value for _, s in ways)
        }

    # ---- statements

    def _block(self, statements: list[ast.stmt]) -> None:
        for statement in statements:
            if not self._alive:
                return
            self._statement(statement)

    def _statement(self, statement: ast.stmt) -> None:
        match statement:
            case ast.Expr(ast.Constant()):
                pass
            case ast.Expr(value):
                self._value(value)
            case ast.Assign(targets, value):
                found = self._value(value)
                for target in targets:
                    self._assign(target, found)
            case ast.AnnAssign(target, _, ast.expr() as value):
                self._assign(target, self._value(value))
            case ast.AugAssign(target, operator, value):
                before = self._number(self._value(target))
                self._assign(target, self._n.operate(operator, before, self._number(self._value(value))))
            case ast.Return(value):
                self._leave(None if value is None else self._value(value))
            case ast.If(test, body, orelse):
                self._branch(test, body, orelse)
            case ast.For(target, ast.Call(ast.Name("range"), bounds), body, []):
                places = [self._number(self._value(bound)) for bound in bounds]
                if any(isinstance(place, Number) for place in places):
                    raise UnknownForm("a loop of a number of rounds that is not known")
                for j in range(*(int(place) for place in places)):  # type: ignore[arg-type] # none is unknown
                    if self._alive:
                        self._assign(target, j)
                        self._block(body)
            case ast.While(test, body, []):
                self._repeat(test, body, _MOST_ROUNDS)
            case _:
                raise UnknownForm(type(statement).__name__)

    def _branch(self, test: ast.expr, body: list[ast.stmt], other: list[ast.stmt]) -> None:
        condition = self._truth(test)
        if not isinstance(condition, Number):
            self._block(body if condition else other)
            return
        self._either(condition, lambda: self._block(body), lambda: self._block(other))

    def _repeat(self, test: ast.expr, body: list[ast.stmt], rounds: int) -> None:
        """Write a loop out: a round within the other, until it is known to be the last."""
        condition = self._truth(test)
        if condition is False or rounds == 0:
            if rounds == 0:
                raise UnknownForm("a loop without a known end")
            return

        def again() -> None:
            self._block(body)
            if self._alive:
                self._repeat(test, body, rounds - 1)

        if isinstance(condition, Number):
            self._either(condition, again, lambda: None)
        else:
            again()

    def _either(self, condition: Number, then: Callable[[], None], other: Callable[[], None]) -> None:
        """Write two ways, and go on where they meet."""
        f = self._f
        labels = f.label(), f.label()
        f.split(self._n.text(condition, BIT), *labels)
        end, ways = f.label(), []
        state = self._state()
        for label, way in zip(labels, (then, other), strict=True):
            f.place(label)
            self._set(state)
            self._alive = True
            way()
            if self._alive:
                ways.append((f.block, self._state()))
                f.do(f"br label %{end}")
        self._alive = bool(ways)
        if ways:
            f.place(end)
            self._meet(ways)

    def _assign(self, target: ast.expr, value: Value) -> None:
        match target:
            case ast.Name(name):
                self._calls[-1].variables[name] = value
            case ast.Tuple(targets):
                if not isinstance(value, tuple) or len(value) != len(targets):
                    raise UnknownForm("parts of what is no tuple")
                for each, part in zip(targets, value, strict=True):
                    self._assign(each, part)
            case ast.Subscript(table, place):
                found = self._value(table)
                if not isinstance(found, Table):
                    raise UnknownForm("a cell of what is no table")
                self._cells.write(found.name, self._numbers_of(place), self._number(value))
            case _:
                raise UnknownForm("an assignment to something else")

    # ---- expressions

    def _truth(self, expression: ast.expr) -> Either:
        value = self._number(self._value(expression))
        if not isinstance(value, Number):
            return bool(value)
        if value.kind == DOUBLE:
            raise UnknownForm("the truth of a real number")
        return value if value.kind == BIT else self._n.compare(ast.NotEq(), value, 0)

    def _number(self, value: Value) -> Either:
        if not isinstance(value, int | float | Number):
            raise UnknownForm(f"{type(value).__name__} where a number is needed")
        return value

    def _numbers_of(self, place: ast.expr) -> list[Either]:
        """Return row and column of a place, or the place in a table of one dimension."""
        parts = place.elts if isinstance(place, ast.Tuple) else [place]
        return [self._number(self._value(part)) for part in parts]

    def _value(self, expression: ast.expr) -> Value:
        match expression:
            case ast.Constant(value):
                return value if isinstance(value, int | float) else None
            case ast.Name(name):
                return self._named(name)
            case ast.Attribute(ast.Name("T"), name):
                return getattr(tables, name)  # type: ignore[no-any-return] # a number
            case ast.Attribute(of, name) if isinstance(self._value(of), AllTables):
                return Table(name)
            case ast.Subscript(table, place):
                return self._element(self._value(table), place)
            case ast.Tuple(parts):
                return tuple(self._value(part) for part in parts)
            case ast.BinOp(a, operator, b):
                return self._n.operate(operator, *(self._number(self._value(each)) for each in (a, b)))
            case ast.UnaryOp(operator, of):
                return self._unary(operator, of)
            case ast.BoolOp(operator, parts):
                return self._all(isinstance(operator, ast.Or), parts)
            case ast.Compare(first, orders, others):
                return self._compared(first, orders, others)
            case ast.IfExp(test, then, other):
                condition = self._truth(test)
                if not isinstance(condition, Number):
                    return self._value(then if condition else other)
                _require_simple(then, other)
                return self._n.chosen(condition, *(self._number(self._value(each)) for each in (then, other)))
            case ast.Call(ast.Name() | ast.Attribute() as of, given, []):
                return self._call(of, given)
        raise UnknownForm(type(expression).__name__)

    def _named(self, name: str) -> Value:
        call = self._calls[-1]
        if name in call.variables:
            return call.variables[name]
        found = call.scope.get(name)
        if not isinstance(found, int | float | tuple):
            raise UnknownForm(f"the name {name}")
        return found

    def _element(self, table: Value, place: ast.expr) -> Value:
        if isinstance(table, Table):
            return self._cells.read(table.name, self._numbers_of(place))
        if not isinstance(table, tuple):
            raise UnknownForm("a part of what is no table")
        at = self._number(self._value(place))
        if not isinstance(at, Number):
            return table[int(at)]
        values = [value for value in table if isinstance(value, int)]
        name = self._f.constant(values)
        kind = f"[{len(values)} x {WORD}]"
        pointer = self._f.pointer(kind)
        found = f"getelementptr {kind}, {pointer} {name}, {WORD} 0, {WORD} {self._n.text(at, WORD)}"
        cell = self._n.pure(found, self._f.pointer(WORD)).name
        loaded = f"load {WORD}, {self._f.pointer(WORD)} {cell}, align 8"
        return self._n.pure(loaded, WORD, min(values), max(values))

    def _unary(self, operator: ast.unaryop, of: ast.expr) -> Either:
        if isinstance(operator, ast.Not):
            return self._n.inverted(self._truth(of))
        value = self._number(self._value(of))
        if isinstance(operator, ast.USub):
            if not isinstance(value, Number):
                return -value
            if value.kind != DOUBLE:
                return self._n.operate(ast.Sub(), 0, value)
        if isinstance(operator, ast.Invert):
            return self._n.operate(ast.BitXor(), value, -1)
        raise UnknownForm(type(operator).__name__)

    def _all(self, either: bool, parts: list[ast.expr]) -> Either:
        """Return the truth of `and` and `or`; what comes behind one that decides is not looked at."""
        found: Either = not either
        for part in parts:
            if not isinstance(found, Number) and bool(found) == either:
                return found
            if isinstance(found, Number):
                _require_simple(part)
            found = self._n.both(found, self._truth(part), either)
        return found

    def _compared(self, first: ast.expr, orders: list[ast.cmpop], others: list[ast.expr]) -> Either:
        left, found = self._number(self._value(first)), True
        result: Either = found
        for order, other in zip(orders, others, strict=True):
            right = self._value(other)
            if isinstance(order, ast.In) and isinstance(right, tuple):
                equal = [self._n.compare(ast.Eq(), left, self._number(each)) for each in right]
                return functools.reduce(lambda a, b: self._n.both(a, b, either=True), equal)
            right = self._number(right)
            result = self._n.both(result, self._n.compare(order, left, right))
            left = right
        return result

    def _call(self, of: ast.expr, given: list[ast.expr]) -> Value:
        name = of.id if isinstance(of, ast.Name) else ast.unparse(of)
        function = self._calls[-1].scope.get(name)
        if isinstance(function, FunctionType):
            values = [self._value(each) for each in given]
            return self._asked(values) if name == "ask" else self._called(function, values)
        numbers = [self._number(self._value(each)) for each in given]
        match name, numbers:
            case ("int" | "bool", [value]):
                return self._n.to_whole(value) if name == "int" else value
            case "float", [value]:
                return self._n.to_real(value)
            case "math.floor", [value]:
                return self._n.floor(value)
            case "min" | "max", [a, b]:
                order = ast.Lt() if name == "min" else ast.Gt()
                return self._n.chosen(self._n.compare(order, b, a), b, a)
        raise UnknownForm(f"the function {name}")

    def _asked(self, given: list[Value]) -> Either:
        """Let Python do what no table holds: it reads tables, and writes some."""
        helper = self._f.load(WORD, self._wire, 3 * tables.Wire._fields.index("helper"))
        numbers = [(WORD, self._n.text(self._number(value), WORD)) for value in given[1:]]
        result = self._f.call(INT, helper, numbers)
        self._cells.known = {}
        return Number(self._f.let(f"sext {INT} {result} to {WORD}"), WORD)


def is_written_out(frames: Frames, what: int, i: int) -> bool:
    """Return True for an action that is short enough: a frame of 8 bytes that arrives at once, a look."""

    def of(column: int) -> int:
        found = frames.known("messages", i * tables.MESSAGE + column)
        return int(found or 0)

    if what == tables.WATCH:
        return of(tables.PAGES) <= 1 and of(tables.LISTENERS) <= 4
    if what != tables.SEND or of(tables.RING) >= 0 or of(tables.LOGGED) or of(tables.SEND_TYPE):
        return False
    return of(tables.LENGTH) <= 8 and of(tables.SIGNALS) <= 16 and of(tables.LISTENERS) <= 4


def _require_simple(*expressions: ast.expr) -> None:
    """Raise UnknownForm for an expression that may do more than to give a value."""
    for expression in expressions:
        for node in ast.walk(expression):
            if isinstance(node, ast.Call) and not (
                isinstance(node.func, ast.Name) and node.func.id in _SIMPLE
            ):
                raise UnknownForm("a call that is made or not")


_SIMPLE = ("is_off", "int", "float", "min", "max", "taken", "modulus")


@functools.cache
def _definition(function: FunctionType) -> ast.FunctionDef:
    module = inspect.getmodule(function)
    assert isinstance(module, ModuleType)  # it is of this package
    for statement in _parsed(module).body:
        if isinstance(statement, ast.FunctionDef) and statement.name == function.__name__:
            return statement
    raise UnknownForm(f"the source of {function.__name__}")


@functools.cache
def _parsed(module: ModuleType) -> ast.Module:
    return ast.parse(inspect.getsource(module))
