"""Description of a model for instance.c: its variables, the fields of its state, its functions."""

from __future__ import annotations

from collections.abc import Iterator, Set

from ...models.base import Model
from ...models.base import Variable as Declared
from ..interface import exposed
from . import ir
from .emit_blocks import quoted
from .emit_expressions import literal
from .emit_functions import Functions
from .emit_types import c_name, numbers, type_name
from .values import BOOLEAN, INTEGER, REAL, EnumType, Scalar, Type

_CAUSALITY = {"parameter": "p", "input": "i", "independent": "t", "output": "o"}
_KIND = {"Real": "r", "Integer": "i", "Boolean": "b", "Enumeration": "e"}


def description(
    model: type[Model], program: ir.Program, identity: str, token: str, functions: Functions
) -> Iterator[str]:
    """Return the tables and the frame functions of a model, and at last the `model` that names them all."""
    has_memory = bool(functions.memory)
    yield from _variables(model, program)
    yield _state_fields(program)
    frames = _Frames(model, program, functions.failing, functions.with_memory)
    yield from frames.functions(has_memory)
    yield _model(model, program, identity, token, has_memory)


# -- variables -----------------------------------------------------------------------------------------------


def _variables(model: type[Model], program: ir.Program) -> Iterator[str]:
    records = {
        "parameter": program.parameters.name,
        "input": program.inputs.name,
        "independent": program.inputs.name,
        "output": program.outputs_type.name,
    }
    limits: list[str] = []
    items: list[str] = []
    lines: list[str] = []
    for reference, causality, v in exposed(model):
        fields = [quoted(v.name), quoted(v.unit), f"'{_KIND[v.type]}'", f"'{_CAUSALITY[causality]}'"]
        fields += [f"offsetof({c_name(records[causality])}, {c_name(v.name)})", literal(REAL, float(v.start))]
        for which, value in (("minimum", v.min), ("maximum", v.max)):
            if value is not None:
                limits.append(f"static const double {which}_{reference} = {literal(REAL, float(value))};")
            fields.append("NULL" if value is None else f"&{which}_{reference}")
        fields += ["NULL" if value is None else quoted(str(value)) for value in (v.min, v.max)]
        fields += _items(v, reference, items)
        lines.append(f"    {{{', '.join(fields)}}},")
    yield "\n".join([*limits, *items, "static const model_variable variables[] = {", *lines, "};\n"])


def _items(v: Declared, reference: int, to: list[str]) -> list[str]:
    """Return the fields of a variable that name the items of its enumeration; add their table to `to`."""
    if v.enumeration is None:
        return ["NULL", "0", "NULL"]
    values = ", ".join(str(int(item)) for item in v.enumeration)
    to.append(f"static const int32_t items_{reference}[] = {{{values}}};")
    shown = ", ".join(f"{int(item)} {item.name.lower()}" for item in v.enumeration)
    return [f"items_{reference}", str(len(v.enumeration)), quoted(shown)]


def _state_fields(program: ir.Program) -> str:
    name, tables, rows = type_name(program.state), dict[str, str](), list[str]()
    for row in numbers(program.state, ""):
        items = ["NULL", "0"]
        if isinstance(row.type, EnumType):
            table = f"items_of_{row.type.enumeration.__name__}"
            values = [str(int(item)) for item in row.type.enumeration]
            tables[table] = f"static const int32_t {table}[] = {{{', '.join(values)}}};"
            items = [table, str(len(values))]
        kind = _FIELD.get(row.type, "e") if isinstance(row.type, Scalar) else "e"
        place = f"offsetof({name}, {row.place})"
        rows.append(f"    {{'{kind}', {place}, {row.length}, {row.stride}, {', '.join(items)}}},")
    if not rows:
        return ""
    return "\n".join([*tables.values(), "static const model_field state_fields[] = {", *rows, "};\n"])


_FIELD = {REAL: "r", INTEGER: "i", BOOLEAN: "b"}


# -- frames: the functions of a model with the arguments that step.h and instance.c have ---------------------


