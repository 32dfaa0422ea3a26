/* Python's module cmath: what its functions give, and when they fail.

   Finite arguments come first; what the standard says on infinities and NaNs is a function of its own. */
#ifndef PYTHON_CMATH_H
#define PYTHON_CMATH_H

#include <errno.h>
#include <float.h>
#include <math.h>

#include "python_complex.h"
#include "python_failure.h"
#include "python_math.h"

/* cmath.isfinite(a): Modules/cmathmodule.c, cmath_isfinite_impl */
static inline bool py_cmath_isfinite(py_complex a)
{
    return isfinite(a.re) && isfinite(a.im);
}

/* cmath.isnan(a): Modules/cmathmodule.c, cmath_isnan_impl */
static inline bool py_cmath_isnan(py_complex a)
{
    return isnan(a.re) || isnan(a.im);
}

/* cmath.isinf(a): Modules/cmathmodule.c, cmath_isinf_impl */
static inline bool py_cmath_isinf(py_complex a)
{
    return isinf(a.re) || isinf(a.im);
}

/* The logarithm from which on exp() would overflow too soon: Modules/cmathmodule.c, CM_LOG_LARGE_DOUBLE */
#define PY_LOG_LARGE 708.3964185322641 /* log(DBL_MAX / 4) */

/* The rule of cmath's functions that can overflow. */
static inline bool py_cmath_finite(py_complex value, py_complex *result, py_failure *failure)
{
    if (isinf(value.re) || isinf(value.im))
        return py_math_range(failure);
    *result = value;
    return true;
}

/* size * (cos(angle), sin(angle)) for a size of infinity or 0, whose signs alone count. */
static inline py_complex py_cmath_signs(double size, double angle)
{
    return py_complex_of(copysign(size, cos(angle)), copysign(size, sin(angle)));
}

/* cmath.exp(z) for an infinite or NaN part: Modules/cmathmodule.c, exp_special_values */
PY_COLD bool py_cmath_exp_special(py_complex z, py_complex *result, py_failure *failure)
{
    const bool minus = isinf(z.re) && z.re < 0.0;
    if (isinf(z.im) && !isnan(z.re) && !minus)
        return py_math_invalid(failure);
    if (isinf(z.re) && isfinite(z.im) && z.im != 0.0)
        *result = py_cmath_signs(minus ? 0.0 : PY_INFINITY, z.im);
    else if (minus)
        *result = py_complex_of(0.0, z.im == 0.0 ? z.im : 0.0);
    else if (z.im == 0.0)
        *result = z;
    else
        *result = py_complex_of(isinf(z.re) ? PY_INFINITY : PY_NAN, PY_NAN);
    return true;
}

/* cmath.exp(z): Modules/cmathmodule.c, cmath_exp_impl */
static inline bool py_cmath_exp(py_complex z, py_complex *result, py_failure *failure)
{
    py_complex value;
    double size;
    if (!py_cmath_isfinite(z))
        return py_cmath_exp_special(z, result, failure);
    z = py_complex_opaque(z);
    if (z.re > PY_LOG_LARGE) {
        size = exp(z.re - 1.0);
        value = py_complex_of(size * cos(z.im) * PY_E, size * sin(z.im) * PY_E);
    } else {
        size = exp(z.re);
        value = py_complex_of(size * cos(z.im), size * sin(z.im));
    }
    return py_cmath_finite(value, result, failure);
}

/* cmath.cosh(z) for an infinite or NaN part: Modules/cmathmodule.c, cosh_special_values */
PY_COLD bool py_cmath_cosh_special(py_complex z, py_complex *result, py_failure *failure)
{
    const double side = copysign(1.0, z.re);
    if (isinf(z.im) && !isnan(z.re))
        return py_math_invalid(failure);
    if (isinf(z.re) && isfinite(z.im) && z.im != 0.0) {
        const py_complex signs = py_cmath_signs(PY_INFINITY, z.im);
        *result = py_complex_of(signs.re, side * signs.im);
    } else if (isinf(z.re)) {
        *result = py_complex_of(PY_INFINITY, side * z.im);
    } else {
        *result = py_complex_of(PY_NAN, z.re == 0.0 || z.im == 0.0 ? 0.0 : PY_NAN);
    }
    return true;
}

