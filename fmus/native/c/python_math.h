/* Python's module math: what its functions give, and when they fail.

   They are those of the C library, so that the last bit is that of the library of this machine. */
#ifndef PYTHON_MATH_H
#define PYTHON_MATH_H

#include <float.h>
#include <math.h>

#include "python_failure.h"
#include "python_float.h"
#include "python_text.h"

#define PY_PI 3.14159265358979323846
#define PY_E 2.71828182845904523536
#define PY_LN2 0.6931471805599453094
#define PY_LN10 2.302585092994045684

/* math.floor(x): Modules/mathmodule.c, math_floor */
static inline bool py_math_floor(double x, int64_t *result, py_failure *failure)
{
    return py_float_int(floor(x), result, failure);
}

/* math.ceil(x): Modules/mathmodule.c, math_ceil */
static inline bool py_math_ceil(double x, int64_t *result, py_failure *failure)
{
    return py_float_int(ceil(x), result, failure);
}

/* math.trunc(x): Modules/mathmodule.c, math_trunc */
static inline bool py_math_trunc(double x, int64_t *result, py_failure *failure)
{
    return py_float_int(x, result, failure);
}

/* Fill the failure for an argument that has no result. */
PY_COLD void py_math_domain_fill(const char *expected, double x, py_failure *failure)
{
#if PY_VERSION_MINOR >= 14
    char text[sizeof failure->text], number[PY_REPR_SIZE];
    py_writer to = {text, sizeof text, 0};
    py_put_text(&to, expected);
    py_put_text(&to, ", got ");
    py_put_text(&to, py_repr_float(number, sizeof number, x));
    py_failure_fill(failure, PY_DOMAIN, py_written(&to));
#else
    (void)expected;
    (void)x;
    py_failure_fill(failure, PY_DOMAIN, "math domain error");
#endif
}

/* Fail for an argument that has no result; `expected` is what Python says since 3.14, before the argument. */
static inline bool py_math_domain(const char *expected, double x, py_failure *failure)
{
    py_math_domain_fill(expected, x, failure);
    return false;
}

/* Fail without a word on the argument. */
static inline bool py_math_invalid(py_failure *failure)
{
    return py_failed(failure, PY_DOMAIN, "math domain error");
}

/* Fail for a result beyond the largest double. */
static inline bool py_math_range(py_failure *failure)
{
    return py_failed(failure, PY_RANGE, "math range error");
}

/* math.sqrt(x): Modules/mathmodule.c, math_1 */
static inline bool py_math_sqrt(double x, double *result, py_failure *failure)
{
    if (x < 0.0)
        return py_math_domain("expected a nonnegative input", x, failure);
    *result = sqrt(x);
    return true;
}

/* The rule of functions that can overflow: Modules/mathmodule.c, math_1 with can_overflow */
static inline bool py_math_finite(double x, double value, double *result, py_failure *failure)
{
    if (isinf(value) && isfinite(x))
        return py_math_range(failure);
    *result = value;
    return true;
}

/* math.exp(x): Modules/mathmodule.c, math_1 */
static inline bool py_math_exp(double x, double *result, py_failure *failure)
{
    return py_math_finite(x, exp(py_opaque(x)), result, failure);
}

/* math.exp2(x): Modules/mathmodule.c, math_1 */
static inline bool py_math_exp2(double x, double *result, py_failure *failure)
{
    return py_math_finite(x, exp2(py_opaque(x)), result, failure);
}

/* math.expm1(x): Modules/mathmodule.c, math_1 */
static inline bool py_math_expm1(double x, double *result, py_failure *failure)
{
    return py_math_finite(x, expm1(py_opaque(x)), result, failure);
}

/* math.log(x) of a float: Modules/mathmodule.c, m_log */
static inline bool py_math_log(double x, double *result, py_failure *failure)
{
    if (x <= 0.0)
        return py_math_domain("expected a positive input", x, failure);
    *result = log(py_opaque(x));
    return true;
}

/* math.log(x, base) of floats: Modules/mathmodule.c, math_log */
static inline bool py_math_log_base(double x, double base, double *result, py_failure *failure)
{
    double above, below;
    return py_math_log(x, &above, failure) && py_math_log(base, &below, failure) &&
           py_float_div(above, below, result, failure);
}

