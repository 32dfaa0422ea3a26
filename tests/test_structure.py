"""The rules of the house for all modules: sentences, sizes, a test file for each, names that exist."""

from __future__ import annotations

import ast
import graphlib
import importlib
import re
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parent.parent
PACKAGES = ("api", "models", "fmus", "cosim", "master")
MODULES = [path for package in PACKAGES for path in sorted((ROOT / package).rglob("*.py"))]
PROGRAMS = [path for folder in ("benchmarks", "examples", "tests") for path in (ROOT / folder).rglob("*.py")]
PAGES = [*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md"), ROOT / "pyproject.toml"]

LINES, FUNCTION_LINES = 400, 60
UNTESTED = {
    "master/machine/tables.py",  # constants alone; what they mean is tested with kernel and program
    "cosim/can/wire/tables.py",  # constants alone; what they mean is tested with the functions that use them
}
BEGINNING = re.compile(r"(What|Whether|How|Where|See)\b")
DOTTED = re.compile(r"\bevcosim\.(?:models|fmus|cosim|master)(?:\.[A-Za-z_]\w*)+")
FILE = re.compile(r"(?<![\w/.])(?:api|models|fmus|cosim|master|tests|benchmarks)/[\w/]+\.py\b")
OF_THE_READER = {"models/heater.py", "models/driver.py"}  # pages of docs/how-to show how to write them


def name(path: Path) -> str:
    return path.relative_to(ROOT).as_posix()


def nodes(path: Path) -> Iterator[ast.AST]:
    return ast.walk(ast.parse(path.read_text(encoding="utf-8")))


def docstrings(path: Path) -> Iterator[tuple[int, str]]:
    """Yield line and text of every docstring, also of those below attributes and constants."""
    for node in nodes(path):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
            for statement in node.body:
                match statement:
                    case ast.Expr(value=ast.Constant(value=str(text))):
                        yield statement.lineno, text.strip()


def imports(path: Path) -> set[str]:
    """Return the dotted names, from the project's root, that a module's relative imports may mean."""
    found = set()
    for node in nodes(path):
        if isinstance(node, ast.ImportFrom) and node.level:
            base = path.relative_to(ROOT).parts[: -node.level]
            target = ".".join([*base, *([node.module] if node.module else [])])
            found |= {target, *(f"{target}.{alias.name}" for alias in node.names)}
    return found


def exists(dotted: str) -> bool:
    """Return True for the name of a module, or of something in one."""
    parts = dotted.split(".")
    for n in range(len(parts), 0, -1):
        try:
            found: object = importlib.import_module(".".join(parts[:n]))
        except ModuleNotFoundError:
            continue
        for part in parts[n:]:
            found = getattr(found, part, None)
        return found is not None
    return False


def test_docstrings_begin_with_a_verb_or_name_what_is_returned():
    found = [
        f"{name(path)}:{line}: {text.splitlines()[0]}"
        for path in MODULES
        for line, text in docstrings(path)
        if BEGINNING.match(text)
    ]
    assert not found, "\n".join(found)


def test_modules_are_short():
    lengths = {name(path): len(path.read_text(encoding="utf-8").splitlines()) for path in MODULES}
    assert {path: n for path, n in lengths.items() if n > LINES} == {}


def test_functions_fit_on_a_screen():
    lengths = {
        f"{name(path)}: {node.name}": (node.end_lineno or 0) - node.lineno + 1
        for path in MODULES
        for node in nodes(path)
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
    }
    assert {function: n for function, n in lengths.items() if n > FUNCTION_LINES} == {}


def test_the_imports_of_cosim_make_no_circle():
    """Also those for types, and those on first use but for what `Results` shows: `plot`, `report`, HTML."""
    modules = {
        ".".join(p.relative_to(ROOT).with_suffix("").parts): p
        for p in MODULES
        if p.is_relative_to(ROOT / "cosim")
    }
    graph = {module: imports(path) & set(modules) for module, path in modules.items()}
    graph["cosim.results.results"] -= {"cosim.figures.asked", "cosim.report.inline", "cosim.report.page"}
    graphlib.TopologicalSorter(graph).prepare()  # raises CycleError, which names the circle


def test_the_tests_of_a_module_are_found_by_its_name():
    own = [
        path.relative_to(ROOT)
        for path in MODULES
        if path.relative_to(ROOT).parts[0] in ("cosim", "master")
        if path.stem not in ("__init__", "__main__") and name(path) not in UNTESTED
    ]
    expected = [ROOT / "tests" / path.parent / f"test_{path.stem}.py" for path in own]
    missing = [name(path) for path in expected if not path.is_file()]
    assert not missing, "\n".join(missing)


def test_modules_that_are_named_in_a_text_exist():
    found = []
    for path in (*MODULES, *PROGRAMS, *PAGES):
        text = path.read_text(encoding="utf-8")
        gone = [dotted for dotted in DOTTED.findall(text) if not exists(dotted)]
        gone += [
            file for file in FILE.findall(text) if file not in OF_THE_READER and not (ROOT / file).exists()
        ]
        found += [f"{name(path)}: {each}" for each in dict.fromkeys(gone)]
    assert not found, "\n".join(found)
