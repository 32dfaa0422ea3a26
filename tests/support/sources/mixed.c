/* A unit with a variable of every type, for FMI 1.0, 2.0 and 3.0 Co-Simulation: -DFMI=1, 2 or 3.

   x <- x + h (gain u - x), y = x; every other output is its input, Integers plus 1, Booleans negated.
   Value references: tests/support/c_fmu.py. BEHAVIOR (a number, 0: good) makes one thing go wrong:
   10 s  doStep returns status s from t = 0.5 on    20 s  setReal returns status s    30 s  getReal does
   70 s  as 20 s, but from t = 0.5 s on             80 s  as 30 s, but from t = 0.5 s on
   1     instantiate returns nothing                2     getReal gives NaN from t = 0.5 on
   50 on: from t = 0.5 s on, doStep 50 writes to address 0, 51 aborts, 52 and 53 call exit(0) and exit(3), 54 never
   returns, 55 recurses without end, 56 takes memory without end, 57 fills a file, 58 frees twice
   63 sleeps for 50 ms in each doStep, 64 says "out of coffee" (Error) and writes to address 0, 65 starts a process
   66 adds 1 to its own input u after each step
   60 instantiate writes to address 0               61 terminate never returns     62 prints a banner
   3     FMI 3.0: terminateSimulation at t = 0.5    4     FMI 3.0: early return at t = 0.5 */

#include <stdbool.h>
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#ifndef BEHAVIOR
#define BEHAVIOR 0
#endif
#define EXPORT __attribute__((visibility("default")))

typedef unsigned int Reference;
enum { COUNT = 64 };

typedef struct {
    double values[COUNT];
    int64_t wide[COUNT];
    char *texts[COUNT];
    double time;
    void *environment;
    char *name;
#if FMI == 3
    void (*log)(void *, int, const char *, const char *);
#else
    void (*log)(void *, const char *, int, const char *, const char *, ...);
#endif
} Unit;

static int bad(Unit *u, int group) {
    if (BEHAVIOR / 10 != group || (group != 2 && group != 3 && u->time < 0.4999)) return 0;
    int status = BEHAVIOR % 10;
#if FMI == 3
    if (u->log) u->log(u->environment, status, "logStatus", "as it was told, 100 %");
#else
    if (u->log) u->log(FMI == 1 ? (void *)u : u->environment, u->name, status, "logStatus", "as it was %s, %d %%", "told", 100);
#endif
    return status;
}

static void misbehave(void);
static int *volatile nowhere; /* where the compiler cannot see that it is */

static void advance(Unit *u, double h) {
    double *v = u->values;
    if (BEHAVIOR == 63) usleep(50000);
    if (BEHAVIOR == 64 && u->time >= 0.4999) {
#if FMI == 3
        u->log(u->environment, 3, "logStatusError", "out of coffee");
#else
        u->log(FMI == 1 ? (void *)u : u->environment, u->name, 3, "logStatusError", "out of %s", "coffee");
#endif
        *nowhere = 1;
    }
    if (u->time >= 0.4999) misbehave();
    v[1] += h * (v[2] * v[0] - v[1]);
    if (BEHAVIOR == 66) v[0] += 1.0;
    if (BEHAVIOR == 2 && u->time >= 0.4999) v[1] = NAN;
    v[4] = v[3] + 1;
    v[6] = !v[5];
    v[11] = (double)(float)v[10];
    for (int i = 20; i < 40; i += 2) {
        v[i + 1] = v[i];
        u->wide[i + 1] = u->wide[i] + 1;
    }
    free(u->texts[8]);
    u->texts[8] = strdup(u->texts[7] ? u->texts[7] : "");
    u->time += h;
}

static int deeper(volatile int n) { return n ? deeper(n + 1) + n : 0; }

static void misbehave(void) {
    switch (BEHAVIOR) {
    case 50: *nowhere = 1; break;
    case 51: abort();
    case 52: exit(0);
    case 53: exit(3);
    case 54: for (volatile int i = 0;; i++) {}
    case 55: deeper(1); break;
    case 56: for (;;) { char *p = malloc(1 << 28); if (!p) abort(); p[0] = 1; }
    case 57: { FILE *f = fopen("large", "w"); static char block[1 << 20]; for (;;) fwrite(block, 1, sizeof block, f); }
    case 65: {
        static int child = 0;
        if (!child && !(child = fork())) for (;;) pause();
        FILE *f = fopen(getenv("EVCOSIM_TEST_CHILD"), "w");
        fprintf(f, "%d", child);
        fclose(f);
        break;
    }
    case 58: { char *volatile p = malloc(100); free(p); free(p); }
    }
}

static Unit *make(const char *name) {
    if (BEHAVIOR == 1) return NULL;
    if (BEHAVIOR == 60) *nowhere = 1;
    if (BEHAVIOR == 62) { printf("*** a banner of the tool ***\n"); fflush(stdout); }
    Unit *u = calloc(1, sizeof(Unit));
    u->values[2] = 1.0;
    u->texts[7] = strdup("some text");
    u->texts[8] = strdup("");
    u->name = strdup(name);
    return u;
}

static void release(Unit *u) {
    for (int i = 0; i < COUNT; i++) free(u->texts[i]);
    free(u->name);
    free(u);
}

#define CAT_(a, b) a##b
#define CAT(a, b) CAT_(a, b)
#if FMI == 1
#define F(name) CAT(MODEL, CAT(_fmi, name))
typedef char Bool;
#elif FMI == 2
#define F(name) CAT(fmi2, name)
typedef int Bool;
#else
#define F(name) CAT(fmi3, name)
typedef bool Bool;
#endif

