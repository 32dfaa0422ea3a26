"""Statements of a program as C, each local variable declared where it is first needed."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator

from . import ir
from .emit_expressions import Scope, argument_list, expression, handed
from .emit_inlining import derived_name
from .emit_kept import Kept
from .emit_types import c_name, type_name
from .values import (
    BOOLEAN,
    COMPLEX,
    REAL,
    ArrayType,
    ListType,
    ParametersType,
    Scalar,
    StructType,
    Type,
)

_FAILURE = "&failure->python"


@dataclasses.dataclass(frozen=True)
class Frame:
    """A function, and what its statements need to know of its program.

    `failing` are the functions of the program that can fail, with the accessors of derived values. `unread`
    are locals of the function that nothing reads, `filled` those that a call gives their value through their
    address.
    """

    function: ir.Function
    scope: Scope
    failing: frozenset[str]
    unread: frozenset[str]
    kept: Kept
    filled: frozenset[str] = frozenset()
    speaks: bool = False

    @property
    def can_fail(self) -> bool:
        """True where the function returns whether it went well, and its result through a pointer."""
        return self.function.can_fail or self.speaks


def body(frame: Frame) -> list[str]:
    """Return the lines of a function's body."""
    frame = dataclasses.replace(frame, filled=frozenset(_filled(frame.function.body, frame)))
    needed = frame.filled.union(read(frame.function.body))
    return _block(
        frame.function.body, {x.name: x.type for x in frame.function.locals if x.name in needed}, frame
    )


def _filled(block: ir.Block, frame: Frame) -> Iterator[str]:
    """Return the names of the variables that a call fills through their address, read or not."""
    for s in block:
        match s:
            case ir.Checked():
                yield s.target.name
            case ir.Call() if s.target is not None and s.function in frame.failing:
                yield s.target.name
            case ir.Derive() if derived_name(type_name(s.parameters.type), s.name) in frame.failing:
                yield s.target.name
            case ir.If():
                yield from _filled(s.then + s.otherwise, frame)
            case ir.For():
                yield from _filled(s.body, frame)
            case ir.While():
                yield from _filled(s.before + s.body, frame)


def named(node: object) -> Iterator[str]:
    """Return the names of all variables in an expression, a statement or a block, targets too."""
    if isinstance(node, ir.Local):
        yield node.name
    elif isinstance(node, tuple):
        for part in node:
            yield from named(part)
    elif dataclasses.is_dataclass(node) and not isinstance(node, ir.Place):
        for field in dataclasses.fields(node):
            if field.name != "type":
                yield from named(getattr(node, field.name))


def read(node: object) -> Iterator[str]:
    """Return the names of all variables that an expression, a statement or a block reads."""
    match node:
        case ir.Assign():
            yield from named(node.value)
        case ir.Checked() | ir.Call():
            yield from named(node.arguments)
        case ir.Derive():
            yield from named(node.parameters)
        case ir.If():
            yield from named(node.test)
            yield from read(node.then + node.otherwise)
        case ir.For():
            yield from named((node.start, node.stop))
            yield from read(node.body)
        case ir.While():
            yield from named(node.test)
            yield from read(node.before + node.body)
        case tuple():
            for part in node:
                yield from read(part)
        case _:
            yield from named(node)


# -- declarations --------------------------------------------------------------------------------------------


def _block(block: ir.Block, undeclared: dict[str, Type], frame: Frame) -> list[str]:
    """Return the lines of a block that declares these variables, in it or within one of its statements."""
    mentioned = [frozenset(named(s)) for s in block]
    lines: list[str] = []
    inner: list[dict[str, Type]] = [{} for _ in block]
    first: list[list[str]] = [[] for _ in block]
    for name in undeclared:
        places = [k for k, names in enumerate(mentioned) if name in names]
        if len(places) == 1 and _can_be_within(block[places[0]], name):
            inner[places[0]][name] = undeclared[name]
        elif places:
            first[places[0]].append(name)
    for k, statement in enumerate(block):
        at_once = _target_at_once(statement)
        if at_once in frame.unread:  # its statement may not be written at all
            at_once = None
        later = [ir.Local(undeclared[name], name) for name in first[k] if name != at_once]
        lines += [_unset(local, local.name in frame.filled) for local in later]
        declared = f"{type_name(undeclared[at_once])} " if at_once and at_once in first[k] else ""
        lines += _statement(statement, declared, inner[k], frame)
    return lines


