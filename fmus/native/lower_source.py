"""The source of a model's functions: their syntax trees, the places in them, their equation marks."""

from __future__ import annotations

import ast
import dataclasses
import functools
import importlib.util
import inspect
import io
import re
import sys
import tokenize
import types
from collections.abc import Iterator
from pathlib import Path

from .errors import Unsupported
from .ir import Place

FunctionNode = ast.FunctionDef | ast.Lambda

_MARK = re.compile(r"\(\w+\)")


class NeedsNumber(Unsupported):
    """A number that must be known when the FMU is built: an argument may be one at some of its calls."""


@dataclasses.dataclass(frozen=True, eq=False)
class Module:
    """A Python file: its globals, its syntax tree, and the comment of each line.

    `file` is its name in messages, as an FMU of Python has it: its path below the FMU's package.
    """

    file: str
    scope: dict[str, object]
    tree: ast.Module
    comments: dict[int, str]

    def refuse(
        self, node: ast.AST, rule: str, instead: str, kind: type[Unsupported] = Unsupported
    ) -> Unsupported:
        """Return the exception for a construct: `file:line: source: rule; what to write instead`."""
        text = " ".join(ast.unparse(node).split())
        text = text if len(text) <= 80 else f"{text[:77]}..."
        name = self.file.rpartition("/")[2]
        return kind(f"{name}:{getattr(node, 'lineno', 1)}: {text}: {rule}; {instead}")

    def place(self, node: ast.AST) -> Place:
        """Return the place that a traceback names for what fails in this node."""
        return Place(self.file, getattr(node, "lineno", 1))

    def note(self, first: int, last: int) -> str:
        """Return the equation marks in the comments of these lines, as "(V1), (V6)"; "" for none."""
        comments = (self.comments.get(line, "") for line in range(first, last + 1))
        return ", ".join(dict.fromkeys(text for text in comments if _MARK.match(text)))

    def changes(self, name: str) -> bool:
        """Return True if a function of this file gives a global of it another value, or writes in it."""
        return name in _changed_globals(self.tree) or any(
            module.changes(own) for module, own in self._origins(name)
        )

    def _origins(self, name: str) -> Iterator[tuple[Module, str]]:
        """Return the module from which a global is imported, and its name there."""
        for node in ast.walk(self.tree):
            if isinstance(node, ast.ImportFrom):
                own = next((a.name for a in node.names if (a.asname or a.name) == name), None)
                package = str(self.scope.get("__package__") or "")
                module = importlib.util.resolve_name("." * node.level + (node.module or ""), package)
                file = getattr(sys.modules.get(module), "__file__", None)
                if own is not None and file and Path(file).suffix == ".py" and module not in _STANDARD:
                    yield module_of(vars(sys.modules[module]), file), own


@functools.cache
def _changed_globals(tree: ast.Module) -> frozenset[str]:
    """Return the globals that a function declares as `global`, and those that code writes in."""
    found: set[str] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Global):
            found.update(node.names)
        elif isinstance(node, ast.Subscript | ast.Attribute) and not isinstance(node.ctx, ast.Load):
            if isinstance(node.value, ast.Name):
                found.add(node.value.id)
        elif isinstance(node, ast.Attribute) and node.attr in _MUTATORS and isinstance(node.value, ast.Name):
            found.add(node.value.id)
    return frozenset(found)


_STANDARD = sys.stdlib_module_names

_MUTATORS = {
    *("append", "extend", "insert", "pop", "remove", "clear", "sort", "reverse"),
    *("update", "setdefault", "popitem", "add", "discard"),
}


def module_of(scope: dict[str, object], file: str) -> Module:
    """Return the module with these globals, read from its file. Raises Unsupported for one without source."""
    name = str(scope.get("__name__", ""))
    shown = name.replace(".", "/") if name != "__main__" else Path(file).stem
    if Path(file).name == "__init__.py":
        shown = f"{shown}/__init__"
    try:
        text = Path(file).read_text(encoding="utf-8")
    except OSError:
        raise Unsupported(f"{file}: there is no source; write the model in a file") from None
    return Module(f"{shown}.py", scope, *_parsed(text))


