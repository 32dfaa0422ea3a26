/* Small models as equations, for FMI 1.0 (Model Exchange), 2.0 and 3.0 (both, and Co-Simulation of the same
   source): -DFMI=1, 2 or 3. -DMODEL= chooses the equations, -DBEHAVIOR= (0: good) makes one thing go wrong:
   OSCILLATOR x0' = x1, x1' = p0 (1 - x0^2) x1 - x0           van der Pol's; stiff for a large p0
   BALL       x0' = x1, x1' = -p0; at x0 <= 0 the speed x1 becomes -p1 x1; at rest below 0.01 m/s
   RELAY      x0' = u - x0; counts when u passes p0; the first step behind x0 = 0.9 asks for an event, held is x0 there
   TIMER      no states: counts at multiples of p0 s; level, demand and armed act on held, seen in events alone
   WAVE       no states: counts the zeros of sin(2 pi t / p0), and keeps the time of the last one
   DECAY      x0' = -p0 x0, with a nominal value of p1
   1 derivatives are NaN from t = 0.5 on   2 terminateSimulation in an event   3 new discrete states without end
   4 an event at once after each event     5 derivatives: Discard from t = 0.5 on   6 derivatives: Error there
   7 terminateSimulation after a solver step from t = 0.5 on (FMI 1.0: in the event that it asks for)   8 derivatives are NaN for x0 < 0.5
   9 nominals: NaN   10 FMI 1.0: the types are those of another platform   11 FMI 1.0: setting u before the
   initialization is an Error   12 FMI 1.0: the first event is left to be iterated   13 FMI 1.0: the initialization: Error
   14 has every function, nominals of 1 too
   Value references: tests/support/equations.py. */

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#define OSCILLATOR 1
#define BALL 2
#define RELAY 3
#define TIMER 4
#define WAVE 5
#define DECAY 6
#ifndef BEHAVIOR
#define BEHAVIOR 0
#endif

#if MODEL == OSCILLATOR || MODEL == BALL
enum { NX = 2 };
#elif MODEL == RELAY || MODEL == DECAY
enum { NX = 1 };
#else
enum { NX = 0 };
#endif
enum { NZ = MODEL == BALL || MODEL == RELAY || MODEL == WAVE };
enum { X0, X1, DER0, DER1, U, Y, P0, P1, LAST, LEVEL, HELD, DEMAND = 20, SEEN, COUNT, ARMED = 30, ON, SIZE };
enum { DISCARD = 2, ERROR = 3 };
enum { EVENT_MODE = 1, CONTINUOUS = 2 };

typedef struct {
    double r[SIZE], time, next;
    int mode, sign, past; /* sign: the domain of the indicator at the last event */
    char *label, *shown;
} Unit;

static int late(Unit *c) { return c->time >= 0.5; }

static int derivatives(Unit *c, double *d) {
    double *r = c->r;
    if (BEHAVIOR == 5 && late(c)) return DISCARD;
    if (BEHAVIOR == 6 && late(c)) return ERROR;
    switch (MODEL) {
    case OSCILLATOR: d[0] = r[X1], d[1] = r[P0] * (1 - r[X0] * r[X0]) * r[X1] - r[X0]; break;
    case BALL: d[0] = r[X1], d[1] = r[X0] <= 0 && r[X1] == 0 ? 0 : -r[P0]; break;
    case RELAY: d[0] = r[U] - r[X0]; break;
    case DECAY: d[0] = -r[P0] * r[X0]; break;
    }
    if ((BEHAVIOR == 1 && late(c)) || (BEHAVIOR == 8 && r[X0] < 0.5)) d[NX - 1] = NAN;
    return 0;
}

static double indicator(Unit *c) {
    if (MODEL == BALL) return c->r[X0] <= 0 && c->r[X1] == 0 ? 1 : c->r[X0];
    if (MODEL == RELAY) return c->r[U] - c->r[P0];
    return sin(2 * 3.14159265358979323846 * c->time / c->r[P0]);
}

