/* Calls every function of FMI 2.0 of the model that it is linked with, in many orders, well and badly, and
   counts the allocations of memory. Prints what is wrong; ends with 0 where nothing is. The linker gives it all
   calls of the allocating functions (-Wl,--wrap), where COUNTING is defined. */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "counting.h"
#include "fmi2Functions.h"

static int messages;

static void note(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category,
                 fmi2String message, ...)
{
    char text[20000];
    va_list arguments;
    (void)environment, (void)category, (void)status;
    va_start(arguments, message);
    vsnprintf(text, sizeof text, message, arguments); /* as an importer does */
    va_end(arguments);
    messages += strlen(name) == 4 && strlen(text) > 0;
}

static const fmi2CallbackFunctions callbacks = {note, NULL, NULL, NULL, NULL};

static fmi2Component made(void)
{
    fmi2Component c = fmi2Instantiate("name", fmi2CoSimulation, TOKEN, "", &callbacks, fmi2False, fmi2True);
    CHECK(c != NULL);
    return c;
}

static void initialize(fmi2Component c)
{
    CHECK(fmi2SetupExperiment(c, fmi2False, 0.0, 0.0, fmi2False, 0.0) == fmi2OK);
    CHECK(fmi2EnterInitializationMode(c) == fmi2OK);
    CHECK(fmi2ExitInitializationMode(c) == fmi2OK);
}

enum { SPEED = 7, STEPS = 9, ON = 10, LEVER = 11, TOTAL = 12, DIRECT = 13, TICKS = 14, IS_ON = 15, LAST = 16 };

/* Steps that go well, tell, and fail; nothing is allocated. */
static void steps(fmi2Component c)
{
    const fmi2ValueReference reals[] = {TOTAL, DIRECT}, whole[] = {TICKS, LAST}, truths[] = {IS_ON};
    const fmi2ValueReference given[] = {SPEED}, counted[] = {STEPS, LEVER}, switched[] = {ON}, none[] = {77, 78};
    fmi2Real y[2];
    fmi2Integer n[2];
    fmi2Boolean b[1];
    const int before = allocations, told = messages;
    for (int k = 0; k < 500; k++) {
        const fmi2Real u = k % 10 == 9 ? 666.0 : 0.1 * k; /* which fails */
        const fmi2Integer count[] = {k % 7 - 3, k % 5 ? 2 : -1};
        const fmi2Boolean on = k % 2;
        CHECK(fmi2SetReal(c, given, 1, &u) == fmi2OK);
        CHECK(fmi2SetInteger(c, counted, 2, count) == fmi2OK);
        CHECK(fmi2SetBoolean(c, switched, 1, &on) == fmi2OK);
        CHECK(fmi2DoStep(c, 0.1 * k, 0.1, fmi2True) == (u == 666.0 ? fmi2Discard : fmi2OK));
        CHECK(fmi2GetReal(c, reals, 2, y) == (u == 666.0 ? fmi2Error : fmi2OK));
        CHECK(fmi2GetInteger(c, whole, 2, n) == (u == 666.0 ? fmi2Error : fmi2OK));
        CHECK(fmi2GetBoolean(c, truths, 1, b) == (u == 666.0 ? fmi2Error : fmi2OK));
        CHECK(fmi2GetReal(c, none, 2, y) == fmi2Error);
        CHECK(fmi2SetReal(c, none, 2, y) == fmi2Error);
        CHECK(fmi2DoStep(c, 0.1 * k, NAN, fmi2True) == fmi2Discard);
    }
    CHECK(allocations == before);
    CHECK(messages > told + 1000);
}

static void states(fmi2Component c)
{
    fmi2FMUstate saved = NULL, read = NULL;
    size_t size;
    char *bytes;
    CHECK(fmi2GetFMUstate(c, &saved) == fmi2OK);
    CHECK(fmi2GetFMUstate(c, &saved) == fmi2OK);
    CHECK(fmi2SerializedFMUstateSize(c, saved, &size) == fmi2OK);
    bytes = malloc(size);
    CHECK(fmi2SerializeFMUstate(c, saved, bytes, size) == fmi2OK);
    CHECK(fmi2SerializeFMUstate(c, saved, bytes, size - 1) == fmi2Error);
    for (size_t k = 0; k < size; k++) { /* every byte damaged: it is refused, or is a state */
        const char whole = bytes[k];
        bytes[k] = (char)(whole ^ 0x85);
        if (fmi2DeSerializeFMUstate(c, bytes, size, &read) == fmi2OK) {
            CHECK(fmi2SetFMUstate(c, read) == fmi2OK);
            fmi2DoStep(c, 0.0, 0.1, fmi2True);
            CHECK(fmi2GetFMUstate(c, &read) == fmi2OK);
        }
        CHECK(fmi2DeSerializeFMUstate(c, bytes, k, &read) == fmi2Error); /* cut off */
        bytes[k] = whole;
    }
    CHECK(fmi2DeSerializeFMUstate(c, bytes, size, &read) == fmi2OK);
    CHECK(fmi2SetFMUstate(c, saved) == fmi2OK);
    CHECK(fmi2SetFMUstate(c, NULL) == fmi2Error);
    CHECK(fmi2FreeFMUstate(c, &saved) == fmi2OK && saved == NULL);
    CHECK(fmi2FreeFMUstate(c, &saved) == fmi2OK);
    CHECK(fmi2FreeFMUstate(c, &read) == fmi2OK);
    free(bytes);
}

