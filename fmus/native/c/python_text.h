/* Python's texts of numbers, for messages: digits are exact, whatever the C library and the locale.

   A double is an integer times a power of two, so it has an end as a decimal number too: at most 767 digits
   that count. Here all of them are made, and rounded as decimal digits. */
#ifndef PYTHON_TEXT_H
#define PYTHON_TEXT_H

#include <math.h>
#include <string.h>

#include "python_failure.h"

enum {
    PY_DIGITS = 800,     /* of the longest double, and of the half-way points beside it */
    PY_LIMBS = 90,       /* of such an integer, of nine digits each */
    PY_REPR_SIZE = 32,   /* characters for the repr() of a float, with the final zero */
    PY_MOST_DIGITS = 999 /* a format's width and precision, which Python does not bound */
};

/* 0.d1 d2 d3 ... times 10**point, the first digit not 0; no digits for zero. */
typedef struct {
    int count;
    int point;
    char digit[PY_DIGITS]; /* 0 to 9 */
} py_decimal;

/* Text of a given size: what does not fit is left out. */
typedef struct {
    char *text;
    size_t size, length;
} py_writer;

/* An integer, nine digits in each limb, times a factor of at most ten digits. */
static inline int py_limbs_multiply(uint32_t *limbs, int count, uint64_t factor)
{
    uint64_t carry = 0;
    for (int i = 0; i < count; i++) {
        carry += limbs[i] * factor;
        limbs[i] = (uint32_t)(carry % 1000000000u);
        carry /= 1000000000u;
    }
    for (; carry != 0; carry /= 1000000000u)
        limbs[count++] = (uint32_t)(carry % 1000000000u);
    return count;
}

/* All digits of significand * 2**exponent. */
static inline void py_decimal_exact(uint64_t significand, int exponent, py_decimal *decimal)
{
    uint32_t limbs[PY_LIMBS];
    const bool whole = exponent >= 0;
    int count = 0, left = whole ? exponent : -exponent;
    bool leading = true;
    for (; significand != 0; significand /= 1000000000u)
        limbs[count++] = (uint32_t)(significand % 1000000000u);
    for (; left > 0; left -= 13) { /* 2**-n is 5**n / 10**n; 5**13 has ten digits */
        uint64_t factor = 1;
        for (int i = 0; i < (left < 13 ? left : 13); i++)
            factor *= whole ? 2u : 5u;
        count = py_limbs_multiply(limbs, count, factor);
    }
    decimal->count = 0;
    for (int i = count - 1; i >= 0; i--)
        for (uint32_t unit = 100000000u; unit != 0; unit /= 10) {
            const char digit = (char)(limbs[i] / unit % 10);
            leading = leading && digit == 0;
            if (!leading)
                decimal->digit[decimal->count++] = digit;
        }
    decimal->point = decimal->count + (whole ? 0 : exponent);
}

/* significand * 2**exponent of a finite double > 0. */
static inline uint64_t py_double_parts(double x, int *exponent)
{
    uint64_t significand = (uint64_t)ldexp(frexp(x, exponent), 53);
    *exponent -= 53;
    while (*exponent < -1074) { /* a subnormal number has fewer digits */
        significand >>= 1;
        ++*exponent;
    }
    return significand;
}

/* Digit i, behind the last one a 0. */
static inline int py_decimal_at(const py_decimal *decimal, int i)
{
    return i < decimal->count ? decimal->digit[i] : 0;
}

/* -1, 0 or 1 for a < b, a == b, a > b, both > 0. */
static inline int py_decimal_compare(const py_decimal *a, const py_decimal *b)
{
    if (a->point != b->point)
        return a->point < b->point ? -1 : 1;
    for (int i = 0; i < a->count || i < b->count; i++)
        if (py_decimal_at(a, i) != py_decimal_at(b, i))
            return py_decimal_at(a, i) < py_decimal_at(b, i) ? -1 : 1;
    return 0;
}

/* -1, 0 or 1 where what follows n digits is less than a half, a half, more. */
static inline int py_decimal_rest(const py_decimal *decimal, int n)
{
    if (py_decimal_at(decimal, n) != 5)
        return py_decimal_at(decimal, n) < 5 ? -1 : 1;
    for (int i = n + 1; i < decimal->count; i++)
        if (decimal->digit[i] != 0)
            return 1;
    return 0;
}

