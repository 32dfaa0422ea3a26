"""Refusal of loops over values that Python computes turn by turn and native code before: they can differ."""

from __future__ import annotations

import ast

from .lower_frame import Frame
from .lower_source import own_nodes
from .lower_values import Group, Run, Value, reads_list
from .values import ListType


def check_lazy(frame: Frame, node: ast.For, value: Value, since: int) -> None:
    """Raise Unsupported where the turns of a loop would be computed before it, and Python does it one by one.

    `value` is what the loop goes through, computed by the statements from `since` on.
    """
    if any(isinstance(n, ast.GeneratorExp) for n in ast.walk(node.iter)) and frame.block[since:]:
        raise frame.refuse(
            node.iter, "a generator computes its values turn by turn", "compute them in the body of the loop"
        )
    if isinstance(value, Group) and _reads(value) and _may_write(frame, node):
        raise frame.refuse(
            node.iter, "a list that is read turn by turn may change in the loop", "write for k in range(n)"
        )


def _reads(value: Value) -> bool:
    if isinstance(value, Group):
        return any(_reads(item) for item in value.items)
    return isinstance(value, Run) and reads_list(value.expr)


def _may_write(frame: Frame, node: ast.For) -> bool:
    """Return True if the body of a loop gives an item a value, or hands on a list."""
    for part in own_nodes(node.body):
        if isinstance(part, ast.Subscript) and isinstance(part.ctx, ast.Store):
            return True
        if isinstance(part, ast.Call):
            names = [
                n.id for a in (*part.args, *part.keywords) for n in ast.walk(a) if isinstance(n, ast.Name)
            ]
            values = [frame.env.get(name) for name in names]
            if any(isinstance(v, Run) and isinstance(v.type, ListType) for v in values):
                return True
    return False
