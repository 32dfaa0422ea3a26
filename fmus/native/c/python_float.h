/* Python's float: what its operators and built-in functions give, bit for bit. */
#ifndef PYTHON_FLOAT_H
#define PYTHON_FLOAT_H

#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "python_failure.h"
#include "python_text.h"

/* a / b: Objects/floatobject.c, float_div */
static inline bool py_float_div(double a, double b, double *result, py_failure *failure)
{
    if (b == 0.0)
        return py_failed(failure, PY_ZERO_DIVISION, PY_ZERO_TEXT("float division by zero"));
    *result = a / b;
    return true;
}

/* Quotient and remainder for b != 0: Objects/floatobject.c, _float_div_mod */
static inline void py_float_quotient(double a, double b, double *quotient, double *remainder)
{
    double mod = fmod(a, b), div = (a - mod) / b;
    if (mod == 0.0) {
        mod = copysign(0.0, b); /* a zero has the sign of the divisor */
    } else if ((b < 0.0) != (mod < 0.0)) {
        mod += b;
        div -= 1.0;
    }
    if (div == 0.0) {
        *quotient = copysign(0.0, a / b);
    } else { /* rounding may have made it miss the integer that it is next to */
        const double whole = floor(div);
        *quotient = div - whole > 0.5 ? whole + 1.0 : whole;
    }
    *remainder = mod;
}

/* a // b: Objects/floatobject.c, float_floor_div */
static inline bool py_float_floordiv(double a, double b, double *result, py_failure *failure)
{
    double remainder;
    if (b == 0.0)
        return py_failed(failure, PY_ZERO_DIVISION, PY_ZERO_TEXT("float floor division by zero"));
    py_float_quotient(a, b, result, &remainder);
    return true;
}

/* a % b: Objects/floatobject.c, float_rem */
static inline bool py_float_mod(double a, double b, double *result, py_failure *failure)
{
    double mod;
    if (b == 0.0)
        return py_failed(failure, PY_ZERO_DIVISION, PY_MODULO_TEXT);
    mod = fmod(a, b);
    if (mod == 0.0)
        mod = copysign(0.0, b);
    else if ((b < 0.0) != (mod < 0.0))
        mod += b;
    *result = mod;
    return true;
}

/* divmod(a, b): Objects/floatobject.c, float_divmod */
static inline bool py_float_divmod(double a, double b, double *quotient, double *remainder,
                                   py_failure *failure)
{
    if (b == 0.0)
        return py_failed(failure, PY_ZERO_DIVISION, PY_ZERO_TEXT("float divmod()"));
    py_float_quotient(a, b, quotient, remainder);
    return true;
}

/* The first of divmod(a, b), whose failure has a text of its own: Objects/floatobject.c, float_divmod */
static inline bool py_float_divmod_floordiv(double a, double b, double *result, py_failure *failure)
{
    double remainder;
    return py_float_divmod(a, b, result, &remainder, failure);
}

/* True for 1.0, -3.0 ...: Objects/floatobject.c, DOUBLE_IS_ODD_INTEGER */
static inline bool py_float_is_odd(double x)
{
    return fmod(fabs(x), 2.0) == 1.0;
}

/* The power of infinities and NaNs: the first half of Objects/floatobject.c, float_pow */
static inline double py_float_pow_special(double a, double b)
{
    if (isnan(a))
        return a;
    if (isnan(b))
        return a == 1.0 ? 1.0 : b;
    if (isinf(b)) {
        const double size = fabs(a);
        if (size == 1.0)
            return 1.0;
        return (b > 0.0) == (size > 1.0) ? fabs(b) : 0.0;
    }
    if (b > 0.0)
        return py_float_is_odd(b) ? a : fabs(a);
    return py_float_is_odd(b) ? copysign(0.0, a) : 0.0;
}

