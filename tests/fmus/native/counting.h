/* What the exercises count: what is wrong, and allocations of memory where COUNTING is defined. */
#include <stdio.h>
#include <stdlib.h>

static int wrong, allocations;

#ifdef COUNTING
void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *old, size_t size);
void __real_free(void *memory);
void *__wrap_malloc(size_t size)
{
    allocations++;
    return __real_malloc(size);
}
void *__wrap_calloc(size_t count, size_t size)
{
    allocations++;
    return __real_calloc(count, size);
}
void *__wrap_realloc(void *old, size_t size)
{
    allocations++;
    return __real_realloc(old, size);
}
void __wrap_free(void *memory)
{
    allocations += memory != NULL;
    __real_free(memory);
}
#endif

#define CHECK(condition)                                                                                     \
    do {                                                                                                     \
        if (!(condition)) {                                                                                  \
            wrong++;                                                                                         \
            printf("line %d: %s\n", __LINE__, #condition);                                                   \
        }                                                                                                    \
    } while (0)
