/* FMI 3.0 for Co-Simulation: the functions of the standard around one instance (instance.h).

   Values, refusals and their words are those of fmi2.c, with the names of FMI 3.0: a real is a Float64, an
   integer an Int32, an item of an enumeration an Int64. There are no arrays, so that there is one value for
   each value reference. A step is never left early and needs no event: eventHandlingNeeded and earlyReturn are
   false. A step that fails returns fmi3Discard with terminateSimulation, and leaves state and outputs as they
   were. The functions for other kinds of FMUs, and those for what this FMU does not have, return fmi3Error.
   Messages are plain text. */
#include "fmi3_types.h"

#include <string.h>

#include "instance.h"

static const char errors[] = "logStatusError", warnings[] = "logStatusWarning";

/* What an instance keeps for FMI. */
typedef struct {
    fmi3LogMessageCallback log;
    fmi3InstanceEnvironment environment;
    bool tells_errors, tells_warnings;
} outer;

static outer *outer_of(const instance *m)
{
    return m->own;
}

/* -- messages  ------------------------------------------------------------------------------------ */

static void send(const outer *o, fmi3Status status, const char *category, const char *text)
{
    if (o->log)
        o->log(o->environment, status, category, text);
}

/* Tell why a call failed, and return its status. */
static fmi3Status error(instance *m, const char *call)
{
    if (outer_of(m)->tells_errors)
        send(outer_of(m), fmi3Error, errors, instance_message(m, call, m->text, false));
    return fmi3Error;
}

static fmi3Status unsupported(fmi3Instance m, const char *call)
{
    if (!m)
        return fmi3Error;
    instance_refuse(m, "this FMU does not support it");
    return error(m, call);
}

EXPORT const char *fmi3GetVersion(void)
{
    return "3.0";
}

EXPORT fmi3Status fmi3SetDebugLogging(fmi3Instance m, fmi3Boolean on, size_t count,
                                      const fmi3String categories[])
{
    if (!m)
        return fmi3Error;
    outer *o = outer_of(m);
    o->tells_errors = o->tells_warnings = on && count == 0;
    for (size_t k = 0; on && k < count; k++) {
        o->tells_errors = o->tells_errors || !strcmp(categories[k], errors);
        o->tells_warnings = o->tells_warnings || !strcmp(categories[k], warnings);
    }
    return fmi3OK;
}

/* -- creation  ------------------------------------------------------------------------------------ */

/* Tell why there is no instance, in any case, and return none. */
static fmi3Instance none(instance *m, const char *call)
{
    send(outer_of(m), fmi3Error, errors, instance_message(m, call, m->text, false));
    instance_free(m);
    return NULL;
}

static instance *made(fmi3Boolean log, fmi3InstanceEnvironment environment, fmi3LogMessageCallback callback)
{
    instance *m = instance_new("Int32", true, sizeof(outer));
    if (m)
        *outer_of(m) = (outer){callback, environment, log, log};
    return m;
}

static fmi3Instance other_kind(const char *call, fmi3InstanceEnvironment environment,
                               fmi3LogMessageCallback log)
{
    instance *m = made(true, environment, log);
    if (!m)
        return NULL;
    instance_refuse(m, "%s is an FMU for Co-Simulation", model.name);
    return none(m, call);
}

EXPORT fmi3Instance fmi3InstantiateCoSimulation(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean log,
    fmi3Boolean event_mode, fmi3Boolean early_return, const fmi3ValueReference intermediate[],
    size_t intermediate_count, fmi3InstanceEnvironment environment, fmi3LogMessageCallback callback,
    fmi3IntermediateUpdateCallback update)
{
    static const char call[] = "fmi3InstantiateCoSimulation";
    instance *m = made(log, environment, callback);
    (void)name, (void)resources, (void)visible, (void)early_return, (void)intermediate, (void)update;
    if (!m)
        return NULL;
    if (!token || strcmp(token, model.token) != 0)
        instance_refuse(m, "the instantiationToken is '%s', that of %s is '%s'", token ? token : "",
                        model.name, model.token);
    else if (event_mode)
        instance_refuse(m, "%s has no event mode", model.name);
    else if (intermediate_count)
        instance_refuse(m, "%s has no intermediate values within a step", model.name);
    else
        return m;
    return none(m, call);
}

EXPORT fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources,
                                                 fmi3Boolean visible, fmi3Boolean log,
                                                 fmi3InstanceEnvironment environment,
                                                 fmi3LogMessageCallback callback)
{
    (void)name, (void)token, (void)resources, (void)visible, (void)log;
    return other_kind("fmi3InstantiateModelExchange", environment, callback);
}