def _unset(local: ir.Local, filled: bool) -> str:
    """Return the declaration of a variable that gets its value later.

    Compilers do not see that a call which fails is left at once, and would warn of a number that it has not
    `filled` through its address: this one is 0 at first.
    """
    zero = {REAL: " = 0.0", BOOLEAN: " = false", COMPLEX: " = {0.0, 0.0}"}
    none = "" if isinstance(local.type, StructType | ArrayType | ListType | ParametersType) else " = 0"
    start = zero.get(local.type, none) if isinstance(local.type, Scalar) else none
    return f"{type_name(local.type)} {c_name(local.name)}{start if filled else ''};"


def _target_at_once(statement: ir.Statement) -> str | None:
    """Return the variable that a statement gives its first value in one expression, if it is such a one."""
    if isinstance(statement, ir.Assign) and statement.target.name not in set(named(statement.value)):
        return statement.target.name
    if isinstance(statement, ir.Checked | ir.Call) and statement.target is not None:
        return None if statement.target.name in set(named(statement.arguments)) else statement.target.name
    return statement.target.name if isinstance(statement, ir.Derive) else None


def _can_be_within(statement: ir.Statement, name: str) -> bool:
    """Return True if a variable that only this statement mentions can be declared within one of its blocks.

    In a loop each turn must give it a value before it reads it.
    """
    match statement:
        case ir.If():
            return name not in set(named(statement.test)) and not (
                name in set(named(statement.then)) and name in set(named(statement.otherwise))
            )
        case ir.For():
            if name in set(named((statement.start, statement.stop))):
                return False
            if name == statement.local.name:  # one that its body changes is not what counts
                return name not in {target.name for target in _targets(statement.body)}
            return _is_given_first(statement.body, name)
        case ir.While():
            if name in set(named(statement.test)):
                return False
            if name in set(named(statement.before)) and name in set(named(statement.body)):
                return False
            return _is_given_first(statement.before + statement.body, name)
    return False


def _is_given_first(block: ir.Block, name: str) -> bool:
    first = next(s for s in block if name in set(named(s)))
    if isinstance(first, ir.Assign | ir.Checked | ir.Call | ir.Derive):
        given = first.target is not None and first.target.name == name
        return given and name not in set(read(first))
    if isinstance(first, ir.If | ir.For):
        return first is block[-1] and _can_be_within(first, name) and _only_block_gives(first, name)
    return False


def _only_block_gives(statement: ir.If | ir.For, name: str) -> bool:
    if isinstance(statement, ir.For):
        return _is_given_first(statement.body, name)
    block = statement.then if name in set(named(statement.then)) else statement.otherwise
    return _is_given_first(block, name)


# -- statements ----------------------------------------------------------------------------------------------


