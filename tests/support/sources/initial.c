/* A unit that shows what it sees in its initialization, for FMI 1.0, 2.0 and 3.0 (-DFMI=1, 2 or 3), Co-Simulation
   and Model Exchange. Its outputs are what the input u was when it entered the initialization, when it was set
   within (-1: it was not), when it left, what the parameter p was when it entered, and the tolerance told (-1: none); y = p u, and h, whose
   start value is given, sums up the steps times u in Co-Simulation. In FMI 1.0, which has no such mode, entering and leaving are one.
   -DRESETS=1     the setup of the experiment puts p to 1
   -DREFUSES=s    u set before the initialization returns status s, after which no call does anything but free
   Value references: tests/support/initial.py. */

#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#ifndef RESETS
#define RESETS 0
#endif
#ifndef REFUSES
#define REFUSES 0
#endif
#define EXPORT __attribute__((visibility("default")))
enum { ERROR = 3 };
enum { U, P, ENTERED, WITHIN, LEFT, GAIN, Y, H, DER_H, TOLD, N = 10, N_ENTERED, B = 20, B_ENTERED, SIZE };
enum { BEFORE, IN, AFTER };
typedef unsigned int Reference;

typedef struct {
    double r[SIZE];
    int phase, broken;
} Unit;

static Unit *make(void) {
    Unit *c = calloc(1, sizeof(Unit));
    c->r[U] = 7, c->r[P] = 1, c->r[H] = 0.5, c->r[WITHIN] = c->r[TOLD] = -1;
    return c;
}

static int set_up(Unit *c, int defined, double tolerance) {
    if (defined) c->r[TOLD] = tolerance;
    if (RESETS) c->r[P] = 1;
    return c->broken ? ERROR : 0;
}

static int enter(Unit *c) {
    double *r = c->r;
    r[ENTERED] = r[U], r[N_ENTERED] = r[N], r[B_ENTERED] = r[B], r[GAIN] = r[P];
    c->phase = IN;
    return c->broken ? ERROR : 0;
}

static int leave(Unit *c) {
    c->r[LEFT] = c->r[U];
    c->phase = AFTER;
    return c->broken ? ERROR : 0;
}

static int set(Unit *c, Reference v, double x) {
    if (c->broken) return ERROR;
    if (REFUSES && v == U && c->phase == BEFORE) return c->broken = 1, REFUSES;
    if (v == U && c->phase == IN) c->r[WITHIN] = x;
    c->r[v] = x;
    return 0;
}

static int step(Unit *c, double h) {
    c->r[H] += h * c->r[U];
    return c->broken ? ERROR : 0;
}

static int status(Unit *c) {
    c->r[Y] = c->r[P] * c->r[U];
    return c->broken ? ERROR : 0;
}

#define CAT_(a, b) a##b
#define CAT(a, b) CAT_(a, b)
#if FMI == 1
#define F(name) CAT(initial_fmi, name)
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

#define ACCESS(TYPE, C)                                                                                   \
    EXPORT int F(Get##TYPE)(void *c, const Reference *v, size_t n, C *x EXTRA) {                          \
        int s = status(c);                                                                                \
        for (size_t i = 0; i < n; i++) x[i] = (C)((Unit *)c)->r[v[i]];                                    \
        return s;                                                                                         \
    }                                                                                                     \
    EXPORT int F(Set##TYPE)(void *c, const Reference *v, size_t n, const C *x EXTRA) {                    \
        for (size_t i = 0; i < n; i++) {                                                                  \
            int s = set(c, v[i], x[i]);                                                                   \
            if (s) return s;                                                                              \
        }                                                                                                 \
        return 0;                                                                                         \
    }
#if FMI == 3
ACCESS(Float64, double)
ACCESS(Int32, int)
#else
ACCESS(Real, double)
ACCESS(Integer, int)
#endif
ACCESS(Boolean, Bool)

#if FMI == 1
typedef struct {
    void *logger, *allocate, *release, *finished;
} Callbacks;

EXPORT void *F(InstantiateSlave)(const char *n, const char *g, const char *l, const char *m, double t, char v,
                                 char i, Callbacks k, char o) { return make(); }
