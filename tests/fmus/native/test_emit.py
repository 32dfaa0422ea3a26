"""Random programs of typed functions as C, in one file, beside the interpreter of such programs: every bit.

Expressions of all operators in all nestings, branches, loops whose variable changes in their body, `while`
with what is computed before its test, break, continue, lists, failures, calls, remembered calls, derived
values.
"""

from __future__ import annotations

import ctypes
import dataclasses
import random
import re
import struct
import subprocess
from pathlib import Path
from typing import Any

import pytest

from evcosim.fmus.native import emit, ir, toolchain
from evcosim.fmus.native.emit_types import c_name
from evcosim.fmus.native.lower import lower
from evcosim.fmus.native.values import BOOLEAN, INTEGER, REAL, ListType, Type
from support.ir_interpreter import Failed, Interpreter
from support.lowered import compare
from support.needs import need_c_compiler
from support.small_model import cases, small

RUNTIME = Path(emit.__file__).parent / "c"
NAMES = cases(Path(__file__).with_name("taken_names.txt"))
COUNT, CALLS = 150, 12
LIST = ListType(REAL, 4)
PLACE = ir.Place("chance.py", 7)
NUMBERS = (0.0, -0.0, 1.0, -2.5, 0.1, 3.0, 1e-3, 7.25, 1e6)
Block = list[ir.Statement]


def whole(value: int) -> ir.Literal:
    """Return an integer."""
    return ir.Literal(INTEGER, value)