/* cmath.cosh(z): Modules/cmathmodule.c, cmath_cosh_impl */
static inline bool py_cmath_cosh(py_complex z, py_complex *result, py_failure *failure)
{
    py_complex value;
    if (!py_cmath_isfinite(z))
        return py_cmath_cosh_special(z, result, failure);
    z = py_complex_opaque(z);
    if (fabs(z.re) > PY_LOG_LARGE) {
        const double nearer = z.re - copysign(1.0, z.re);
        value = py_complex_of(cos(z.im) * cosh(nearer) * PY_E, sin(z.im) * sinh(nearer) * PY_E);
    } else {
        value = py_complex_of(cos(z.im) * cosh(z.re), sin(z.im) * sinh(z.re));
    }
    return py_cmath_finite(value, result, failure);
}

/* cmath.sinh(z) for an infinite or NaN part: Modules/cmathmodule.c, sinh_special_values */
PY_COLD bool py_cmath_sinh_special(py_complex z, py_complex *result, py_failure *failure)
{
    if (isinf(z.im) && !isnan(z.re))
        return py_math_invalid(failure);
    if (isinf(z.re) && isfinite(z.im) && z.im != 0.0) {
        const py_complex signs = py_cmath_signs(PY_INFINITY, z.im);
        *result = py_complex_of(copysign(1.0, z.re) * signs.re, signs.im);
    } else if (z.im == 0.0) {
        *result = z;
    } else {
        *result = py_complex_of(isinf(z.re) ? PY_INFINITY : z.re == 0.0 ? 0.0 : PY_NAN, PY_NAN);
    }
    return true;
}

/* cmath.sinh(z): Modules/cmathmodule.c, cmath_sinh_impl */
static inline bool py_cmath_sinh(py_complex z, py_complex *result, py_failure *failure)
{
    py_complex value;
    if (!py_cmath_isfinite(z))
        return py_cmath_sinh_special(z, result, failure);
    z = py_complex_opaque(z);
    if (fabs(z.re) > PY_LOG_LARGE) {
        const double nearer = z.re - copysign(1.0, z.re);
        value = py_complex_of(cos(z.im) * sinh(nearer) * PY_E, sin(z.im) * cosh(nearer) * PY_E);
    } else {
        value = py_complex_of(cos(z.im) * sinh(z.re), sin(z.im) * cosh(z.re));
    }
    return py_cmath_finite(value, result, failure);
}

/* cmath.tanh(z) for an infinite or NaN part: Modules/cmathmodule.c, tanh_special_values */
PY_COLD bool py_cmath_tanh_special(py_complex z, py_complex *result, py_failure *failure)
{
    const double side = copysign(1.0, z.re);
    if (isinf(z.im) && isfinite(z.re))
        return py_math_invalid(failure);
    if (isinf(z.re) && isfinite(z.im) && z.im != 0.0)
        *result = py_complex_of(side, copysign(0.0, 2.0 * sin(z.im) * cos(z.im)));
    else if (isinf(z.re))
        *result = py_complex_of(side, z.im == 0.0 ? z.im : 0.0);
    else if (isnan(z.re) && z.im == 0.0)
        *result = z;
    else if (z.re == 0.0 && PY_VERSION_MINOR >= 14)
        *result = py_complex_of(z.re, PY_NAN);
    else
        *result = py_complex_of(PY_NAN, PY_NAN);
    return true;
}

