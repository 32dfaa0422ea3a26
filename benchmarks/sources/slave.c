/* The calls of one unit and nothing else: `steps` times set its inputs, do a step, get its outputs. */

#include <stddef.h>

typedef int (*Access)(void *, const unsigned *, size_t, void *);
typedef int (*Step)(void *, double, double, int);

#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

/* One call of fmi2Set or fmi2Get of a type; from each step to the next its values are `stride` bytes further. */
struct call {
    Access function;
    const unsigned *references;
    size_t count;
    char *values;
    size_t stride;
};

EXPORT int drive(void *unit, const struct call *sets, size_t set_count, Step step, const struct call *gets,
                 size_t get_count, size_t steps, double h) {
    int status = 0;
    for (size_t k = 0; k < steps; k++) {
        for (size_t i = 0; i < set_count; i++)
            status |= sets[i].function(unit, sets[i].references, sets[i].count, sets[i].values + k * sets[i].stride);
        status |= step(unit, k * h, h, 1);
        for (size_t i = 0; i < get_count; i++)
            status |= gets[i].function(unit, gets[i].references, gets[i].count, gets[i].values + k * gets[i].stride);
    }
    return status;
}
