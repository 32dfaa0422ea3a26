"""docs/python.md: its reference is what the code says, and its examples print what it shows."""

from __future__ import annotations

import ast
import contextlib
import io
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import evcosim
from support import python_page

ROOT = Path(__file__).parents[1]
TEXT = python_page.PAGE.read_text(encoding="utf-8")
LINES = r"((?:(?!```).*\n)*)"
EXAMPLES = re.findall(rf"^```python\n{LINES}```\n\n```text\n{LINES}```\n", TEXT, re.MULTILINE)


def test_the_reference_is_what_the_code_says():
    assert python_page.rewritten(TEXT) == TEXT, "python tests/support/python_page.py --write writes it"


def test_every_public_name_has_a_reference():
    assert sorted(python_page.described(TEXT)) == [n for n in evcosim.__all__ if n != "__version__"]


def defined() -> set[str]:
    """Return the names of all classes and types that the package defines in its modules."""
    found = set()
    for path in (file for folder in ("cosim", "master") for file in (ROOT / folder).rglob("*.py")):
        for node in ast.parse(path.read_text(encoding="utf-8")).body:
            if isinstance(node, ast.ClassDef):
                found.add(node.name)
            elif isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
                found.add(node.targets[0].id)
    return found


def test_every_type_in_a_public_signature_is_public():
    types = python_page.named(TEXT) & defined()
    assert {"Fit", "Failure", "TaskProgress", "Value"} <= types
    assert types <= set(evcosim.__all__), sorted(types - set(evcosim.__all__))


def alone(code: str) -> bool:
    """True of an example that starts processes, which import it: it is a script of its own."""
    return "__main__" in code


def imported(tree: ast.Module) -> set[str]:
    """Return the names that an example imports."""
    imports = [node for node in ast.walk(tree) if isinstance(node, ast.Import | ast.ImportFrom)]
    return {alias.asname or alias.name for node in imports for alias in node.names}


def test_every_example_imports_what_it_uses():
    """Results and systems may come from an example above; modules and what is in them may not."""
    trees = [ast.parse(code) for code, _ in EXAMPLES]
    everything = set.union(*map(imported, trees))
    for tree in trees:
        used = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}
        assert used & everything <= imported(tree), ast.unparse(tree)


def test_the_page_says_what_mypy_needs_after_an_editable_installation():
    """tests/test_api.py lets mypy do it."""
    assert "MYPYPATH=CLONE/.typing mypy --follow-imports=silent script.py" in TEXT
    assert (ROOT / ".typing" / "evcosim" / "py.typed").is_file()


def test_the_help_of_a_run_names_its_options():
    assert "`evcosim.RunOptions`" in (evcosim.simulate.__doc__ or "")


def test_the_examples_print_what_is_shown(tmp_path, monkeypatch):
    """In one interpreter, from top to bottom: later ones use what earlier ones made."""
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {"__name__": "page"}
    together = [example for example in EXAMPLES if not alone(example[0])]
    assert len(together) >= 6
    for code, shown in together:
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(compile(code, "python.md", "exec"), names)
        assert printed.getvalue() == shown
    assert {path.name for path in Path("run").iterdir()} == {"results.csv", "run.json", "figure.png"}


def test_the_scripts_print_what_is_shown(tmp_path):
    scripts = [example for example in EXAMPLES if alone(example[0])]
    assert len(scripts) == 2
    for code, shown in scripts:
        script = tmp_path / "script.py"
        script.write_text(code, encoding="utf-8")
        done = subprocess.run([sys.executable, script], cwd=tmp_path, capture_output=True, text=True)
        assert (done.stdout, done.returncode) == (shown, 0), done.stderr