@functools.cache
def _parsed(text: str) -> tuple[ast.Module, dict[int, str]]:
    comments = {
        token.start[0]: token.string.lstrip("# ")
        for token in tokenize.generate_tokens(io.StringIO(text).readline)
        if token.type == tokenize.COMMENT
    }
    return ast.parse(text), comments


@functools.cache
def source_of(function: types.FunctionType) -> tuple[FunctionNode, Module]:
    """Return the syntax tree of a Python function and its module. Raises Unsupported without source."""
    code = function.__code__
    module = module_of(function.__globals__, inspect.getsourcefile(function) or code.co_filename)
    found = [node for node in ast.walk(module.tree) if _is_of(node, code)]
    if len(found) == 1 and isinstance(found[0], ast.AsyncFunctionDef):
        raise module.refuse(found[0], "`async`", "write a plain function")
    if len(found) != 1:
        raise Unsupported(
            f"{module.file.rpartition('/')[2]}:{code.co_firstlineno}: {function.__qualname__}: its source is "
            "not found; write it as a function of its own, on lines of its own"
        )
    node = found[0]
    assert isinstance(node, FunctionNode)
    return node, module


def _is_of(node: ast.AST, code: types.CodeType) -> bool:
    if isinstance(node, ast.Lambda):
        return code.co_name == "<lambda>" and node.lineno == code.co_firstlineno
    if not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
        return False
    first = min([node.lineno, *(d.lineno for d in node.decorator_list)])
    return node.name == code.co_name and first == code.co_firstlineno


def first_line(documented: object) -> str:
    """Return the first line of a docstring, "" where there is none."""
    return (getattr(documented, "__doc__", None) or "").strip().partition("\n")[0]


# -- names in a function -------------------------------------------------------------------------------------


def own_nodes(body: list[ast.stmt]) -> list[ast.AST]:
    """Return all nodes of some statements, but not those within functions that they define."""
    found: list[ast.AST] = []
    waiting: list[ast.AST] = list(reversed(body))
    while waiting:
        node = waiting.pop()
        found.append(node)
        if not isinstance(node, ast.FunctionDef | ast.Lambda | ast.ClassDef):
            waiting.extend(reversed(list(ast.iter_child_nodes(node))))
    return found


def stored(body: list[ast.stmt]) -> dict[str, list[int]]:
    """Return the names that statements give a value, each with the lines on which they do."""
    found: dict[str, list[int]] = {}
    inside = _of_comprehensions(body)
    for node in own_nodes(body):
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store) and id(node) not in inside:
            found.setdefault(node.id, []).append(node.lineno)
        elif isinstance(node, ast.FunctionDef):
            found.setdefault(node.name, []).append(node.lineno)
    return found


def _of_comprehensions(body: list[ast.stmt]) -> set[int]:
    """Return the ids of the names that belong to comprehensions, which are none of the function's."""
    return {
        id(name)
        for node in own_nodes(body)
        if isinstance(node, ast.comprehension)
        for name in ast.walk(node.target)
    }


def statements(node: FunctionNode) -> list[ast.stmt]:
    """Return the body of a function; that of a lambda is one `return`."""
    if isinstance(node, ast.FunctionDef):
        return node.body
    returned = ast.Return(node.body)
    return [ast.copy_location(returned, node.body)]


def parameters(node: FunctionNode) -> list[str]:
    """Return the names of a function's parameters, all kinds."""
    a = node.args
    more = [x for x in (a.vararg, a.kwarg) if x is not None]
    return [x.arg for x in (*a.posonlyargs, *a.args, *a.kwonlyargs, *more)]


def read_names(node: FunctionNode) -> list[str]:
    """Return the names that a function reads, those within its own functions too, in their order."""
    return list(
        dict.fromkeys(n.id for s in statements(node) for n in ast.walk(s) if isinstance(n, ast.Name) and n.id)
    )