/* cmath.tanh(z): Modules/cmathmodule.c, cmath_tanh_impl */
static inline bool py_cmath_tanh(py_complex z, py_complex *result, py_failure *failure)
{
    if (!py_cmath_isfinite(z))
        return py_cmath_tanh_special(z, result, failure);
    z = py_complex_opaque(z);
    if (fabs(z.re) > PY_LOG_LARGE) {
        const double small = 4.0 * sin(z.im) * cos(z.im) * exp(-2.0 * fabs(z.re));
        *result = py_complex_of(copysign(1.0, z.re), small);
    } else {
        const double tx = tanh(z.re), ty = tan(z.im), cx = 1.0 / cosh(z.re);
        const double both = tx * ty, denominator = 1.0 + both * both;
        *result = py_complex_of(tx * (1.0 + ty * ty) / denominator, ((ty / denominator) * cx) * cx);
    }
    return true;
}

/* cmath.cos(z) = cosh(iz): Modules/cmathmodule.c, cmath_cos_impl */
static inline bool py_cmath_cos(py_complex z, py_complex *result, py_failure *failure)
{
    return py_cmath_cosh(py_complex_of(-z.im, z.re), result, failure);
}

/* cmath.sin(z) = -i sinh(iz): Modules/cmathmodule.c, cmath_sin_impl */
static inline bool py_cmath_sin(py_complex z, py_complex *result, py_failure *failure)
{
    py_complex value;
    if (!py_cmath_sinh(py_complex_of(-z.im, z.re), &value, failure))
        return false;
    *result = py_complex_of(value.im, -value.re);
    return true;
}

/* cmath.tan(z) = -i tanh(iz): Modules/cmathmodule.c, cmath_tan_impl */
static inline bool py_cmath_tan(py_complex z, py_complex *result, py_failure *failure)
{
    py_complex value;
    if (!py_cmath_tanh(py_complex_of(-z.im, z.re), &value, failure))
        return false;
    *result = py_complex_of(value.im, -value.re);
    return true;
}

/* cmath.sqrt(z) for an infinite or NaN part: Modules/cmathmodule.c, sqrt_special_values */
static inline py_complex py_cmath_sqrt_special(py_complex z)
{
    if (isinf(z.im))
        return py_complex_of(PY_INFINITY, z.im);
    if (!isinf(z.re))
        return py_complex_of(PY_NAN, PY_NAN);
    if (z.re > 0.0)
        return py_complex_of(PY_INFINITY, isnan(z.im) ? PY_NAN : copysign(0.0, z.im));
    return isnan(z.im) ? py_complex_of(PY_NAN, PY_INFINITY) : py_complex_of(0.0, copysign(PY_INFINITY, z.im));
}

/* cmath.sqrt(z): Modules/cmathmodule.c, cmath_sqrt_impl */
static inline py_complex py_cmath_sqrt(py_complex z)
{
    double re, im, root, half;
    if (!py_cmath_isfinite(z))
        return py_cmath_sqrt_special(z);
    if (z.re == 0.0 && z.im == 0.0)
        return py_complex_of(0.0, z.im);
    z = py_complex_opaque(z);
    re = fabs(z.re);
    im = fabs(z.im);
    if (re < DBL_MIN && im < DBL_MIN) { /* their size may be subnormal, and lack digits */
        re = ldexp(re, 53);
        root = ldexp(sqrt(re + hypot(re, ldexp(im, 53))), -27);
    } else { /* eighths, so that nothing overflows */
        re /= 8.0;
        root = 2.0 * sqrt(re + hypot(re, im / 8.0));
    }
    half = im / (2.0 * root);
    if (z.re >= 0.0)
        return py_complex_of(root, copysign(half, z.im));
    return py_complex_of(half, copysign(root, z.im));
}