/* math.log2(x) of a float: Modules/mathmodule.c, m_log2 */
static inline bool py_math_log2(double x, double *result, py_failure *failure)
{
    if (x <= 0.0)
        return py_math_domain("expected a positive input", x, failure);
    *result = log2(py_opaque(x));
    return true;
}

/* math.log10(x) of a float: Modules/mathmodule.c, m_log10 */
static inline bool py_math_log10(double x, double *result, py_failure *failure)
{
    if (x <= 0.0)
        return py_math_domain("expected a positive input", x, failure);
    *result = log10(py_opaque(x));
    return true;
}

/* math.log1p(x): Modules/mathmodule.c, math_1, and Modules/_math.h, _Py_log1p */
static inline bool py_math_log1p(double x, double *result, py_failure *failure)
{
    if (x <= -1.0)
        return py_math_domain("expected argument value > -1", x, failure);
    *result = x == 0.0 ? x : log1p(py_opaque(x));
    return true;
}

/* math.sin(x): Modules/mathmodule.c, math_1 */
static inline bool py_math_sin(double x, double *result, py_failure *failure)
{
    if (isinf(x))
        return py_math_domain("expected a finite input", x, failure);
    *result = sin(py_opaque(x));
    return true;
}

/* math.cos(x): Modules/mathmodule.c, math_1 */
static inline bool py_math_cos(double x, double *result, py_failure *failure)
{
    if (isinf(x))
        return py_math_domain("expected a finite input", x, failure);
    *result = cos(py_opaque(x));
    return true;
}

/* math.tan(x): Modules/mathmodule.c, math_1 */
static inline bool py_math_tan(double x, double *result, py_failure *failure)
{
    if (isinf(x))
        return py_math_domain("expected a finite input", x, failure);
    *result = tan(py_opaque(x));
    return true;
}

/* math.asin(x): Modules/mathmodule.c, math_1 */
static inline bool py_math_asin(double x, double *result, py_failure *failure)
{
    if (x < -1.0 || x > 1.0)
        return py_math_domain("expected a number in range from -1 up to 1", x, failure);
    *result = asin(py_opaque(x));
    return true;
}

/* math.acos(x): Modules/mathmodule.c, math_1 */
static inline bool py_math_acos(double x, double *result, py_failure *failure)
{
    if (x < -1.0 || x > 1.0)
        return py_math_domain("expected a number in range from -1 up to 1", x, failure);
    *result = acos(py_opaque(x));
    return true;
}

/* math.atan(x): Modules/mathmodule.c, math_1 */
static inline double py_math_atan(double x)
{
    return atan(py_opaque(x));
}

/* math.atan2(y, x): Modules/mathmodule.c, m_atan2, which asks the library for finite y != 0 and x alone */
static inline double py_math_atan2(double y, double x)
{
    const bool right = copysign(1.0, x) == 1.0;
    if (isnan(x) || isnan(y))
        return x + y;
    if (isinf(y)) {
        if (isinf(x))
            return copysign(right ? 0.25 * PY_PI : 0.75 * PY_PI, y);
        return copysign(0.5 * PY_PI, y);
    }
    if (isinf(x) || y == 0.0)
        return copysign(right ? 0.0 : PY_PI, y);
    return atan2(py_opaque(y), py_opaque(x));
}

/* math.sinh(x): Modules/mathmodule.c, math_1 */
static inline bool py_math_sinh(double x, double *result, py_failure *failure)
{
    return py_math_finite(x, sinh(py_opaque(x)), result, failure);
}

/* math.cosh(x): Modules/mathmodule.c, math_1 */
static inline bool py_math_cosh(double x, double *result, py_failure *failure)
{
    return py_math_finite(x, cosh(py_opaque(x)), result, failure);
}

/* math.tanh(x): Modules/mathmodule.c, math_1 */
static inline double py_math_tanh(double x)
{
    return tanh(py_opaque(x));
}

/* math.asinh(x): Modules/mathmodule.c, math_1 */
static inline double py_math_asinh(double x)
{
    return asinh(py_opaque(x));
}

/* math.acosh(x): Modules/mathmodule.c, math_1 */
static inline bool py_math_acosh(double x, double *result, py_failure *failure)
{
    if (x < 1.0)
        return py_math_domain("expected argument value not less than 1", x, failure);
    *result = acosh(py_opaque(x));
    return true;
}

