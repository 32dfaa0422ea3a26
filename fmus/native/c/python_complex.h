/* Python's complex: its operators, and repr(). */
#ifndef PYTHON_COMPLEX_H
#define PYTHON_COMPLEX_H

#include <errno.h>
#include <float.h>
#include <math.h>

#include "python_failure.h"
#include "python_math.h"

typedef struct {
    double re, im;
} py_complex;

/* complex(re, im): Objects/complexobject.c, complex_new_impl, of floats */
static inline py_complex py_complex_of(double re, double im)
{
    const py_complex z = {re, im};
    return z;
}

/* z as a value that the compiler does not know. */
static inline py_complex py_complex_opaque(py_complex z)
{
    return py_complex_of(py_opaque(z.re), py_opaque(z.im));
}

/* a + b: Objects/complexobject.c, _Py_c_sum */
static inline py_complex py_complex_add(py_complex a, py_complex b)
{
    return py_complex_of(a.re + b.re, a.im + b.im);
}

/* a - b: Objects/complexobject.c, _Py_c_diff */
static inline py_complex py_complex_sub(py_complex a, py_complex b)
{
    return py_complex_of(a.re - b.re, a.im - b.im);
}

/* -a: Objects/complexobject.c, _Py_c_neg */
static inline py_complex py_complex_neg(py_complex a)
{
    return py_complex_of(-a.re, -a.im);
}

/* a.conjugate(): Objects/complexobject.c, complex_conjugate_impl */
static inline py_complex py_complex_conjugate(py_complex a)
{
    return py_complex_of(a.re, -a.im);
}

/* a == b: Objects/complexobject.c, complex_richcompare */
static inline bool py_complex_eq(py_complex a, py_complex b)
{
    return a.re == b.re && a.im == b.im;
}

/* bool(a): Objects/complexobject.c, complex_bool */
static inline bool py_complex_bool(py_complex a)
{
    return a.re != 0.0 || a.im != 0.0;
}

#if PY_VERSION_MINOR >= 14
/* The direction of an infinity: infinite parts become 1, finite ones 0, with their signs. */
static inline py_complex py_complex_direction(py_complex a)
{
    return py_complex_of(copysign(isinf(a.re) ? 1.0 : 0.0, a.re), copysign(isinf(a.im) ? 1.0 : 0.0, a.im));
}

/* NaNs become zeros, with their signs. */
static inline py_complex py_complex_no_nan(py_complex a)
{
    return py_complex_of(isnan(a.re) ? copysign(0.0, a.re) : a.re, isnan(a.im) ? copysign(0.0, a.im) : a.im);
}

/* The product where it would be NaN in both parts though a factor is infinite or it overflowed. */
PY_COLD py_complex py_complex_mul_infinite(py_complex a, py_complex b, py_complex product)
{
    bool again = false;
    const bool overflow = isinf(a.re * b.re) || isinf(a.im * b.im) || isinf(a.re * b.im) || isinf(a.im * b.re);
    if (isinf(a.re) || isinf(a.im)) {
        a = py_complex_direction(a);
        b = py_complex_no_nan(b);
        again = true;
    }
    if (isinf(b.re) || isinf(b.im)) {
        b = py_complex_direction(b);
        a = py_complex_no_nan(a);
        again = true;
    }
    if (!again && overflow) {
        a = py_complex_no_nan(a);
        b = py_complex_no_nan(b);
        again = true;
    }
    if (!again)
        return product;
    return py_complex_of(PY_INFINITY * (a.re * b.re - a.im * b.im), PY_INFINITY * (a.re * b.im + a.im * b.re));
}

/* The quotient where it would be NaN in both parts though one of the two is infinite. */
PY_COLD py_complex py_complex_quotient_infinite(py_complex a, py_complex b, py_complex quotient)
{
    if ((isinf(a.re) || isinf(a.im)) && isfinite(b.re) && isfinite(b.im)) {
        const py_complex d = py_complex_direction(a);
        return py_complex_of(PY_INFINITY * (d.re * b.re + d.im * b.im), PY_INFINITY * (d.im * b.re - d.re * b.im));
    }
    if ((isinf(b.re) || isinf(b.im)) && isfinite(a.re) && isfinite(a.im)) {
        const py_complex d = py_complex_direction(b);
        return py_complex_of(0.0 * (a.re * d.re + a.im * d.im), 0.0 * (a.im * d.re - a.re * d.im));
    }
    return quotient;
}
#endif

