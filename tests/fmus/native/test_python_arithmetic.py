"""C that computes as Python does: every function against Python, bit for bit, and failures by their text."""

from __future__ import annotations

import cmath
import ctypes
import functools
import itertools
import math
import operator
import platform
import random
import re
import shutil
import struct
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from support.arithmetic import HEADERS, Arithmetic, compile_source, declared
from support.needs import give_up, need_c_compiler

FLOATS = [
    *(
        0.0,
        0.1,
        0.5,
        0.71,
        1.0,
        1.5,
        1.73,
        2.0,
        2.5,
        3.0,
        7.0,
        math.pi / 2,
        math.pi,
        12.75,
        100.0,
        123456.789,
    ),
    *(
        1e-5,
        9.9995e-5,
        1e-4,
        1e15,
        1e16,
        123456789012345680.0,
        1e22,
        1e-300,
        1e300,
        708.0,
        709.78,
        710.5,
        746.0,
    ),
    *(5e-324, 2.225073858507201e-308, sys.float_info.min, 1.6e-162, sys.float_info.max, 1.2e308, math.inf),
    *(2.0**53 - 1, 2.0**53, 2.0**53 + 2, 2.0**62, 2.0**63 - 1024, 2.0**63, 2.0**64, 1 + 2**-52, 1 - 2**-53),
]
FLOATS = [*FLOATS, *(-x for x in FLOATS), math.nan]
INTEGERS = [0, 1, 2, 3, 7, 10, 31, 62, 63, 64, 2**31, 2**32 + 1, 3037000499, 3037000500, 10**18]
INTEGERS += [2**53 - 1, 2**53, 2**53 + 1, 2**53 + 2, 2**53 + 3, 2**62, 2**62 + 1, 2**63 - 513, 2**63 - 1]
INTEGERS = [*INTEGERS, *(-n for n in INTEGERS), -(2**63)]
PARTS_OF_COMPLEX = [0.0, 0.5, 0.8, 1.0, 2.0, 100.0, 709.5, 1e-310, 1e300, sys.float_info.max, math.inf]
PARTS_OF_COMPLEX = [*PARTS_OF_COMPLEX, *(-x for x in PARTS_OF_COMPLEX), 5e-324, math.nan]
COMPLEX = [complex(x, y) for x in PARTS_OF_COMPLEX for y in PARTS_OF_COMPLEX]
SPECIFICATIONS = ["", "g", ".4g", ".9g", ".17g", ".0g", ".3f", ".0f", ".25f", ".6e", ".0e", "E", "F", "G"]
SPECIFICATIONS += [
    "%",
    ".1%",
    "f",
    "e",
    ".3",
    ".1",
    ".0",
    ".17",
    "+",
    "+.3g",
    " .2f",
    "10.3f",
    "012.4g",
    "09",
    "-8.1f",
]

Draw = random.Random


def any_float(draw: Draw) -> float:
    """Return a special value, a bit pattern, a number of a usual size, a whole one, or a short fraction."""
    match draw.randrange(6):
        case 0:
            return draw.choice(FLOATS)
        case 1:
            return float(struct.unpack("<d", draw.getrandbits(64).to_bytes(8, "little"))[0])
        case 2:
            return draw.uniform(-100, 100)
        case 3:
            return draw.uniform(0, 2)
        case 4:
            return float(draw.randint(-50, 50))
        case _:
            return draw.randint(-(2**53), 2**53) / 1024


def any_integer(draw: Draw) -> int:
    """Return a special value, one of any length, or a small one."""
    match draw.randrange(3):
        case 0:
            return draw.choice(INTEGERS)
        case 1:
            return draw.randint(-(2**63), 2**63 - 1) >> draw.randrange(64)
        case _:
            return draw.randint(-100, 100)


def any_specification(draw: Draw) -> str:
    """Return a specification of a format."""
    parts = (("", "", "-", "+", " "), ("", "", "0"), ("", "", "1", "8", "25"))
    digits = draw.randint(-5, 30)
    point = f".{digits}" if digits >= 0 else ""
    return "".join(map(draw.choice, parts)) + point + draw.choice(("", *"eEfFgG%"))