static void event(Unit *c) {
    double *r = c->r;
    int sign = NZ && indicator(c) > 0;
    if (MODEL == BALL && r[X0] <= 0 && r[X1] < 0) {
        r[COUNT]++, r[LAST] = c->time;
        r[X0] = 0, r[X1] *= -r[P1];
        if (r[X1] < 0.01) r[X1] = 0;
    }
    if ((MODEL == RELAY || MODEL == WAVE) && sign != c->sign) r[COUNT]++, r[LAST] = c->time;
    if (MODEL == RELAY && r[X0] > 0.9 && !c->past) c->past = 1, r[HELD] = r[X0];
    if (MODEL == TIMER) {
        while (c->time >= c->next - 1e-12) c->next = ++r[COUNT] * r[P0], r[LAST] = c->time;
        r[HELD] = 2 * r[LEVEL], r[SEEN] = r[DEMAND] + 1, r[ON] = !r[ARMED];
        free(c->shown);
        c->shown = strdup(c->label);
    }
    c->sign = sign;
}

static void show(Unit *c) { c->r[Y] = NX ? c->r[X0] : c->time; }

static Unit *make(void) {
    Unit *c = calloc(1, sizeof(Unit));
    static const double x0[] = {0, 2, 1, 0, 0, 0, 1}, p0[] = {0, 1, 9.81, 0.5, 0.13, 0.3, 1}, p1[] = {0, 0, 0.7, 0, 0, 0, 1};
    c->r[X0] = x0[MODEL], c->r[P0] = p0[MODEL], c->r[P1] = p1[MODEL];
    c->label = strdup(""), c->shown = strdup("");
    return c;
}

static void release(Unit *c) {
    free(c->label), free(c->shown), free(c);
}

#define EXPORT __attribute__((visibility("default")))
#define CAT_(a, b) a##b
#define CAT(a, b) CAT_(a, b)
#if FMI == 3
#define F(name) CAT(fmi3, name)
#define EXTRA , size_t m
typedef bool Bool;
#elif FMI == 1
#define F(name) CAT(equations_fmi, name)
#define EXTRA
typedef char Bool;
#else
#define F(name) CAT(fmi2, name)
#define EXTRA
typedef int Bool;
#endif
typedef unsigned int Reference;

#define ACCESS(TYPE, C)                                                                                   \
    EXPORT int F(Get##TYPE)(void *p, const Reference *v, size_t n, C *x EXTRA) {                          \
        Unit *c = p;                                                                                      \
        show(c);                                                                                          \
        if (NX) derivatives(c, c->r + DER0);                                                              \
        for (size_t i = 0; i < n; i++) x[i] = (C)c->r[v[i]];                                              \
        return 0;                                                                                         \
    }                                                                                                     \
    EXPORT int F(Set##TYPE)(void *p, const Reference *v, size_t n, const C *x EXTRA) {                    \
        Unit *c = p;                                                                                      \
        for (size_t i = 0; i < n; i++) {                                                                  \
            if (c->mode == CONTINUOUS && v[i] != U) return ERROR; /* as the standard demands */           \
            if (BEHAVIOR == 11 && !c->mode && v[i] == U) return ERROR;                                    \
            c->r[v[i]] = x[i];                                                                            \
        }                                                                                                 \
        return 0;                                                                                         \
    }

#if FMI == 3
ACCESS(Float64, double)
ACCESS(Float32, float)
ACCESS(Int8, int8_t)
ACCESS(UInt8, uint8_t)
ACCESS(Int16, int16_t)
ACCESS(UInt16, uint16_t)
ACCESS(Int32, int32_t)
ACCESS(UInt32, uint32_t)
ACCESS(Int64, int64_t)
ACCESS(UInt64, uint64_t)
#else
ACCESS(Real, double)
ACCESS(Integer, int)
#endif
ACCESS(Boolean, Bool)

EXPORT int F(GetString)(void *p, const Reference *v, size_t n, const char **x EXTRA) {
    Unit *c = p;
    for (size_t i = 0; i < n; i++) x[i] = v[i] == 40 ? c->label : c->shown;
    return 0;
}
EXPORT int F(SetString)(void *p, const Reference *v, size_t n, const char *const *x EXTRA) {
    Unit *c = p;
    for (size_t i = 0; i < n; i++) free(c->label), c->label = strdup(x[i]);
    return 0;
}

