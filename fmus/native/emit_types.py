"""The types of a program in C: names, definitions, and the places of the numbers within them."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import NamedTuple

from .values import (
    COMPLEX,
    INTEGER,
    REAL,
    ArrayType,
    EnumType,
    ListType,
    ParametersType,
    Scalar,
    StructType,
    Type,
)

_LANGUAGE = """
auto break case char const continue default do double else enum extern float for goto if inline int long
register restrict return short signed sizeof static struct switch typedef union unsigned void volatile while
bool true false assert errno offsetof isnan isinf isfinite signbit NULL NAN INFINITY
"""
_OWN = "model failure memory result said known variables state_fields forget EOF"
_LIBRARY = """
abort abs acos acosh asin asinh atan atan2 atanh atexit atof atoi atol bsearch calloc cbrt ceil clearerr
copysign cos cosh div erf erfc exit exp exp2 expm1 fabs fclose fdim feof ferror fflush fgetc fgets floor fma
fmax fmin fmod fopen fprintf fputc fputs fread free freopen frexp fscanf fseek ftell fwrite getc getchar
getenv gets hypot ilogb labs ldexp ldiv lgamma llabs log log10 log1p log2 logb lrint lround main malloc
memchr memcmp memcpy memmove memset modf nan nearbyint nextafter perror pow printf putc putchar puts qsort
raise rand realloc remainder remove remquo rename rewind rint round scalbn scanf setbuf sin sinh snprintf
sprintf sqrt srand sscanf strcat strchr strcmp strcpy strlen strncat strncmp strncpy strstr strtod strtol
system tan tanh tgamma tmpfile trunc ungetc vprintf
"""
_INSTANCE = """
instance ALL_IN_USE REAL INTEGER BOOLEAN ENUMERATION SAID_SENTENCES LONGEST_RUN CREATED INITIALIZING STEPPING
ENDED PARAMETERS INPUTS OUTPUTS TIME RECORDS IN_CREATED IN_INITIALIZING IN_STEPPING IN_ENDED KNOWN SETTABLE
"""
_TAKEN = frozenset(f"{_LANGUAGE} {_OWN} {_LIBRARY} {_INSTANCE}".split())
"""Names that mean something else in a file of C: the language, its library, the frame of our own."""
_PATTERN = re.compile(
    r"py_\w+|model_\w+|instance_\w+|PY_\w+|MODEL_\w+"  # of the runtime
    r"|E[A-Z0-9]{2,}|\w+_t|(INT|UINT|PTRDIFF|SIZE|SIG|WCHAR|WINT|DBL|FLT|LDBL|FP|HUGE|EXIT|MATH|RAND|MB)\w*_\w+"
    r"|(acos|asin|atan|atan2|cos|sin|tan|acosh|asinh|atanh|cosh|sinh|tanh|exp|exp2|expm1|frexp|ilogb|ldexp"
    r"|log|log10|log1p|log2|logb|modf|scalbn|scalbln|cbrt|fabs|hypot|pow|sqrt|erf|erfc|lgamma|tgamma|ceil|floor"
    r"|nearbyint|rint|l?lrint|l?lround|round|trunc|fmod|remainder|remquo|copysign|nan|nextafter|nexttoward"
    r"|fdim|fmax|fmin|fma|l?l?abs|l?l?div)[fl]?"
    r"|(is|fpclass|sign)[a-z]{3,}|(mem|str|wc|mb)[a-z]+"
    r"|(real|integer|complex|bool|int64_t|[A-Z]\w*)_(x|list_)\d+"  # of arrays and lists
    r"|\w+_(known|turn|stop)"  # of what is kept, and of loops
)


def c_name(name: str) -> str:
    """Return a name of Python as one of C; a name that is taken there gets a `_`."""
    return f"{name}_" if name in _TAKEN or _PATTERN.fullmatch(name) else name


def type_name(type_: Type) -> str:
    """Return the name of a type in C."""
    match type_:
        case Scalar():
            return type_.value
        case EnumType():
            return "int64_t"
        case StructType() | ParametersType():
            return c_name(type_.name)
        case ArrayType():
            return f"{_stem(type_.item)}_x{type_.length}"
        case ListType():
            return f"{_stem(type_.item)}_list_{type_.capacity}"


def _stem(item: Type) -> str:
    short = {REAL: "real", INTEGER: "integer", COMPLEX: "complex"}
    return short.get(item, type_name(item)) if isinstance(item, Scalar) else type_name(item)


def argument(type_: Type, name: str) -> str:
    """Return the declaration of an argument: lists and parameters are handed on by address."""
    star = "*" if isinstance(type_, ListType | ParametersType) else ""
    return f"{type_name(type_)} {star}{name}"


def parts(type_: Type) -> Iterator[Type]:
    """Return the types within a type and then itself, in the order in which C defines them."""
    match type_:
        case StructType():
            for _, item in type_.fields:
                yield from parts(item)
        case ParametersType():
            for _, item in type_.fields:
                yield from parts(item)
            for item, _ in type_.derived.values():
                yield from parts(item)
        case ArrayType() | ListType():
            yield from parts(type_.item)
        case _:
            return
    yield type_


def definition(type_: Type, comments: dict[str, str] | None = None) -> str:
    """Return the definition of a type; `comments` stand beside the fields of these names."""
    comments = comments or {}
    match type_:
        case ArrayType():
            lines = [f"{type_name(type_.item)} at[{type_.length}];"]
        case ListType():
            lines = ["int64_t length;", f"{type_name(type_.item)} at[{type_.capacity}];"]
        case StructType() | ParametersType():
            lines = [
                f"{type_name(item)} {c_name(name)};"
                + (f" /* {comments[name]} */" if name in comments else "")
                for name, item in type_.fields
            ]
            if isinstance(type_, ParametersType):
                for name, (item, _) in type_.derived.items():
                    lines += [f"bool {name}_known;", f"{type_name(item)} {c_name(name)};"]
        case _:
            raise TypeError(f"{type_} needs no definition")
    inner = "".join(f"    {line}\n" for line in lines or ["char nothing;"])
    about = f"/* {type_.about} */\n" if isinstance(type_, StructType) and type_.about else ""
    return f"{about}typedef struct {{\n{inner}}} {type_name(type_)};\n"


class Row(NamedTuple):
    """Numbers of a record of which each is `stride` bytes after the one before; places and sizes are C's."""

    type: Type
    place: str
    length: int
    stride: str


def numbers(type_: Type, place: str) -> Iterator[Row]:
    """Return where the numbers of a state are, each once, in the order of their declaration."""
    match type_:
        case StructType():
            for name, item in type_.fields:
                yield from numbers(item, f"{place}.{c_name(name)}" if place else c_name(name))
        case ArrayType():
            yield from _items(type_, place)
        case ListType() | ParametersType():
            raise TypeError(f"{place}: a state holds neither lists nor parameters")
        case Scalar.COMPLEX:
            for part in ("re", "im"):
                yield Row(REAL, f"{place}.{part}", 1, "sizeof(double)")
        case _:
            yield Row(type_, place, 1, f"sizeof({type_name(type_)})")


def _items(array: ArrayType, place: str) -> Iterator[Row]:
    """Return the numbers of an array: one row for each number of an item, where items have single numbers."""
    rows = list(numbers(array.item, f"{place}.at[0]"))
    if all(row.length == 1 for row in rows):
        for row in rows:
            yield Row(row.type, row.place, array.length, f"sizeof({type_name(array.item)})")
        return
    for k in range(array.length):
        yield from numbers(array.item, f"{place}.at[{k}]")