/* The first n digits, one more at the last of them where `up`. */
static inline void py_decimal_cut(py_decimal *decimal, int n, bool up)
{
    if (n >= decimal->count)
        return;
    decimal->count = n;
    if (!up)
        return;
    while (n > 0 && decimal->digit[n - 1] == 9)
        n--;
    decimal->count = n;
    if (n > 0) {
        decimal->digit[n - 1]++;
    } else { /* 99.9 becomes 100 */
        decimal->digit[0] = 1;
        decimal->count = 1;
        decimal->point++;
    }
}

/* Rounded to n digits, half to even: Python/dtoa.c, _Py_dg_dtoa in modes 2 and 3 */
static inline void py_decimal_round(py_decimal *decimal, int n)
{
    if (n < 0) {
        decimal->count = 0;
    } else if (n < decimal->count) {
        const int rest = py_decimal_rest(decimal, n);
        py_decimal_cut(decimal, n, rest > 0 || (rest == 0 && n > 0 && decimal->digit[n - 1] % 2 == 1));
    }
    while (decimal->count > 0 && decimal->digit[decimal->count - 1] == 0)
        decimal->count--;
}

/* All digits of abs(x), x finite. */
static inline void py_decimal_of(double x, py_decimal *decimal)
{
    int exponent = 0;
    decimal->count = 0;
    decimal->point = 1;
    if (x != 0.0) {
        const uint64_t significand = py_double_parts(fabs(x), &exponent);
        py_decimal_exact(significand, exponent, decimal);
    }
}

/* The fewest digits that are read back as x > 0, of these the nearest: Python/dtoa.c, mode 0 */
static inline void py_decimal_shortest(double x, py_decimal *shortest)
{
    py_decimal value, low, high, down, up;
    int exponent = 0;
    const uint64_t significand = py_double_parts(x, &exponent);
    const bool even = significand % 2 == 0; /* half-way points are read as the even neighbor */
    const bool narrow = significand == UINT64_C(1) << 52 && exponent > -1074; /* nearer below a power of 2 */
    py_decimal_exact(4 * significand, exponent - 2, &value);
    py_decimal_exact(4 * significand - (narrow ? 1 : 2), exponent - 2, &low);
    py_decimal_exact(4 * significand + 2, exponent - 2, &high);
    for (int n = 1;; n++) { /* 17 at most */
        int above, below, rest;
        down = up = value;
        py_decimal_cut(&down, n, false);
        py_decimal_cut(&up, n, true);
        below = py_decimal_compare(&down, &low);
        above = py_decimal_compare(&high, &up);
        if (below < 0 || (below == 0 && !even))
            below = -1;
        if (above < 0 || (above == 0 && !even))
            above = -1;
        if (below < 0 && above < 0)
            continue;
        rest = py_decimal_rest(&value, n);
        if (below >= 0 && above >= 0)
            *shortest = rest > 0 || (rest == 0 && py_decimal_at(&value, n - 1) % 2 == 1) ? up : down;
        else
            *shortest = below >= 0 ? down : up;
        break;
    }
    py_decimal_round(shortest, shortest->count); /* without zeros at the end */
}

/* One more character. */
static inline void py_put(py_writer *to, char c)
{
    if (to->length + 1 < to->size)
        to->text[to->length++] = c;
}

/* A whole text. */
static inline void py_put_text(py_writer *to, const char *text)
{
    for (; *text != '\0'; text++)
        py_put(to, *text);
}

/* The final zero; the text. */
static inline const char *py_written(py_writer *to)
{
    if (to->size > 0)
        to->text[to->length] = '\0';
    return to->text;
}

/* A number without its sign, with at least `digits` digits: no point, no exponent. */
static inline void py_put_unsigned(py_writer *to, uint64_t number, int digits)
{
    char text[20];
    int n = 0;
    for (; number != 0 || n < digits; number /= 10)
        text[n++] = (char)('0' + number % 10);
    while (n > 0)
        py_put(to, text[--n]);
}