EXPORT int F(InitializeSlave)(void *c, double start, char known, double stop) { return set_up(c, 0, 0) | enter(c) | leave(c); }
EXPORT int F(DoStep)(void *c, double t, double h, char n) { return step(c, h); }
EXPORT int F(TerminateSlave)(void *c) { return 0; }
EXPORT void F(FreeSlaveInstance)(void *c) { free(c); }
/* Model Exchange; of its structure of callbacks this unit needs nothing */
typedef struct { Bool converged, references, values, ends, defined; double next; } Info;
typedef struct { void *logger, *allocate, *release; } ModelCallbacks;
EXPORT void *F(InstantiateModel)(const char *n, const char *g, ModelCallbacks k, Bool logging) { return make(); }
EXPORT int F(EventUpdate)(void *c, Bool intermediate, Info *info) { return memset(info, 0, sizeof *info), info->converged = 1, status(c); }
EXPORT int F(Initialize)(void *c, Bool controlled, double tolerance, Info *info) {
    return set_up(c, controlled, tolerance) | enter(c) | leave(c) | F(EventUpdate)(c, 0, info);
}
EXPORT int F(GetDerivatives)(void *c, double *d, size_t n) { return d[0] = 0, status(c); }
EXPORT int F(CompletedIntegratorStep)(void *c, Bool *wants_event) { return *wants_event = 0, status(c); }
EXPORT void F(FreeModelInstance)(void *c) { free(c); }
#elif FMI == 2
typedef struct { Bool again, ends, nominals, values, defined; double next; } Info;
EXPORT void *fmi2Instantiate(const char *n, int k, const char *g, const char *r, void *f, Bool v, Bool l) { return make(); }
EXPORT int fmi2SetupExperiment(void *c, Bool d, double t, double start, Bool s, double stop) { return set_up(c, d, t); }
EXPORT int fmi2EnterInitializationMode(void *c) { return enter(c); }
EXPORT int fmi2DoStep(void *c, double t, double h, Bool n) { return step(c, h); }
EXPORT int fmi2NewDiscreteStates(void *c, Info *info) { return memset(info, 0, sizeof *info), status(c); }
EXPORT int fmi2GetDerivatives(void *c, double *d, size_t n) { return d[0] = 0, status(c); }
#else
EXPORT void *fmi3InstantiateCoSimulation(const char *n, const char *t, const char *r, Bool v, Bool l, Bool a, Bool b, const Reference *q, size_t m, void *e, void *f, void *g) { return make(); }
EXPORT void *fmi3InstantiateModelExchange(const char *n, const char *t, const char *r, Bool v, Bool l, void *e, void *f) { return make(); }
EXPORT int fmi3EnterInitializationMode(void *c, Bool d, double t, double start, Bool s, double stop) { return set_up(c, d, t) | enter(c); }
EXPORT int fmi3DoStep(void *c, double t, double h, Bool s, Bool *event, Bool *ends, Bool *early, double *last) {
    *event = *ends = *early = 0, *last = t + h;
    return step(c, h);
}
EXPORT int fmi3UpdateDiscreteStates(void *c, Bool *again, Bool *ends, Bool *nominals, Bool *values, Bool *defined, double *next) {
    *again = *ends = *nominals = *values = *defined = 0;
    return status(c);
}
EXPORT int fmi3GetContinuousStateDerivatives(void *c, double *d, size_t n) { return d[0] = 0, status(c); }
#endif

#if FMI != 1
EXPORT int F(ExitInitializationMode)(void *c) { return leave(c); }
EXPORT int F(EnterEventMode)(void *c) { return status(c); }
EXPORT int F(EnterContinuousTimeMode)(void *c) { return status(c); }
EXPORT int F(CompletedIntegratorStep)(void *c, Bool n, Bool *wants_event, Bool *ends) { return *wants_event = *ends = 0, status(c); }
EXPORT void F(FreeInstance)(void *c) { free(c); }
#endif
EXPORT int F(SetTime)(void *c, double t) { return status(c); }
EXPORT int F(GetContinuousStates)(void *c, double *x, size_t n) { return x[0] = ((Unit *)c)->r[H], status(c); }
EXPORT int F(SetContinuousStates)(void *c, const double *x, size_t n) { return ((Unit *)c)->r[H] = x[0], status(c); }
EXPORT int F(Terminate)(void *c) { return status(c); }

/* FMPy looks up every function of the standard; nobody calls these */

#define S(name) EXPORT int F(name)(void) { return ERROR; }
#if FMI == 1
S(CancelStep) S(GetBooleanStatus) S(GetIntegerStatus) S(GetRealOutputDerivatives) S(GetRealStatus)
S(GetStatus) S(GetString) S(GetStringStatus) S(GetTypesPlatform) S(GetVersion) S(ResetSlave)
S(SetDebugLogging) S(SetRealInputDerivatives) S(SetString) S(GetEventIndicators) S(GetStateValueReferences)
EXPORT const char *F(GetModelTypesPlatform)(void) { return "standard32"; }
#elif FMI == 2
S(CancelStep) S(DeSerializeFMUstate) S(FreeFMUstate) S(GetBooleanStatus) S(GetDirectionalDerivative)
S(GetFMUstate) S(GetIntegerStatus) S(GetRealOutputDerivatives) S(GetRealStatus) S(GetStatus) S(GetString)
S(GetStringStatus) S(GetTypesPlatform) S(GetVersion) S(Reset) S(SerializeFMUstate) S(SerializedFMUstateSize)
S(SetDebugLogging) S(SetFMUstate) S(SetRealInputDerivatives) S(SetString) S(GetEventIndicators)
#else
S(ActivateModelPartition) S(DeserializeFMUState) S(EnterConfigurationMode) S(EnterStepMode)
S(EvaluateDiscreteStates) S(ExitConfigurationMode) S(FreeFMUState) S(GetAdjointDerivative) S(GetBinary)
S(GetClock) S(GetDirectionalDerivative) S(GetEventIndicators) S(GetFMUState) S(GetFloat32) S(GetInt16)
S(GetInt64) S(GetInt8) S(GetIntervalDecimal) S(GetIntervalFraction) S(GetNumberOfContinuousStates)
S(GetNumberOfEventIndicators) S(GetNumberOfVariableDependencies) S(GetOutputDerivatives) S(GetShiftDecimal)
S(GetShiftFraction) S(GetString) S(GetUInt16) S(GetUInt32) S(GetUInt64) S(GetUInt8) S(GetVariableDependencies)
S(GetVersion) S(InstantiateScheduledExecution) S(Reset) S(SerializeFMUState) S(SerializedFMUStateSize)
S(SetBinary) S(SetClock) S(SetDebugLogging) S(SetFMUState) S(SetFloat32) S(SetInt16) S(SetInt64) S(SetInt8)
S(SetIntervalDecimal) S(SetIntervalFraction) S(SetShiftDecimal) S(SetShiftFraction) S(SetString) S(SetUInt16)
S(SetUInt32) S(SetUInt64) S(SetUInt8)
#endif
#if FMI == 1
EXPORT int F(GetNominalContinuousStates)(void *c, double *x, size_t n) { return x[0] = 1, 0; }
#else
EXPORT int F(GetNominalsOfContinuousStates)(void *c, double *x, size_t n) { return x[0] = 1, 0; }
#endif
