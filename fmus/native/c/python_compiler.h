/* What Python's arithmetic asks of a C compiler: IEEE 754, and no arithmetic of its own. */
#ifndef PYTHON_COMPILER_H
#define PYTHON_COMPILER_H

#include <math.h>

#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "Python's arithmetic is that of IEEE 754: compile without -ffast-math, -Ofast and -ffinite-math-only"
#endif
#if defined(__FLT_EVAL_METHOD__) && __FLT_EVAL_METHOD__ == 2
#error "Python's arithmetic is that of doubles: compile without 80-bit registers (-mfpmath=sse)"
#endif
#if defined(__clang__) /* a * b + c is rounded twice */
#pragma STDC FP_CONTRACT OFF
#elif defined(__GNUC__) && defined(__FP_FAST_FMA) /* and GCC 12 forgets it where it makes vectors of two */
#pragma GCC optimize("fp-contract=off", "no-tree-slp-vectorize")
#endif

#ifndef PY_VERSION_MINOR
#define PY_VERSION_MINOR 11
#endif

#if defined(__GNUC__) /* what fails is no part of the straight way through a function */
#define PY_COLD static __attribute__((cold, noinline, unused))
#else
#define PY_COLD static inline
#endif

#define PY_INFINITY ((double)INFINITY)
#define PY_NAN ((double)NAN)

/* x, a constant too, as a value that the compiler does not know.

   A compiler replaces functions of the library where it knows an argument: exp(1.5) by the nearest double,
   pow(x, 2.0) by x * x, pow(2.0, x) by exp2(x). Python asks the library, which may differ in the last bit. */
static inline double py_opaque(double x)
{
#if defined(__GNUC__)
    if (__builtin_constant_p(x))
        __asm__("" : "+m"(x));
#endif
    return x;
}

#endif
