/* Texts of failures and of a model's sentences: put together from pieces, in the words of Python. */
#ifndef EVCOSIM_FAILURE_H
#define EVCOSIM_FAILURE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "python_arithmetic.h"

enum { MODEL_TEXT = 1024 };

#if defined(__GNUC__) /* compilers lay out a way that leads here as one that is seldom taken */
#define MODEL_SELDOM __attribute__((cold))
#else
#define MODEL_SELDOM
#endif

/* Why a function of the model failed: Python's exception, its text, and where it was raised. */
typedef struct {
    py_failure python; /* what a function of python_arithmetic.h has left */
    const char *exception;
    const char *file;
    int line;
    char text[MODEL_TEXT];
} model_failure;

/* A text that grows; what is beyond its size is cut off. */
typedef struct {
    char *at;
    size_t size, length;
} model_text;

/* Begin an empty text in `size` bytes at `at`; size is at least 1. */
model_text model_begin(char *at, size_t size);

/* Add a piece, a real by a format of Python ("" is str(), "!r" is repr()), or another number as Python shows it. */
MODEL_SELDOM void model_put(model_text *text, const char *piece);
MODEL_SELDOM void model_put_real(model_text *text, double value, const char *format);
MODEL_SELDOM void model_put_integer(model_text *text, int64_t value);
MODEL_SELDOM void model_put_boolean(model_text *text, bool value);

/* Keep an exception whose text is in failure->text, and where it was raised; then one of python_arithmetic.h. */
MODEL_SELDOM void model_keep(model_failure *failure, const char *exception, const char *file, int line);
MODEL_SELDOM void model_keep_python(model_failure *failure, const char *file, int line);

/* The same, and false, for the caller to return: inline, so that compilers know the value. */
static inline bool model_raise(model_failure *failure, const char *exception, const char *file, int line)
{
    model_keep(failure, exception, file, line);
    return false;
}

static inline bool model_raised(model_failure *failure, const char *file, int line)
{
    model_keep_python(failure, file, line);
    return false;
}

#endif
