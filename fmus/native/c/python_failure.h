/* Failures of Python's arithmetic: which exception it raises, and the exact text of it.

   A function that can fail returns true where all is well, and has its result by a pointer before the last
   argument; where it returns false the failure is filled and the result untouched.

   PY_VERSION_MINOR chooses the Python 3 whose words and rules are followed (11 to 14). */
#ifndef PYTHON_FAILURE_H
#define PYTHON_FAILURE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "python_compiler.h"

typedef enum {
    PY_ZERO_DIVISION = 1, /* ZeroDivisionError */
    PY_DOMAIN,            /* ValueError of math and cmath: no result for this argument */
    PY_RANGE,             /* OverflowError of math and cmath: the result is too large */
    PY_INDEX,             /* IndexError */
    PY_OVERFLOW,          /* OverflowError; also of an integer beyond 64 bits, which Python has */
    PY_VALUE              /* ValueError; also of a complex result, which Python has */
} py_failure_code;

typedef struct {
    py_failure_code code;
    char text[80]; /* what str() of the exception gives */
} py_failure;

/* The name of the exception's class. */
static inline const char *py_exception(py_failure_code code)
{
    switch (code) {
    case PY_ZERO_DIVISION: return "ZeroDivisionError";
    case PY_INDEX: return "IndexError";
    case PY_RANGE:
    case PY_OVERFLOW: return "OverflowError";
    default: return "ValueError";
    }
}

/* Fill `failure`. A longer text would be cut. */
PY_COLD void py_failure_fill(py_failure *failure, py_failure_code code, const char *text)
{
    size_t n = 0;
    for (; text[n] != '\0' && n + 1 < sizeof failure->text; n++)
        failure->text[n] = text[n];
    failure->text[n] = '\0';
    failure->code = code;
}

/* The same; false, which the caller returns. What only fails is inline, so that compilers see that it is false,
   and that no result is read which was not written. */
static inline bool py_failed(py_failure *failure, py_failure_code code, const char *text)
{
    py_failure_fill(failure, code, text);
    return false;
}

#define PY_BEYOND_64_BITS "an integer beyond 64 bits" /* ours: an int of Python has no bounds */
#define PY_COMPLEX_RESULT "a negative number to a fractional power gives a complex number" /* ours, too */
#define PY_FLOAT_RESULT "an integer to a negative power gives a float"                     /* ours, too */

#if PY_VERSION_MINOR >= 14
#define PY_ZERO_TEXT(before_3_14) "division by zero"
#define PY_ZERO_POWER_TEXT "zero to a negative power"
#define PY_ZERO_COMPLEX_POWER_TEXT "zero to a negative or complex power"
#else
#define PY_ZERO_TEXT(before_3_14) before_3_14
#define PY_ZERO_POWER_TEXT "0.0 cannot be raised to a negative power"
#define PY_ZERO_COMPLEX_POWER_TEXT "0.0 to a negative or complex power"
#endif
#if PY_VERSION_MINOR >= 13
#define PY_MODULO_TEXT PY_ZERO_TEXT("float modulo by zero")
#else
#define PY_MODULO_TEXT "float modulo"
#endif

#endif