VALUES: dict[str, tuple[list[Any], Callable[[Draw], Any]]] = {
    "double": (FLOATS, any_float),
    "int64_t": (INTEGERS, any_integer),
    "bool": ([False, True], lambda draw: draw.random() < 0.5),
    "py_complex": (COMPLEX, lambda draw: complex(any_float(draw), any_float(draw))),
    "const double *": ([], lambda draw: [any_float(draw) for _ in range(draw.randint(0, 6))]),
    "const char *": (SPECIFICATIONS, any_specification),
}
"""Of each type of argument: the values that are combined with all others, and any value."""


def _real_power(a: float, b: float) -> float:
    if -math.inf < a < 0 and math.isfinite(b) and b != math.floor(b):
        raise ValueError("a negative number to a fractional power gives a complex number")
    return a**b


def _shifted(a: int, b: int) -> int:
    return a << min(b, 200)  # a longer result is beyond 64 bits as well, and takes as much memory


def _power(a: int, b: int) -> int:
    if b < 0:
        raise ValueError("an integer to a negative power gives a float")
    return a ** min(b, 200 + b % 2)  # the same


def _item(words: str) -> Callable[[int, int], int]:
    """Return what an index is counted from the start, for so many items."""

    def place(index: int, n: int) -> int:
        if not -n <= index < n:
            raise IndexError(words)
        return index % n

    return place


MATH = """floor ceil trunc sqrt exp exp2 expm1 log log2 log10 log1p sin cos tan asin acos atan atan2 sinh cosh
tanh asinh acosh atanh cbrt erf erfc pow fmod remainder copysign fabs isnan isinf isfinite degrees radians"""
CMATH = "isnan isinf isfinite exp cosh sinh tanh cos sin tan sqrt log log10 phase polar rect"
EXPECTED: dict[str, Callable[..., Any]] = {
    "py_float_div": lambda a, b: a / b,
    "py_float_floordiv": lambda a, b: a // b,
    "py_float_divmod_floordiv": lambda a, b: divmod(a, b)[0],
    "py_float_mod": lambda a, b: a % b,
    "py_float_divmod": divmod,
    "py_float_pow": _real_power,
    "py_float_max": max,
    "py_float_min": min,
    "py_float_abs": abs,
    "py_float_bool": bool,
    "py_float_int": int,
    "py_float_round": round,
    "py_float_round_digits": round,
    "py_int_add": operator.add,
    "py_int_sub": operator.sub,
    "py_int_mul": operator.mul,
    "py_int_neg": operator.neg,
    "py_int_abs": abs,
    "py_int_floordiv": operator.floordiv,
    "py_int_mod": operator.mod,
    "py_int_divmod": divmod,
    "py_int_pow": _power,
    "py_int_div": operator.truediv,
    "py_int_lshift": _shifted,
    "py_int_rshift": operator.rshift,
    "py_int_and": operator.and_,
    "py_int_or": operator.or_,
    "py_int_xor": operator.xor,
    "py_int_invert": operator.invert,
    "py_int_max": max,
    "py_int_min": min,
    "py_int_bool": bool,
    "py_int_float": float,
    "py_int_eq_float": operator.eq,
    "py_int_lt_float": operator.lt,
    "py_int_le_float": operator.le,
    "py_int_gt_float": operator.gt,
    "py_int_ge_float": operator.ge,
    "py_int_compare_float": lambda a, b: 2 if math.isnan(b) else (a > b) - (a < b),
    "py_list_index": _item("list index out of range"),
    "py_list_set_index": _item("list assignment index out of range"),
    "py_tuple_index": _item("tuple index out of range"),
    **{f"py_math_{name}": getattr(math, name) for name in MATH.split()},
    "py_math_log_base": math.log,
    "py_math_isclose": lambda a, b, r, t: math.isclose(a, b, rel_tol=r, abs_tol=t),
    "py_math_hypot": lambda vector: math.hypot(*vector),
    "py_math_hypot2": math.hypot,
    "py_math_hypot3": math.hypot,
    "py_math_dist2": lambda *x: math.dist(x[:2], x[2:]),
    "py_math_dist3": lambda *x: math.dist(x[:3], x[3:]),
    "py_complex_of": complex,
    "py_complex_add": operator.add,
    "py_complex_sub": operator.sub,
    "py_complex_mul": operator.mul,
    "py_complex_div": operator.truediv,
    "py_complex_pow": operator.pow,
    "py_complex_neg": operator.neg,
    "py_complex_conjugate": complex.conjugate,
    "py_complex_eq": operator.eq,
    "py_complex_bool": bool,
    "py_complex_abs": abs,
    **{f"py_cmath_{name}": getattr(cmath, name) for name in CMATH.split()},
    "py_repr_float": repr,
    "py_repr_int": repr,
    "py_repr_bool": repr,
    "py_repr_complex": repr,
    "py_format_float": format,
}
INSIDE = {
    *(
        "py_complex_opaque",
        "py_float_quotient",
        "py_float_is_odd",
        "py_float_pow_special",
        "py_float_no_int",
        "py_int_beyond",
    ),
    *("py_int_size", "py_int_quotient", "py_int_ratio", "py_place", "py_math_domain", "py_math_domain_fill"),
    *(
        "py_math_invalid",
        "py_math_range",
        "py_math_finite",
        "py_squares_add",
        "py_squares_add_square",
        "py_squares_total",
    ),
    *("py_vector_norm", "py_complex_direction", "py_complex_no_nan", "py_complex_mul_infinite"),
    *("py_complex_quotient_infinite", "py_complex_quotient", "py_complex_pow_whole", "py_complex_pow_polar"),
    *("py_cmath_finite", "py_cmath_signs", "py_cmath_exp_special", "py_cmath_cosh_special"),
    *("py_cmath_sinh_special", "py_cmath_tanh_special", "py_cmath_sqrt_special", "py_cmath_rect_special"),
    *("py_limbs_multiply", "py_decimal_exact", "py_double_parts", "py_decimal_at", "py_decimal_compare"),
    *("py_decimal_rest", "py_decimal_cut", "py_decimal_round", "py_decimal_of", "py_decimal_shortest"),
    *("py_decimal_text", "py_put", "py_put_text", "py_written", "py_put_unsigned", "py_put_fixed"),
    *("py_put_exponent", "py_put_short", "py_put_magnitude", "py_spec_number", "py_spec_read"),
}
"""Steps of the functions above."""