#if FMI == 3
#define EXTRA , size_t m
#else
#define EXTRA
#endif

#define ACCESS(TYPE, C, STORE)                                                                            \
    EXPORT int F(Get##TYPE)(void *c, const Reference *r, size_t n, C *x EXTRA) {                          \
        int status = bad(c, 3) | bad(c, 8);                                                               \
        for (size_t i = 0; i < n; i++) {                                                                  \
            if (r[i] >= COUNT) return 3;                                                                  \
            x[i] = (C)((Unit *)c)->STORE[r[i]];                                                           \
        }                                                                                                 \
        return status;                                                                                    \
    }                                                                                                     \
    EXPORT int F(Set##TYPE)(void *c, const Reference *r, size_t n, const C *x EXTRA) {                    \
        int status = bad(c, 2) | bad(c, 7);                                                               \
        for (size_t i = 0; i < n; i++) {                                                                  \
            if (r[i] >= COUNT) return 3;                                                                  \
            ((Unit *)c)->STORE[r[i]] = x[i];                                                              \
        }                                                                                                 \
        return status;                                                                                    \
    }

#if FMI == 3
ACCESS(Float64, double, values)
ACCESS(Float32, float, values)
ACCESS(Int8, int8_t, wide)
ACCESS(UInt8, uint8_t, wide)
ACCESS(Int16, int16_t, wide)
ACCESS(UInt16, uint16_t, wide)
ACCESS(UInt32, uint32_t, wide)
ACCESS(Int64, int64_t, wide)
ACCESS(UInt64, uint64_t, wide)
ACCESS(Int32, int32_t, values)
#else
ACCESS(Real, double, values)
ACCESS(Integer, int, values)
#endif
ACCESS(Boolean, Bool, values)

EXPORT int F(GetString)(void *c, const Reference *r, size_t n, const char **x EXTRA) {
    for (size_t i = 0; i < n; i++) x[i] = ((Unit *)c)->texts[r[i]];
    return 0;
}
EXPORT int F(SetString)(void *c, const Reference *r, size_t n, const char *const *x EXTRA) {
    for (size_t i = 0; i < n; i++) {
        free(((Unit *)c)->texts[r[i]]);
        ((Unit *)c)->texts[r[i]] = strdup(x[i]);
    }
    return 0;
}

#if FMI == 1
typedef struct {
    void (*logger)(void *, const char *, int, const char *, const char *, ...);
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*finished)(void *, int);
} Callbacks;

EXPORT void *F(InstantiateSlave)(const char *name, const char *guid, const char *location, const char *mime,
                                 double timeout, char visible, char interactive, Callbacks callbacks, char logging) {
    Unit *u = make(name);
    if (u) u->log = callbacks.logger;
    return u;
}
EXPORT int F(InitializeSlave)(void *c, double start, char stop_defined, double stop) {
    ((Unit *)c)->time = start;
    return 0;
}
EXPORT int F(DoStep)(void *c, double t, double h, char new_step) {
    int status = bad(c, 1);
    if (status < 2) advance(c, h);
    return status;
}
EXPORT int F(TerminateSlave)(void *c) { return 0; }
EXPORT void F(FreeSlaveInstance)(void *c) { release(c); }
#elif FMI == 2
typedef struct {
    void (*logger)(void *, const char *, int, const char *, const char *, ...);
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*finished)(void *, int);
    void *environment;
} Callbacks;

EXPORT void *F(Instantiate)(const char *name, int type, const char *guid, const char *resources,
                            const Callbacks *callbacks, int visible, int logging) {
    Unit *u = make(name);
    if (u) u->log = callbacks->logger, u->environment = callbacks->environment;
    return u;
}
EXPORT int F(SetupExperiment)(void *c, int td, double tolerance, double start, int sd, double stop) {
    ((Unit *)c)->time = start;
    return 0;
}
EXPORT int F(EnterInitializationMode)(void *c) { return 0; }
EXPORT int F(ExitInitializationMode)(void *c) { return 0; }
EXPORT int F(DoStep)(void *c, double t, double h, int no_set_state) {
    int status = bad(c, 1);
    if (status < 2) advance(c, h);
    return status;
}
EXPORT int F(Terminate)(void *c) { while (BEHAVIOR == 61) {} return 0; }
EXPORT void F(FreeInstance)(void *c) { release(c); }
#else
EXPORT void *F(InstantiateCoSimulation)(const char *name, const char *token, const char *resources, bool visible,
                                        bool logging, bool events, bool early, const Reference *r, size_t n,
                                        void *environment, void (*log)(void *, int, const char *, const char *),
                                        void *update) {
    Unit *u = make(name);
    if (u) u->log = log, u->environment = environment;
    return u;
}
EXPORT int F(EnterInitializationMode)(void *c, bool td, double tolerance, double start, bool sd, double stop) {
    ((Unit *)c)->time = start;
    return 0;
}
EXPORT int F(ExitInitializationMode)(void *c) { return 0; }
EXPORT int F(DoStep)(void *c, double t, double h, bool no_set_state, bool *event, bool *terminate, bool *early,
                     double *reached) {
    int status = bad(c, 1), late = ((Unit *)c)->time >= 0.4999;
    *event = false;
    *terminate = BEHAVIOR == 3 && late;
    *early = BEHAVIOR == 4 && late;
    if (status < 2) advance(c, h);
    *reached = t + h;
    return status;
}
EXPORT int F(Terminate)(void *c) { return 0; }
EXPORT void F(FreeInstance)(void *c) { release(c); }
#endif
