"""The Python files that an FMU carries, and their names in it.

Embedded files are found by following import statements from the model's module and from the slave:
- those of `evcosim.models` and, for the slave, of `evcosim.fmus`,
- those of the model's own package, or in the folder of a model that is a single file.
Everything else (numpy, scipy, the standard library) is left to the Python in which the FMU runs.

Inside the FMU all of it lies in one package that is named after the FMU and its content, because pythonfmu
imports into the importer's interpreter: two FMUs with a module of one name would share the first one's code.
Relative imports then hold as they are; absolute imports of embedded modules get the package's name in front.
Imports under `if TYPE_CHECKING:` and `if __name__ == "__main__":` are not followed.
"""

from __future__ import annotations

import ast
import functools
import os
import sys
import sysconfig
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

_HERE = Path(__file__).resolve().parent
_SLAVE = "evcosim.fmus.slave"


class Source(NamedTuple):
    """One embedded file: its module's dotted name, its path on this machine and its content."""

    module: str
    file: Path
    content: bytes

    @property
    def path(self) -> str:
        """The file's path below the FMU's package."""
        folder = self.module.replace(".", "/")
        return f"{folder}/__init__.py" if self.file.name == "__init__.py" else f"{folder}.py"


class Roots(NamedTuple):
    """The places in which embedded modules are looked for.

    `folder` holds the model's top-level package or file; `package` is that package, "" where the model is a
    single file and its siblings in `folder` count.
    """

    folder: Path
    package: str

    def locate(self, module: str) -> Path | None:
        """Return the file of an embedded module or package; None for a module that stays outside."""
        top, _, rest = module.partition(".")
        if top == "evcosim":
            part, _, rest = rest.partition(".")
            folder = {"models": models_folder(), "fmus": _HERE}.get(part)
            return None if folder is None else _file(folder, rest)
        if top == (self.package or top) and not (self.package == "" and _is_shared(self.folder)):
            return _file(self.folder, module)
        return None


def own_roots(module: str, file: Path) -> Roots:
    """Return the roots of a model in `module`, which was read from `file`."""
    depth = len(module.split(".")) - (file.name != "__init__.py")
    folder = file.resolve().parents[depth]
    return Roots(folder, module.partition(".")[0] if "." in module else "")


def collect(module: str, file: Path) -> list[Source]:
    """Return every file that the model in `module` needs, sorted by name.

    Raises ValueError that names file and line for an import that cannot be embedded.
    """
    roots = own_roots(module, file)
    found: dict[str, Source] = {}
    asked: set[str] = set()
    waiting = [(module, file.resolve()), (_SLAVE, _HERE / "slave.py")]
    while waiting:
        name, path = waiting.pop()
        if name in found:
            continue
        source = found[name] = Source(name, path, path.read_bytes())
        for needed in (*_parents(name), *_imported(source)):
            if needed in asked:
                continue
            asked.add(needed)
            located = roots.locate(needed)
            if located is not None:
                waiting.append((needed, located))
            elif needed.startswith("evcosim.") and needed.count(".") == 1:
                raise ValueError(f"{path}: an FMU carries no {needed}; a model imports evcosim.models only")
    return sorted(found.values(), key=lambda source: source.module)


def rewritten(source: Source, package: str, embedded: set[str]) -> bytes:
    """Return the file's content in the FMU: absolute imports of embedded modules begin with `package`."""
    lines = source.content.splitlines(keepends=True)
    for line, start, end, text in sorted(_edits(source, package, embedded), reverse=True):
        lines[line - 1] = lines[line - 1][:start] + text.encode() + lines[line - 1][end:]
    return b"".join(lines)


def text_of_class(file: Path, name: str) -> str:
    """Return the first line of a class's docstring, read without importing the module. Raises ValueError."""
    for node in ast.parse(file.read_bytes()).body:
        if isinstance(node, ast.ClassDef) and node.name == name:
            return (ast.get_docstring(node) or name).splitlines()[0].replace("`", "")
    raise ValueError(f"{file} has no class {name}")


def _edits(source: Source, package: str, embedded: set[str]) -> Iterator[tuple[int, int, int, str]]:
    """Yield (line, first column, last column, replacement), columns in bytes."""
    packages = {parent for name in embedded for parent in _parents(name)}
    tops = {name.partition(".")[0] for name in embedded}
    for node in _import_nodes(source):
        if isinstance(node, ast.ImportFrom):
            if node.level == 0 and node.module in embedded | packages:
                yield _edit_from(source, node, f"{package}.")
        else:
            for alias in node.names:
                if alias.name in embedded:
                    yield _edit_import(source, alias, f"{package}.")
                elif alias.name in tops:
                    raise ValueError(
                        f"{source.file}:{alias.lineno}: import the modules of {alias.name} by name"
                    )


