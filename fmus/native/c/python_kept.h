/* Functions that keep their last value: for an argument with the same bits it is the same, and not computed anew. */
#ifndef PYTHON_KEPT_H
#define PYTHON_KEPT_H

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "python_float.h"
#include "python_math.h"

/* The arguments of the last call that did not fail, as bits, and its value. */
typedef struct {
    bool known;
    uint64_t first, second;
    double value;
} py_kept;

static inline uint64_t py_kept_bits(double x)
{
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

static inline bool py_is_kept(const py_kept *kept, double first)
{
    return kept->known && kept->first == py_kept_bits(first);
}

static inline void py_keep(py_kept *kept, double first, double second, double value)
{
    kept->known = true;
    kept->first = py_kept_bits(first);
    kept->second = py_kept_bits(second);
    kept->value = value;
}

#define PY_KEPT(FUNCTION)                                                                                    \
    static inline bool py_kept_##FUNCTION(double x, py_kept *kept, double *result, py_failure *failure)      \
    {                                                                                                        \
        if (py_is_kept(kept, x)) {                                                                           \
            *result = kept->value;                                                                           \
            return true;                                                                                     \
        }                                                                                                    \
        if (!py_math_##FUNCTION(x, result, failure))                                                         \
            return false;                                                                                    \
        py_keep(kept, x, 0.0, *result);                                                                      \
        return true;                                                                                         \
    }

PY_KEPT(exp)
PY_KEPT(expm1)
PY_KEPT(log)
PY_KEPT(sin)
PY_KEPT(cos)
PY_KEPT(tan)
PY_KEPT(asin)
PY_KEPT(acos)
PY_KEPT(sinh)
PY_KEPT(cosh)

/* a ** b */
static inline bool py_kept_pow(double a, double b, py_kept *kept, double *result, py_failure *failure)
{
    if (py_is_kept(kept, a) && kept->second == py_kept_bits(b)) {
        *result = kept->value;
        return true;
    }
    if (!py_float_pow(a, b, result, failure))
        return false;
    py_keep(kept, a, b, *result);
    return true;
}

#endif