class _Frames:
    def __init__(
        self, model: type[Model], program: ir.Program, failing: Set[str], with_memory: Set[str]
    ) -> None:
        self._program, self._failing, self._with_memory = program, failing, with_memory
        self._feeds_through = model.feeds_through()

    def functions(self, has_memory: bool) -> Iterator[str]:
        """Return the frame of each function of the model, and of what forgets."""
        p, inputs = self._program, type_name(self._program.inputs)
        state, shown = type_name(p.state), type_name(p.outputs_type)
        x, u = f"*(const {state} *)x", f"*(const {inputs} *)u"
        yield self._frame("initial", p.initial, "const void *u", [u], state, "x")
        yield self._frame(
            "step", p.step, "const void *x, const void *u, double dt", [x, u, "dt"], state, "next"
        )
        shows = [x, u] if self._feeds_through else [x]
        yield self._frame("outputs", p.outputs, "const void *x, const void *u", shows, shown, "y")
        if p.notice is not None:
            yield self._notice(p.notice, [x, f"*(const {state} *)next", u])
        known = [f"    ((Parameters *)p)->{name}_known = false;" for name in p.parameters.derived]
        known = [line.replace("Parameters", type_name(p.parameters)) for line in known] or ["    (void)p;"]
        memory = "    memset(memory, 0, sizeof(Memory));" if has_memory else "    (void)memory;"
        yield "\n".join(["static void forget(void *p, void *memory)", "{", *known, memory, "}\n"])

    def _frame(self, name: str, function: str, given: str, values: list[str], made: str, to: str) -> str:
        memory = ["memory"] if function in self._with_memory else []
        target = f"({made} *){to}"
        kind = "static bool" if name == "initial" else "MODEL_IN_PLACE bool"
        head = f"{kind} {name}_frame(void *p, {given}, void *memory, void *{to}, model_failure *failure)"
        unused = [] if memory else ["    (void)memory;"]
        if name == "outputs" and not self._feeds_through:
            unused.append("    (void)u;")
        if function in self._failing:
            call = f"    return {c_name(function)}({', '.join(['p', *values, target, *memory, 'failure'])});"
            return "\n".join([head, "{", *unused, call, "}\n"])
        call = f"    *{target} = {c_name(function)}({', '.join(['p', *values, *memory])});"
        return "\n".join([head, "{", *unused, "    (void)failure;", call, "    return true;", "}\n"])

    def _notice(self, function: str, values: list[str]) -> str:
        memory = ["memory"] if function in self._with_memory else []
        return "\n".join(
            [
                "MODEL_IN_PLACE bool notice_frame(void *p, const void *x, const void *next, const void *u,",
                "        void *memory, char *text, size_t size, model_failure *failure)",
                "{",
                *([] if memory else ["    (void)memory;"]),
                "    model_text said = model_begin(text, size);",
                f"    return {c_name(function)}({', '.join(['p', *values, '&said', *memory, 'failure'])});",
                "}\n",
            ]
        )


def _model(model: type[Model], program: ir.Program, identity: str, token: str, has_memory: bool) -> str:
    """Return the definition of `model`."""
    records: list[Type] = [program.parameters, program.inputs, program.state, program.outputs_type]
    sizes = [f"sizeof({type_name(record)})" for record in records]
    flags = ["true" if flag else "false" for flag in (model.sampled, model.feeds_through(), _timed(model))]
    has_state = any(True for _ in numbers(program.state, ""))
    rows = [
        quoted(program.name),
        quoted(identity),
        quoted(token),
        ", ".join(flags),
        ", ".join([*sizes, "sizeof(Memory)" if has_memory else "0"]),
        "variables, sizeof variables / sizeof *variables" if exposed(model) else "NULL, 0",
        "state_fields, sizeof state_fields / sizeof *state_fields" if has_state else "NULL, 0",
        "initial_frame, step_frame, outputs_frame",
        "NULL" if program.notice is None else "notice_frame",
        "forget",
    ]
    return "\n".join(["const model_description model = {", *(f"    {row}," for row in rows), "};\n"])


def _timed(model: type[Model]) -> bool:
    return any(causality == "independent" for _, causality, _ in exposed(model))