/* math.atanh(x): Modules/mathmodule.c, math_1 */
static inline bool py_math_atanh(double x, double *result, py_failure *failure)
{
    if (x <= -1.0 || x >= 1.0)
        return py_math_domain("expected a number between -1 and 1", x, failure);
    *result = atanh(py_opaque(x));
    return true;
}

/* math.cbrt(x): Modules/mathmodule.c, math_1 */
static inline double py_math_cbrt(double x)
{
    return cbrt(py_opaque(x));
}

/* math.erf(x): Modules/mathmodule.c, math_1a */
static inline double py_math_erf(double x)
{
    return erf(py_opaque(x));
}

/* math.erfc(x): Modules/mathmodule.c, math_1a */
static inline double py_math_erfc(double x)
{
    return erfc(py_opaque(x));
}

/* math.pow(x, y), always of floats: Modules/mathmodule.c, math_pow_impl */
static inline bool py_math_pow(double x, double y, double *result, py_failure *failure)
{
    double power;
    if (!isfinite(x) || !isfinite(y)) {
        *result = y == 0.0 ? 1.0 : py_float_pow_special(x, y);
        return true;
    }
    power = pow(py_opaque(x), py_opaque(y));
    if (isnan(power) || (isinf(power) && x == 0.0))
        return py_math_invalid(failure);
    if (isinf(power))
        return py_math_range(failure);
    *result = power;
    return true;
}

/* math.fmod(x, y): Modules/mathmodule.c, math_fmod_impl */
static inline bool py_math_fmod(double x, double y, double *result, py_failure *failure)
{
    const double value = isinf(y) && isfinite(x) ? x : fmod(x, y);
    if (isnan(value) && !isnan(x) && !isnan(y))
        return py_math_invalid(failure);
    *result = value;
    return true;
}

/* math.remainder(x, y): Modules/mathmodule.c, m_remainder; exact, so that the library's is the same but for a zero's sign */
static inline bool py_math_remainder(double x, double y, double *result, py_failure *failure)
{
    const double value = isinf(y) && isfinite(x) ? x : remainder(x, y);
    if (isnan(value) && !isnan(x) && !isnan(y))
        return py_math_invalid(failure);
    *result = value == 0.0 ? copysign(0.0, x) : value;
    return true;
}

/* math.copysign(x, y): Modules/mathmodule.c, math_2 */
static inline double py_math_copysign(double x, double y)
{
    return copysign(x, y);
}

/* math.fabs(x): Modules/mathmodule.c, math_1 */
static inline double py_math_fabs(double x)
{
    return fabs(x);
}

/* math.isnan(x): Modules/mathmodule.c, math_isnan_impl */
static inline bool py_math_isnan(double x)
{
    return isnan(x);
}

/* math.isinf(x): Modules/mathmodule.c, math_isinf_impl */
static inline bool py_math_isinf(double x)
{
    return isinf(x);
}

/* math.isfinite(x): Modules/mathmodule.c, math_isfinite_impl */
static inline bool py_math_isfinite(double x)
{
    return isfinite(x);
}

/* math.degrees(x): Modules/mathmodule.c, math_degrees_impl */
static inline double py_math_degrees(double x)
{
    return x * (180.0 / PY_PI);
}

/* math.radians(x): Modules/mathmodule.c, math_radians_impl */
static inline double py_math_radians(double x)
{
    return x * (PY_PI / 180.0);
}

/* math.isclose(a, b, rel_tol=, abs_tol=): Modules/mathmodule.c, math_isclose_impl */
static inline bool py_math_isclose(double a, double b, double rel_tol, double abs_tol, bool *result,
                                   py_failure *failure)
{
    const double difference = fabs(b - a);
    if (rel_tol < 0.0 || abs_tol < 0.0)
        return py_failed(failure, PY_VALUE, "tolerances must be non-negative");
    if (a == b)
        *result = true;
    else if (isinf(a) || isinf(b))
        *result = false;
    else
        *result = difference <= fabs(rel_tol * b) || difference <= fabs(rel_tol * a) || difference <= abs_tol;
    return true;
}

/* A sum of squares as a head, which is 1 too large, and the parts that it lacks. */
typedef struct {
    double head, first, second, third;
} py_squares;

