/* The lower bound: the FMI calls of a ring of units and nothing else, one after the other in C.

   Step k: every unit takes the output that its predecessor showed at t_k, then steps, then shows its own. */

#include <stddef.h>

typedef int (*Get)(void *, const unsigned *, size_t, double *);
typedef int (*Set)(void *, const unsigned *, size_t, const double *);
typedef int (*Step)(void *, double, double, int);

#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

EXPORT int ring(void **units, size_t count, Set set, Step step, Get get, const unsigned *inputs,
                const unsigned *outputs, size_t signals, double *values, double h, size_t steps) {
    int status = 0;
    for (size_t k = 0; k < steps; k++) {
        for (size_t i = 0; i < count; i++) {
            const double *from = values + signals * ((i + count - 1) % count);
            status |= set(units[i], inputs, signals, from);
        }
        for (size_t i = 0; i < count; i++) {
            status |= step(units[i], k * h, h, 1);
            status |= get(units[i], outputs, signals, values + signals * i);
        }
    }
    return status;
}
