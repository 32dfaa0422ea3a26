"""Texts: pieces that are put together where an exception is raised or a notice returned."""

from __future__ import annotations

import ast
import re

from . import ir
from .lower_frame import Frame
from .lower_values import Known, Run, Value, Words, described
from .values import BOOLEAN, INTEGER, REAL, EnumType, is_integral

_SPEC = re.compile(r"[-+ ]?0?\d*(\.\d+)?[eEfFgG%]?")


def formatted(frame: Frame, node: ast.JoinedStr) -> Value:
    """Return an f-string as pieces, or as a text where all of it is known."""
    pieces: list[str | ir.Shown] = []
    for part in node.values:
        mark = len(frame.block)
        if isinstance(part, ast.Constant):
            new: ir.Text = (str(part.value),)
        else:
            assert isinstance(part, ast.FormattedValue)
            new = _shown(frame, part)
        before = frame.held(mark, Words(tuple(pieces)))
        assert isinstance(before, Words)
        pieces = [*before.pieces, *new]
    return joined(tuple(pieces))


def joined(pieces: ir.Text) -> Value:
    """Return pieces as one text, those that are known side by side as one."""
    found: list[str | ir.Shown] = []
    for piece in pieces:
        if isinstance(piece, str) and found and isinstance(found[-1], str):
            found[-1] += piece
        elif piece != "":
            found.append(piece)
    if all(isinstance(piece, str) for piece in found):
        return Known("".join(piece for piece in found if isinstance(piece, str)))
    return Words(tuple(found))


def _shown(frame: Frame, part: ast.FormattedValue) -> ir.Text:
    spec = "" if part.format_spec is None else _known_text(frame, part, part.format_spec)
    value = frame.value(part.value)
    as_repr = part.conversion == ord("r")
    if isinstance(value, Words):
        if spec:
            raise frame.refuse(part, "the format of a text", "leave the format out")
        return value.pieces
    if isinstance(value, Known):
        text = repr(value.value) if as_repr else value.value
        return (format(text, spec),)
    return (show(frame, part, value, spec, as_repr),)


def show(frame: Frame, node: ast.AST, value: Value, spec: str = "", as_repr: bool = False) -> ir.Shown:
    """Return a number within a text."""
    e = frame.expr(node, value)
    if e.type is not REAL and not is_integral(e.type):
        raise frame.refuse(node, f"{described(value)} in a text", "show its numbers one by one")
    if as_repr and isinstance(e.type, EnumType):
        raise frame.refuse(node, "the name of an item that is known only when it runs", "leave the !r out")
    if spec == "d" and e.type is not REAL and e.type is not BOOLEAN:
        spec = ""
    if e.type not in (REAL, BOOLEAN) and is_integral(e.type) and e.type is not INTEGER:
        e = ir.Convert(INTEGER, e)
    if spec and (e.type is not REAL or not _SPEC.fullmatch(spec)):
        raise frame.refuse(
            node, f"the format {spec!r} of {described(value)}", "write float(...) and `.4g` or the like"
        )
    return ir.Shown(e, "!r" if as_repr else spec)


def _known_text(frame: Frame, node: ast.AST, spec: ast.expr) -> str:
    value = frame.value(spec)
    if not isinstance(value, Known):
        raise frame.refuse(node, "a format that is known only when it runs", "write it as `.4g` or the like")
    return str(value.value)


def pieces_of(frame: Frame, node: ast.expr, value: Value) -> ir.Text:
    """Return a value in a text as pieces."""
    if isinstance(value, Words):
        return value.pieces
    if isinstance(value, Known) and isinstance(value.value, str):
        return (value.value,) if value.value else ()
    if isinstance(value, Run):
        return (show(frame, node, value),)
    if isinstance(value, Known):
        return (str(value.value),)
    raise frame.refuse(node, f"{described(value)} as a text", "write an f-string")


def added(frame: Frame, node: ast.expr, left: Value, right: Value) -> Value | None:
    """Return two texts one behind the other; None where an operand is none."""
    if not (is_text(left) and is_text(right)):
        return None
    return joined((*pieces_of(frame, node, left), *pieces_of(frame, node, right)))


def is_text(value: Value) -> bool:
    """Return True for a text, known or not."""
    return isinstance(value, Words) or (isinstance(value, Known) and isinstance(value.value, str))


def glued(frame: Frame, node: ast.expr, between: str, values: list[Value]) -> Value:
    """Return `between.join(values)`."""
    pieces: list[str | ir.Shown] = []
    for k, value in enumerate(values):
        if not is_text(value):
            raise frame.refuse(node, f"{described(value)} joined to a text", "write an f-string")
        pieces += [*([between] if k else []), *pieces_of(frame, node, value)]
    return joined(tuple(pieces))