/* a ** b: Objects/floatobject.c, float_pow; the words for a result that is too large are those on Linux */
static inline bool py_float_pow(double a, double b, double *result, py_failure *failure)
{
    bool negative = false;
    double power;
    if (b == 0.0) {
        *result = 1.0;
        return true;
    }
    if (!isfinite(a) || !isfinite(b)) {
        *result = py_float_pow_special(a, b);
        return true;
    }
    if (a == 0.0) {
        if (b < 0.0)
            return py_failed(failure, PY_ZERO_DIVISION, PY_ZERO_POWER_TEXT);
        *result = py_float_is_odd(b) ? a : 0.0;
        return true;
    }
    if (a < 0.0) {
        if (b != floor(b))
            return py_failed(failure, PY_VALUE, PY_COMPLEX_RESULT);
        negative = py_float_is_odd(b);
        a = -a;
    }
    if (a == 1.0) {
        *result = negative ? -1.0 : 1.0;
        return true;
    }
    a = py_opaque(a);
    b = py_opaque(b);
    power = pow(a, b);
    if (!isnormal(power)) { /* here alone can the library have said that it is out of range */
        errno = 0;
        power = pow(a, b);
        if (isinf(power) || (errno != 0 && power != 0.0))
            return py_failed(failure, PY_OVERFLOW, "(34, 'Numerical result out of range')");
    }
    *result = negative ? -power : power;
    return true;
}

/* max(a, b), the first of equals: Python/bltinmodule.c, min_max */
static inline double py_float_max(double a, double b)
{
    return b > a ? b : a;
}

/* min(a, b), the first of equals: Python/bltinmodule.c, min_max */
static inline double py_float_min(double a, double b)
{
    return b < a ? b : a;
}

/* abs(x): Objects/floatobject.c, float_abs */
static inline double py_float_abs(double x)
{
    return fabs(x);
}

/* bool(x), true for NaN: Objects/floatobject.c, float_bool */
static inline bool py_float_bool(double x)
{
    return x != 0.0;
}

/* The reason why a float is no integer of 64 bits: Objects/longobject.c, PyLong_FromDouble */
static inline bool py_float_no_int(double x, py_failure *failure)
{
    const char *const unbounded = isinf(x) ? "cannot convert float infinity to integer" : PY_BEYOND_64_BITS;
    const char *const text = isnan(x) ? "cannot convert float NaN to integer" : unbounded;
    return py_failed(failure, isnan(x) ? PY_VALUE : PY_OVERFLOW, text);
}

/* int(x), math.trunc(x): Objects/floatobject.c, float___trunc___impl */
static inline bool py_float_int(double x, int64_t *result, py_failure *failure)
{
    if (!(x >= -9223372036854775808.0 && x < 9223372036854775808.0))
        return py_float_no_int(x, failure);
    *result = (int64_t)x;
    return true;
}

/* round(x), half to even: Objects/floatobject.c, float___round___impl without digits */
static inline bool py_float_round(double x, int64_t *result, py_failure *failure)
{
    double rounded = round(x);
    if (fabs(x - rounded) == 0.5)
        rounded = 2.0 * round(x / 2.0);
    return py_float_int(rounded, result, failure);
}

/* round(x, digits): Objects/floatobject.c, float___round___impl and double_round */
static inline bool py_float_round_digits(double x, int64_t digits, double *result, py_failure *failure)
{
    char text[PY_DIGITS + 16];
    double rounded;
    if (!isfinite(x) || digits > 323) { /* more than a double has behind its point */
        *result = x;
        return true;
    }
    if (digits < -308) {
        *result = 0.0 * x;
        return true;
    }
    py_decimal_text(x, (int)digits, text);
    rounded = strtod(text, NULL); /* without a point: whatever the locale's is */
    if (isinf(rounded))
        return py_failed(failure, PY_OVERFLOW, "rounded value too large to represent");
    *result = copysign(rounded, x);
    return true;
}

#endif