/* 123.45, `decimals` digits behind the point. */
static inline void py_put_fixed(py_writer *to, const py_decimal *decimal, int decimals)
{
    if (decimal->point <= 0)
        py_put(to, '0');
    for (int i = 0; i < decimal->point; i++)
        py_put(to, (char)('0' + py_decimal_at(decimal, i)));
    if (decimals > 0)
        py_put(to, '.');
    for (int i = 0; i < decimals; i++) {
        const int place = decimal->point + i;
        py_put(to, (char)('0' + (place < 0 ? 0 : py_decimal_at(decimal, place))));
    }
}

/* 1.2345e+02, `decimals` digits behind the point. */
static inline void py_put_exponent(py_writer *to, const py_decimal *decimal, int decimals, char letter)
{
    const int exponent = decimal->point - 1;
    py_put(to, (char)('0' + py_decimal_at(decimal, 0)));
    if (decimals > 0)
        py_put(to, '.');
    for (int i = 1; i <= decimals; i++)
        py_put(to, (char)('0' + py_decimal_at(decimal, i)));
    py_put(to, letter);
    py_put(to, exponent < 0 ? '-' : '+');
    py_put_unsigned(to, (uint64_t)(exponent < 0 ? -exponent : exponent), 2);
}

/* As many digits as there are, with an exponent from 10**`most` on: Python/pystrtod.c, format_float_short */
static inline void py_put_short(py_writer *to, const py_decimal *decimal, int most, bool point, char letter)
{
    if (-4 < decimal->point && decimal->point <= most) {
        const int decimals = decimal->count - decimal->point;
        py_put_fixed(to, decimal, decimals < point ? point : decimals);
    } else {
        py_put_exponent(to, decimal, decimal->count - 1, letter);
    }
}

/* abs(x), x finite, rounded to `digits` behind the point, without a point: 0123e-2 */
static inline void py_decimal_text(double x, int digits, char *text)
{
    py_decimal decimal;
    py_writer to = {text, PY_DIGITS + 16, 0};
    int exponent;
    py_decimal_of(x, &decimal);
    py_decimal_round(&decimal, decimal.point + digits);
    exponent = decimal.point - decimal.count;
    py_put(&to, '0');
    for (int i = 0; i < decimal.count; i++)
        py_put(&to, (char)('0' + decimal.digit[i]));
    py_put(&to, 'e');
    py_put(&to, exponent < 0 ? '-' : '+');
    py_put_unsigned(&to, (uint64_t)(exponent < 0 ? -exponent : exponent), 1);
    py_written(&to);
}

/* repr(x), str(x): Objects/floatobject.c, float_repr; the buffer, which 32 characters always fit */
static inline const char *py_repr_float(char *buffer, size_t size, double x)
{
    py_decimal decimal;
    py_writer to = {buffer, size, 0};
    if (isnan(x)) {
        py_put_text(&to, "nan");
        return py_written(&to);
    }
    if (signbit(x))
        py_put(&to, '-');
    if (isinf(x)) {
        py_put_text(&to, "inf");
        return py_written(&to);
    }
    if (x == 0.0)
        py_decimal_of(x, &decimal);
    else
        py_decimal_shortest(fabs(x), &decimal);
    py_put_short(&to, &decimal, 16, true, 'e');
    return py_written(&to);
}

/* What a format specification asks for: [sign][0][width][.precision][type]. */
typedef struct {
    char sign; /* '-', '+' or ' ' */
    char fill; /* ' ' or '0' */
    int width;
    int precision; /* -1: none */
    char type;     /* one of "eEfFgG%", '\0' for none */
} py_spec;

/* A number of a specification; -1 where there is none, or too great a one. */
static inline int py_spec_number(const char **at)
{
    int number = -1;
    for (; **at >= '0' && **at <= '9'; ++*at) {
        number = (number < 0 ? 0 : number * 10) + (**at - '0');
        if (number > PY_MOST_DIGITS)
            return -1;
    }
    return number;
}