EXPORT fmi3Instance fmi3InstantiateScheduledExecution(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean log,
    fmi3InstanceEnvironment environment, fmi3LogMessageCallback callback, fmi3ClockUpdateCallback clock,
    fmi3LockPreemptionCallback lock, fmi3UnlockPreemptionCallback unlock)
{
    (void)name, (void)token, (void)resources, (void)visible, (void)log, (void)clock, (void)lock, (void)unlock;
    return other_kind("fmi3InstantiateScheduledExecution", environment, callback);
}

EXPORT void fmi3FreeInstance(fmi3Instance m)
{
    instance_free(m);
}

/* -- phases  -------------------------------------------------------------------------------------- */

EXPORT fmi3Status fmi3EnterInitializationMode(fmi3Instance of_importer, fmi3Boolean has_tolerance,
                                              fmi3Float64 tolerance, fmi3Float64 start, fmi3Boolean has_stop,
                                              fmi3Float64 stop)
{
    instance *m = of_importer;
    (void)has_tolerance, (void)tolerance, (void)has_stop, (void)stop;
    if (!m)
        return fmi3Error;
    if (!instance_is(m, IN_CREATED))
        return error(m, "fmi3EnterInitializationMode");
    instance_set_start(m, start);
    m->phase = INITIALIZING;
    return fmi3OK;
}

EXPORT fmi3Status fmi3ExitInitializationMode(fmi3Instance m)
{
    if (!m)
        return fmi3Error;
    if (!instance_is(m, IN_INITIALIZING) || !instance_start(m))
        return error(m, "fmi3ExitInitializationMode");
    return fmi3OK;
}

EXPORT fmi3Status fmi3Terminate(fmi3Instance of_importer)
{
    instance *m = of_importer;
    if (!m)
        return fmi3Error;
    if (!instance_is(m, IN_STEPPING))
        return error(m, "fmi3Terminate");
    m->phase = ENDED;
    return fmi3OK;
}

EXPORT fmi3Status fmi3Reset(fmi3Instance m)
{
    if (!m)
        return fmi3Error;
    instance_reset(m);
    return fmi3OK;
}

/* -- values  -------------------------------------------------------------------------------------- */

#define GET(TYPE)                                                                                            \
    EXPORT fmi3Status fmi3Get##TYPE(fmi3Instance m, const fmi3ValueReference r[], size_t count,              \
                                    fmi3##TYPE values[], size_t value_count)
#define SET(TYPE)                                                                                            \
    EXPORT fmi3Status fmi3Set##TYPE(fmi3Instance m, const fmi3ValueReference r[], size_t count,              \
                                    const fmi3##TYPE values[], size_t value_count)

static const instance_kind float64 = {"Float64", REAL}, int32 = {"Int32", INTEGER},
                           boolean = {"Boolean", BOOLEAN}, int64 = {"Int64", ENUMERATION};

static bool one_each(instance *m, size_t count, size_t value_count)
{
    return count == value_count ||
           instance_refuse(m, "there are %zu values for %zu value references", value_count, count);
}

static bool readable(instance *m, instance_kind kind, const fmi3ValueReference r[], size_t count,
                     size_t values)
{
    return instance_is(m, KNOWN) && instance_ready(m) && instance_has(m, kind, r, count) &&
           one_each(m, count, values);
}

static bool settable(instance *m, instance_kind kind, const fmi3ValueReference r[], size_t count,
                     size_t values)
{
    return instance_is(m, SETTABLE) && instance_can_set(m, kind, r, count) && one_each(m, count, values);
}

/* Read any reals. */
MODEL_APART fmi3Status get_reals(instance *m, const fmi3ValueReference r[], size_t count, double values[],
                                 size_t value_count)
{
    if (!m)
        return fmi3Error;
    if (!readable(m, float64, r, count, value_count))
        return error(m, "fmi3GetFloat64");
    for (size_t k = 0; k < count; k++)
        values[k] = instance_real(m, r[k]);
    return fmi3OK;
}

GET(Float64)
{
    if (m && count == value_count && instance_get_run(m, r, count, values))
        return fmi3OK;
    return get_reals(m, r, count, values, value_count);
}

GET(Int32)
{
    if (!m)
        return fmi3Error;
    if (!readable(m, int32, r, count, value_count))
        return error(m, "fmi3GetInt32");
    for (size_t k = 0; k < count; k++)
        values[k] = (fmi3Int32)instance_integer(m, r[k]);
    return fmi3OK;
}

