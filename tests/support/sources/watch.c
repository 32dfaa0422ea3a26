/* A unit that shows the times it is told, for FMI 1.0, 2.0 and 3.0 Co-Simulation: -DFMI=1, 2 or 3.

   After a step from t over h: begin = t, size = h, before = t of the step before, stop = the stop time that it
   was told (-1: none), stairs = the whole seconds of t + h (a discrete Integer), y = u, copy = count (Integers).
   A step that does not begin where the last one ended, to 1e-9 s, or that ends after the stop time is an Error.
   With -DENDS=T it asks to end the simulation in the step that reaches T [s] (FMI 2.0 and 3.0), after the step; with
   -DWITHIN it gets no farther than T; with -DREFUSES it returns Discard there and does not ask; with -DSILENT it does
   not tell how far it got. Value references: tests/support/watch.py. */

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>

#define EXPORT __attribute__((visibility("default")))
#define CAT_(a, b) a##b
#define CAT(a, b) CAT_(a, b)
#if FMI == 1
#define F(name) CAT(watch_fmi, name)
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
#define Real Float64
#define Integer Int32
#else
#define EXTRA
#endif

enum { BEGIN, LENGTH, BEFORE, STOP, Y, U, STAIRS, COPY, COUNT, SIZE };
typedef struct { double v[SIZE], end; int asks; } Unit;
#ifndef ENDS
#define ENDS 0
#endif
#ifndef WITHIN
#define WITHIN 0
#endif

static int setup(Unit *c, double start, int defined, double stop) {
    c->end = c->v[BEGIN] = start, c->v[STOP] = defined ? stop : -1, c->v[STAIRS] = floor(start + 1e-9);
    return 0;
}

static int step(Unit *c, double t, double h) {
    double *v = c->v;
    c->asks = ENDS > 0 && t + h > ENDS - 1e-9;
    if (c->asks && WITHIN) h = ENDS - t;
    if (fabs(t - c->end) > 1e-9 || (v[STOP] >= 0 && t + h > v[STOP])) return 3;
    v[BEFORE] = v[BEGIN], v[BEGIN] = t, v[LENGTH] = h, c->end = t + h;
    v[Y] = v[U], v[STAIRS] = floor(t + h + 1e-9), v[COPY] = v[COUNT];
    return 0;
}

#define ACCESS(TYPE, C)                                                                                   \
    EXPORT int CAT(F(Get), TYPE)(void *c, const unsigned *r, size_t n, C *x EXTRA) {                      \
        for (size_t i = 0; i < n; i++) x[i] = (C)((Unit *)c)->v[r[i]];                                    \
        return 0;                                                                                         \
    }                                                                                                     \
    EXPORT int CAT(F(Set), TYPE)(void *c, const unsigned *r, size_t n, const C *x EXTRA) {                \
        for (size_t i = 0; i < n; i++) ((Unit *)c)->v[r[i]] = x[i];                                       \
        return 0;                                                                                         \
    }
ACCESS(Real, double)
ACCESS(Integer, int)

#if FMI == 1
typedef struct { void *logger, *allocate, *release, *finished; } Callbacks;
EXPORT void *F(InstantiateSlave)(const char *name, const char *guid, const char *location, const char *mime,
                                 double timeout, char visible, char interactive, Callbacks callbacks, char logging) {
    return calloc(1, sizeof(Unit));
}
EXPORT int F(InitializeSlave)(void *c, double start, char sd, double stop) { return setup(c, start, sd, stop); }
EXPORT int F(DoStep)(void *c, double t, double h, char new_step) {
    int status = step(c, t, h);
    return status || !((Unit *)c)->asks ? status : 2;
}
EXPORT int F(TerminateSlave)(void *c) { return 0; }
EXPORT void F(FreeSlaveInstance)(void *c) { free(c); }
#else
#if FMI == 2
EXPORT void *F(Instantiate)(const char *name, int type, const char *guid, const char *resources, const void *callbacks,
                            int visible, int logging) {
    return calloc(1, sizeof(Unit));
}
EXPORT int F(SetupExperiment)(void *c, int td, double tolerance, double start, int sd, double stop) {
    return setup(c, start, sd, stop);
}
EXPORT int F(EnterInitializationMode)(void *c) { return 0; }
EXPORT int F(DoStep)(void *c, double t, double h, int no_set_state) {
    int status = step(c, t, h);
    return status || !((Unit *)c)->asks ? status : 2;
}
EXPORT int F(GetBooleanStatus)(void *c, int kind, int *value) {
#ifdef REFUSES
    return *value = 0, 0;
#endif
    return *value = kind == 3 && ((Unit *)c)->asks, 0;
}
#ifndef SILENT
EXPORT int F(GetRealStatus)(void *c, int kind, double *value) { return *value = ((Unit *)c)->end, kind == 2 ? 0 : 2; }
#endif
#else
EXPORT void *F(InstantiateCoSimulation)(const char *name, const char *token, const char *resources, bool visible,
                                        bool logging, bool events, bool early, const unsigned *r, size_t n,
                                        void *environment, void *log, void *update) {
    return calloc(1, sizeof(Unit));
}
EXPORT int F(EnterInitializationMode)(void *c, bool td, double tolerance, double start, bool sd, double stop) {
    return setup(c, start, sd, stop);
}
EXPORT int F(DoStep)(void *c, double t, double h, bool no_set_state, bool *event, bool *ends, bool *early, double *at) {
    int status = step(c, t, h);
    *event = *early = false, *ends = ((Unit *)c)->asks;
#ifndef SILENT
    *at = ((Unit *)c)->end;
#endif
#ifdef REFUSES
    if (*ends) return *ends = false, 2;
#endif
    return status;
}
#endif
EXPORT int F(ExitInitializationMode)(void *c) { return 0; }
EXPORT int F(Terminate)(void *c) { return 0; }
EXPORT void F(FreeInstance)(void *c) { free(c); }
#endif