/* a * b: Objects/complexobject.c, _Py_c_prod */
static inline py_complex py_complex_mul(py_complex a, py_complex b)
{
    const py_complex product = {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
#if PY_VERSION_MINOR >= 14
    if (isnan(product.re) && isnan(product.im))
        return py_complex_mul_infinite(a, b, product);
#endif
    return product;
}

/* a / b for b != 0: Objects/complexobject.c, _Py_c_quot */
static inline py_complex py_complex_quotient(py_complex a, py_complex b)
{
    const double re = fabs(b.re), im = fabs(b.im);
    py_complex quotient = {PY_NAN, PY_NAN};
    if (im == 0.0 && re > 0.0 && re <= DBL_MAX) { /* the ratio is a zero: the same numbers as below, sooner */
        const double ratio = b.im * b.re;
        quotient.re = (a.re + a.im * ratio) / b.re;
        quotient.im = (a.im - a.re * ratio) / b.re;
    } else if (re >= im) {
        const double ratio = b.im / b.re, denominator = b.re + b.im * ratio;
        quotient.re = (a.re + a.im * ratio) / denominator;
        quotient.im = (a.im - a.re * ratio) / denominator;
    } else if (im >= re) {
        const double ratio = b.re / b.im, denominator = b.re * ratio + b.im;
        quotient.re = (a.re * ratio + a.im) / denominator;
        quotient.im = (a.im * ratio - a.re) / denominator;
    }
#if PY_VERSION_MINOR >= 14
    if (isnan(quotient.re) && isnan(quotient.im))
        return py_complex_quotient_infinite(a, b, quotient);
#endif
    return quotient;
}

/* a / b: Objects/complexobject.c, complex_div */
static inline bool py_complex_div(py_complex a, py_complex b, py_complex *result, py_failure *failure)
{
    if (b.re == 0.0 && b.im == 0.0)
        return py_failed(failure, PY_ZERO_DIVISION, PY_ZERO_TEXT("complex division by zero"));
    *result = py_complex_quotient(a, b);
    return true;
}

/* abs(a): Objects/complexobject.c, _Py_c_abs and complex_abs */
static inline bool py_complex_abs(py_complex a, double *result, py_failure *failure)
{
    const double size = hypot(py_opaque(a.re), py_opaque(a.im));
    if (isinf(size) && isfinite(a.re) && isfinite(a.im))
        return py_failed(failure, PY_OVERFLOW, "absolute value too large");
    *result = size;
    return true;
}

/* a to a power of 0 to 100, by squaring: Objects/complexobject.c, c_powu */
static inline py_complex py_complex_pow_whole(py_complex a, int power)
{
    py_complex result = {1.0, 0.0};
    for (int bit = 1; bit <= power; bit <<= 1) {
        if (power & bit)
            result = py_complex_mul(result, a);
        a = py_complex_mul(a, a);
    }
    return result;
}

/* a to any power, a != 0: Objects/complexobject.c, _Py_c_pow */
static inline py_complex py_complex_pow_polar(py_complex a, py_complex power)
{
    const double size = hypot(a.re, a.im), angle = atan2(a.im, a.re);
    double length = pow(size, power.re), phase = angle * power.re;
    if (power.im != 0.0) {
#if PY_VERSION_MINOR >= 14
        length *= exp(-angle * power.im);
#else
        length /= exp(angle * power.im);
#endif
        phase += power.im * log(size);
    }
    return py_complex_of(length * cos(phase), length * sin(phase));
}

/* a ** power: Objects/complexobject.c, complex_pow */
static inline bool py_complex_pow(py_complex a, py_complex power, py_complex *result, py_failure *failure)
{
    const bool whole = power.im == 0.0 && power.re == floor(power.re) && fabs(power.re) <= 100.0;
    const bool zero = a.re == 0.0 && a.im == 0.0;
    py_complex value = {0.0, 0.0};
    errno = 0; /* which Python asks too: the library's EDOM, for a phase that is infinite, is its zero power */
    if (whole && power.re > 0.0) {
        value = py_complex_pow_whole(a, (int)power.re);
    } else if (whole) {
        const py_complex one = {1.0, 0.0}, below = py_complex_pow_whole(a, (int)-power.re);
        if (below.re == 0.0 && below.im == 0.0)
            errno = EDOM;
        else
            value = py_complex_quotient(one, below);
    } else if (!zero) {
        value = py_complex_pow_polar(py_complex_opaque(a), py_complex_opaque(power));
    } else if (power.im != 0.0 || power.re < 0.0) {
        errno = EDOM;
    }
    if (errno == EDOM)
        return py_failed(failure, PY_ZERO_DIVISION, PY_ZERO_COMPLEX_POWER_TEXT);
    if (isinf(value.re) || isinf(value.im))
        return py_failed(failure, PY_OVERFLOW, "complex exponentiation");
    *result = value;
    return true;
}

/* repr(z), str(z): Objects/complexobject.c, complex_repr; 64 characters always fit */
static inline const char *py_repr_complex(char *buffer, size_t size, py_complex z)
{
    char number[PY_REPR_SIZE];
    py_writer to = {buffer, size, 0};
    const bool imaginary = z.re == 0.0 && !signbit(z.re);
    for (int part = imaginary; part < 2; part++) {
        const char *text;
        if (part == 0)
            py_put(&to, '(');
        else if (!imaginary && (isnan(z.im) || !signbit(z.im)))
            py_put(&to, '+');
        text = py_repr_float(number, sizeof number, part == 0 ? z.re : z.im);
        py_put_text(&to, text);
        if (to.length >= 2 && to.text[to.length - 2] == '.' && to.text[to.length - 1] == '0')
            to.length -= 2; /* 1j, not 1.0j */
    }
    py_put_text(&to, imaginary ? "j" : "j)");
    return py_written(&to);
}

#endif
