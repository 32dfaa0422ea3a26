"""The functions of a program as C, and the memory of those that remember their last call."""

from __future__ import annotations

import re
from collections.abc import Iterator

from . import ir
from .emit_blocks import Frame, body, read
from .emit_expressions import Scope
from .emit_inlining import Calls, called, derived_name
from .emit_kept import Kept
from .emit_types import argument, c_name, type_name
from .values import COMPLEX, ArrayType, EnumType, ListType, ParametersType, Scalar, StructType, Type


def comment(text: str) -> str:
    """Return a text that a comment of C can hold."""
    return text.replace("*/", "* /").replace("/*", "/ *").replace("\\", "/")


# -- remembered calls ----------------------------------------------------------------------------------------


def remembered(program: ir.Program) -> list[ir.Function]:
    return [f for f in program.functions if f.remembers]


def _compared(function: ir.Function) -> list[ir.Local]:
    return [a for a in function.arguments if not isinstance(a.type, ParametersType)]


def memory(program: ir.Program, values: int) -> str:
    """Return the definition of what is kept between steps: the last call of each function that remembers
    it, and so many values of the mathematical library; "" if that is nothing."""
    lines = [f"    py_kept kept[{values}];"] if values else []
    for function in remembered(program):
        assert function.returns is not None
        fields = [f"{type_name(a.type)} {c_name(a.name)};" for a in _compared(function)]
        fields = ["bool known;", *fields, f"{type_name(function.returns)} result;"]
        lines += [
            "    struct {",
            *(f"        {field}" for field in fields),
            f"    }} {c_name(function.name)};",
        ]
    about = "/* what is kept between steps: values of exp and the like, last calls of functions */"
    return "\n".join([about, "typedef struct {", *lines, "} Memory;\n"]) if lines else ""


def _same(type_: Type, a: str, b: str) -> str:
    """Return a test that two values are equal as Python compares them."""
    if type_ is COMPLEX:
        return f"py_complex_eq({a}, {b})"
    if isinstance(type_, Scalar | EnumType):
        return f"{a} == {b}"
    if isinstance(type_, StructType):
        return " && ".join(_same(t, f"{a}.{c_name(n)}", f"{b}.{c_name(n)}") for n, t in type_.fields)
    assert isinstance(type_, ArrayType), type_
    return " && ".join(_same(type_.item, f"{a}.at[{k}]", f"{b}.at[{k}]") for k in range(type_.length))


# -- functions -----------------------------------------------------------------------------------------------