/* A summand that is smaller than the head; `lost` takes what rounding leaves out. */
static inline void py_squares_add(py_squares *sum, double summand, double *lost)
{
    const double head = sum->head + summand;
    *lost += (sum->head - head) + summand;
    sum->head = head;
}

/* sign * x**2 for abs(x) <= 1, exactly: x is split into halves of 26 bits */
static inline void py_squares_add_square(py_squares *sum, double x, double sign)
{
    const double wide = x * 134217729.0; /* 2**27 + 1 */
    const double high = wide - (wide - x), low = x - high;
#if PY_VERSION_MINOR >= 12
    const double square = x * x;
    const double rest = ((high * high - square) + 2.0 * high * low) + low * low; /* square + rest is exact */
    py_squares_add(sum, sign * square, &sum->second);
    sum->first += sign * rest;
#else
    py_squares_add(sum, sign * high * high, &sum->first);
    py_squares_add(sum, sign * 2.0 * high * low, &sum->second);
    if (sign > 0.0)
        sum->third += low * low;
    else
        py_squares_add(sum, -low * low, &sum->third);
#endif
}

/* The sum of squares, rounded. */
static inline double py_squares_total(const py_squares *sum)
{
    return sum->head - 1.0 + (sum->first + sum->second + sum->third);
}

/* The length of a vector whose largest size is `most`: Modules/mathmodule.c, vector_norm

   Scaled by a power of two, squared and summed up without loss but for the last bits, and one step of
   Newton's method for the root: nearly always the nearest double. */
static inline double py_vector_norm(const double *vector, int64_t n, double most, bool nan_found)
{
    py_squares sum = {1.0, 0.0, 0.0, 0.0};
    double up = 1.0, scale, root;
    int exponent;
    if (isinf(most))
        return most;
    if (nan_found)
        return PY_NAN;
    if (most == 0.0 || n <= 1)
        return most;
    (void)frexp(most, &exponent);
#if PY_VERSION_MINOR >= 12
    if (exponent < -1023) { /* the scale would be infinite: subnormal numbers become normal ones first */
        up = DBL_MIN;
        (void)frexp(most / DBL_MIN, &exponent);
    }
#else
    if (exponent < -1023) {
        for (int64_t i = 0; i < n; i++) {
            const double x = vector[i] / most;
            py_squares_add(&sum, x * x, &sum.first);
        }
        return most * sqrt(sum.head - 1.0 + sum.first);
    }
#endif
    scale = ldexp(1.0, -exponent);
    for (int64_t i = 0; i < n; i++)
        py_squares_add_square(&sum, vector[i] / up * scale, 1.0);
    root = sqrt(py_squares_total(&sum));
    py_squares_add_square(&sum, root, -1.0);
    root += py_squares_total(&sum) / (2.0 * root);
    return up * (root / scale);
}

/* math.hypot(*vector): Modules/mathmodule.c, math_hypot */
static inline double py_math_hypot(const double *vector, int64_t n)
{
    double most = 0.0;
    bool nan_found = false;
    for (int64_t i = 0; i < n; i++) {
        const double size = fabs(vector[i]);
        nan_found = nan_found || isnan(size);
        most = size > most ? size : most;
    }
    return py_vector_norm(vector, n, most, nan_found);
}

/* math.hypot(x, y): Modules/mathmodule.c, math_hypot */
static inline double py_math_hypot2(double x, double y)
{
    const double vector[2] = {x, y};
    return py_math_hypot(vector, 2);
}

/* math.hypot(x, y, z): Modules/mathmodule.c, math_hypot */
static inline double py_math_hypot3(double x, double y, double z)
{
    const double vector[3] = {x, y, z};
    return py_math_hypot(vector, 3);
}

/* math.dist((x0, y0), (x1, y1)): Modules/mathmodule.c, math_dist_impl */
static inline double py_math_dist2(double x0, double y0, double x1, double y1)
{
    return py_math_hypot2(x0 - x1, y0 - y1);
}

/* math.dist((x0, y0, z0), (x1, y1, z1)): Modules/mathmodule.c, math_dist_impl */
static inline double py_math_dist3(double x0, double y0, double z0, double x1, double y1, double z1)
{
    return py_math_hypot3(x0 - x1, y0 - y1, z0 - z1);
}

#endif
