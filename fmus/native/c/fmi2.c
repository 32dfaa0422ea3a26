/* FMI 2.0 for Co-Simulation: the functions of the standard around one instance (instance.h).

   Texts, values and what is refused are those of the FMU that runs the same model in Python. What differs:
   - A call that fails returns fmi2Error, its message has status Error and the category logStatusError, and
     the instance is as it was before the call. The FMU in Python can only say fmi2Fatal, without a category.
   - Calls are refused outside the phases in which the standard allows them.
   - The instance is asked to have the guid of its description, and to be for Co-Simulation.
   - fmi2Terminated becomes false again with a step that is done, with fmi2Reset and with fmi2SetFMUstate.
   As there, a step that fails returns fmi2Discard and leaves state and outputs as they were; it can be tried
   again. Messages are printf formats without arguments, so that "%" is doubled in them. */
#include "fmi2_types.h"

#include <stdio.h>
#include <string.h>

#include "instance.h"

static const instance_kind real_kind = {"Real", REAL};
static const instance_kind integer_kind = {"Integer", INTEGER | ENUMERATION};
static const instance_kind boolean_kind = {"Boolean", BOOLEAN};
static const instance_kind string_kind = {"String", 0};

static const char errors[] = "logStatusError", warnings[] = "logStatusWarning";

/* What an instance keeps for FMI; its name follows. */
typedef struct {
    fmi2CallbackFunctions callbacks;
    bool tells_errors, tells_warnings;
    bool asks_to_end;
    char name[];
} outer;

static outer *outer_of(const instance *m)
{
    return m->own;
}

/* -- messages ------------------------------------------------------------------------------------- */

/* Send a message to the importer's log. */
static void send(const instance *m, fmi2Status status, const char *category, const char *text)
{
    const outer *o = outer_of(m);
    if (o->callbacks.logger)
        o->callbacks.logger(o->callbacks.componentEnvironment, o->name, status, category, text);
}

/* Tell why a call failed, and return its status. */
MODEL_SELDOM static fmi2Status error(instance *m, const char *call)
{
    if (outer_of(m)->tells_errors)
        send(m, fmi2Error, errors, instance_message(m, call, m->text, true));
    return fmi2Error;
}

static fmi2Status unsupported(fmi2Component c, const char *call)
{
    if (!c)
        return fmi2Error;
    instance_refuse(c, "this FMU does not support it");
    return error(c, call);
}

/* -- phases --------------------------------------------------------------------------------------- */

EXPORT const char *fmi2GetTypesPlatform(void)
{
    return "default";
}

EXPORT const char *fmi2GetVersion(void)
{
    return "2.0";
}

EXPORT fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t count,
                                      const fmi2String categories[])
{
    if (!c)
        return fmi2Error;
    outer *o = outer_of(c);
    o->tells_errors = o->tells_warnings = on && count == 0;
    for (size_t k = 0; on && k < count; k++) {
        o->tells_errors = o->tells_errors || !strcmp(categories[k], errors);
        o->tells_warnings = o->tells_warnings || !strcmp(categories[k], warnings);
    }
    return fmi2OK;
}

EXPORT fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                                     const fmi2CallbackFunctions *callbacks, fmi2Boolean visible,
                                     fmi2Boolean log)
{
    const size_t length = name ? strlen(name) : 0;
    instance *m = instance_new("Integer", false, sizeof(outer) + length + 1);
    (void)resources, (void)visible;
    if (!m)
        return NULL;
    outer *o = outer_of(m);
    if (callbacks)
        o->callbacks = *callbacks;
    memcpy(o->name, name ? name : "", length + 1);
    o->tells_errors = o->tells_warnings = log != 0;
    const bool right = guid && !strcmp(guid, model.token);
    if (right && type == fmi2CoSimulation)
        return m;
    if (right)
        instance_refuse(m, "%s is an FMU for Co-Simulation", model.name);
    else
        instance_refuse(m, "the guid is '%s', that of %s is '%s'", guid ? guid : "", model.name, model.token);
    /* in any case, as the standard asks */
    send(m, fmi2Error, errors, instance_message(m, "fmi2Instantiate", m->text, true));
    instance_free(m);
    return NULL;
}

EXPORT void fmi2FreeInstance(fmi2Component c)
{
    instance_free(c);
}

EXPORT fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean has_tolerance, fmi2Real tolerance,
                                      fmi2Real start, fmi2Boolean has_stop, fmi2Real stop)
{
    (void)has_tolerance, (void)tolerance, (void)has_stop, (void)stop;
    if (!c)
        return fmi2Error;
    if (!instance_is(c, IN_CREATED))
        return error(c, "fmi2SetupExperiment");
    instance_set_start(c, start);
    return fmi2OK;
}

EXPORT fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
    instance *m = c;
    if (!m)
        return fmi2Error;
    if (!instance_is(m, IN_CREATED))
        return error(m, "fmi2EnterInitializationMode");
    m->phase = INITIALIZING;
    return fmi2OK;
}

