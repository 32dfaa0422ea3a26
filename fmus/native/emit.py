"""A lowered model as one file of readable C99: its types, its tables, its functions, its description.

Each function of Python is a function of C, with the same names, its equation numbers as comments, and the
place in Python's source that it comes from. Compile it with -ffp-contract=off: a product that is fused with
a sum has other last bits than Python's.
"""

from __future__ import annotations

from collections.abc import Iterator

from ...models.base import Model, variables
from ..interface import exposed
from . import ir
from .basis import python_minor
from .emit_description import description
from .emit_expressions import constant
from .emit_functions import Functions, comment
from .emit_types import c_name, definition, parts, type_name
from .values import Type


def c_source(
    model: type[Model], program: ir.Program, identity: str, token: str, minor: int | None = None
) -> str:
    """Return model.c of a model, of the program that it was lowered to.

    `identity` is that of its FMU, to which saved states belong, `token` the guid of its description, and
    `minor` the version of Python 3 that it follows, by default this one's.
    """
    clock = [e.variable.name for e in exposed(model) if e.causality == "independent"]
    functions = Functions(program, *clock)
    minor = minor or python_minor()
    pieces = [
        f"/* {program.name}: {comment(program.about)}\n\n   Made by evcosim of the model in Python. */",
        f"/* The Python 3 whose rules and words it follows. */\n#define PY_VERSION_MINOR {minor}\n",
        '#include <string.h>\n\n#include "model.h"\n',
        *_types(model, program),
        *(
            f"static const {type_name(t.type)} {c_name(t.name)} = {constant(t.value)};\n"
            for t in program.tables
        ),
        functions.memory,
        "\n".join(f"{head};" for head in functions.heads()) + "\n",
        *functions.texts(),
        *description(model, program, identity, token, functions),
        '#include "step.h"',
    ]
    text = "\n".join(piece for piece in pieces if piece)
    return "".join(f"{line}\n" for long in text.splitlines() for line in wrapped(long))


def _types(model: type[Model], program: ir.Program) -> Iterator[str]:
    """Return the definitions of all types, each before those that use it."""
    records = {
        program.parameters.name: model.Parameters,
        program.inputs.name: model.Inputs,
        program.state.name: model.State,
        program.outputs_type.name: model.Outputs,
    }
    wanted: list[Type] = [
        *program.types,
        program.inputs,
        program.state,
        program.outputs_type,
        program.parameters,
    ]
    for function in program.functions:
        wanted += [x.type for x in (*function.arguments, *function.locals)]
        wanted += [function.returns] if function.returns else []
    wanted += [table.type for table in program.tables]
    defined: set[str] = set()
    for type_ in wanted:
        for part in parts(type_):
            if (name := type_name(part)) not in defined:
                defined.add(name)
                yield definition(part, _meanings(records[name]) if name in records else None)


def _meanings(record: type) -> dict[str, str]:
    """Return description and unit of each variable of a record, as a comment."""
    try:
        declared = variables(record)
    except TypeError:  # a state may have fields that are no variables
        return {}
    texts = {v.name: f"{v.description} [{v.unit}]" if v.unit else v.description for v in declared}
    return {name: comment(text) for name, text in texts.items()}


def wrapped(line: str) -> list[str]:
    """Return a line of C as lines of at most 110 characters, where it can be broken at a blank.

    It is broken after a comma or before an operator if it has one, and never within a text.
    """
    lines, indent = [], " " * (len(line) - len(line.lstrip()) + 8)
    while len(line) > _WIDTH:
        places = [k for k in _blanks(line) if len(indent) < k <= _WIDTH]
        good = [k for k in places if line[k - 1] == "," or line[k + 1] in "+-*/&|?:"] or places
        if not good:
            break
        lines.append(line[: good[-1]])
        line = indent + line[good[-1] + 1 :]
    return [*lines, line]


_WIDTH = 110


def _blanks(line: str) -> list[int]:
    """Return the places of the blanks of a line that are in no text."""
    if line.lstrip().startswith("/*"):
        return [k for k, c in enumerate(line) if c == " "]
    found, within = [], False
    for k, c in enumerate(line):
        if c == '"' and line[k - 1] != "\\":
            within = not within
        elif c == " " and not within:
            found.append(k)
    return found