class Writer:
    """One random function; `known` are the variables that have a value where the next statement stands."""

    def __init__(
        self, draw: random.Random, number: int, program: ir.Program, callees: list[ir.Function]
    ) -> None:
        self.draw, self.callees, self.fails, self.loops = draw, callees, False, 0
        self.parameters = ir.Local(program.parameters, "p")
        self.arguments = (
            self.parameters,
            *(ir.Local(REAL, n) for n in "ab"),
            *(ir.Local(INTEGER, n) for n in "km"),
            ir.Local(BOOLEAN, "t"),
        )
        self.known: set[ir.Local] = set(self.arguments[1:])
        self.locals: dict[str, ir.Local] = {}
        remembers = draw.random() < 0.25
        body = self.block(draw.randint(2, 6), 0)
        body.append(ir.Return(self.real(3)))
        self.function = ir.Function(
            f"f{number}", self.arguments, REAL, tuple(self.locals.values()), tuple(body), self.fails,
            ir.Place("chance.py", number + 1), f"Function {number}", remembers,
        )  # fmt: skip # as they are declared

    def local(self, type_: Type) -> ir.Local:
        """Return a variable, new or old, that a statement gives a value."""
        kind = {REAL: "x", INTEGER: "n", BOOLEAN: "c"}.get(type_, "l")  # type: ignore[call-overload] # a key of any type
        name = f"{kind}{self.draw.randint(0, 4)}"
        return self.locals.setdefault(name, ir.Local(type_, name))

    def fresh(self, kind: str) -> ir.Local:
        """Return a new integer that no other statement changes."""
        self.loops += 1
        name = f"{kind}{self.loops}"
        return self.locals.setdefault(name, ir.Local(INTEGER, name))

    def of(self, type_: Type) -> ir.Local | None:
        """Return a variable of a type that has a value."""
        found = sorted((x for x in self.known if x.type == type_), key=lambda x: x.name)
        return self.draw.choice(found) if found else None

    # -- expressions -----------------------------------------------------------------------------------------

    def real(self, depth: int) -> ir.Expression:
        """Return a random real."""
        draw, more = self.draw, depth - 1
        if depth == 0 or draw.random() < 0.15:
            if (variable := self.of(REAL)) and draw.random() < 0.7:
                return variable
            return ir.Literal(REAL, draw.choice(NUMBERS))
        kind = draw.choice(
            ("+", "-", "*", "/", "neg", "select", "int", "max", "min", "abs", "item", "field", "call")
        )
        if kind in ("+", "-", "*"):
            return ir.Operation(REAL, kind, (self.real(more), self.real(more)))
        if kind == "/":
            return ir.Operation(REAL, "/", (self.real(more), ir.Literal(REAL, draw.choice((3.0, -0.7, 1e3)))))
        if kind == "neg":
            return ir.Operation(REAL, "-", (self.real(more),))
        if kind == "select":
            return ir.Select(REAL, self.truth(more), self.real(more), self.real(more))
        if kind == "int":
            return ir.Convert(REAL, self.integer(more))
        if kind == "abs":
            return ir.Apply(REAL, "py_float_abs", (self.real(more),))
        if kind == "field":
            return ir.Field(REAL, self.parameters, "a")
        if kind == "item" and (numbers := self.of(LIST)):
            return ir.Item(REAL, numbers, whole(draw.randint(0, 3)))
        pure = [f for f in self.callees if not f.can_fail]
        if kind == "call" and pure:
            return ir.Invoke(REAL, (f := draw.choice(pure)).name, self.given(f, more))
        return ir.Apply(
            REAL, draw.choice(("py_float_max", "py_float_min")), (self.real(more), self.real(more))
        )

    def integer(self, depth: int) -> ir.Expression:
        """Return a random integer that is small enough for every operator above it."""
        draw, more = self.draw, depth - 1
        if depth <= 0 or draw.random() < 0.2:
            if (variable := self.of(INTEGER)) and draw.random() < 0.7:
                return variable
            return whole(draw.randint(-9, 9))
        kind = draw.choice(("+", "-", "*", "neg", "select", "bool", "length"))
        if kind in ("+", "-"):
            return ir.Operation(INTEGER, kind, (self.integer(more), self.integer(more)))
        if kind == "*":
            return ir.Operation(INTEGER, "*", (self.integer(more), whole(draw.randint(-9, 9))))
        if kind == "neg":
            return ir.Operation(INTEGER, "-", (self.integer(more),))
        if kind == "select":
            return ir.Select(INTEGER, self.truth(more), self.integer(more), self.integer(more))
        if kind == "length" and (numbers := self.of(LIST)):
            return ir.Length(INTEGER, numbers)
        return ir.Convert(INTEGER, self.truth(more))

    def bounded(self, depth: int) -> ir.Expression:
        """Return a random integer from -99 to 99."""
        low = ir.Apply(INTEGER, "py_int_max", (self.integer(depth), whole(-99)))
        return ir.Apply(INTEGER, "py_int_min", (low, whole(99)))

    def truth(self, depth: int) -> ir.Expression:
        """Return a random truth value."""
        draw, more = self.draw, depth - 1
        if depth <= 0:
            return self.of(BOOLEAN) or ir.TRUE
        kind = draw.choice(("and", "or", "not", "==", "!=", "<", "<=", ">", ">=", "select"))
        if kind in ("and", "or"):
            return ir.Operation(BOOLEAN, kind, (self.truth(more), self.truth(more)))
        if kind == "not":
            return ir.Operation(BOOLEAN, "not", (self.truth(more),))
        if kind == "select":
            return ir.Select(BOOLEAN, self.truth(more), self.truth(more), self.truth(more))
        of = draw.choice((self.real, self.integer))
        return ir.Operation(BOOLEAN, kind, (of(more), of(more)))

    def given(self, function: ir.Function, depth: int) -> tuple[ir.Expression, ...]:
        """Return arguments of another function."""
        assert len(function.arguments) == 6
        numbers = self.bounded(0), self.bounded(0)
        return (self.parameters, self.real(depth), self.real(depth), *numbers, self.truth(depth))

    # -- statements ------------------------------------------------------------------------------------------

    def block(self, length: int, depth: int, within: bool = False) -> Block:
        """Return statements; `within` a loop some leave it."""
        found: Block = []
        for _ in range(length):
            found += self.statement(depth, within)
        return found

    def statement(self, depth: int, within: bool) -> Block:
        """Return one statement, or a few that belong together."""
        draw = self.draw
        kinds = ["real", "real", "integer", "truth", "list", "checked", "call", "derive", "item"]
        kinds += ["if", "if", "for", "while"] if depth < 3 else []
        kinds += ["leave"] if within else []
        kind = draw.choice(kinds)
        if kind in ("if", "for", "while"):
            return {"if": self.branch, "for": self.turns, "while": self.loop}[kind](depth, within)
        if kind == "leave":
            leave = (ir.Break(),) if draw.random() < 0.5 else (ir.Continue(),)
            return [ir.If(self.truth(2), leave)]
        if kind == "item" and (numbers := self.of(LIST)):
            return [ir.SetItem(numbers, whole(draw.randint(0, 3)), self.real(2))]
        if kind == "call" and self.callees:
            return [self.called(draw.choice(self.callees))]
        target, made = self.assigned(kind)
        self.known.add(target)
        return made

    def assigned(self, kind: str) -> tuple[ir.Local, Block]:
        """Return a statement that gives a variable a value, and the variable."""
        if kind == "integer":
            value = self.bounded(3)
            return (target := self.local(INTEGER)), [ir.Assign(target, value)]
        if kind == "truth":
            value = self.truth(3)
            return (target := self.local(BOOLEAN)), [ir.Assign(target, value)]
        if kind == "list":
            made = ir.Make(LIST, tuple(self.real(1) for _ in range(4)))
            return (target := self.local(LIST)), [ir.Assign(target, made)]
        if kind == "derive":
            return (target := self.local(REAL)), [ir.Derive(target, self.parameters, "derived")]
        if kind == "checked":
            self.fails = True
            name = self.draw.choice(("py_float_div", "py_float_mod", "py_float_floordiv"))
            given = self.real(2), self.real(2)
            return (target := self.local(REAL)), [ir.Checked(target, name, given, PLACE, "(V1)")]
        value = self.real(4)
        return (target := self.local(REAL)), [ir.Assign(target, value)]

    def called(self, function: ir.Function) -> ir.Statement:
        """Return a call of another function."""
        self.fails |= function.can_fail
        given = self.given(function, 2)
        target = self.local(REAL)
        self.known.add(target)
        return (
            ir.Call(target, function.name, given)
            if function.can_fail
            else ir.Assign(target, ir.Invoke(REAL, function.name, given))
        )

    def branch(self, depth: int, within: bool) -> Block:
        """Return an `if`, which may fail."""
        test, before = self.truth(3), set(self.known)
        then = self.block(self.draw.randint(1, 3), depth + 1, within)
        after_then, self.known = self.known, before
        otherwise = self.block(self.draw.randint(0, 2), depth + 1, within)
        self.known = self.known & after_then
        if self.draw.random() < 0.1:
            self.fails = True
            text = ("a is ", ir.Shown(self.arguments[1], "!r"))
            then.append(ir.Raise("ValueError", text, PLACE))
            self.known = before
        return [ir.If(test, tuple(then), tuple(otherwise))]

    def turns(self, depth: int, _: bool) -> Block:
        """Return a `for` over a range, whose variable its body may change and others may read behind it."""
        draw = self.draw
        turn = draw.choice((self.fresh("i"), self.local(INTEGER)))
        start, stop = whole(draw.randint(-2, 3)), whole(draw.randint(-2, 4))
        step = draw.choice((1, 1, 2, -1))
        known = set(self.known)
        if draw.random() < 0.4 and (number := self.of(INTEGER)):
            limit = ir.Apply(INTEGER, "py_int_min", (number, whole(3)))
            stop = limit if step > 0 else ir.Apply(INTEGER, "py_int_max", (limit, whole(-3)))
        self.known = known | {turn}
        body = self.block(draw.randint(1, 3), depth + 1, True)
        self.known = known
        return [ir.For(turn, start, stop, step, tuple(body))]

    def loop(self, depth: int, _: bool) -> Block:
        """Return a `while` of a few turns, counted before its test."""
        count = self.fresh("w")
        known = set(self.known)
        before: Block = [ir.Assign(count, ir.Operation(INTEGER, "+", (count, whole(1))))]
        if self.draw.random() < 0.5:
            target, made = self.assigned(self.draw.choice(("real", "truth")))
            before += made
            self.known.add(target)
        test = ir.Operation(BOOLEAN, "<", (count, whole(self.draw.randint(1, 5))))
        if self.draw.random() < 0.5:
            test = ir.Operation(BOOLEAN, "and", (test, self.truth(2)))
        body = self.block(self.draw.randint(1, 3), depth + 1, True)
        self.known = known
        return [ir.Assign(count, whole(0)), ir.While(tuple(before), test, tuple(body))]