GET(Int64)
{
    if (!m)
        return fmi3Error;
    if (!readable(m, int64, r, count, value_count))
        return error(m, "fmi3GetInt64");
    for (size_t k = 0; k < count; k++)
        values[k] = instance_integer(m, r[k]);
    return fmi3OK;
}

GET(Boolean)
{
    if (!m)
        return fmi3Error;
    if (!readable(m, boolean, r, count, value_count))
        return error(m, "fmi3GetBoolean");
    for (size_t k = 0; k < count; k++)
        values[k] = instance_boolean(m, r[k]);
    return fmi3OK;
}

/* Write any reals. */
MODEL_APART fmi3Status set_reals(instance *m, const fmi3ValueReference r[], size_t count, const double values[],
                                 size_t value_count)
{
    if (!m)
        return fmi3Error;
    if (!settable(m, float64, r, count, value_count))
        return error(m, "fmi3SetFloat64");
    for (size_t k = 0; k < count; k++)
        instance_put_real(m, r[k], values[k]);
    instance_was_set(m);
    return fmi3OK;
}

SET(Float64)
{
    if (m && count == value_count && instance_set_run(m, r, count, values))
        return fmi3OK;
    return set_reals(m, r, count, values, value_count);
}

SET(Int32)
{
    if (!m)
        return fmi3Error;
    if (!settable(m, int32, r, count, value_count))
        return error(m, "fmi3SetInt32");
    for (size_t k = 0; k < count; k++)
        instance_put_integer(m, r[k], values[k]);
    instance_was_set(m);
    return fmi3OK;
}

SET(Int64)
{
    if (!m)
        return fmi3Error;
    for (size_t k = 0; k < count && k < value_count; k++)
        if (!instance_has_item(m, r[k], values[k]))
            return error(m, "fmi3SetInt64");
    if (!settable(m, int64, r, count, value_count))
        return error(m, "fmi3SetInt64");
    for (size_t k = 0; k < count; k++)
        instance_put_integer(m, r[k], values[k]);
    instance_was_set(m);
    return fmi3OK;
}

SET(Boolean)
{
    if (!m)
        return fmi3Error;
    if (!settable(m, boolean, r, count, value_count))
        return error(m, "fmi3SetBoolean");
    for (size_t k = 0; k < count; k++)
        instance_put_boolean(m, r[k], values[k]);
    instance_was_set(m);
    return fmi3OK;
}

/* Types of which no model has a variable: no references are well, any other one is not known. */
static fmi3Status read_none(instance *m, const char *call, const char *type, const fmi3ValueReference r[],
                            size_t count, size_t values)
{
    const instance_kind kind = {type, 0};
    return m && readable(m, kind, r, count, values) ? fmi3OK : m ? error(m, call) : fmi3Error;
}

static fmi3Status set_none(instance *m, const char *call, const char *type, const fmi3ValueReference r[],
                           size_t count, size_t values)
{
    const instance_kind kind = {type, 0};
    if (!m)
        return fmi3Error;
    if (!settable(m, kind, r, count, values))
        return error(m, call);
    instance_was_set(m);
    return fmi3OK;
}