/* cmath.log(z): Modules/cmathmodule.c, c_log */
static inline bool py_cmath_log(py_complex z, py_complex *result, py_failure *failure)
{
    double re, im, size;
    z = py_complex_opaque(z);
    re = fabs(z.re);
    im = fabs(z.im);
    if (!py_cmath_isfinite(z)) {
        *result = py_complex_of(py_cmath_isinf(z) ? PY_INFINITY : PY_NAN, py_math_atan2(z.im, z.re));
        return true;
    }
    if (re == 0.0 && im == 0.0)
        return py_math_invalid(failure);
    if (re > DBL_MAX / 4.0 || im > DBL_MAX / 4.0) {
        size = log(hypot(re / 2.0, im / 2.0)) + PY_LN2;
    } else if (re < DBL_MIN && im < DBL_MIN) {
        size = log(hypot(ldexp(re, DBL_MANT_DIG), ldexp(im, DBL_MANT_DIG))) - DBL_MANT_DIG * PY_LN2;
    } else {
        const double absolute = hypot(re, im);
        if (0.71 <= absolute && absolute <= 1.73) { /* near 1, where its logarithm has few digits */
            const double more = re > im ? re : im, less = re > im ? im : re;
            const double beyond = (more - 1.0) * (more + 1.0) + less * less;
            size = (beyond == 0.0 ? beyond : log1p(beyond)) / 2.0;
        } else {
            size = log(absolute);
        }
    }
    *result = py_complex_of(size, atan2(z.im, z.re));
    return true;
}

/* cmath.log10(z): Modules/cmathmodule.c, cmath_log10_impl */
static inline bool py_cmath_log10(py_complex z, py_complex *result, py_failure *failure)
{
    py_complex value;
    if (!py_cmath_log(z, &value, failure))
        return false;
    *result = py_complex_of(value.re / PY_LN10, value.im / PY_LN10);
    return true;
}

/* cmath.phase(z): Modules/cmathmodule.c, cmath_phase_impl */
static inline bool py_cmath_phase(py_complex z, double *result, py_failure *failure)
{
    const double angle = atan2(py_opaque(z.im), py_opaque(z.re));
    if (angle == 0.0 && z.im != 0.0) { /* where alone the library may say that it is too small */
        errno = 0;
        (void)atan2(py_opaque(z.im), py_opaque(z.re));
        if (errno == ERANGE)
            return py_math_range(failure);
    }
    *result = angle;
    return true;
}

/* cmath.polar(z): Modules/cmathmodule.c, cmath_polar_impl */
static inline bool py_cmath_polar(py_complex z, double *size, double *angle, py_failure *failure)
{
    const double value = hypot(py_opaque(z.re), py_opaque(z.im));
    if (isinf(value) && py_cmath_isfinite(z))
        return py_math_range(failure);
    *size = value;
    *angle = atan2(py_opaque(z.im), py_opaque(z.re));
    return true;
}

/* cmath.rect(size, angle) for an infinite or NaN part: Modules/cmathmodule.c, rect_special_values */
PY_COLD bool py_cmath_rect_special(double size, double angle, py_complex *result, py_failure *failure)
{
    const double side = copysign(1.0, size);
    if (isinf(angle) && size != 0.0 && !isnan(size))
        return py_math_invalid(failure);
    if (isinf(size) && isfinite(angle) && angle != 0.0) {
        const py_complex signs = py_cmath_signs(PY_INFINITY, angle);
        *result = py_complex_of(side * signs.re, side * signs.im);
    } else if (isinf(size)) {
        *result = isnan(angle) ? py_complex_of(PY_INFINITY, PY_NAN) : py_complex_of(size, side * angle);
    } else if (size == 0.0) {
        *result = py_complex_of(0.0, 0.0);
    } else {
        *result = py_complex_of(PY_NAN, isnan(size) && angle == 0.0 ? 0.0 : PY_NAN);
    }
    return true;
}

/* cmath.rect(size, angle): Modules/cmathmodule.c, cmath_rect_impl */
static inline bool py_cmath_rect(double size, double angle, py_complex *result, py_failure *failure)
{
    if (!isfinite(size) || !isfinite(angle))
        return py_cmath_rect_special(size, angle, result, failure);
    if (angle == 0.0)
        *result = py_complex_of(size, size * angle);
    else
        *result = py_complex_of(size * cos(py_opaque(angle)), size * sin(py_opaque(angle)));
    return true;
}

#endif
