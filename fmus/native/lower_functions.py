"""Functions: one that is lowered, calls of the others, functions in functions, derived values."""

from __future__ import annotations

import ast
import contextlib
import dataclasses
import types
from collections.abc import Iterator, Sequence

from . import ir
from . import lower_expressions as expressions
from . import lower_statements as statements_of
from .lower_binding import Bound, bind, counting_names, has_whole_number, native, node_of, takes_text
from .lower_calls import called
from .lower_captured import captured, handed_on, own_parameters
from .lower_flow import different
from .lower_frame import Env, Frame, Lowered, Lowering
from .lower_sequences import items
from .lower_source import (
    FunctionNode,
    Module,
    NeedsNumber,
    parameters,
    read_names,
    source_of,
    statements,
    stored,
)
from .lower_text import is_text
from .lower_values import (
    Callable,
    Code,
    Known,
    LocalFunction,
    Missing,
    Run,
    Value,
    described,
    is_parameters,
    number_type,
)
from .values import ListType, ParametersType, Type


class ReturnsText(Exception):
    """A function returns a text, which has no native form: it is put together where it is needed."""


class FunctionFrame(Frame):
    """A function that is being lowered."""

    def __init__(
        self, program: Lowering, code: Code, node: FunctionNode, module: Module, expected: Type | None
    ):
        body = statements(node)
        self.stores = {}
        names = [*parameters(node), *stored(body), *read_names(node)]
        super().__init__(program, code, node, module, names)
        self.stores = stored(body)
        self.returns: Type | None = None
        self.constants: list[Value] = []
        self.speaks = self.is_root = False
        self._expected, self._returned = expected, False
        self._inline: list[Value] | None = None
        self._inline_block: object = None
        self._fields: dict[str, Value] = {}
        self._body: object = None

    # -- the parts -----------------------------------------------------------------------------------------

    def value(self, node: ast.expr) -> Value:
        """Return the value of an expression."""
        return expressions.value(self, node)

    def truth(self, node: ast.expr) -> Known | Run:
        """Return the truth value of an expression."""
        return expressions.truth(self, node)

    def attribute(self, node: ast.expr, of: Value, name: str) -> Value:
        """Return an attribute of a value."""
        own = (
            isinstance(node, ast.Attribute)
            and isinstance(node.value, ast.Name)
            and node.value.id == self.self_name
        )
        if own and name in self._fields:
            return self._fields[name]
        return expressions.attribute(self, node, of, name)

    def items(self, node: ast.AST, value: Value) -> list[Value]:
        """Return the items of a value whose length is known."""
        return items(self, node, value)

    def called(self, node: ast.Call) -> Value:
        """Return the result of a call."""
        return called(self, node)

    def run(self, statements: Sequence[ast.stmt]) -> bool:
        """Lower statements."""
        return statements_of.run(self, statements)

    def assign(self, name: str, value: Value, node: ast.AST) -> None:
        """Give a variable a value."""
        statements_of.assign(self, name, value, node)

    def unpack(self, target: ast.expr, value: Value) -> None:
        """Give a target its value."""
        statements_of.unpack(self, target, value)

    # -- the whole -----------------------------------------------------------------------------------------

    def lower(self) -> bool:
        """Lower the body; return True where its end is not reached."""
        self._body = self.block
        ended = self.run(statements(self.node))
        if not ended and self.self_name:
            self._finish_object()
        elif not ended and (self.returns is not None or self.constants or self.is_root):
            raise self.refuse(self.node, "a path without return", "return a value on every path")
        return ended

    def returned(self, node: ast.Return) -> None:
        """Lower a `return`."""
        if self.speaks and self._inline is None:
            statements_of.say(self, node, node.value)
            return
        value = Known(None) if node.value is None else self.value(node.value)
        if self._inline is not None:
            if self.block is not self._inline_block:
                raise self.refuse(node, "a text that depends on a condition", "raise it in each branch")
            self._inline.append(value)
            return
        if is_text(value):
            raise ReturnsText
        if isinstance(value, Known) and value.value is None:
            self._check_all(node, None)
            self.emit(ir.Return(None))
            return
        e = self.expr(node, value) if self.is_root else self.types.expression(value)
        if e is None:
            self.constants.append(value)
            self._check_all(node, None)
            return
        self._check_list(node, e)
        self._check_all(node, e.type)
        self.emit(ir.Return(e))

    def _check_all(self, node: ast.Return, type_: Type | None) -> None:
        """Raise Unsupported for a return of another type than those before."""
        if self._expected is not None and type_ != self._expected:
            name = getattr(getattr(self._expected, "python", None), "__name__", "State")
            raise self.refuse(
                node, f"{self.node_name} returns another type than {name}", f"return {name}(...)"
            )
        if self._returned and type_ != self.returns:
            known = [t for t in (self.returns, type_) if t is not None]
            why = different(known)
            instead = why.instead if len(known) == 2 else "return a value on every path"
            rule = (
                why.why.replace("has different", "returns different")
                if len(known) == 2
                else "a path without return"
            )
            raise self.refuse(node, rule, instead)
        self.returns, self._returned = type_, True

    def _check_list(self, node: ast.Return, e: ir.Expression) -> None:
        for part in e.items if isinstance(e, ir.Make) else (e,):
            if isinstance(part.type, ListType) and isinstance(part, ir.Local) and part in self.arguments:
                raise self.refuse(
                    node, "a list that was handed in is returned", "return nothing: it is changed in place"
                )

    @property
    def node_name(self) -> str:
        """The function's name in its source."""
        return self.node.name if isinstance(self.node, ast.FunctionDef) else "the lambda"

    # -- objects whose __init__ assigns --------------------------------------------------------------------

    def assign_self(self, target: ast.Attribute, value: Value) -> None:
        """Give an attribute of the object that is being made its value."""
        if self.block is not self._body or target.attr in self._fields:
            raise self.refuse(
                target, "an attribute that is assigned twice, or under a condition", "assign it once"
            )
        if isinstance(value, Known) and number_type(value.value) is None:
            self._fields[target.attr] = value
            return
        e = self.expr(target, value)
        if isinstance(e.type, ListType):
            raise self.refuse(target, "a list in an object", "write tuple(a)")
        python = self.env[self.self_name]
        if isinstance(python, Known) and hasattr(getattr(python.value, target.attr, None), "__set__"):
            raise self.refuse(target, "a property that is assigned", "give the attribute another name")
        local = self.temporary(e.type, target.attr)
        self.store(local, Run(e), target)
        self.temporaries.discard(local.name)
        self._fields[target.attr] = Run(local)

    def _finish_object(self) -> None:
        python = self.env[self.self_name]
        assert isinstance(python, Known) and isinstance(python.value, type)
        made = [(name, self.expr(self.node, v)) for name, v in self._fields.items()]
        type_ = self.types.record(python.value, [(name, e.type) for name, e in made])
        self.returns = type_
        self.emit(ir.Return(ir.Make(type_, tuple(e for _, e in made))))

    # -- calls ---------------------------------------------------------------------------------------------

    def call(
        self, node: ast.expr, callee: Callable, given: Sequence[Value], named: dict[str, Value]
    ) -> Value:
        """Return the result of a call of one of the model's functions."""
        if self.program.is_active(callee.code):
            raise self.refuse(node, "a function that calls itself", "write a loop")
        own = tuple(
            own_parameters(self, node, v.type) if isinstance(v, Run) and is_parameters(v) else v
            for v in callee.bound
        )
        callee = dataclasses.replace(callee, bound=own)
        bound = bind(self, node, callee, given, named)
        if takes_text(bound):
            return self._inlined(node, callee, bound)
        try:
            lowered, arguments = self._specialized(node, callee, bound)
        except ReturnsText:
            return self._inlined(node, callee, bound)
        if lowered.function is None:
            assert lowered.constant is not None
            return lowered.constant
        result = self._result(lowered, lowered.function, arguments)
        return result if lowered.constant is None else lowered.constant

    def _specialized(
        self, node: ast.expr, callee: Callable, bound: Bound
    ) -> tuple[Lowered, list[ir.Expression]]:
        try:
            return self._with(node, callee, bound, False)
        except NeedsNumber:
            if not has_whole_number(bound):
                raise
            return self._with(node, callee, bound, True)

    def _with(
        self, node: ast.expr, callee: Callable, bound: Bound, numbers_known: bool
    ) -> tuple[Lowered, list[ir.Expression]]:
        arguments: list[ir.Expression] = []
        given: Bound = []
        counting = counting_names(node_of(callee.code))
        if isinstance(callee.code, LocalFunction):
            arguments += [self.expr(node, value) for value in callee.bound]
        for name, value in bound:
            e = native(self.types, value, numbers_known or name in counting)
            if e is not None:
                arguments.append(e)
                given.append((name, Run(e)))
            elif isinstance(value, Known | Callable):
                given.append((name, value))
            else:
                raise self.refuse(
                    node, f"{described(value)} as the argument {name}", "give it numbers or tuples"
                )
            if e is not None and isinstance(e.type, ListType) and not isinstance(e, ir.Local):
                arguments[-1] = self.keep(e, name).expr
        for name, own in handed_on(self, node, callee, given):
            given.append((name, own))
            arguments.append(self.expr(node, own))
        return self.program.specialize(callee, given), arguments

    def _result(self, lowered: Lowered, function: ir.Function, arguments: list[ir.Expression]) -> Value:
        if lowered.changes:
            own = [a for a in arguments if isinstance(a.type, ListType)]
            self.changes_arguments |= any(a in self.arguments for a in own)
        must = function.can_fail or lowered.changes
        if function.returns is None:
            if must:
                self.emit(ir.Call(None, function.name, tuple(arguments)))
            return Known(None)
        if not must:
            return Run(ir.Invoke(function.returns, function.name, tuple(arguments)))
        target = self.temporary(function.returns, "returned")
        self.emit(ir.Call(target, function.name, tuple(arguments)))
        return Run(target)

    def _inlined(self, node: ast.expr, callee: Callable, bound: Bound) -> Value:
        """Return the text that a function returns, put together here."""
        code = callee.code
        if isinstance(code, LocalFunction):
            raise self.refuse(node, "a text of a function in a function", "write the f-string here")
        body, module = source_of(code)
        with self._as(code, body, module, dict(bound)) as results:
            self.run(statements(body))
        if len(results) != 1:
            raise self.refuse(node, "a function of texts that returns none", "write the f-string here")
        return results[0]

    @contextlib.contextmanager
    def _as(
        self, code: Code, node: FunctionNode, module: Module, env: dict[str, Value]
    ) -> Iterator[list[Value]]:
        kept = (
            self.code,
            self.module,
            self.env,
            self.stores,
            self._inline,
            self._inline_block,
            self._by_name,
        )
        results: list[Value] = []
        given: Env = {**env}
        self.code, self.module, self.env, self.stores = code, module, given, stored(statements(node))
        self._inline, self._inline_block, self._by_name = results, self.block, {}
        try:
            yield results
        finally:
            (self.code, self.module, self.env, self.stores) = kept[:4]
            self._inline, self._inline_block, self._by_name = kept[4:]

    def captured(self, node: ast.FunctionDef | ast.Lambda, name: str) -> Value:
        """Return a function in this function, with the values that it captures."""
        return captured(self, node, name)

    # -- derived values ------------------------------------------------------------------------------------

    def derived(self, node: ast.expr, of: Run, function: types.FunctionType, name: str) -> Value:
        """Return a cached property; of the parameters it is computed at its first use."""
        if not isinstance(of.type, ParametersType):
            return self.call(node, Callable(function), (of,), {})
        key = f"{of.expr.name}.{name}" if isinstance(of.expr, ir.Local) else ""
        found = self.env.get(key)
        if found is not None and not isinstance(found, Missing):
            return found
        if name not in of.type.derived:
            if self.program.is_active(function):
                raise self.refuse(node, "a value that is derived from itself", "write a loop")
            lowered = self.program.specialize(Callable(function), [("self", of)], f"compute_{name}")
            if lowered.constant is not None:
                return lowered.constant
            assert lowered.function is not None
            if lowered.function.returns is None or isinstance(lowered.function.returns, ListType):
                raise self.refuse(
                    node, f"{name} gives nothing that can be kept", "return a number or a tuple"
                )
            of.type.derived[name] = (lowered.function.returns, lowered.function.name)
        target = self.temporary(of.type.derived[name][0], name)
        self.emit(ir.Derive(target, of.expr, name))
        if key:
            self.env[key] = Run(target)
        return Run(target)
