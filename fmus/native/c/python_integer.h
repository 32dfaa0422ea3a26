/* Python's int within 64 bits: what Python gives, or a failure where its result would be longer. */
#ifndef PYTHON_INTEGER_H
#define PYTHON_INTEGER_H

#include <math.h>

#include "python_failure.h"

/* Fail for a result that Python has and 64 bits have not. */
static inline bool py_int_beyond(py_failure *failure)
{
    return py_failed(failure, PY_OVERFLOW, PY_BEYOND_64_BITS);
}

/* a + b: Objects/longobject.c, long_add */
static inline bool py_int_add(int64_t a, int64_t b, int64_t *result, py_failure *failure)
{
    if (b > 0 ? a > INT64_MAX - b : a < INT64_MIN - b)
        return py_int_beyond(failure);
    *result = a + b;
    return true;
}

/* a - b: Objects/longobject.c, long_sub */
static inline bool py_int_sub(int64_t a, int64_t b, int64_t *result, py_failure *failure)
{
    if (b > 0 ? a < INT64_MIN + b : a > INT64_MAX + b)
        return py_int_beyond(failure);
    *result = a - b;
    return true;
}

/* The size of an integer without its sign. */
static inline uint64_t py_int_size(int64_t a)
{
    return a < 0 ? 0u - (uint64_t)a : (uint64_t)a;
}

/* a * b: Objects/longobject.c, long_mul */
static inline bool py_int_mul(int64_t a, int64_t b, int64_t *result, py_failure *failure)
{
    if (a != (int32_t)a || b != (int32_t)b) { /* the product of halves always fits, without a division */
        const uint64_t limit = (uint64_t)INT64_MAX + ((a < 0) != (b < 0));
        if (a != 0 && py_int_size(b) > limit / py_int_size(a))
            return py_int_beyond(failure);
    }
    *result = (int64_t)((uint64_t)a * (uint64_t)b);
    return true;
}

/* -a: Objects/longobject.c, long_neg */
static inline bool py_int_neg(int64_t a, int64_t *result, py_failure *failure)
{
    if (a == INT64_MIN)
        return py_int_beyond(failure);
    *result = -a;
    return true;
}

/* abs(a): Objects/longobject.c, long_abs */
static inline bool py_int_abs(int64_t a, int64_t *result, py_failure *failure)
{
    if (a < 0)
        return py_int_neg(a, result, failure);
    *result = a;
    return true;
}

/* Floor division for b != 0; false beyond 64 bits: Objects/longobject.c, l_divmod */
static inline bool py_int_quotient(int64_t a, int64_t b, int64_t *quotient, int64_t *remainder)
{
    if (b == -1) { /* the one divisor whose quotient can be too long, which the processor would not do */
        if (a == INT64_MIN)
            return false;
        *quotient = -a;
        *remainder = 0;
        return true;
    }
    *quotient = a / b;
    *remainder = a % b;
    if (*remainder != 0 && (*remainder < 0) != (b < 0)) {
        *remainder += b;
        *quotient -= 1;
    }
    return true;
}

/* a // b: Objects/longobject.c, long_div */
static inline bool py_int_floordiv(int64_t a, int64_t b, int64_t *result, py_failure *failure)
{
    int64_t remainder;
    if (b == 0)
        return py_failed(failure, PY_ZERO_DIVISION, PY_ZERO_TEXT("integer division or modulo by zero"));
    return py_int_quotient(a, b, result, &remainder) || py_int_beyond(failure);
}

/* a % b: Objects/longobject.c, long_mod */
static inline bool py_int_mod(int64_t a, int64_t b, int64_t *result, py_failure *failure)
{
    int64_t quotient;
    if (b == 0)
        return py_failed(failure, PY_ZERO_DIVISION, PY_ZERO_TEXT("integer modulo by zero"));
    if (!py_int_quotient(a, b, &quotient, result))
        *result = 0;
    return true;
}

