"""Values that are kept between steps: the same as computed anew, and those whose arguments often stay."""

from __future__ import annotations

import ctypes
import math
import random
import re
from pathlib import Path

from evcosim.fmus.native import emit
from evcosim.fmus.native.lower import lower
from evcosim.models.bound_planner import BoundPlanner
from support.arithmetic import HEADERS, compile_source
from support.needs import need_c_compiler
from support.small_model import small

KEPT = re.findall(r"^PY_KEPT\((\w+)\)", (HEADERS / "python_kept.h").read_text(), re.MULTILINE)
ODD = (0.0, -0.0, math.inf, -math.inf, math.nan, 5e-324, 1e300, -1e300, 710.5, -1.0, 1.0)

SAME = r"""
#include "python_arithmetic.h"

/* The same outcome: bits, or words; what fails leaves the result alone. */
static bool same(bool a, bool b, double x, double y, const py_failure *f, const py_failure *g)
{
    if (a != b)
        return false;
    if (!a)
        return y == 7.0 && !strcmp(f->text, g->text);
    return py_kept_bits(x) == py_kept_bits(y) || (isnan(x) && isnan(y));
}

#define CHECK(F)                                                            \
    bool check_##F(double x)                                                \
    {                                                                       \
        static py_kept kept;                                                \
        py_failure f, g;                                                    \
        double value = 7.0, again = 7.0;                                    \
        const bool went = py_math_##F(x, &value, &f);                       \
        const bool same_way = py_kept_##F(x, &kept, &again, &g);            \
        return same(went, same_way, value, again, &f, &g);                  \
    }

bool check_pow(double a, double b)
{
    static py_kept kept;
    py_failure f, g;
    double value = 7.0, again = 7.0;
    const bool went = py_float_pow(a, b, &value, &f), same_way = py_kept_pow(a, b, &kept, &again, &g);
    return same(went, same_way, value, again, &f, &g);
}
"""


def test_a_value_that_is_kept_is_that_of_its_argument_s_bits(tmp_path: Path) -> None:
    need_c_compiler()
    source = SAME + "\n".join(f"CHECK({name})" for name in KEPT)
    compile_source(source, tmp_path / "kept.so", ("-O2", "-fPIC", "-shared"))
    library, draw = ctypes.CDLL(str(tmp_path / "kept.so")), random.Random(3)
    assert len(KEPT) > 5
    for name in (*KEPT, "pow"):
        check = getattr(library, f"check_{name}")
        check.restype = ctypes.c_bool
        count = 2 if name == "pow" else 1
        x = [0.5] * count
        for _ in range(3000):
            if draw.random() < 0.6:
                x[draw.randrange(count)] = draw.choice((*ODD, draw.gauss(0.0, 3.0)))
            assert check(*map(ctypes.c_double, x)), (name, x)


def test_what_is_made_of_inputs_parameters_and_the_step_is_kept_and_what_changes_is_not() -> None:
    above = """
def wave(value):
    return math.sin(value)

def fall(value):
    return math.exp(value)
"""
    body = """y = wave(u.u) + math.cos(p.a * dt) + u.v ** 2.0
z = fall(u.u) + fall(x.x)
for k in range(p.n):
    y += math.tan(k * u.u)
moved = u.v
if u.flag:
    moved = x.x
return Small.State(y + z + math.log(moved) + p.both)"""
    derived = "@cached_property\ndef both(self):\n    return math.expm1(self.a)"
    model = small(body, above=above, derived=derived)
    source = emit.c_source(model, lower(model), "id", "{t}")
    for kept in ("py_kept_sin(value", "py_kept_cos(p->a * dt", "py_kept_pow(u.v, 2.0"):
        assert source.count(kept) == 1, kept
    for anew in ("py_math_exp(", "py_math_tan(", "py_math_log(moved", "py_math_expm1("):
        assert source.count(anew) == 1, anew
    assert re.findall(r"&memory->kept\[(\d)\]", source) == ["0", "1", "2"]
    assert "py_kept kept[3];" in source
    assert "sizeof(Memory)" in source


def test_the_time_is_not_held() -> None:
    source = emit.c_source(BoundPlanner, lower(BoundPlanner), "id", "{t}")
    assert "py_math_sin(" in source
    assert "py_kept_sin(" not in source