def _edit_from(source: Source, node: ast.ImportFrom, prefix: str) -> tuple[int, int, int, str]:
    assert node.module is not None  # level 0
    line = source.content.splitlines()[node.lineno - 1]
    start = line.find(node.module.encode(), node.col_offset + len("from"))
    if start < 0:
        raise ValueError(f"{source.file}:{node.lineno}: write 'from {node.module} import' on one line")
    return node.lineno, start, start, prefix


def _edit_import(source: Source, alias: ast.alias, prefix: str) -> tuple[int, int, int, str]:
    start, end = alias.col_offset, alias.col_offset + len(alias.name.encode())
    if alias.asname is not None:
        return alias.lineno, start, start, prefix
    if "." in alias.name:
        head, _, last = alias.name.rpartition(".")
        raise ValueError(
            f"{source.file}:{alias.lineno}: write 'from {head} import {last}' instead of "
            f"'import {alias.name}', so that it can be embedded in an FMU"
        )
    return alias.lineno, start, end, f"{prefix}{alias.name} as {alias.name}"


def _imported(source: Source) -> Iterator[str]:
    """Yield the modules that the file's import statements may mean, as absolute dotted names."""
    for node in _import_nodes(source):
        if isinstance(node, ast.Import):
            for alias in node.names:
                yield alias.name
                yield from _parents(alias.name)
            continue
        base = node.module or ""
        if node.level:
            parts = source.module.split(".")
            kept = len(parts) - node.level + (source.file.name == "__init__.py")
            base = ".".join([*parts[:kept], *([node.module] if node.module else [])])
        yield base
        yield from _parents(base)
        yield from (f"{base}.{alias.name}" for alias in node.names)


@functools.lru_cache(maxsize=256)
def _import_nodes(source: Source) -> tuple[ast.Import | ast.ImportFrom, ...]:
    """Return the import statements that run when the module is imported or its functions are called."""
    try:
        tree = ast.parse(source.content, str(source.file))
    except SyntaxError as error:
        raise ValueError(f"{source.file}:{error.lineno}: {error.msg}") from None
    return tuple(_statements(tree))


def _statements(node: ast.AST) -> Iterator[ast.Import | ast.ImportFrom]:
    """Yield the import statements below a node; expressions, most of the tree, hold none and are skipped."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.Import | ast.ImportFrom):
            yield child
        elif isinstance(child, ast.stmt | ast.ExceptHandler | ast.match_case):
            if isinstance(child, ast.If) and _is_elsewhere(child.test):
                for other in child.orelse:
                    yield from _statements(ast.Module([other], []))
            else:
                yield from _statements(child)


def _is_elsewhere(test: ast.expr) -> bool:
    """Return True for the conditions `TYPE_CHECKING` and `__name__ == "__main__"`."""
    return ast.unparse(test) in ("TYPE_CHECKING", "typing.TYPE_CHECKING", "__name__ == '__main__'")


def _parents(module: str) -> Iterator[str]:
    parts = module.split(".")
    for k in range(1, len(parts)):
        yield ".".join(parts[:k])


def _file(folder: Path, module: str) -> Path | None:
    path = os.path.join(folder, *module.split(".")) if module else str(folder)
    if os.path.isfile(package := os.path.join(path, "__init__.py")):  # methods of Path would take far longer
        return Path(package)
    return Path(f"{path}.py") if module and os.path.isfile(f"{path}.py") else None


def _is_shared(folder: Path) -> bool:
    """Return True for a folder of Python's own, whose modules are not a model's siblings."""
    paths = sysconfig.get_paths()
    shared = {Path(paths[key]).resolve() for key in ("stdlib", "platstdlib", "purelib", "platlib")}
    return folder in shared or folder.name in ("site-packages", "dist-packages")


@functools.cache
def models_folder() -> Path:
    """Return the folder of the models of this package."""
    from .. import models  # light: a docstring

    return Path(models.__file__ or "").resolve().parent


def file_of(module: str) -> tuple[str, Path]:
    """Return dotted name and file of a loaded module; a script has the name of its file.

    Raises ValueError for code that stands in no file.
    """
    loaded = sys.modules[module]
    file = getattr(loaded, "__file__", None)
    if file is None:
        raise ValueError("an FMU is built from a model that is written in a file, not at a prompt")
    return (Path(file).stem if module == "__main__" else module), Path(file)