class Functions:
    """The functions of a program as C: which fail, which need the memory, their heads and bodies."""

    def __init__(self, program: ir.Program, clock: str | None = None) -> None:
        """`clock` is the name of the time among the inputs."""
        self._program = program
        self._derived = [
            (program.parameters, name, type_, by) for name, (type_, by) in program.parameters.derived.items()
        ]
        fails = {f.name for f in program.functions if f.can_fail}
        accessors = {derived_name(type_name(p), name): by for p, name, _, by in self._derived}
        self.failing = frozenset(fails | {name for name, by in accessors.items() if by in fails})
        calls = Calls(program)
        self._in_place = calls.in_place()
        self._kept = Kept(program, calls.in_step, clock)
        self.memory = memory(program, self._kept.count)
        self.with_memory = self._in_need_of_memory(accessors)
        self._apart = frozenset([*accessors.values(), *(f"{f.name}_computed" for f in remembered(program))])

    def _in_need_of_memory(self, accessors: dict[str, str]) -> frozenset[str]:
        """Return the functions that keep something, and those that call one of them, however deep."""
        calls = {f.name: set(called(f.body)) for f in self._program.functions}
        calls |= {name: {by} for name, by in accessors.items()}
        needing = {f.name for f in remembered(self._program)} | self._kept.functions
        while more := {name for name, its in calls.items() if its & needing} - needing:
            needing |= more
        return frozenset(needing)

    def heads(self) -> Iterator[str]:
        """Return the head of every function, so that their order does not matter."""
        for f in self._program.functions:
            yield self._head(f, f.name)
        for p, name, type_, _ in self._derived:
            yield self._accessor_head(p, name, type_)

    def texts(self) -> Iterator[str]:
        """Return the text of every function."""
        for f in self._program.functions:
            if f.remembers:
                yield self._function(f, f"{f.name}_computed")
                yield self._remembering(f)
            else:
                yield self._function(f, f.name)
        for derived in self._derived:
            yield self._accessor(*derived)

    def _speaks(self, f: ir.Function) -> bool:
        return f.name == self._program.notice

    def _head(self, f: ir.Function, name: str) -> str:
        """Return the head of a function: the result of one that can fail goes through a pointer."""
        given = [argument(a.type, c_name(a.name)) for a in f.arguments]
        fails = f.can_fail or self._speaks(f)
        if fails and f.returns is not None:
            given.append(f"{type_name(f.returns)} *result")
        if self._speaks(f):
            given.append("model_text *said")
        if f.name in self.with_memory:
            given.append("Memory *memory")
        if fails:
            given.append("model_failure *failure")
        returned = "bool" if fails else "void" if f.returns is None else type_name(f.returns)
        return f"{self._linkage(name)} {returned} {c_name(name)}({', '.join(given) or 'void'})"

    def _linkage(self, name: str) -> str:
        """Return how a function is declared: what is computed once is kept out of what each step does."""
        return (
            "MODEL_IN_PLACE" if name in self._in_place else "MODEL_APART" if name in self._apart else "static"
        )

    def _function(self, f: ir.Function, name: str) -> str:
        addresses = frozenset(a.name for a in f.arguments if isinstance(a.type, ListType | ParametersType))
        reads = set(read(f.body))
        unread = frozenset(x.name for x in f.locals if x.name not in reads)
        frame = Frame(
            f, Scope(addresses, self.with_memory), self.failing, unread, self._kept, speaks=self._speaks(f)
        )
        lines = body(frame)
        if frame.can_fail and f.returns is None and not (lines and lines[-1].startswith("return")):
            lines.append("return true;")
        text = "\n".join(lines)
        written = set(re.findall(r"\w+", text))
        unused = [c_name(a.name) for a in f.arguments if c_name(a.name) not in written]
        frames = (("failure", frame.can_fail), ("said", frame.speaks), ("memory", f.name in self.with_memory))
        unused += [name for name, given in frames if given and name not in text]
        lines = [f"(void){name};" for name in unused] + lines
        inner = "".join(f"    {line}\n" for line in lines)
        about = f"{comment(f.about)} " if f.about else ""
        head = self._head(f, name)
        return f"/* {about}({f.place.file}:{f.place.line}) */\n{head}\n{{\n{inner}}}\n"

    def _remembering(self, f: ir.Function) -> str:
        """Return the function that gives the remembered result for equal arguments, else computes it."""
        kept, compared = f"memory->{c_name(f.name)}", [c_name(a.name) for a in _compared(f)]
        tests = [_same(a.type, f"{kept}.{c_name(a.name)}", c_name(a.name)) for a in _compared(f)]
        computed, given = c_name(f"{f.name}_computed"), [c_name(a.name) for a in f.arguments]
        if f.can_fail:
            given += [f"&{kept}.result", "memory", "failure"]
            compute = [f"if (!{computed}({', '.join(given)}))", "    return false;"]
            leave = [f"*result = {kept}.result;", "return true;"]
        else:
            compute = [f"{kept}.result = {computed}({', '.join([*given, 'memory'])});"]
            leave = [f"return {kept}.result;"]
        keep = [*compute, *(f"{kept}.{name} = {name};" for name in compared), f"{kept}.known = true;"]
        lines = [f"if (!({' && '.join([f'{kept}.known', *tests])})) {{", f"    {kept}.known = false;"]
        lines += [*(f"    {line}" for line in keep), "}", *leave]
        return f"{self._head(f, f.name)}\n{{\n" + "".join(f"    {line}\n" for line in lines) + "}\n"

    def _accessor_head(self, p: ParametersType, name: str, type_: Type) -> str:
        own = derived_name(type_name(p), name)
        memory = ["Memory *memory"] if own in self.with_memory else []
        if own in self.failing:
            given = [f"{type_name(p)} *p", f"{type_name(type_)} *result", *memory, "model_failure *failure"]
            return f"{self._linkage(own)} bool {own}({', '.join(given)})"
        return f"{self._linkage(own)} {type_name(type_)} {own}({', '.join([f'{type_name(p)} *p', *memory])})"

    def _accessor(self, p: ParametersType, name: str, type_: Type, by: str) -> str:
        """Return the function that gives what is derived from the parameters, computed at its first use."""
        field, own = f"p->{c_name(name)}", derived_name(type_name(p), name)
        memory = ["memory"] if by in self.with_memory else []
        if own in self.failing:
            given = ", ".join(["p", f"&{field}", *memory, "failure"])
            compute = [f"if (!{c_name(by)}({given}))", "    return false;"]
            leave = [f"*result = {field};", "return true;"]
        else:
            compute = [f"{field} = {c_name(by)}({', '.join(['p', *memory])});"]
            leave = [f"return {field};"]
        known = [f"    {line}" for line in (*compute, f"p->{name}_known = true;")]
        lines = [f"if (!p->{name}_known) {{", *known, "}", *leave]
        return f"{self._accessor_head(p, name, type_)}\n{{\n" + "".join(f"    {x}\n" for x in lines) + "}\n"
