/* A unit of FMI 2.0 Co-Simulation that goes on in steps of its own, of 0.01 s, until its own time is that of the end
   of doStep, as many tools' do: y counts them. It has every function of FMI 2.0 that hosts look up. */
#include <stdlib.h>

#define EXPORT __attribute__((visibility("default")))

typedef struct {
    double time, count;
} Unit;

EXPORT void *fmi2Instantiate(const char *name, int kind, const char *guid, const char *resources, const void *functions,
                             int visible, int logging) {
    return calloc(1, sizeof(Unit));
}
EXPORT void fmi2FreeInstance(void *c) { free(c); }
EXPORT const char *fmi2GetTypesPlatform(void) { return "default"; }
EXPORT const char *fmi2GetVersion(void) { return "2.0"; }
EXPORT int fmi2SetupExperiment(void *c, int tolerant, double tolerance, double start, int stops, double stop) {
    ((Unit *)c)->time = start;
    return 0;
}
EXPORT int fmi2GetReal(void *c, const unsigned *references, size_t n, double *values) {
    for (size_t i = 0; i < n; i++) values[i] = ((Unit *)c)->count;
    return 0;
}
EXPORT int fmi2DoStep(void *c, double time, double size, int final) {
    Unit *unit = c;
    for (; unit->time < time + size; unit->time += 0.01) unit->count += 1.0;
    return 0;
}

#define OK(name) EXPORT int fmi2##name(void) { return 0; }
#define ERROR(name) EXPORT int fmi2##name(void) { return 3; }
OK(SetDebugLogging) OK(EnterInitializationMode) OK(ExitInitializationMode) OK(Terminate) OK(Reset)
ERROR(GetInteger) ERROR(GetBoolean) ERROR(GetString) ERROR(SetReal) ERROR(SetInteger) ERROR(SetBoolean) ERROR(SetString)
ERROR(GetFMUstate) ERROR(SetFMUstate) ERROR(FreeFMUstate) ERROR(SerializedFMUstateSize) ERROR(SerializeFMUstate)
ERROR(DeSerializeFMUstate) ERROR(GetDirectionalDerivative) ERROR(SetRealInputDerivatives)
ERROR(GetRealOutputDerivatives) ERROR(CancelStep) ERROR(GetStatus) ERROR(GetRealStatus) ERROR(GetIntegerStatus)
ERROR(GetBooleanStatus) ERROR(GetStringStatus)
