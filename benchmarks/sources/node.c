/* The unit of the benchmarks: SIGNALS lags side by side, as an FMI 2.0 Co-Simulation FMU.

   x_i <- x_i + h (gain u_i + bias_i - x_i),  y_i = x_i

   It does next to nothing, so that what is measured is the master. Value references: u_i = i,
   y_i = SIGNALS + i, gain = 2 SIGNALS, bias_i = 2 SIGNALS + 1 + i. Compiled by benchmarks/fmus.py. */

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#ifndef SIGNALS
#define SIGNALS 1
#endif

#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

typedef void *fmi2Component;
typedef double fmi2Real;
typedef int fmi2Integer;
typedef int fmi2Boolean;
typedef const char *fmi2String;
typedef unsigned int fmi2ValueReference;
typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;

enum { COUNT = 3 * SIGNALS + 1 };

typedef struct {
    double values[COUNT];
} Node;

EXPORT const char *fmi2GetTypesPlatform(void) { return "default"; }
EXPORT const char *fmi2GetVersion(void) { return "2.0"; }

EXPORT fmi2Component fmi2Instantiate(fmi2String name, int type, fmi2String guid, fmi2String resources,
                                     const void *callbacks, fmi2Boolean visible, fmi2Boolean logging) {
    (void)name, (void)type, (void)guid, (void)resources, (void)callbacks, (void)visible, (void)logging;
    Node *node = calloc(1, sizeof(Node));
    if (node) node->values[2 * SIGNALS] = 1.0;
    return node;
}

EXPORT void fmi2FreeInstance(fmi2Component c) { free(c); }

EXPORT fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real h, fmi2Boolean no_set_state) {
    (void)time, (void)no_set_state;
    double *u = ((Node *)c)->values, *y = u + SIGNALS, gain = u[2 * SIGNALS], *bias = u + 2 * SIGNALS + 1;
    for (int i = 0; i < SIGNALS; i++) y[i] = y[i] + h * (gain * u[i] + bias[i] - y[i]);
    return fmi2OK;
}

EXPORT fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference *vr, size_t n, fmi2Real *value) {
    for (size_t i = 0; i < n; i++) {
        if (vr[i] >= COUNT) return fmi2Error;
        value[i] = ((Node *)c)->values[vr[i]];
    }
    return fmi2OK;
}

EXPORT fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference *vr, size_t n, const fmi2Real *value) {
    for (size_t i = 0; i < n; i++) {
        if (vr[i] >= COUNT) return fmi2Error;
        ((Node *)c)->values[vr[i]] = value[i];
    }
    return fmi2OK;
}

EXPORT fmi2Status fmi2Reset(fmi2Component c) {
    memset(c, 0, sizeof(Node));
    ((Node *)c)->values[2 * SIGNALS] = 1.0;
    return fmi2OK;
}

/* what there is nothing to do for, or nothing of */
EXPORT fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String *categories) {
    (void)c, (void)on, (void)n, (void)categories;
    return fmi2OK;
}
EXPORT fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean tolerance_defined, fmi2Real tolerance,
                                      fmi2Real start, fmi2Boolean stop_defined, fmi2Real stop) {
    (void)c, (void)tolerance_defined, (void)tolerance, (void)start, (void)stop_defined, (void)stop;
    return fmi2OK;
}
EXPORT fmi2Status fmi2EnterInitializationMode(fmi2Component c) { (void)c; return fmi2OK; }
EXPORT fmi2Status fmi2ExitInitializationMode(fmi2Component c) { (void)c; return fmi2OK; }
EXPORT fmi2Status fmi2Terminate(fmi2Component c) { (void)c; return fmi2OK; }

#define NOTHING(NAME, VALUE)                                                                              \
    EXPORT fmi2Status NAME(fmi2Component c, const fmi2ValueReference *vr, size_t n, VALUE *value) {       \
        (void)c, (void)vr, (void)value;                                                                   \
        return n ? fmi2Error : fmi2OK;                                                                    \
    }
NOTHING(fmi2GetInteger, fmi2Integer)
NOTHING(fmi2GetBoolean, fmi2Boolean)
NOTHING(fmi2GetString, fmi2String)
NOTHING(fmi2SetInteger, const fmi2Integer)
NOTHING(fmi2SetBoolean, const fmi2Boolean)
NOTHING(fmi2SetString, const fmi2String)

#define UNABLE(NAME, ...)                                                                                 \
    EXPORT fmi2Status NAME(__VA_ARGS__) { return fmi2Error; }
UNABLE(fmi2GetFMUstate, fmi2Component c, void **state)
UNABLE(fmi2SetFMUstate, fmi2Component c, void *state)
UNABLE(fmi2FreeFMUstate, fmi2Component c, void **state)
UNABLE(fmi2SerializedFMUstateSize, fmi2Component c, void *state, size_t *size)
UNABLE(fmi2SerializeFMUstate, fmi2Component c, void *state, char *bytes, size_t size)
UNABLE(fmi2DeSerializeFMUstate, fmi2Component c, const char *bytes, size_t size, void **state)
UNABLE(fmi2GetDirectionalDerivative, fmi2Component c, const fmi2ValueReference *unknown, size_t m,
       const fmi2ValueReference *known, size_t n, const fmi2Real *seed, fmi2Real *derivative)
UNABLE(fmi2SetRealInputDerivatives, fmi2Component c, const fmi2ValueReference *vr, size_t n,
       const fmi2Integer *order, const fmi2Real *value)
UNABLE(fmi2GetRealOutputDerivatives, fmi2Component c, const fmi2ValueReference *vr, size_t n,
       const fmi2Integer *order, fmi2Real *value)
UNABLE(fmi2CancelStep, fmi2Component c)
UNABLE(fmi2GetStatus, fmi2Component c, int kind, fmi2Status *value)
UNABLE(fmi2GetRealStatus, fmi2Component c, int kind, fmi2Real *value)
UNABLE(fmi2GetIntegerStatus, fmi2Component c, int kind, fmi2Integer *value)
UNABLE(fmi2GetBooleanStatus, fmi2Component c, int kind, fmi2Boolean *value)
UNABLE(fmi2GetStringStatus, fmi2Component c, int kind, fmi2String *value)