@functools.cache
def arithmetic() -> Arithmetic:
    """Return the functions for the Python that runs the tests."""
    return Arithmetic(tuple(EXPECTED))


def bits(value: Any) -> Any:
    """Return a value as what has to be equal: the bits of floats, where every NaN is one."""
    match value:
        case float():
            return "nan" if math.isnan(value) else struct.pack("<d", value)
        case complex():
            return bits(value.real), bits(value.imag)
        case tuple():
            return tuple(map(bits, value))
        case _:
            return value


def outcome(function: Callable[..., Any], *values: Any) -> Any:
    """Return the bits of a result, or class and text of the exception; what C cannot hold is a failure."""
    try:
        value = function(*values)
    except (ArithmeticError, ValueError, IndexError) as error:
        return type(error).__name__, str(error)
    for each in value if isinstance(value, tuple) else (value,):
        if isinstance(each, int) and not -(2**63) <= each < 2**63:
            return "OverflowError", "an integer beyond 64 bits"
    return bits(value)


def kinds(name: str) -> list[str]:
    """Return the types of what the function is given: the length of an array follows from it."""
    given = [kind for kind, _ in declared()[name].arguments if kind in VALUES]
    return given[:1] if "const double *" in given else given


def is_of_the_patch_version(name: str, values: tuple[Any, ...]) -> bool:
    """Return True for what one Python 3.13 does otherwise than another: tanh(0+nanj), tan(nan+0j)."""
    if name not in ("py_cmath_tanh", "py_cmath_tan"):
        return False
    re, im = (values[0].real, values[0].imag) if name == "py_cmath_tanh" else (values[0].imag, values[0].real)
    return re == 0.0 and math.isnan(im)