def _statement(s: ir.Statement, declared: str, inner: dict[str, Type], frame: Frame) -> list[str]:
    """Return the lines of a statement; `declared` stands before the variable that it is the first to give."""
    scope = frame.scope
    match s:
        case ir.Assign():
            if s.target.name in frame.unread:
                return []
            return [f"{declared}{_place_of(s.target, scope)} = {expression(s.value, scope)};{_note(s.note)}"]
        case ir.SetItem():
            place = f"{_list(s.list, scope)}at[{expression(s.index, scope)}]"
            return [f"{place} = {expression(s.value, scope)};{_note(s.note)}"]
        case ir.SetLength():
            return [f"{_list(s.list, scope)}length = {expression(s.length, scope)};"]
        case ir.Checked():
            function, kept = frame.kept.call(frame.function.name, s)
            arguments = [*(expression(a, scope) for a in s.arguments), *kept]
            given = ", ".join([*arguments, f"&{c_name(s.target.name)}", _FAILURE])
            failed = f'model_raised(failure, "{s.place.file}", {s.place.line})'
            before = [_unset(s.target, True)] if declared else []
            return [*before, f"if (!{function}({given})){_note(s.note)}", f"    return {failed};"]
        case ir.Call():
            return _call(s, declared, frame)
        case ir.Derive():
            return _derive(s, declared, frame)
        case ir.If():
            return _if(s, inner, frame)
        case ir.For():
            return _for(s, inner, frame)
        case ir.While():
            return _while(s, inner, frame)
        case ir.Break():
            return ["break;"]
        case ir.Continue():
            return ["continue;"]
        case ir.Return():
            return _return(s, frame)
        case ir.Raise():
            failed = f'model_raise(failure, "{s.exception}", "{s.place.file}", {s.place.line})'
            begin = "model_text text = model_begin(failure->text, MODEL_TEXT);"
            return [begin, *_texts(s.text, "&text", scope), f"return {failed};"]
        case ir.Say():
            return [*_texts(s.text, "said", scope), "return true;"]


def _call(s: ir.Call, declared: str, frame: Frame) -> list[str]:
    scope, name = frame.scope, c_name(s.function)
    if s.function in frame.failing:
        result = [] if s.target is None else [f"&{c_name(s.target.name)}"]
        given = argument_list(s.function, s.arguments, scope, *result, "failure")
        before = [_unset(s.target, True)] if declared and s.target else []
        return [*before, f"if (!{name}({given})){_note(s.note)}", "    return false;"]
    called = f"{name}({argument_list(s.function, s.arguments, scope)});{_note(s.note)}"
    if s.target is None or s.target.name in frame.unread:
        return [called]
    return [f"{declared}{_place_of(s.target, scope)} = {called}"]


def _derive(s: ir.Derive, declared: str, frame: Frame) -> list[str]:
    accessor = derived_name(type_name(s.parameters.type), s.name)
    target = c_name(s.target.name)
    memory = ", memory" if accessor in frame.scope.with_memory else ""
    given = handed(s.parameters, frame.scope)
    if accessor in frame.failing:
        before = [_unset(s.target, True)] if declared else []
        return [
            *before,
            f"if (!{accessor}({given}, &{target}{memory}, failure)){_note(s.note)}",
            "    return false;",
        ]
    if s.target.name in frame.unread:
        return []
    return [f"{declared}{target} = {accessor}({given}{memory});{_note(s.note)}"]


def _if(s: ir.If, inner: dict[str, Type], frame: Frame) -> list[str]:
    names = set(named(s.then))
    then = _block(s.then, {n: t for n, t in inner.items() if n in names}, frame)
    otherwise = _block(s.otherwise, {n: t for n, t in inner.items() if n not in names}, frame)
    test = expression(s.test, frame.scope)
    if not then and not otherwise:
        return []
    lines = [f"if ({test}) {{{_note(s.note)}", *_indented(then)]
    if not otherwise:
        return [*lines, "}"]
    if len(s.otherwise) == 1 and isinstance(s.otherwise[0], ir.If) and otherwise[0].startswith("if ("):
        return [*lines, f"}} else {otherwise[0]}", *otherwise[1:]]
    return [*lines, "} else {", *_indented(otherwise), "}"]


