"""A model as a program of typed functions: what `lower` makes of Python, and `emit` writes as C.

Expressions are pure and cannot fail, so that their order does not matter. All that can fail in Python (a
division, exp, an index, a call of a function that fails) is a statement with a target, in Python's order of
evaluation. Nothing here knows Python's syntax or C's.
"""

from __future__ import annotations

import dataclasses

from .values import BOOLEAN, ParametersType, StructType, Type


@dataclasses.dataclass(frozen=True)
class Place:
    """File and line that Python's traceback would name, the file as in `evcosim/models/scooter.py`."""

    file: str
    line: int


# -- expressions ---------------------------------------------------------------------------------------------


@dataclasses.dataclass(frozen=True)
class Literal:
    """A number that is known when the FMU is built; of an enumeration, its value."""

    type: Type
    value: float | int | bool | complex


@dataclasses.dataclass(frozen=True)
class Local:
    """An argument or a local variable."""

    type: Type
    name: str


@dataclasses.dataclass(frozen=True)
class TableItem:
    """The whole of a table of constants (`Program.tables`)."""

    type: Type
    name: str


@dataclasses.dataclass(frozen=True)
class Field:
    """A field of a struct or of the parameters; `re` and `im` of a complex number."""

    type: Type
    of: Expression
    name: str


@dataclasses.dataclass(frozen=True)
class Item:
    """An item of an array or a list; the index is within its length."""

    type: Type
    of: Expression
    index: Expression


@dataclasses.dataclass(frozen=True)
class Length:
    """The length of a list."""

    type: Type
    of: Expression


@dataclasses.dataclass(frozen=True)
class Operation:
    """Values of one type joined by an operator of Python that cannot fail here.

    It is one of `+ - *` and comparisons of reals and of integers whose sum is known to be within 64 bits,
    `/` by a real that is known not to be 0, `and`, `or` and `not` of truth values, and `-` with one operand.
    """

    type: Type
    operator: str
    operands: tuple[Expression, ...]


@dataclasses.dataclass(frozen=True)
class Apply:
    """A function of python_arithmetic.h that cannot fail."""

    type: Type
    function: str
    arguments: tuple[Expression, ...]


@dataclasses.dataclass(frozen=True)
class Invoke:
    """A function of the program that cannot fail and changes no argument."""

    type: Type
    function: str
    arguments: tuple[Expression, ...]


@dataclasses.dataclass(frozen=True)
class Select:
    """`then if test else otherwise`."""

    type: Type
    test: Expression
    then: Expression
    otherwise: Expression


@dataclasses.dataclass(frozen=True)
class Convert:
    """A number as a real, a truth value as an integer, an item of an enumeration as an integer."""

    type: Type
    value: Expression


@dataclasses.dataclass(frozen=True)
class Make:
    """A struct or an array of these values, in the order of its fields."""

    type: Type
    items: tuple[Expression, ...]


Expression = (
    Literal | Local | TableItem | Field | Item | Length | Operation | Apply | Invoke | Select | Convert | Make
)


# -- statements ----------------------------------------------------------------------------------------------


@dataclasses.dataclass(frozen=True)
class Assign:
    """`target = value`; `note` is the source's comment at the end of the line, as (V2)."""

    target: Local
    value: Expression
    note: str = ""


@dataclasses.dataclass(frozen=True)
class SetItem:
    """`list[index] = value`; the index is within the length."""

    list: Local
    index: Expression
    value: Expression
    note: str = ""


@dataclasses.dataclass(frozen=True)
class SetLength:
    """The length of a list becomes `length`, which is within its capacity."""

    list: Local
    length: Expression


@dataclasses.dataclass(frozen=True)
class Checked:
    """`target = function(arguments)`, a function of python_arithmetic.h that can fail."""

    target: Local
    function: str
    arguments: tuple[Expression, ...]
    place: Place
    note: str = ""


@dataclasses.dataclass(frozen=True)
class Call:
    """`target = function(arguments)`, a function of the program that can fail, or changes a list.

    A failure in it has its own place. `target` is None where it returns nothing.
    """

    target: Local | None
    function: str
    arguments: tuple[Expression, ...]
    note: str = ""


@dataclasses.dataclass(frozen=True)
class Derive:
    """`target = parameters.name`, a cached property: computed at its first use, as Python does."""

    target: Local
    parameters: Expression
    name: str
    note: str = ""


@dataclasses.dataclass(frozen=True)
class If:
    """One of two blocks."""

    test: Expression
    then: Block
    otherwise: Block = ()
    note: str = ""


@dataclasses.dataclass(frozen=True)
class For:
    """`for local in range(start, stop, step)`: the bounds are evaluated once, `step` is a number not 0."""

    local: Local
    start: Expression
    stop: Expression
    step: int
    body: Block
    note: str = ""


@dataclasses.dataclass(frozen=True)
class While:
    """`while True` with `before` evaluated each time, then left where `test` is false, then `body`."""

    before: Block
    test: Expression
    body: Block
    note: str = ""


@dataclasses.dataclass(frozen=True)
class Break:
    """Leave the innermost loop."""


@dataclasses.dataclass(frozen=True)
class Continue:
    """Go on with the next turn of the innermost loop."""


@dataclasses.dataclass(frozen=True)
class Return:
    """Leave the function."""

    value: Expression | None
    note: str = ""


@dataclasses.dataclass(frozen=True)
class Shown:
    """A value within a text: `spec` is a format of Python (".4g"), "" for str() and "!r" for repr()."""

    value: Expression
    spec: str = ""


Text = tuple[str | Shown, ...]
"""Pieces of a text that is put together when it is needed."""


@dataclasses.dataclass(frozen=True)
class Raise:
    """Fail with an exception (the name of its class) and its text."""

    exception: str
    text: Text
    place: Place


@dataclasses.dataclass(frozen=True)
class Say:
    """Return this text from `notice`."""

    text: Text


Computing = Assign | SetItem | SetLength | Checked | Call | Derive
Leading = If | For | While | Break | Continue | Return | Raise | Say
Statement = Computing | Leading
Block = tuple[Statement, ...]


# -- programs ------------------------------------------------------------------------------------------------


@dataclasses.dataclass(frozen=True)
class Function:
    """One specialization of a Python function: its name is unique within the program.

    `locals` are all variables but the arguments. `returns` is None for a function that only changes lists.
    `remembers` is True where the last call is kept (functools.lru_cache): the same arguments give the same
    result without a second computation. Arguments of ParametersType are no part of what is compared.
    """

    name: str
    arguments: tuple[Local, ...]
    returns: Type | None
    locals: tuple[Local, ...]
    body: Block
    can_fail: bool
    place: Place
    about: str = ""
    remembers: bool = False


@dataclasses.dataclass(frozen=True)
class Table:
    """Numbers of a module that do not change: a tuple, a list or a dict by the items of an enumeration."""

    name: str
    type: Type
    value: Literal | Make


@dataclasses.dataclass(frozen=True)
class Program:
    """A model, lowered. Types and functions stand before those that use them.

    `initial(p, u)`, `step(p, x, u, dt)`, `outputs(p, x[, u])` and `notice(p, x, x', u)` are names of
    functions; `notice` is None where the model has none, and returns nothing but says a text.
    """

    name: str
    about: str
    parameters: ParametersType
    inputs: StructType
    state: StructType
    outputs_type: StructType
    types: tuple[StructType, ...]
    tables: tuple[Table, ...]
    functions: tuple[Function, ...]
    initial: str
    step: str
    outputs: str
    notice: str | None


TRUE = Literal(BOOLEAN, True)