def check(name: str, *values: Any) -> None:
    if not is_of_the_patch_version(name, values):
        got = outcome(functools.partial(arithmetic(), name), *values)
        assert got == outcome(EXPECTED[name], *values), (name, values)


def combined(name: str) -> Iterator[tuple[Any, ...]]:
    """Yield all combinations of the special values, or 3,000 of them, always the same."""
    pools = [VALUES[kind][0] for kind in kinds(name)]
    if math.prod(map(len, pools)) <= 3000:
        return itertools.product(*pools)
    rng = random.Random(name)
    return (tuple(rng.choice(pool) for pool in pools) for _ in range(3000))


def test_no_function_is_left_out():
    assert declared().keys() == EXPECTED.keys() | INSIDE
    assert not EXPECTED.keys() & INSIDE


@pytest.mark.parametrize("name", EXPECTED)
def test_every_function_names_the_rule_that_it_follows(name):
    assert re.search(r"\b(Objects|Modules|Python)/\w+\.[ch], \w+", declared()[name].comment)


@pytest.mark.parametrize("name", EXPECTED)
def test_special_values(name):
    for values in combined(name):
        check(name, *values)


@pytest.mark.parametrize("name", EXPECTED)
def test_any_values(name):
    draw = random.Random(f"any {name}")
    for _ in range(250):
        check(name, *(VALUES[kind][1](draw) for kind in kinds(name)))


def test_vectors_of_one_magnitude_have_their_length_to_the_last_bit():
    rng = random.Random(7)
    for _ in range(5000):
        size = 2.0 ** rng.randint(-1074, 1023)
        vector = [size * rng.uniform(-1, 1) for _ in range(rng.randint(0, 7))]
        check("py_math_hypot", vector)
        check("py_math_hypot2", *vector[:2], *(0.0,) * (2 - len(vector)))


@pytest.mark.parametrize("name", ["py_repr_float", "py_format_float", "py_float_round_digits"])
def test_texts_of_any_bits(name):
    """Powers of two have a nearer neighbor below, numbers of few digits are half-way between two texts."""
    rng = random.Random(11)
    for k in range(-1074, 1024):
        power = math.ldexp(1.0, k)
        other = struct.unpack("<d", rng.getrandbits(64).to_bytes(8, "little"))[0]
        for x in (
            power,
            math.nextafter(power, 0.0),
            math.nextafter(power, math.inf),
            other,
            k / 32,
            k / 1000,
        ):
            if name == "py_repr_float":
                check(name, x)
            elif name == "py_format_float":
                check(name, x, f".{rng.randint(0, 20)}{rng.choice('efg%')}")
            else:
                check(name, x, rng.randint(-325, 325))
                check(name, x, rng.randint(-3, 4))


def test_ratios_of_long_integers_are_the_nearest_float():
    rng = random.Random(13)
    for _ in range(5000):
        a, b = (rng.getrandbits(rng.randint(50, 63)) - rng.getrandbits(3) for _ in range(2))
        check("py_int_div", a, b or 1)
        check("py_int_div", -a, b or 1)


@pytest.mark.parametrize("size", [1, 2, 5, 8])
def test_a_text_that_does_not_fit_is_cut(size):
    whole = repr(-1234567.5)
    assert arithmetic()("py_repr_float", -1234567.5, size=size) == whole[: size - 1]
    assert arithmetic()("py_format_float", -1234567.5, ".2f", size=size) == f"{-1234567.5:.2f}"[: size - 1]


@pytest.mark.parametrize(
    "specification", ["d", "x", "n", ",", "<8", ".4q", "1000", ".1000f", "#g", ".g", "4.", "gg"]
)
def test_a_specification_that_is_not_understood(specification):
    assert arithmetic()("py_format_float", 1.5, specification) == "?"