def _for(s: ir.For, inner: dict[str, Type], frame: Frame) -> list[str]:
    """Return a loop over a range; Python evaluates its bounds once, and does not count with the variable."""
    scope, name = frame.scope, c_name(s.local.name)
    given = {t.name for t in _targets(s.body)}
    own = s.local.name not in given and s.local.name in inner
    inner = {n: t for n, t in inner.items() if n != s.local.name}
    counter = name if own else f"{name}_turn"
    start, stop = expression(s.start, scope), expression(s.stop, scope)
    if not (isinstance(s.stop, ir.Literal) or (isinstance(s.stop, ir.Local) and s.stop.name not in given)):
        start, stop = f"{start}, {name}_stop = {stop}", f"{name}_stop"
    sign, step = ("<", f"{counter} += {s.step}") if s.step > 0 else (">", f"{counter} -= {-s.step}")
    step = {1: f"{counter}++", -1: f"{counter}--"}.get(s.step, step)
    head = f"for (int64_t {counter} = {start}; {counter} {sign} {stop}; {step}) {{"
    first = [] if own or s.local.name in frame.unread else [f"{name} = {counter};"]
    return [f"{head}{_note(s.note)}", *_indented([*first, *_block(s.body, inner, frame)]), "}"]


def _targets(block: ir.Block) -> Iterator[ir.Local]:
    """Return the variables that a block gives values, in blocks within it too."""
    for s in block:
        match s:
            case ir.Assign() | ir.Checked() | ir.Call() | ir.Derive():
                if s.target is not None:
                    yield s.target
            case ir.If():
                yield from _targets(s.then + s.otherwise)
            case ir.For():
                yield s.local
                yield from _targets(s.body)
            case ir.While():
                yield from _targets(s.before + s.body)


def _while(s: ir.While, inner: dict[str, Type], frame: Frame) -> list[str]:
    names = set(named(s.before))
    before = _block(s.before, {n: t for n, t in inner.items() if n in names}, frame)
    inside = _block(s.body, {n: t for n, t in inner.items() if n not in names}, frame)
    test = expression(s.test, frame.scope)
    if not before:
        return [f"while ({test}) {{{_note(s.note)}", *_indented(inside), "}"]
    return [f"for (;;) {{{_note(s.note)}", *_indented([*before, f"if (!({test})) break;", *inside]), "}"]


def _return(s: ir.Return, frame: Frame) -> list[str]:
    if s.value is None:
        return ["return true;" if frame.can_fail else "return;"]
    value = expression(s.value, frame.scope)
    if frame.can_fail:
        return [f"*result = {value};{_note(s.note)}", "return true;"]
    return [f"return {value};{_note(s.note)}"]


def _texts(text: ir.Text, to: str, scope: Scope) -> list[str]:
    """Return the calls that put the pieces of a text together."""
    lines = []
    for piece in text:
        if isinstance(piece, str):
            lines.append(f"model_put({to}, {quoted(piece)});")
        else:
            lines.append(_put(piece, to, expression(piece.value, scope)))
    return lines


def _put(piece: ir.Shown, to: str, value: str) -> str:
    """Return the call that adds a number to a text."""
    if piece.value.type is REAL:
        return f"model_put_real({to}, {value}, {quoted(piece.spec)});"
    if piece.spec not in ("", "!r"):
        raise TypeError(f"format {piece.spec!r} of a number that is no float")
    return f"model_put_{'boolean' if piece.value.type is BOOLEAN else 'integer'}({to}, {value});"


def quoted(text: str) -> str:
    """Return a text as a string of C: bytes beyond ASCII are written by their numbers."""
    out = []
    for byte in text.encode("utf-8"):
        plain = 32 <= byte < 127 and byte not in b'"\\?'
        out.append(chr(byte) if plain else f"\\{byte:03o}")
    return '"' + "".join(out) + '"'


def _place_of(target: ir.Local, scope: Scope) -> str:
    name = c_name(target.name)
    return f"*{name}" if target.name in scope.addresses else name


def _list(local: ir.Local, scope: Scope) -> str:
    assert isinstance(local.type, ListType)
    return f"{c_name(local.name)}{'->' if local.name in scope.addresses else '.'}"


def _note(note: str) -> str:
    return f" /* {note.replace('*/', '* /')} */" if note else ""


def _indented(lines: list[str]) -> list[str]:
    return [f"    {line}" for line in lines]