#define NO_VARIABLES(TYPE)                                                                                   \
    GET(TYPE)                                                                                                \
    {                                                                                                        \
        (void)values;                                                                                        \
        return read_none(m, "fmi3Get" #TYPE, #TYPE, r, count, value_count);                                  \
    }                                                                                                        \
    SET(TYPE)                                                                                                \
    {                                                                                                        \
        (void)values;                                                                                        \
        return set_none(m, "fmi3Set" #TYPE, #TYPE, r, count, value_count);                                   \
    }

NO_VARIABLES(Float32)
NO_VARIABLES(Int8)
NO_VARIABLES(UInt8)
NO_VARIABLES(Int16)
NO_VARIABLES(UInt16)
NO_VARIABLES(UInt32)
NO_VARIABLES(UInt64)
NO_VARIABLES(String)

EXPORT fmi3Status fmi3GetBinary(fmi3Instance m, const fmi3ValueReference r[], size_t count, size_t sizes[],
                                fmi3Binary values[], size_t value_count)
{
    (void)sizes, (void)values;
    return read_none(m, "fmi3GetBinary", "Binary", r, count, value_count);
}

EXPORT fmi3Status fmi3SetBinary(fmi3Instance m, const fmi3ValueReference r[], size_t count,
                                const size_t sizes[], const fmi3Binary values[], size_t value_count)
{
    (void)sizes, (void)values;
    return set_none(m, "fmi3SetBinary", "Binary", r, count, value_count);
}

EXPORT fmi3Status fmi3GetClock(fmi3Instance m, const fmi3ValueReference r[], size_t count, fmi3Clock values[])
{
    (void)values;
    return read_none(m, "fmi3GetClock", "Clock", r, count, count);
}

EXPORT fmi3Status fmi3SetClock(fmi3Instance m, const fmi3ValueReference r[], size_t count,
                               const fmi3Clock values[])
{
    (void)values;
    return set_none(m, "fmi3SetClock", "Clock", r, count, count);
}

/* -- steps  --------------------------------------------------------------------------------------- */

/* Tell why the step at t failed. */
static void tell_failure(instance *m, fmi3Float64 t)
{
    if (outer_of(m)->tells_errors)
        send(outer_of(m), fmi3Error, errors, instance_step_message(m, "fmi3DoStep", t, false));
}

EXPORT fmi3Status fmi3DoStep(fmi3Instance of_importer, fmi3Float64 t, fmi3Float64 step,
                             fmi3Boolean no_state_before, fmi3Boolean *event_needed, fmi3Boolean *end,
                             fmi3Boolean *early, fmi3Float64 *last_successful)
{
    instance *m = of_importer;
    (void)no_state_before;
    if (!m)
        return fmi3Error;
    const bool done = instance_step(m, t, step);
    if (event_needed)
        *event_needed = false;
    if (end)
        *end = !done;
    if (early)
        *early = false;
    if (last_successful)
        *last_successful = done ? m->reached : t;
    if (!done)
        tell_failure(m, t);
    else if (m->notice && outer_of(m)->tells_warnings)
        send(outer_of(m), fmi3Warning, warnings, instance_message(m, "", m->notice, false));
    return done ? fmi3OK : fmi3Discard;
}

/* -- saved states  -------------------------------------------------------------------------------- */

EXPORT fmi3Status fmi3GetFMUState(fmi3Instance m, fmi3FMUState *state)
{
    if (!m)
        return fmi3Error;
    instance_snapshot *saved = instance_save(m, *state);
    if (!saved)
        return error(m, "fmi3GetFMUState");
    *state = saved;
    return fmi3OK;
}

EXPORT fmi3Status fmi3SetFMUState(fmi3Instance m, fmi3FMUState state)
{
    if (!m)
        return fmi3Error;
    return instance_restore(m, state) ? fmi3OK : error(m, "fmi3SetFMUState");
}

EXPORT fmi3Status fmi3FreeFMUState(fmi3Instance m, fmi3FMUState *state)
{
    if (!m)
        return fmi3Error;
    if (state) {
        instance_free_saved(*state);
        *state = NULL;
    }
    return fmi3OK;
}

EXPORT fmi3Status fmi3SerializedFMUStateSize(fmi3Instance m, fmi3FMUState state, size_t *size)
{
    (void)state;
    if (!m)
        return fmi3Error;
    *size = instance_bytes_size();
    return fmi3OK;
}

EXPORT fmi3Status fmi3SerializeFMUState(fmi3Instance m, fmi3FMUState state, fmi3Byte bytes[], size_t size)
{
    if (!m)
        return fmi3Error;
    return instance_to_bytes(m, state, bytes, size) ? fmi3OK : error(m, "fmi3SerializeFMUState");
}

EXPORT fmi3Status fmi3DeserializeFMUState(fmi3Instance m, const fmi3Byte bytes[], size_t size,
                                          fmi3FMUState *state)
{
    if (!m)
        return fmi3Error;
    instance_snapshot *saved = *state;
    if (!instance_from_bytes(m, bytes, size, &saved))
        return error(m, "fmi3DeserializeFMUState");
    *state = saved;
    return fmi3OK;
}

/* -- what this FMU does not have ------------------------------------------------------------------ */

#define UNSUPPORTED(FUNCTION, ...)                                                                           \
    EXPORT fmi3Status fmi3##FUNCTION(fmi3Instance m, __VA_ARGS__)                                            \
    {                                                                                                        \
        UNUSED;                                                                                              \
        return unsupported(m, "fmi3" #FUNCTION);                                                             \
    }
#define UNSUPPORTED_PLAIN(FUNCTION)                                                                          \
    EXPORT fmi3Status fmi3##FUNCTION(fmi3Instance m)                                                         \
    {                                                                                                        \
        return unsupported(m, "fmi3" #FUNCTION);                                                             \
    }

UNSUPPORTED_PLAIN(EnterEventMode)
UNSUPPORTED_PLAIN(EnterStepMode)
UNSUPPORTED_PLAIN(EnterConfigurationMode)
UNSUPPORTED_PLAIN(ExitConfigurationMode)
UNSUPPORTED_PLAIN(EvaluateDiscreteStates)
UNSUPPORTED_PLAIN(EnterContinuousTimeMode)

#define UNUSED (void)a, (void)n
UNSUPPORTED(SetContinuousStates, const fmi3Float64 a[], size_t n)
UNSUPPORTED(GetContinuousStateDerivatives, fmi3Float64 a[], size_t n)
UNSUPPORTED(GetEventIndicators, fmi3Float64 a[], size_t n)
UNSUPPORTED(GetContinuousStates, fmi3Float64 a[], size_t n)
UNSUPPORTED(GetNominalsOfContinuousStates, fmi3Float64 a[], size_t n)
UNSUPPORTED(GetNumberOfVariableDependencies, fmi3ValueReference a, size_t *n)
UNSUPPORTED(ActivateModelPartition, fmi3ValueReference a, fmi3Float64 n)
#undef UNUSED

#define UNUSED (void)a
UNSUPPORTED(SetTime, fmi3Float64 a)
UNSUPPORTED(GetNumberOfEventIndicators, size_t *a)
UNSUPPORTED(GetNumberOfContinuousStates, size_t *a)
#undef UNUSED

#define UNUSED (void)r, (void)n, (void)a
UNSUPPORTED(GetShiftDecimal, const fmi3ValueReference r[], size_t n, fmi3Float64 a[])
UNSUPPORTED(SetIntervalDecimal, const fmi3ValueReference r[], size_t n, const fmi3Float64 a[])
UNSUPPORTED(SetShiftDecimal, const fmi3ValueReference r[], size_t n, const fmi3Float64 a[])
UNSUPPORTED(CompletedIntegratorStep, fmi3Boolean r, fmi3Boolean *n, fmi3Boolean *a)
#undef UNUSED

#define UNUSED (void)r, (void)n, (void)a, (void)b
UNSUPPORTED(GetIntervalDecimal, const fmi3ValueReference r[], size_t n, fmi3Float64 a[],
            fmi3IntervalQualifier b[])
UNSUPPORTED(GetShiftFraction, const fmi3ValueReference r[], size_t n, fmi3UInt64 a[], fmi3UInt64 b[])
UNSUPPORTED(SetIntervalFraction, const fmi3ValueReference r[], size_t n, const fmi3UInt64 a[],
            const fmi3UInt64 b[])
UNSUPPORTED(SetShiftFraction, const fmi3ValueReference r[], size_t n, const fmi3UInt64 a[],
            const fmi3UInt64 b[])
#undef UNUSED

#define UNUSED (void)r, (void)n, (void)a, (void)b, (void)d
UNSUPPORTED(GetIntervalFraction, const fmi3ValueReference r[], size_t n, fmi3UInt64 a[], fmi3UInt64 b[],
            fmi3IntervalQualifier d[])
UNSUPPORTED(GetOutputDerivatives, const fmi3ValueReference r[], size_t n, const fmi3Int32 a[],
            fmi3Float64 b[], size_t d)
#undef UNUSED

#define UNUSED (void)r, (void)a, (void)b, (void)d, (void)e, (void)n
UNSUPPORTED(GetVariableDependencies, fmi3ValueReference r, size_t a[], fmi3ValueReference b[], size_t d[],
            fmi3DependencyKind e[], size_t n)
UNSUPPORTED(UpdateDiscreteStates, fmi3Boolean *r, fmi3Boolean *a, fmi3Boolean *b, fmi3Boolean *d,
            fmi3Boolean *e, fmi3Float64 *n)
#undef UNUSED

#define UNUSED (void)r, (void)n, (void)a, (void)b, (void)d, (void)e, (void)f, (void)g
UNSUPPORTED(GetDirectionalDerivative, const fmi3ValueReference r[], size_t n, const fmi3ValueReference a[],
            size_t b, const fmi3Float64 d[], size_t e, fmi3Float64 f[], size_t g)
UNSUPPORTED(GetAdjointDerivative, const fmi3ValueReference r[], size_t n, const fmi3ValueReference a[],
            size_t b, const fmi3Float64 d[], size_t e, fmi3Float64 f[], size_t g)
#undef UNUSED