WORDS = [
    ("py_float_div", (1.0, 0.0), "float division by zero", "division by zero"),
    ("py_float_floordiv", (1.0, 0.0), "float floor division by zero", "division by zero"),
    ("py_float_divmod_floordiv", (1.0, 0.0), "float divmod()", "division by zero"),
    ("py_float_divmod", (1.0, 0.0), "float divmod()", "division by zero"),
    ("py_float_pow", (0.0, -1.0), "0.0 cannot be raised to a negative power", "zero to a negative power"),
    ("py_int_floordiv", (1, 0), "integer division or modulo by zero", "division by zero"),
    ("py_int_mod", (1, 0), "integer modulo by zero", "division by zero"),
    ("py_complex_div", (1j, 0j), "complex division by zero", "division by zero"),
    (
        "py_complex_pow",
        (0j, -1j),
        "0.0 to a negative or complex power",
        "zero to a negative or complex power",
    ),
    ("py_math_sqrt", (-1.0,), "math domain error", "expected a nonnegative input, got -1.0"),
    ("py_math_log", (0.0,), "math domain error", "expected a positive input, got 0.0"),
    ("py_math_log1p", (-1.5,), "math domain error", "expected argument value > -1, got -1.5"),
    ("py_math_sin", (math.inf,), "math domain error", "expected a finite input, got inf"),
    ("py_math_asin", (2.0,), "math domain error", "expected a number in range from -1 up to 1, got 2.0"),
    ("py_math_acosh", (0.5,), "math domain error", "expected argument value not less than 1, got 0.5"),
    ("py_math_atanh", (1.0,), "math domain error", "expected a number between -1 and 1, got 1.0"),
    ("py_math_fmod", (1.0, 0.0), "math domain error", "math domain error"),
    ("py_math_exp", (1e4,), "math range error", "math range error"),
]
"""What Python 3.11 and 3.14 say."""


@functools.cache
def of_version(minor: int) -> Arithmetic:
    return Arithmetic((*(name for name, *_ in WORDS), "py_float_mod", "py_complex_mul"), minor)


@pytest.mark.parametrize(("name", "values", "before", "since"), WORDS)
def test_the_words_are_those_of_the_version(name, values, before, since):
    for minor, words in ((11, before), (13, before), (14, since)):
        with pytest.raises((ArithmeticError, ValueError)) as error:
            of_version(minor)(name, *values)
        assert str(error.value) == words


@pytest.mark.parametrize(("minor", "words"), [(12, "modulo"), (13, "modulo by zero"), (14, "")])
def test_the_words_of_a_modulo(minor, words):
    with pytest.raises(ZeroDivisionError) as error:
        of_version(minor)("py_float_mod", 1.0, 0.0)
    assert str(error.value) == (f"float {words}" if words else "division by zero")


def test_the_product_with_an_infinity_is_that_of_the_version():
    """Since 3.14 an infinite product has infinite parts, as C99 recommends, where it was NaN in both."""
    assert math.isnan(of_version(13)("py_complex_mul", complex(math.inf, math.inf), 1j * math.inf).real)
    assert of_version(14)("py_complex_mul", complex(math.inf, 0.0), complex(0.0, math.inf)).imag == math.inf


def loaded(source: str, folder: Path, flags: tuple[str, ...] = ("-O2",)) -> ctypes.CDLL:
    """Return a library of one C source that includes the headers."""
    need_c_compiler()
    compile_source(
        f'#include "python_arithmetic.h"\n{source}', folder / "unit.so", (*flags, "-fPIC", "-shared")
    )
    return ctypes.CDLL(str(folder / "unit.so"))


