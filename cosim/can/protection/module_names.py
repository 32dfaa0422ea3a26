"""Modules of Python as they are before anybody runs them: where they stand, and which names they bind."""

from __future__ import annotations

import ast
import importlib.machinery
import importlib.util
import symtable
from pathlib import Path

_ANY = {"globals", "exec", "vars", "setattr"}
"""Functions by which a module can bind names that its source does not have."""


def bound_names(source: bytes, file: str) -> set[str] | None:
    """Return the names that a module's source binds; None where it can bind others too.

    Raises SyntaxError, or ValueError, for what is no Python.
    """
    text = importlib.util.decode_source(source)
    tree = ast.parse(text, file)
    for node in ast.walk(tree):
        star = isinstance(node, ast.ImportFrom) and any(alias.name == "*" for alias in node.names)
        if star or (isinstance(node, ast.Name) and node.id in _ANY):
            return None
    own = {each for node in ast.walk(tree) if isinstance(node, ast.Global) for each in node.names}
    table = symtable.symtable(text, file, "exec")
    own |= {s.get_name() for s in table.get_symbols() if s.is_assigned() or s.is_imported()}
    return None if "__getattr__" in own else own


def installed(name: str) -> tuple[bool, Path | None]:
    """Return True if there may be an installed module of this dotted name, and its file of Python, if known.

    None of its packages is imported.
    """
    top, *parts = name.split(".")
    if top == "__main__":  # what runs now: it has all its names once it has run
        return True, None
    try:
        spec = importlib.util.find_spec(top)
    except ValueError:  # it is imported already, and nobody knows from where
        return True, None
    if spec is None:
        return False, None
    for i, _ in enumerate(parts, 2):
        if spec.submodule_search_locations is None:
            return True, None  # a module may make others, as `os` makes `os.path`
        places = list(spec.submodule_search_locations)
        spec = importlib.machinery.PathFinder.find_spec(".".join([top, *parts][:i]), places)
        if spec is None:
            return False, None
    file = Path(spec.origin) if spec.has_location and spec.origin is not None else None
    return True, file if file is not None and file.suffix == ".py" else None