def random_program(seed: int) -> tuple[Any, ir.Program]:
    """Return a small model, and its program with many random functions."""
    model = small("return Small.State(x.x)")
    program = lower(model)
    p = ir.Local(program.parameters, "p")
    value = ir.Operation(REAL, "*", (ir.Field(REAL, p, "a"), ir.Literal(REAL, 3.3)))
    derive = ir.Function("derive_it", (p,), REAL, (), (ir.Return(value),), False, PLACE)
    program.parameters.derived["derived"] = (REAL, "derive_it")
    draw, functions = random.Random(seed), []
    for number in range(COUNT):
        callees = draw.sample(functions, min(len(functions), 3))
        functions.append(Writer(draw, number, program, callees).function)
    return model, dataclasses.replace(program, functions=(*program.functions, derive, *functions))


def library(model: Any, program: ir.Program, folder: Path) -> ctypes.CDLL:
    """Return the program as C, with a function for callers around each random one."""
    functions = emit.Functions(program)
    lines = ["static Memory kept;"]
    for f in (f for f in program.functions if f.about.startswith("Function ")):
        memory = ", &kept" if f.name in functions.with_memory else ""
        given = "double a, double b, int64_t k, int64_t m, bool t, double *r, model_failure *w"
        head = f"bool run_{f.name}({given})"
        made = f"{f.name}(&given, a, b, k, m, t, r{memory}, w)"
        if not f.can_fail:
            made = f"(*r = {f.name}(&given, a, b, k, m, t{memory}), (void)w, true)"
        lines.append(f'__attribute__((visibility("default"))) {head}\n{{\n    return {made};\n}}')
    given = "static Parameters given = {.a = 1.5};\n"
    (folder / "model.c").write_text(emit.c_source(model, program, "id", "{t}") + given + "\n".join(lines))
    runtime = ["failure.c", "instance.c", "saved.c"]
    for file in (*RUNTIME.glob("*.h"), *(RUNTIME / name for name in runtime)):
        (folder / file.name).write_bytes(file.read_bytes())
    command = ["cc", *toolchain.EXACT, "-O1", "-fPIC", "-shared", "model.c", *runtime]
    done = subprocess.run([*command, "-o", "it.so", "-lm"], cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[:3000]
    return ctypes.CDLL(str(folder / "it.so"))


class Failure(ctypes.Structure):
    _fields_ = [
        ("code", ctypes.c_int),
        ("words", ctypes.c_char * 80),
        ("exception", ctypes.c_char_p),
        ("file", ctypes.c_char_p),
        ("line", ctypes.c_int),
        ("text", ctypes.c_char * 1024),
    ]


def bits(value: float) -> bytes:
    """Return what tells a number from others; any NaN is one NaN."""
    return b"nan" if value != value else struct.pack("<d", value)


@pytest.mark.parametrize("seed", [1, 2])
def test_random_programs_are_computed_as_the_interpreter_does(seed: int, tmp_path: Path) -> None:
    need_c_compiler()
    model, program = random_program(seed)
    native, run = library(model, program, tmp_path), Interpreter(program, model.Parameters())
    draw, failed, done = random.Random(seed), 0, 0
    for f in (f for f in program.functions if f.about.startswith("Function ")):
        for _ in range(CALLS):
            a, b = (draw.choice((*NUMBERS, draw.gauss(0.0, 3.0))) for _ in range(2))
            k, m, t = draw.randint(-9, 9), draw.randint(-9, 9), draw.random() < 0.5
            result, failure = ctypes.c_double(), Failure()
            given = (
                ctypes.c_double(a),
                ctypes.c_double(b),
                ctypes.c_int64(k),
                ctypes.c_int64(m),
                ctypes.c_bool(t),
            )
            function = getattr(native, f"run_{f.name}")
            function.restype = ctypes.c_bool
            went = function(*given, ctypes.byref(result), ctypes.byref(failure))
            try:
                expected = run._call(f.name, run.parameters, a, b, k, m, t)
            except Failed as error:
                said = (failure.exception, failure.text, failure.file, failure.line)
                assert not went and said == tuple(
                    x.encode() if isinstance(x, str) else x for x in error.args
                ), (f, a, b, k, m, t)
                failed += 1
            else:
                assert went and bits(result.value) == bits(expected), (
                    f.name,
                    a,
                    b,
                    k,
                    m,
                    t,
                    expected,
                    result.value,
                )
                done += 1
    assert done > failed > 10


def test_two_loops_of_one_block_count_with_the_same_name_to_ends_of_their_own(tmp_path: Path) -> None:
    need_c_compiler()
    model = small("""y = 0.0
for k in range(p.n):
    y += u.u
for k in range(p.n):
    y += u.v
return Small.State(y)""")
    source = emit.c_source(model, lower(model), "id", "{t}")
    assert source.count("k_stop = ") == 2
    is_c_without_warnings(source, tmp_path)


def is_c_without_warnings(source: str, folder: Path) -> None:
    (folder / "model.c").write_text(source)
    command = ["cc", "-std=c99", "-Wall", "-Wextra", "-Werror", "-fsyntax-only", f"-I{RUNTIME}", "model.c"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[:2000]


@pytest.mark.parametrize("name", NAMES)
def test_a_name_that_is_taken_in_c_is_that_of_a_model_too(name: str, tmp_path: Path) -> None:
    need_c_compiler()
    model = NAMES[name].model()
    program = lower(model)
    is_c_without_warnings(emit.c_source(model, program, "id", "{t}"), tmp_path)
    for seed in range(4):
        compare(model, program, seed, steps=3)


def test_a_step_is_computed_in_place_and_what_is_known_already_is_not() -> None:
    derived = "@cached_property\ndef both(self):\n    return self.a + self.a"
    long = "".join(f"value = value * {k}.0\n    " for k in range(100))
    above = f"def twice(value):\n    return value + value\n\n\ndef long(value):\n    {long}return value"
    model = small(
        "return Small.State(twice(long(long(long(long(u.u))))) + p.both)", derived=derived, above=above
    )
    source = emit.c_source(model, lower(model), "id", "{t}")
    for head in (
        "MODEL_IN_PLACE State step(",
        "MODEL_IN_PLACE double twice(",
        "MODEL_IN_PLACE double Parameters_both(",
        "MODEL_APART double compute_both(",
        "static double long_(",  # 400 statements in place of four calls
        "static State initial(",
    ):
        assert source.count(f"\n{head}") == 2, head  # declared and defined


def test_no_name_of_a_model_is_one_of_the_runtime() -> None:
    """Every name that model.c finds in the headers gets a `_` where a model has it too."""
    headers = [RUNTIME / name for name in ("instance.h", "model.h", "failure.h", "step.h")]
    text = re.sub(r"/\*.*?\*/", "", "".join(header.read_text() for header in headers), flags=re.DOTALL)
    constants = [
        re.findall(r"\w+(?=\s*(?:=|,|$))", within)
        for within in re.findall(r"enum \{(.*?)\}", text, re.DOTALL)
    ]
    defined = {name for names in constants for name in names if not name.isdigit()}
    types = set(re.findall(r"^\}? ?(?:typedef .* )?(\w+);$", text, re.MULTILINE))
    functions = set(re.findall(r"^[\w *]*\b(\w+)\(", text, re.MULTILINE)) - {"__attribute__"}
    found = {*defined, *types, *functions}
    assert {"SETTABLE", "REAL", "instance", "instance_step", "model_begin"} <= found
    assert [name for name in sorted(found) if c_name(name) == name] == []
