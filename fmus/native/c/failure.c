#include "failure.h"

#include <string.h>

model_text model_begin(char *at, size_t size)
{
    at[0] = '\0';
    return (model_text){at, size, 0};
}

void model_put(model_text *text, const char *piece)
{
    const size_t left = text->size - 1 - text->length, length = strlen(piece), n = length < left ? length : left;
    memcpy(text->at + text->length, piece, n);
    text->length += n;
    text->at[text->length] = '\0';
}

void model_put_real(model_text *text, double value, const char *format)
{
    char buffer[PY_MOST_DIGITS + PY_DIGITS];
    const bool plain = format[0] == '\0' || format[0] == '!';
    model_put(text, plain ? py_repr_float(buffer, sizeof buffer, value)
                          : py_format_float(buffer, sizeof buffer, value, format));
}

void model_put_integer(model_text *text, int64_t value)
{
    char buffer[32];
    model_put(text, py_repr_int(buffer, sizeof buffer, value));
}

void model_put_boolean(model_text *text, bool value)
{
    char buffer[8];
    model_put(text, py_repr_bool(buffer, sizeof buffer, value));
}

void model_keep(model_failure *failure, const char *exception, const char *file, int line)
{
    failure->exception = exception;
    failure->file = file;
    failure->line = line;
}

void model_keep_python(model_failure *failure, const char *file, int line)
{
    model_text text = model_begin(failure->text, sizeof failure->text);
    model_put(&text, failure->python.text);
    model_keep(failure, py_exception(failure->python.code), file, line);
}
