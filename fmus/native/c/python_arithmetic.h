/* Python's arithmetic in C99, bit for bit, for models that were written in Python.

   python_compiler.h   what is asked of a compiler; PY_VERSION_MINOR, the Python 3 that is followed (11 to 14)
   python_failure.h    exceptions and their texts
   python_float.h      py_float_...: operators and built-in functions of float
   python_integer.h    py_int_...: those of int within 64 bits; places in lists and tuples
   python_math.h       py_math_...: module math
   python_kept.h       py_kept_...: functions of math that keep their last value for the same argument
   python_complex.h    py_complex_...: operators of complex
   python_cmath.h      py_cmath_...: module cmath
   python_text.h       py_repr_..., py_format_float: the texts of numbers

   Each function names the rule of CPython that it follows, by file and function. A function that can fail
   returns bool, with its result by a pointer and the failure as last argument; any other one returns its
   result. `a + b`, comparisons and such of floats are those of C. Nothing is allocated, and nothing is kept
   between calls but by the caller. Compile with -ffp-contract=off, and without -ffast-math. */
#ifndef PYTHON_ARITHMETIC_H
#define PYTHON_ARITHMETIC_H

#include "python_cmath.h"
#include "python_compiler.h"
#include "python_complex.h"
#include "python_failure.h"
#include "python_float.h"
#include "python_integer.h"
#include "python_kept.h"
#include "python_math.h"
#include "python_text.h"

#endif
