/* Included before every file of a native FMU: each call of the mathematical library is kept with its arguments. */
#ifndef COUNTED_H
#define COUNTED_H

#include <math.h>

/* Functions of one number, and of two. */
#define OF_ONE(DO) \
    DO(exp) DO(exp2) DO(expm1) DO(log) DO(log10) DO(log1p) DO(log2) DO(sin) DO(cos) DO(tan) DO(asin) DO(acos) \
    DO(atan) DO(sinh) DO(cosh) DO(tanh) DO(asinh) DO(acosh) DO(atanh) DO(cbrt) DO(floor) DO(ceil) DO(round)
#define OF_TWO(DO) DO(pow) DO(fmod) DO(remainder) DO(atan2) DO(hypot)

#define DECLARE_ONE(f) double counted_##f(double x);
#define DECLARE_TWO(f) double counted_##f(double x, double y);
OF_ONE(DECLARE_ONE)
OF_TWO(DECLARE_TWO)

#define exp(x) counted_exp(x)
#define exp2(x) counted_exp2(x)
#define expm1(x) counted_expm1(x)
#define log(x) counted_log(x)
#define log10(x) counted_log10(x)
#define log1p(x) counted_log1p(x)
#define log2(x) counted_log2(x)
#define sin(x) counted_sin(x)
#define cos(x) counted_cos(x)
#define tan(x) counted_tan(x)
#define asin(x) counted_asin(x)
#define acos(x) counted_acos(x)
#define atan(x) counted_atan(x)
#define sinh(x) counted_sinh(x)
#define cosh(x) counted_cosh(x)
#define tanh(x) counted_tanh(x)
#define asinh(x) counted_asinh(x)
#define acosh(x) counted_acosh(x)
#define atanh(x) counted_atanh(x)
#define cbrt(x) counted_cbrt(x)
#define floor(x) counted_floor(x)
#define ceil(x) counted_ceil(x)
#define round(x) counted_round(x)
#define pow(x, y) counted_pow(x, y)
#define fmod(x, y) counted_fmod(x, y)
#define remainder(x, y) counted_remainder(x, y)
#define atan2(y, x) counted_atan2(y, x)
#define hypot(x, y) counted_hypot(x, y)
#endif