/* divmod(a, b): Objects/longobject.c, long_divmod */
static inline bool py_int_divmod(int64_t a, int64_t b, int64_t *quotient, int64_t *remainder,
                                 py_failure *failure)
{
    if (b == 0)
        return py_failed(failure, PY_ZERO_DIVISION, PY_ZERO_TEXT("integer division or modulo by zero"));
    return py_int_quotient(a, b, quotient, remainder) || py_int_beyond(failure);
}

/* a ** b for b >= 0: Objects/longobject.c, long_pow; a negative b gives a float in Python */
static inline bool py_int_pow(int64_t a, int64_t b, int64_t *result, py_failure *failure)
{
    int64_t power = 1;
    if (b < 0)
        return py_failed(failure, PY_VALUE, PY_FLOAT_RESULT);
    if (a == 0 || a == 1) {
        *result = b == 0 ? 1 : a;
        return true;
    }
    if (a == -1) {
        *result = b % 2 == 0 ? 1 : -1;
        return true;
    }
    for (; b > 0; b--) /* 63 times at most: the size of a is 2 or more */
        if (!py_int_mul(power, a, &power, failure))
            return false;
    *result = power;
    return true;
}

/* The float nearest to a / b, half to even, for a and b > 0 of any size: long division */
static inline double py_int_ratio(uint64_t a, uint64_t b)
{
    uint64_t digits = 0, rest = 0;
    int power = 0, taken = 0;
    for (; a < UINT64_C(1) << 63; power--) /* a * 2**-power has its highest bit, so has the divisor */
        a <<= 1;
    for (; b < UINT64_C(1) << 63; power++)
        b <<= 1;
    if (a >= b) { /* the digit before the point of a / b, which is between 1/2 and 2 now */
        digits = 1;
        rest = a - b;
    } else {
        rest = a;
    }
    while (digits < UINT64_C(1) << 54) { /* 55 digits: two more than a double has */
        const bool carry = rest >= UINT64_C(1) << 63;
        rest <<= 1;
        digits <<= 1;
        if (carry || rest >= b) {
            digits |= 1;
            rest -= b;
        }
        taken++;
    }
    if (rest != 0)
        digits |= 1; /* what is left decides where the digits stand half-way */
    return ldexp((double)digits, power - taken);
}

/* a / b, the float nearest to the exact ratio: Objects/longobject.c, long_true_divide */
static inline bool py_int_div(int64_t a, int64_t b, double *result, py_failure *failure)
{
    const int64_t exact = INT64_C(1) << 53;
    double ratio;
    if (b == 0)
        return py_failed(failure, PY_ZERO_DIVISION, "division by zero");
    if (-exact <= a && a <= exact && -exact <= b && b <= exact) {
        *result = (double)a / (double)b;
        return true;
    }
    ratio = a == 0 ? 0.0 : py_int_ratio(py_int_size(a), py_int_size(b));
    *result = (a < 0) != (b < 0) ? -ratio : ratio;
    return true;
}

/* a << b: Objects/longobject.c, long_lshift */
static inline bool py_int_lshift(int64_t a, int64_t b, int64_t *result, py_failure *failure)
{
    if (b < 0)
        return py_failed(failure, PY_VALUE, "negative shift count");
    if (a == 0) {
        *result = 0;
        return true;
    }
    if (b > 63 || (b == 63 && a != -1))
        return py_int_beyond(failure);
    if (b == 63) {
        *result = INT64_MIN;
        return true;
    }
    return py_int_mul(a, (int64_t)(UINT64_C(1) << b), result, failure);
}

/* a >> b: Objects/longobject.c, long_rshift */
static inline bool py_int_rshift(int64_t a, int64_t b, int64_t *result, py_failure *failure)
{
    if (b < 0)
        return py_failed(failure, PY_VALUE, "negative shift count");
    if (b > 63)
        b = 63;
    *result = a < 0 ? ~(~a >> b) : a >> b; /* C says nothing about the right shift of negative numbers */
    return true;
}

/* a & b: Objects/longobject.c, long_bitwise, of numbers in two's complement */
static inline int64_t py_int_and(int64_t a, int64_t b)
{
    return a & b;
}