/* What is not supported, and what is not known. */
static void others(fmi2Component c)
{
    const fmi2ValueReference r[] = {SPEED};
    const fmi2Integer order[] = {1};
    const fmi2String text[] = {"x"};
    fmi2Real y[1];
    fmi2Integer n;
    fmi2Boolean b;
    fmi2String s[1];
    fmi2Status status;
    y[0] = 1.0;
    CHECK(fmi2SetReal(c, r, 1, y) == fmi2OK);
    CHECK(!strcmp(fmi2GetVersion(), fmi2Version) && !strcmp(fmi2GetTypesPlatform(), fmi2TypesPlatform));
    CHECK(fmi2SetRealInputDerivatives(c, r, 1, order, y) == fmi2Error);
    CHECK(fmi2GetRealOutputDerivatives(c, r, 1, order, y) == fmi2Error);
    CHECK(fmi2GetDirectionalDerivative(c, r, 1, r, 1, y, y) == fmi2Error);
    CHECK(fmi2SetString(c, r, 1, text) == fmi2Error);
    CHECK(fmi2GetString(c, r, 1, s) == fmi2Error);
    CHECK(fmi2SetString(c, r, 0, text) == fmi2OK && fmi2GetString(c, r, 0, s) == fmi2OK);
    CHECK(fmi2CancelStep(c) == fmi2Error);
    CHECK(fmi2GetStatus(c, fmi2DoStepStatus, &status) == fmi2Discard);
    CHECK(fmi2GetIntegerStatus(c, fmi2DoStepStatus, &n) == fmi2Discard);
    CHECK(fmi2GetStringStatus(c, fmi2PendingStatus, s) == fmi2Discard);
    CHECK(fmi2GetRealStatus(c, fmi2Terminated, y) == fmi2Discard);
    CHECK(fmi2GetBooleanStatus(c, fmi2LastSuccessfulTime, &b) == fmi2Discard);
    CHECK(fmi2GetRealStatus(c, fmi2LastSuccessfulTime, y) == fmi2OK);
    CHECK(fmi2DoStep(c, 2.0, 0.0, fmi2True) == fmi2Discard);
    CHECK(fmi2GetBooleanStatus(c, fmi2Terminated, &b) == fmi2OK && b);
    CHECK(fmi2DoStep(c, 2.0, 0.5, fmi2True) == fmi2OK);
    CHECK(fmi2GetBooleanStatus(c, fmi2Terminated, &b) == fmi2OK && !b);
    CHECK(fmi2GetRealStatus(c, fmi2LastSuccessfulTime, y) == fmi2OK && y[0] == 2.5);
}

int main(void)
{
    const fmi2ValueReference gain[] = {0, 2, 1};
    const fmi2Real numbers[] = {1e308};
    fmi2ValueReference many[3000];
    fmi2Real values[3000] = {0.0};
    fmi2Component first = made(), second;
    int before = allocations;
#ifdef COUNTING
    CHECK(before == 1); /* an instance is one piece of memory */
#endif
    initialize(first);
    steps(first);
    CHECK(allocations == before);
    states(first);
    others(first);
    second = made();
    initialize(second);
    steps(second);
    for (unsigned k = 0; k < 3000; k++) many[k] = 4000000000u - k;
    CHECK(fmi2GetReal(second, many, 3000, values) == fmi2Error); /* a text that has no room for all of them */
    CHECK(fmi2Terminate(second) == fmi2OK && fmi2Terminate(second) == fmi2Error);
    CHECK(fmi2Reset(second) == fmi2OK);
    CHECK(fmi2SetReal(second, gain, 1, numbers) == fmi2OK);
    CHECK(fmi2EnterInitializationMode(second) == fmi2OK);
    CHECK(fmi2GetReal(second, gain, 1, values) == fmi2Error);
    CHECK(fmi2ExitInitializationMode(second) == fmi2Error);
    states(second);
    CHECK(fmi2SetDebugLogging(second, fmi2False, 0, NULL) == fmi2OK);
    before = messages;
    CHECK(fmi2ExitInitializationMode(second) == fmi2Error && messages == before);
    fmi2FreeInstance(first);
    CHECK(fmi2Reset(second) == fmi2OK);
    initialize(second);
    fmi2FreeInstance(second);
    fmi2FreeInstance(NULL);
    CHECK(fmi2Instantiate("name", fmi2ModelExchange, TOKEN, "", &callbacks, fmi2False, fmi2False) == NULL);
    CHECK(fmi2Instantiate("name", fmi2CoSimulation, "{0}", "", &callbacks, fmi2False, fmi2False) == NULL);
    CHECK(fmi2Instantiate("name", fmi2CoSimulation, "%n%s", "", NULL, fmi2False, fmi2False) == NULL);
    CHECK(messages == before + 2);
    CHECK(fmi2DoStep(NULL, 0.0, 0.1, fmi2True) == fmi2Error && fmi2Terminate(NULL) == fmi2Error);
    return wrong != 0;
}