def test_functions_of_constants_are_the_library_s_and_not_the_compiler_s(tmp_path):
    rng = random.Random(17)
    one = "exp exp2 expm1 log log2 log10 log1p sin cos tan asin acos atan sinh cosh tanh asinh atanh cbrt erf"
    calls = [(name, (rng.uniform(0.01, 0.99),)) for name in one.split() for _ in range(40)]
    calls += [("pow", (rng.uniform(0.1, 9), n)) for n in (2.0, 3.0, 0.5, -2.0, 1.5) for _ in range(20)]
    calls += [
        (name, (rng.choice([2.0, 10.0]), rng.uniform(-9, 9))) for name in ("pow", "atan2") for _ in range(20)
    ]
    source = ["void all(double *to) {", "py_failure f;"]
    for i, (name, values) in enumerate(calls):
        given = ", ".join(map(float.hex, values))
        can_fail = "py_failure" in str(declared()[f"py_math_{name}"])
        call = f"py_math_{name}({given}, to + {i}, &f)" if can_fail else f"to[{i}] = py_math_{name}({given})"
        source.append(f"(void)({call});")
    found = (ctypes.c_double * len(calls))()
    loaded("\n".join([*source, "}"]), tmp_path).all(found)
    for (name, values), value in zip(calls, found, strict=True):
        assert bits(value) == bits(getattr(math, name)(*values)), (name, values)


def test_sine_and_cosine_are_the_same_where_a_compiler_asks_for_both_at_once(tmp_path):
    library = loaded("void both(double x, double *to) { to[0] = sin(x); to[1] = cos(x); }", tmp_path)
    library.both.argtypes = [ctypes.c_double, ctypes.POINTER(ctypes.c_double)]
    rng, to = random.Random(19), (ctypes.c_double * 2)()
    for x in (*(rng.uniform(-10, 10) for _ in range(10000)), *filter(math.isfinite, FLOATS)):
        library.both(x, to)
        assert bits(tuple(to)) == bits((math.sin(x), math.cos(x)))


def test_no_operations_are_fused_where_the_processor_can(tmp_path):
    """Who compiles the sources may ask for it; GCC 12 does it for complex products even unasked."""
    cpu = Path("/proc/cpuinfo")
    if platform.machine() != "x86_64" or not cpu.exists() or " fma " not in cpu.read_text():
        pytest.skip("this machine is no x86-64 with fused operations")
    product = "void product(const py_complex *a, py_complex *to) { *to = py_complex_mul(a[0], a[1]); }"
    scaled = "void scaled(const double *a, double *to) { *to = a[0] * a[1] + a[2]; }"
    flags = ("-O3", "-mfma", "-std=gnu99", "-ffp-contract=fast")
    library, rng = loaded(product + scaled, tmp_path, flags), random.Random(23)
    for _ in range(2000):
        a = [rng.uniform(-9, 9) for _ in range(4)]
        given, to = (ctypes.c_double * 4)(*a), (ctypes.c_double * 2)()
        library.product(given, to)
        assert bits(complex(*to)) == bits(complex(*a[:2]) * complex(*a[2:]))
        library.scaled(given, to)
        assert bits(to[0]) == bits(a[0] * a[1] + a[2])


STRICT = ("-Wall", "-Wextra", "-Wconversion", "-Wshadow", "-pedantic", "-Werror", "-c")


@pytest.mark.parametrize("compiler", ["cc", "clang"])
@pytest.mark.parametrize("optimization", ["-O0", "-O2"])
@pytest.mark.parametrize("minor", [11, 14])
def test_compilers_have_nothing_to_say(compiler, optimization, minor, tmp_path):
    if shutil.which(compiler) is None:
        give_up(f"there is no {compiler} on this machine")
    flags = (*STRICT, optimization, f"-DPY_VERSION_MINOR={minor}")
    compile_source('#include "python_arithmetic.h"\n', tmp_path / "unit.o", flags, compiler)


@pytest.mark.parametrize("header", [path.name for path in sorted(HEADERS.glob("python_*.h"))])
def test_each_header_stands_alone(header, tmp_path):
    need_c_compiler()
    compile_source(f'#include "{header}"\n#include "{header}"\n', tmp_path / "unit.o", STRICT)


@pytest.mark.parametrize("flag", ["-ffast-math", "-Ofast", "-ffinite-math-only"])
def test_another_arithmetic_is_refused(flag, tmp_path):
    need_c_compiler()
    with pytest.raises(AssertionError, match=r"Python's arithmetic is that of IEEE 754: compile without"):
        compile_source('#include "python_arithmetic.h"\n', tmp_path / "unit.o", (flag, "-c"))
