/* Calls the functions of FMI 3.0 of the model that it is linked with, well and badly, and counts the
   allocations of memory (exercise_fmi2.c). Prints what is wrong; ends with 0 where nothing is. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "counting.h"
#include "fmi3Functions.h"

static int messages;

static void note(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category, fmi3String message)
{
    messages += environment == &messages && strlen(message) > 0 && strlen(category) > 0 && status != fmi3OK;
}

static fmi3Instance made(const char *token, bool event_mode, size_t intermediate)
{
    return fmi3InstantiateCoSimulation("name", token, "", false, true, event_mode, true, NULL, intermediate,
                                       &messages, note, NULL);
}

enum { SPEED = 7, STEPS = 9, ON = 10, LEVER = 11, TOTAL = 12, DIRECT = 13, TICKS = 14, IS_ON = 15, LAST = 16 };

/* Steps that go well, tell, and fail; nothing is allocated. */
static void steps(fmi3Instance m)
{
    const fmi3ValueReference reals[] = {TOTAL, DIRECT}, whole[] = {TICKS}, items[] = {LAST}, truths[] = {IS_ON};
    const fmi3ValueReference given[] = {SPEED}, counted[] = {STEPS}, moved[] = {LEVER}, switched[] = {ON};
    const int before = allocations, told = messages;
    fmi3Float64 y[2], last;
    fmi3Int32 n;
    fmi3Int64 item;
    fmi3Boolean b, event, end, early;
    for (int k = 0; k < 300; k++) {
        const bool fails = k % 10 == 9;
        const fmi3Float64 u = fails ? 666.0 : 0.1 * k;
        const fmi3Int32 count = k % 7 - 3;
        const fmi3Int64 lever = k % 5 ? 2 : -1, none = 3;
        const fmi3Boolean on = k % 2;
        CHECK(fmi3SetFloat64(m, given, 1, &u, 1) == fmi3OK);
        CHECK(fmi3SetInt32(m, counted, 1, &count, 1) == fmi3OK);
        CHECK(fmi3SetInt64(m, moved, 1, &lever, 1) == fmi3OK);
        CHECK(fmi3SetBoolean(m, switched, 1, &on, 1) == fmi3OK);
        event = end = early = !fails;
        CHECK(fmi3DoStep(m, 0.1 * k, 0.1, true, &event, &end, &early, &last) == (fails ? fmi3Discard : fmi3OK));
        CHECK(!event && end == fails && !early && last == (fails ? 0.1 * k : 0.1 * k + 0.1));
        CHECK(fmi3GetFloat64(m, reals, 2, y, 2) == (fails ? fmi3Error : fmi3OK));
        CHECK(fmi3GetInt32(m, whole, 1, &n, 1) == (fails ? fmi3Error : fmi3OK));
        CHECK(fmi3GetInt64(m, items, 1, &item, 1) == (fails ? fmi3Error : fmi3OK));
        CHECK(fmi3GetBoolean(m, truths, 1, &b, 1) == (fails ? fmi3Error : fmi3OK));
        CHECK(fmi3SetInt64(m, moved, 1, &none, 1) == fmi3Error);
        CHECK(fmi3SetInt64(m, counted, 1, &none, 1) == fmi3Error);
        CHECK(fmi3SetFloat64(m, given, 1, y, 2) == fmi3Error);
        CHECK(fmi3SetFloat64(m, reals, 2, y, 2) == fmi3Error);
        CHECK(fmi3DoStep(m, 0.1 * k, NAN, true, NULL, NULL, NULL, NULL) == fmi3Discard);
    }
    CHECK(allocations == before);
    CHECK(messages > told + 1000);
}

static void states(fmi3Instance m)
{
    fmi3FMUState saved = NULL, read = NULL;
    size_t size;
    fmi3Byte *bytes;
    CHECK(fmi3GetFMUState(m, &saved) == fmi3OK);
    CHECK(fmi3SerializedFMUStateSize(m, saved, &size) == fmi3OK);
    bytes = malloc(size);
    CHECK(fmi3SerializeFMUState(m, saved, bytes, size) == fmi3OK);
    CHECK(fmi3SerializeFMUState(m, saved, bytes, size - 1) == fmi3Error);
    CHECK(fmi3DeserializeFMUState(m, bytes, size - 1, &read) == fmi3Error && read == NULL);
    CHECK(fmi3DeserializeFMUState(m, bytes, size, &read) == fmi3OK);
    CHECK(fmi3SetFMUState(m, read) == fmi3OK && fmi3SetFMUState(m, NULL) == fmi3Error);
    CHECK(fmi3FreeFMUState(m, &saved) == fmi3OK && saved == NULL);
    CHECK(fmi3FreeFMUState(m, &read) == fmi3OK);
    free(bytes);
}

int main(void)
{
    fmi3Instance first = made(TOKEN, false, 0), second = made(TOKEN, false, 0);
    CHECK(first != NULL && second != NULL);
    CHECK(fmi3EnterInitializationMode(first, false, 0.0, 0.0, false, 0.0) == fmi3OK);
    CHECK(fmi3ExitInitializationMode(first) == fmi3OK);
    steps(first);
    states(first);
    states(second);
    fmi3FreeInstance(first);
    fmi3FreeInstance(second);
    fmi3FreeInstance(NULL);
    CHECK(made("%n", false, 0) == NULL && made(TOKEN, true, 0) == NULL && made(TOKEN, false, 1) == NULL);
    CHECK(fmi3DoStep(NULL, 0.0, 0.1, true, NULL, NULL, NULL, NULL) == fmi3Error);
    return wrong != 0;
}
