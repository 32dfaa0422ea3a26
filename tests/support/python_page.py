"""docs/python.md: its reference blocks from the signatures and docstrings of the public names.

    .venv/bin/python tests/support/python_page.py            # exit code 1 if a block is out of date
    .venv/bin/python tests/support/python_page.py --write    # the blocks anew

A block stands between `<!-- reference: NAME ... -->` and `<!-- end -->`; one that begins with `summary` has a
line for each name. The prose and the examples around the blocks are written by hand.
"""

from __future__ import annotations

import ast
import dataclasses
import importlib
import inspect
import re
import sys
import textwrap
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import evcosim

PAGE = Path(__file__).parents[2] / "docs" / "python.md"
_BLOCK = re.compile(r"(<!-- (reference|summary): ([\w ]+) -->\n).*?(<!-- end -->)", re.DOTALL)
_WIDTH = 100  # characters of a signature in one line


def rewritten(page: str) -> str:
    """Return the page with each block as the code says it."""
    made = {"reference": reference, "summary": summary}
    return _BLOCK.sub(lambda found: f"{found[1]}\n{made[found[2]](found[3].split())}\n{found[4]}", page)


def described(page: str) -> list[str]:
    """Return the names that have a reference on the page."""
    return [name for found in _BLOCK.finditer(page) for name in found[3].split()]


def named(page: str) -> set[str]:
    """Return the names beginning with a capital in the signatures, keys and members of the references."""
    found = set()
    for block in _BLOCK.finditer(page):
        if block[2] == "reference":
            code = [*re.findall(r"```python\n(.*?)```", block[0], re.DOTALL)]
            code += re.findall(r"^\| `(.*?)` \|(?: `(.*?)` \|)?", block[0].replace("\\|", "/"), re.MULTILINE)
            found |= set(re.findall(r"\b[A-Z]\w+", str(code)))
    return found


def reference(names: list[str]) -> str:
    """Return the references of some names of `evcosim`, in this order."""
    return "\n".join(_entry(name, getattr(evcosim, name)) for name in names)


def summary(names: list[str]) -> str:
    """Return a table of some names of `evcosim`: first paragraph, or the type that it stands for."""
    rows = [(f"`{name}`", _in_a_line(name, getattr(evcosim, name))) for name in names]
    return _table(("name", ""), rows) + "\n"


def _in_a_line(name: str, item: Any) -> str:
    if inspect.isclass(item):
        return _first_paragraph(item)
    body = ast.parse(inspect.getsource(importlib.import_module(f"evcosim.{evcosim._MODULES[name]}"))).body
    (i,) = (
        i
        for i, each in enumerate(body)
        if isinstance(each, ast.Assign) and ast.unparse(each.targets[0]) == name
    )
    assert isinstance(body[i], ast.Assign)
    stands_for = re.sub(r"Annotated\[(\w+), .*", r"\1", ast.unparse(body[i].value))  # without its validators
    return f"`{stands_for}` {_docstring(body[i + 1 : i + 2])}".rstrip()


def _entry(name: str, item: Any) -> str:
    """Heading, signature, docstring and, of a class, its keys (where each is described) and members."""
    parts = [f"#### `{name}`"]
    keys = list(_keys(item)) if _is_record(item) else []
    described = any(row[-1] for row in keys)
    if not (described or _is_error(item)):
        parts.append(f"```python\n{_signature(name, item)}\n```")
    parts.append(inspect.cleandoc(item.__doc__ or ""))
    if described:
        parts.append(_table(("key", "type and default", ""), keys))
    if inspect.isclass(item) and (members := list(_members(item))):
        parts.append(_table(("member", ""), members))
    return "\n\n".join(parts) + "\n"


def _is_record(item: Any) -> bool:
    """True of a class that is its keys: a TypedDict, a dataclass, or the record of a file (pydantic)."""
    return any(hasattr(item, key) for key in ("__optional_keys__", "model_fields")) or (
        dataclasses.is_dataclass(item)
    )


def _is_error(item: Any) -> bool:
    return inspect.isclass(item) and issubclass(item, Exception)