/* True for a specification that is understood: Python/formatter_unicode.c, parse_internal_render_format_spec */
static inline bool py_spec_read(const char *at, py_spec *spec)
{
    const py_spec plain = {'-', ' ', 0, -1, '\0'};
    *spec = plain;
    if (*at == '-' || *at == '+' || *at == ' ')
        spec->sign = *at++;
    if (*at == '0')
        spec->fill = *at++;
    if (*at >= '0' && *at <= '9' && (spec->width = py_spec_number(&at)) < 0)
        return false;
    if (*at == '.') {
        at++;
        if ((spec->precision = py_spec_number(&at)) < 0)
            return false;
    }
    if (*at != '\0' && strchr("eEfFgG%", *at) != NULL)
        spec->type = *at++;
    return *at == '\0';
}

/* The digits of x >= 0 or "inf" or "nan": Python/pystrtod.c, format_float_short */
static inline void py_put_magnitude(py_writer *to, double x, const py_spec *spec)
{
    const bool capital = spec->type == 'E' || spec->type == 'F' || spec->type == 'G';
    int precision = spec->precision < 0 ? 6 : spec->precision;
    py_decimal decimal;
    if (!isfinite(x)) {
        py_put_text(to, isnan(x) ? (capital ? "NAN" : "nan") : (capital ? "INF" : "inf"));
        return;
    }
    py_decimal_of(x, &decimal);
    switch (spec->type) {
    case 'f':
    case 'F':
    case '%':
        py_decimal_round(&decimal, decimal.point + precision);
        py_put_fixed(to, &decimal, precision);
        return;
    case 'e':
    case 'E':
        py_decimal_round(&decimal, precision + 1);
        py_put_exponent(to, &decimal, precision, spec->type);
        return;
    case '\0':
        if (spec->precision < 0) {
            if (x != 0.0)
                py_decimal_shortest(x, &decimal);
            py_put_short(to, &decimal, 16, true, 'e');
            return;
        }
        break;
    default:
        break;
    }
    if (precision == 0)
        precision = 1;
    py_decimal_round(&decimal, precision);
    py_put_short(to, &decimal, spec->type == '\0' ? precision - 1 : precision, spec->type == '\0',
                 capital ? 'E' : 'e');
}

/* format(x, specification) for [sign][0][width][.precision][type], type one of "eEfFgG%" or none;
   "?" for another specification: Python/formatter_unicode.c, format_float_internal */
static inline const char *py_format_float(char *buffer, size_t size, double x, const char *specification)
{
    py_spec spec;
    py_writer to = {buffer, size, 0};
    const bool negative = signbit(x) && !isnan(x);
    char digits[PY_DIGITS + PY_MOST_DIGITS];
    py_writer magnitude = {digits, sizeof digits, 0};
    size_t length;
    if (!py_spec_read(specification, &spec)) {
        py_put(&to, '?');
        return py_written(&to);
    }
    py_put_magnitude(&magnitude, spec.type == '%' ? fabs(x) * 100.0 : fabs(x), &spec);
    if (spec.type == '%')
        py_put(&magnitude, '%');
    length = magnitude.length + (negative || spec.sign != '-');
    if (spec.fill == ' ')
        for (size_t n = length; n < (size_t)spec.width; n++)
            py_put(&to, ' ');
    if (negative || spec.sign != '-')
        py_put(&to, negative ? '-' : spec.sign);
    if (spec.fill == '0')
        for (size_t n = length; n < (size_t)spec.width; n++)
            py_put(&to, '0');
    py_put_text(&to, py_written(&magnitude));
    return py_written(&to);
}

/* repr(a), str(a): Objects/longobject.c, long_to_decimal_string; 21 characters always fit */
static inline const char *py_repr_int(char *buffer, size_t size, int64_t a)
{
    py_writer to = {buffer, size, 0};
    if (a < 0)
        py_put(&to, '-');
    py_put_unsigned(&to, a < 0 ? 0u - (uint64_t)a : (uint64_t)a, 1);
    return py_written(&to);
}

/* repr(a), str(a): Objects/boolobject.c, bool_repr */
static inline const char *py_repr_bool(char *buffer, size_t size, bool a)
{
    py_writer to = {buffer, size, 0};
    py_put_text(&to, a ? "True" : "False");
    return py_written(&to);
}

#endif