EXPORT fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    if (!c)
        return fmi2Error;
    if (!instance_is(c, IN_INITIALIZING) || !instance_start(c))
        return error(c, "fmi2ExitInitializationMode");
    return fmi2OK;
}

EXPORT fmi2Status fmi2Terminate(fmi2Component c)
{
    instance *m = c;
    if (!m)
        return fmi2Error;
    if (!instance_is(m, IN_STEPPING))
        return error(m, "fmi2Terminate");
    m->phase = ENDED;
    return fmi2OK;
}

EXPORT fmi2Status fmi2Reset(fmi2Component c)
{
    if (!c)
        return fmi2Error;
    instance_reset(c);
    outer_of(c)->asks_to_end = false;
    return fmi2OK;
}

/* -- values --------------------------------------------------------------------------------------- */

typedef const fmi2ValueReference references[];

/* Return true where these values can be read now, and make them current. */
static bool readable(instance *m, instance_kind kind, references r, size_t count)
{
    return instance_is(m, KNOWN) && instance_ready(m) && instance_has(m, kind, r, count);
}

/* Return true where these variables can be set now. */
static bool settable(instance *m, instance_kind kind, references r, size_t count)
{
    return instance_is(m, SETTABLE) && instance_can_set(m, kind, r, count);
}

/* Read any reals. */
MODEL_APART fmi2Status get_reals(instance *m, references r, size_t count, fmi2Real values[])
{
    if (!m)
        return fmi2Error;
    if (!readable(m, real_kind, r, count))
        return error(m, "fmi2GetReal");
    for (size_t k = 0; k < count; k++)
        values[k] = instance_real(m, r[k]);
    return fmi2OK;
}

EXPORT fmi2Status fmi2GetReal(fmi2Component c, references r, size_t count, fmi2Real values[])
{
    return c && instance_get_run(c, r, count, values) ? fmi2OK : get_reals(c, r, count, values);
}

EXPORT fmi2Status fmi2GetInteger(fmi2Component c, references r, size_t count, fmi2Integer values[])
{
    if (!c)
        return fmi2Error;
    if (!readable(c, integer_kind, r, count))
        return error(c, "fmi2GetInteger");
    for (size_t k = 0; k < count; k++)
        values[k] = (fmi2Integer)instance_integer(c, r[k]);
    return fmi2OK;
}

EXPORT fmi2Status fmi2GetBoolean(fmi2Component c, references r, size_t count, fmi2Boolean values[])
{
    if (!c)
        return fmi2Error;
    if (!readable(c, boolean_kind, r, count))
        return error(c, "fmi2GetBoolean");
    for (size_t k = 0; k < count; k++)
        values[k] = instance_boolean(c, r[k]);
    return fmi2OK;
}

EXPORT fmi2Status fmi2GetString(fmi2Component c, references r, size_t count, fmi2String values[])
{
    (void)values;
    if (!c)
        return fmi2Error;
    return readable(c, string_kind, r, count) ? fmi2OK : error(c, "fmi2GetString");
}

/* Write any reals. */
MODEL_APART fmi2Status set_reals(instance *m, references r, size_t count, const fmi2Real values[])
{
    if (!m)
        return fmi2Error;
    if (!settable(m, real_kind, r, count))
        return error(m, "fmi2SetReal");
    for (size_t k = 0; k < count; k++)
        instance_put_real(m, r[k], values[k]);
    instance_was_set(m);
    return fmi2OK;
}

EXPORT fmi2Status fmi2SetReal(fmi2Component c, references r, size_t count, const fmi2Real values[])
{
    return c && instance_set_run(c, r, count, values) ? fmi2OK : set_reals(c, r, count, values);
}

EXPORT fmi2Status fmi2SetInteger(fmi2Component c, references r, size_t count, const fmi2Integer values[])
{
    if (!c)
        return fmi2Error;
    for (size_t k = 0; k < count; k++)
        if (!instance_has_item(c, r[k], values[k]))
            return error(c, "fmi2SetInteger");
    if (!settable(c, integer_kind, r, count))
        return error(c, "fmi2SetInteger");
    for (size_t k = 0; k < count; k++)
        instance_put_integer(c, r[k], values[k]);
    instance_was_set(c);
    return fmi2OK;
}

EXPORT fmi2Status fmi2SetBoolean(fmi2Component c, references r, size_t count, const fmi2Boolean values[])
{
    if (!c)
        return fmi2Error;
    if (!settable(c, boolean_kind, r, count))
        return error(c, "fmi2SetBoolean");
    for (size_t k = 0; k < count; k++)
        instance_put_boolean(c, r[k], values[k] != 0);
    instance_was_set(c);
    return fmi2OK;
}

EXPORT fmi2Status fmi2SetString(fmi2Component c, references r, size_t count, const fmi2String values[])
{
    (void)values;
    if (!c)
        return fmi2Error;
    if (!settable(c, string_kind, r, count))
        return error(c, "fmi2SetString");
    instance_was_set(c);
    return fmi2OK;
}

