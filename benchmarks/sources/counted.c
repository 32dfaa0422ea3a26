/* The calls of the mathematical library that counted.h has kept, and all of them once more. The parentheses in (f)(x)
   make it the function of the library, not the one that keeps. */
#include "counted.h"

#include <stddef.h>
#include <stdlib.h>

#define EXPORT __attribute__((visibility("default")))

/* The arguments of the calls of a function, one after the other. */
typedef struct {
    double *at;
    size_t count, room;
} arguments;

static void keep(arguments *kept, double x)
{
    if (kept->count == kept->room) {
        kept->room = kept->room ? 2 * kept->room : 1024;
        kept->at = realloc(kept->at, kept->room * sizeof *kept->at);
        if (!kept->at)
            abort();
    }
    kept->at[kept->count++] = x;
}

#define KEEP_ONE(f)              \
    static arguments of_##f;     \
    double counted_##f(double x) \
    {                            \
        keep(&of_##f, x);        \
        return (f)(x);           \
    }
#define KEEP_TWO(f)                        \
    static arguments of_##f;               \
    double counted_##f(double x, double y) \
    {                                      \
        keep(&of_##f, x);                  \
        keep(&of_##f, y);                  \
        return (f)(x, y);                  \
    }
OF_ONE(KEEP_ONE)
OF_TWO(KEEP_TWO)

/* Keep from now on. */
EXPORT void forget_calls(void)
{
#define FORGET(f) of_##f.count = 0;
    OF_ONE(FORGET)
    OF_TWO(FORGET)
}

/* Return how many calls are kept. */
EXPORT size_t kept_calls(void)
{
    size_t calls = 0;
#define ADD_ONE(f) calls += of_##f.count;
#define ADD_TWO(f) calls += of_##f.count / 2;
    OF_ONE(ADD_ONE)
    OF_TWO(ADD_TWO)
    return calls;
}

/* Do all calls that are kept, function by function; the sum of their values keeps compilers from leaving them out. */
EXPORT double repeat_calls(void)
{
    double sum = 0.0;
#define REPEAT_ONE(f)                         \
    for (size_t k = 0; k < of_##f.count; k++) \
        sum += (f)(of_##f.at[k]);
#define REPEAT_TWO(f)                            \
    for (size_t k = 0; k < of_##f.count; k += 2) \
        sum += (f)(of_##f.at[k], of_##f.at[k + 1]);
    OF_ONE(REPEAT_ONE)
    OF_TWO(REPEAT_TWO)
    return sum;
}