def _table(headers: tuple[str, ...], rows: list[tuple[str, ...]]) -> str:
    escaped = [[cell.replace("|", "\\|") for cell in row] for row in rows]
    first, *others = (f"| {' | '.join(cells)} |".replace("|  |", "| |") for cells in (headers, *escaped))
    return "\n".join([first, "|---" * len(headers) + "|", *others])


# ---- signatures


def _signature(name: str, item: Any) -> str:
    """A call with the types of its arguments, one a line where a line does not hold them."""
    signature = inspect.signature(item)
    text = f"{name}{_as_text(signature)}"
    if len(text) <= _WIDTH:
        return text
    lines = []
    for parameter in signature.parameters.values():
        if parameter.kind is parameter.KEYWORD_ONLY and "*" not in lines:
            lines.append("*")
        lines.append(_unquoted(str(parameter)))
    ending = text.rpartition(")")[2]
    return "\n".join([f"{name}(", *(f"    {line}," for line in lines), f"){ending}"])


def _as_text(signature: inspect.Signature) -> str:
    """A signature without `self`; annotations, which are strings in the code, without quotes."""
    shown = [parameter for parameter in signature.parameters.values() if parameter.name != "self"]
    return _unquoted(str(signature.replace(parameters=shown))).removesuffix(" -> None")


def _unquoted(text: str) -> str:
    return re.sub(r"(?<=: |> )'([^']*)'", r"\1", text)


# ---- what stands in a class


def _keys(item: Any) -> Iterator[tuple[str, ...]]:
    """Name, type with default, and meaning of each key of a record, those of its bases first."""
    for each in reversed(item.__mro__):
        if not each.__module__.startswith("evcosim."):
            continue
        body = _source(each).body
        for i, statement in enumerate(body):
            if isinstance(statement, ast.AnnAssign) and isinstance(statement.target, ast.Name):
                yield (
                    f"`{statement.target.id}`",
                    f"`{ast.unparse(statement.annotation)}{_default(statement.value)}`",
                    _docstring(body[i + 1 : i + 2]),
                )


def _default(value: ast.expr | None) -> str:
    """The default of a key as text; "" where there is none, as in `= Field(min_length=1)`."""
    if isinstance(value, ast.Call) and ast.unparse(value.func) == "Field":
        value = next((keyword.value for keyword in value.keywords if keyword.arg == "default"), None)
    return f" = {ast.unparse(value)}" if value is not None else ""


def _source(item: Any) -> ast.ClassDef:
    found = ast.parse(textwrap.dedent(inspect.getsource(item))).body[0]
    assert isinstance(found, ast.ClassDef)
    return found


def _docstring(following: list[ast.stmt]) -> str:
    """The text below a key; "" where the next statement is none."""
    for statement in following:
        if isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant):
            return " ".join(str(statement.value.value).split())
    return ""


def _members(item: Any) -> Iterator[tuple[str, ...]]:
    """Signature and first paragraph of public properties and methods, in their order in the class."""
    for name, member in vars(item).items():
        if isinstance(member, property):
            yield f"`{name}: {_returned(member.fget)}`", _first_paragraph(member)
        elif isinstance(member, classmethod):
            signature = _as_text(inspect.signature(getattr(item, name)))
            yield f"`{item.__name__}.{name}{signature}`", _first_paragraph(member.__func__)
        elif inspect.isfunction(member) and (not name.startswith("_") or name == "__getitem__"):
            text = _as_text(inspect.signature(member))
            call = f"[{text[1:].replace(')', ']', 1)}" if name == "__getitem__" else f"{name}{text}"
            yield f"`{call}`", _first_paragraph(member)


def _returned(function: Any) -> str:
    return str(inspect.signature(function).return_annotation)


def _first_paragraph(item: Any) -> str:
    return " ".join(inspect.cleandoc(item.__doc__ or "").split("\n\n")[0].split())


def main() -> None:
    """Compare the page with the code, or write it."""
    old = PAGE.read_text(encoding="utf-8")
    new = rewritten(old)
    if sys.argv[1:] == ["--write"]:
        PAGE.write_text(new, encoding="utf-8")
    elif new != old:
        sys.exit(f"{PAGE.name} is not what the code says: python tests/support/python_page.py --write")


if __name__ == "__main__":
    main()