static void begin(Unit *c, double start) {
    c->time = start, c->next = INFINITY;
    if (MODEL == TIMER) c->next = start + c->r[P0], c->r[COUNT] = 1;
}
static int initialized(Unit *c) {
    if (MODEL == TIMER) c->r[COUNT] = 1;
    c->mode = EVENT_MODE, c->sign = NZ && indicator(c) > 0;
    return 0;
}

/* Model Exchange */

#if FMI != 1
EXPORT int F(EnterEventMode)(void *p) { return ((Unit *)p)->mode = EVENT_MODE, 0; }
EXPORT int F(EnterContinuousTimeMode)(void *p) { return ((Unit *)p)->mode = CONTINUOUS, 0; }
#endif
EXPORT int F(SetTime)(void *p, double t) {
    Unit *c = p;
    if (FMI == 1 && !c->mode) begin(c, t);
    return c->time = t, 0;
}
EXPORT int F(GetContinuousStates)(void *p, double *x, size_t n) { return memcpy(x, ((Unit *)p)->r, 8 * n), n == NX ? 0 : ERROR; }
EXPORT int F(SetContinuousStates)(void *p, const double *x, size_t n) { return memcpy(((Unit *)p)->r, x, 8 * n), n == NX ? 0 : ERROR; }
#if FMI == 1
#define NOMINALS GetNominalContinuousStates
#else
#define NOMINALS GetNominalsOfContinuousStates
#endif
#if MODEL == DECAY || BEHAVIOR == 14 /* the others leave it out: 1 is what it is without */
EXPORT int F(NOMINALS)(void *p, double *x, size_t n) {
    for (size_t i = 0; i < n; i++) x[i] = BEHAVIOR == 9 ? NAN : MODEL == DECAY ? ((Unit *)p)->r[P1] : 1;
    return 0;
}
#endif
EXPORT int F(GetEventIndicators)(void *p, double *z, size_t n) {
    if (n) z[0] = indicator(p);
    return n == NZ ? 0 : ERROR;
}
static int wants_event(Unit *c) { return MODEL == RELAY && c->r[X0] > 0.9 && !c->past; }
#if FMI == 1
EXPORT int F(CompletedIntegratorStep)(void *p, Bool *event) { return *event = wants_event(p) || (BEHAVIOR == 7 && late(p)), 0; }
#else
EXPORT int F(CompletedIntegratorStep)(void *p, Bool no_return, Bool *event, Bool *ends) {
    return *event = wants_event(p), *ends = BEHAVIOR == 7 && late(p), 0;
}
#endif
#if FMI == 1
typedef struct { Bool converged, references, values, ends, defined; double next; } Info;
EXPORT int F(GetDerivatives)(void *p, double *d, size_t n) { return n == NX ? derivatives(p, d) : ERROR; }
EXPORT int F(EventUpdate)(void *p, Bool intermediate, Info *info) {
    Bool more, *again = &more, *ends = &info->ends, *nominals = &info->references, *values = &info->values;
    Bool *defined = &info->defined;
    double *next = &info->next;
#elif FMI == 3
EXPORT int fmi3GetContinuousStateDerivatives(void *p, double *d, size_t n) { return derivatives(p, d); }
EXPORT int fmi3UpdateDiscreteStates(void *p, Bool *again, Bool *ends, Bool *nominals, Bool *values, Bool *defined, double *next) {
#else
typedef struct { Bool again, ends, nominals, values, defined; double next; } Info;
EXPORT int fmi2GetDerivatives(void *p, double *d, size_t n) { return derivatives(p, d); }
EXPORT int fmi2NewDiscreteStates(void *p, Info *info) {
    Bool *again = &info->again, *ends = &info->ends, *nominals = &info->nominals, *values = &info->values;
    Bool *defined = &info->defined;
    double *next = &info->next;
#endif
    Unit *c = p;
    double before = c->r[COUNT];
    if (c->mode != EVENT_MODE) return ERROR;
    event(c);
    *again = BEHAVIOR == 3 || c->r[COUNT] != before; /* once more, as though something hung on it */
    *ends = (BEHAVIOR == 2 && c->r[COUNT] > 1) || (FMI == 1 && BEHAVIOR == 7 && late(c));
    *nominals = *values = c->r[COUNT] != before;
    *defined = MODEL == TIMER || BEHAVIOR == 4;
    *next = BEHAVIOR == 4 ? c->time : c->next;
#if FMI == 1
    info->converged = !more;
#endif
    return 0;
}

#if FMI == 1
typedef struct { void *logger, *allocate, *release; } Callbacks;
typedef void Log(void *c, const char *name, int status, const char *category, const char *message, ...);
static void refuse(Callbacks k, void *c) { ((Log *)k.logger)(c, "a", ERROR, "error", "the GUID is not %s", "e"); }

EXPORT const char *F(GetModelTypesPlatform)(void) { return BEHAVIOR == 10 ? "standard64" : "standard32"; }
EXPORT const char *F(GetVersion)(void) { return "1.0"; }
EXPORT void *F(InstantiateModel)(const char *n, const char *g, Callbacks k, Bool logging) {
    return strcmp(g, "e") ? refuse(k, NULL), NULL : make();
}
EXPORT int F(Initialize)(void *p, Bool controlled, double tolerance, Info *info) {
    initialized(p);
    if (BEHAVIOR == 13) return ERROR;
    do F(EventUpdate)(p, 0, info);
    while (!info->converged && BEHAVIOR != 3 && BEHAVIOR != 12);
    return 0;
}
EXPORT int F(GetStateValueReferences)(void *p, Reference *v, size_t n) {
    for (size_t i = 0; i < n; i++) v[i] = MODEL == OSCILLATOR && i ? (Reference)-1 : X0 + i;
    return 0;
}
EXPORT int F(SetDebugLogging)(void *p, Bool on) { return 0; }
EXPORT int F(Terminate)(void *p) { return 0; }
EXPORT void F(FreeModelInstance)(void *p) { release(p); }
#endif

#if FMI != 1
/* Co-Simulation: the midpoint rule in a thousand steps, events at their ends */

static void advance(Unit *c, double h) {
    enum { N = 1000 };
    double start = c->time, d[2], x[2], *r = c->r;
    for (int i = 1; i <= N; i++) {
        memcpy(x, r, sizeof x);
        derivatives(c, d);
        for (int j = 0; j < NX; j++) r[j] = x[j] + 0.5 * h / N * d[j];
        derivatives(c, d);
        for (int j = 0; j < NX; j++) r[j] = x[j] + h / N * d[j];
        c->time = start + i * h / N;
        event(c);
    }
}

#if FMI == 3
EXPORT void *fmi3InstantiateModelExchange(const char *n, const char *t, const char *r, Bool v, Bool l, void *e, void *f) { return make(); }
EXPORT void *fmi3InstantiateCoSimulation(const char *n, const char *t, const char *r, Bool v, Bool l, Bool a, Bool b, const Reference *q, size_t m, void *e, void *f, void *g) { return make(); }
EXPORT int fmi3EnterInitializationMode(void *p, Bool d, double t, double start, Bool s, double stop) { return begin(p, start), 0; }
EXPORT int fmi3DoStep(void *p, double t, double h, Bool s, Bool *event, Bool *ends, Bool *early, double *last) {
    *event = *ends = *early = 0, *last = t + h;
    return advance(p, h), 0;
}
#else
EXPORT void *fmi2Instantiate(const char *n, int k, const char *g, const char *r, void *f, Bool v, Bool l) { return make(); }
EXPORT int fmi2SetupExperiment(void *p, Bool d, double t, double start, Bool s, double stop) { return begin(p, start), 0; }
EXPORT int fmi2EnterInitializationMode(void *p) { return 0; }
EXPORT int fmi2DoStep(void *p, double t, double h, Bool n) { return advance(p, h), 0; }
#endif
EXPORT int F(ExitInitializationMode)(void *p) { return initialized(p); }
EXPORT int F(Terminate)(void *p) { return 0; }
EXPORT void F(FreeInstance)(void *p) { release(p); }
#endif