EXPORT fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, references r, size_t count,
                                              const fmi2Integer order[], const fmi2Real values[])
{
    (void)r, (void)count, (void)order, (void)values;
    return unsupported(c, "fmi2SetRealInputDerivatives");
}

EXPORT fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, references r, size_t count,
                                               const fmi2Integer order[], fmi2Real values[])
{
    (void)r, (void)count, (void)order, (void)values;
    return unsupported(c, "fmi2GetRealOutputDerivatives");
}

EXPORT fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, references unknown, size_t unknown_count,
                                               references known, size_t known_count, const fmi2Real seed[],
                                               fmi2Real values[])
{
    (void)unknown, (void)unknown_count, (void)known, (void)known_count, (void)seed, (void)values;
    return unsupported(c, "fmi2GetDirectionalDerivative");
}

/* -- steps ---------------------------------------------------------------------------------------- */

/* Tell why the step at t failed. */
MODEL_SELDOM static fmi2Status discarded(instance *m, fmi2Real t)
{
    outer_of(m)->asks_to_end = true;
    if (outer_of(m)->tells_errors)
        send(m, fmi2Error, errors, instance_step_message(m, "fmi2DoStep", t, true));
    return fmi2Discard;
}

EXPORT fmi2Status fmi2DoStep(fmi2Component c, fmi2Real t, fmi2Real step, fmi2Boolean no_state_before)
{
    instance *m = c;
    (void)no_state_before;
    if (!m)
        return fmi2Error;
    if (!instance_step(m, t, step))
        return discarded(m, t);
    outer_of(m)->asks_to_end = false;
    if (m->notice && outer_of(m)->tells_warnings)
        send(m, fmi2Warning, warnings, instance_message(m, "", m->notice, true));
    return fmi2OK;
}

EXPORT fmi2Status fmi2CancelStep(fmi2Component c)
{
    return unsupported(c, "fmi2CancelStep");
}

/* Tell that a status is not known: no step is ever pending. */
static fmi2Status not_known(fmi2Component c, const char *call)
{
    if (!c)
        return fmi2Error;
    instance_refuse(c, "this FMU does not have that status");
    error(c, call);
    return fmi2Discard;
}

EXPORT fmi2Status fmi2GetStatus(fmi2Component c, fmi2StatusKind kind, fmi2Status *value)
{
    (void)kind, (void)value;
    return not_known(c, "fmi2GetStatus");
}

EXPORT fmi2Status fmi2GetRealStatus(fmi2Component c, fmi2StatusKind kind, fmi2Real *value)
{
    if (!c || kind != fmi2LastSuccessfulTime)
        return not_known(c, "fmi2GetRealStatus");
    *value = ((const instance *)c)->reached;
    return fmi2OK;
}

EXPORT fmi2Status fmi2GetIntegerStatus(fmi2Component c, fmi2StatusKind kind, fmi2Integer *value)
{
    (void)kind, (void)value;
    return not_known(c, "fmi2GetIntegerStatus");
}

EXPORT fmi2Status fmi2GetBooleanStatus(fmi2Component c, fmi2StatusKind kind, fmi2Boolean *value)
{
    if (!c || kind != fmi2Terminated)
        return not_known(c, "fmi2GetBooleanStatus");
    *value = outer_of(c)->asks_to_end;
    return fmi2OK;
}

EXPORT fmi2Status fmi2GetStringStatus(fmi2Component c, fmi2StatusKind kind, fmi2String *value)
{
    (void)kind, (void)value;
    return not_known(c, "fmi2GetStringStatus");
}

/* -- saved states --------------------------------------------------------------------------------- */

EXPORT fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state)
{
    if (!c)
        return fmi2Error;
    instance_snapshot *saved = instance_save(c, *state);
    if (!saved)
        return error(c, "fmi2GetFMUstate");
    *state = saved;
    return fmi2OK;
}

EXPORT fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state)
{
    if (!c)
        return fmi2Error;
    if (!instance_restore(c, state))
        return error(c, "fmi2SetFMUstate");
    outer_of(c)->asks_to_end = false;
    return fmi2OK;
}

EXPORT fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state)
{
    if (!c)
        return fmi2Error;
    if (state) {
        instance_free_saved(*state);
        *state = NULL;
    }
    return fmi2OK;
}

EXPORT fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t *size)
{
    (void)state;
    if (!c)
        return fmi2Error;
    *size = instance_bytes_size();
    return fmi2OK;
}

EXPORT fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size)
{
    if (!c)
        return fmi2Error;
    return instance_to_bytes(c, state, (unsigned char *)bytes, size) ? fmi2OK
                                                                     : error(c, "fmi2SerializeFMUstate");
}

EXPORT fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size,
                                          fmi2FMUstate *state)
{
    instance_snapshot *saved = *state;
    if (!c)
        return fmi2Error;
    if (!instance_from_bytes(c, (const unsigned char *)bytes, size, &saved))
        return error(c, "fmi2DeSerializeFMUstate");
    *state = saved;
    return fmi2OK;
}