/* a | b: Objects/longobject.c, long_bitwise */
static inline int64_t py_int_or(int64_t a, int64_t b)
{
    return a | b;
}

/* a ^ b: Objects/longobject.c, long_bitwise */
static inline int64_t py_int_xor(int64_t a, int64_t b)
{
    return a ^ b;
}

/* ~a: Objects/longobject.c, long_invert */
static inline int64_t py_int_invert(int64_t a)
{
    return ~a;
}

/* max(a, b): Python/bltinmodule.c, min_max */
static inline int64_t py_int_max(int64_t a, int64_t b)
{
    return b > a ? b : a;
}

/* min(a, b): Python/bltinmodule.c, min_max */
static inline int64_t py_int_min(int64_t a, int64_t b)
{
    return b < a ? b : a;
}

/* bool(a): Objects/longobject.c, long_bool */
static inline bool py_int_bool(int64_t a)
{
    return a != 0;
}

/* float(a), the nearest, half to even: Objects/longobject.c, PyLong_AsDouble */
static inline double py_int_float(int64_t a)
{
    return (double)a;
}

/* -1, 0, 1 for a < b, a == b, a > b, exactly; 2 for a NaN: Objects/floatobject.c, float_richcompare */
static inline int py_int_compare_float(int64_t a, double b)
{
    int64_t whole;
    double rest;
    if (isnan(b))
        return 2;
    if (b >= 9223372036854775808.0)
        return -1;
    if (b < -9223372036854775808.0)
        return 1;
    whole = (int64_t)b;
    if (a != whole)
        return a < whole ? -1 : 1;
    rest = b - (double)whole;
    return rest > 0.0 ? -1 : rest < 0.0;
}

/* a == b of an int and a float: Objects/floatobject.c, float_richcompare */
static inline bool py_int_eq_float(int64_t a, double b)
{
    return py_int_compare_float(a, b) == 0;
}

/* a < b of an int and a float: Objects/floatobject.c, float_richcompare */
static inline bool py_int_lt_float(int64_t a, double b)
{
    return py_int_compare_float(a, b) == -1;
}

/* a <= b of an int and a float: Objects/floatobject.c, float_richcompare */
static inline bool py_int_le_float(int64_t a, double b)
{
    return py_int_compare_float(a, b) <= 0;
}

/* a > b of an int and a float: Objects/floatobject.c, float_richcompare */
static inline bool py_int_gt_float(int64_t a, double b)
{
    return py_int_compare_float(a, b) == 1;
}

/* a >= b of an int and a float: Objects/floatobject.c, float_richcompare */
static inline bool py_int_ge_float(int64_t a, double b)
{
    const int order = py_int_compare_float(a, b);
    return order == 0 || order == 1;
}

/* True where there is an item[index] among n, and its place: Objects/listobject.c, list_subscript */
static inline bool py_place(int64_t index, int64_t n, int64_t *place)
{
    if (index < -n || index >= n)
        return false;
    *place = index < 0 ? index + n : index;
    return true;
}

/* The place that list[index] reads, of n items: Objects/listobject.c, list_subscript */
static inline bool py_list_index(int64_t index, int64_t n, int64_t *place, py_failure *failure)
{
    return py_place(index, n, place) || py_failed(failure, PY_INDEX, "list index out of range");
}

/* The place that list[index] = ... sets, of n items: Objects/listobject.c, list_ass_subscript */
static inline bool py_list_set_index(int64_t index, int64_t n, int64_t *place, py_failure *failure)
{
    return py_place(index, n, place) || py_failed(failure, PY_INDEX, "list assignment index out of range");
}

/* The place that tuple[index] reads, of n items: Objects/tupleobject.c, tuplesubscript */
static inline bool py_tuple_index(int64_t index, int64_t n, int64_t *place, py_failure *failure)
{
    return py_place(index, n, place) || py_failed(failure, PY_INDEX, "tuple index out of range");
}

#endif
