/* A host in plain C, with libdl alone: c_host LIBRARY FMI TOKEN RESOURCES STEP COUNT SAVES UNITS...
 *
 * FMI is 2 or 3. A unit is "(" and then, in any number, "pREFERENCE:TYPE=VALUE" for a parameter or the start of an
 * input and "oREFERENCE:TYPE" for an output; TYPE is r (Real), i (Integer), e (Enumeration) or b (Boolean). After
 * each step the outputs of each unit are printed, exactly. With SAVES 1 the state is saved as bytes after half of
 * the steps, and the other half is taken twice; the second is printed.
 */
#include <dlfcn.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2_types.h"
#include "fmi3_types.h"

enum { MOST = 64, LONGEST = 8 };

typedef struct {
    void *instance;
    unsigned references[MOST];
    char types[MOST];
    int outputs;
} Unit;

static void *library;
static int fmi;

static void *need(const char *name)
{
    void *found = dlsym(library, name);
    if (!found) {
        printf("%s is missing\n", name);
        exit(3);
    }
    return found;
}

static void note2(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category,
                  fmi2String text, ...)
{
    va_list values;
    (void)environment;
    printf("%s %d %s: ", name, (int)status, category);
    va_start(values, text);
    vprintf(text, values);
    va_end(values);
    printf("\n");
}

static void note3(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category, fmi3String text)
{
    (void)environment;
    printf("unit %d %s: %s\n", (int)status, category, text);
}

static void check(int status, const char *call)
{
    if (status > 1) {
        printf("%s: status %d\n", call, status);
        exit(4);
    }
}

static void *made(const char *token, const char *resources)
{
    static const fmi2CallbackFunctions callbacks = {note2, calloc, free, NULL, NULL};
    if (fmi == 2) {
        fmi2Component (*make)(fmi2String, fmi2Type, fmi2String, fmi2String, const fmi2CallbackFunctions *, fmi2Boolean,
                              fmi2Boolean);
        *(void **)&make = need("fmi2Instantiate");
        return make("unit", fmi2CoSimulation, token, resources, &callbacks, 0, 1);
    }
    fmi3Instance (*make)(fmi3String, fmi3String, fmi3String, fmi3Boolean, fmi3Boolean, fmi3Boolean, fmi3Boolean,
                         const fmi3ValueReference[], size_t, fmi3InstanceEnvironment, fmi3LogMessageCallback,
                         fmi3IntermediateUpdateCallback);
    *(void **)&make = need("fmi3InstantiateCoSimulation");
    return make("unit", token, resources, false, true, false, false, NULL, 0, NULL, note3, NULL);
}

static void set(void *instance, unsigned reference, char type, const char *text)
{
    const double real = strtod(text, NULL);
    const int whole = atoi(text);
    const long long wide = whole;
    const bool truth = whole != 0;
    const void *value = type == 'r' ? (const void *)&real : (const void *)&whole;
    const char *name = type == 'r' ? "fmi2SetReal" : type == 'b' ? "fmi2SetBoolean" : "fmi2SetInteger";
    if (fmi == 2) {
        int (*call)(void *, const unsigned *, size_t, const void *);
        *(void **)&call = need(name);
        check(call(instance, &reference, 1, value), name);
        return;
    }
    int (*call)(void *, const unsigned *, size_t, const void *, size_t);
    if (type == 'e')
        value = &wide;
    if (type == 'b')
        value = &truth;
    name = type == 'r' ? "fmi3SetFloat64" : type == 'b' ? "fmi3SetBoolean" : type == 'e' ? "fmi3SetInt64" : "fmi3SetInt32";
    *(void **)&call = need(name);
    check(call(instance, &reference, 1, value, 1), name);
}

static double get(void *instance, unsigned reference, char type)
{
    double real = 0.0;
    int whole = 0;
    long long wide = 0;
    bool truth = false;
    void *value = type == 'r' ? (void *)&real : (void *)&whole;
    const char *name = type == 'r' ? "fmi2GetReal" : type == 'b' ? "fmi2GetBoolean" : "fmi2GetInteger";
    if (fmi == 2) {
        int (*call)(void *, const unsigned *, size_t, void *);
        *(void **)&call = need(name);
        check(call(instance, &reference, 1, value), name);
        return type == 'r' ? real : whole;
    }
    int (*call)(void *, const unsigned *, size_t, void *, size_t);
    if (type == 'e')
        value = &wide;
    if (type == 'b')
        value = &truth;
    name = type == 'r' ? "fmi3GetFloat64" : type == 'b' ? "fmi3GetBoolean" : type == 'e' ? "fmi3GetInt64" : "fmi3GetInt32";
    *(void **)&call = need(name);
    check(call(instance, &reference, 1, value, 1), name);
    return type == 'r' ? real : type == 'e' ? (double)wide : type == 'b' ? (double)truth : whole;
}

static void initialize(void *instance)
{
    int (*plain)(void *);
    if (fmi == 2) {
        int (*setup)(void *, int, double, double, int, double);
        *(void **)&setup = need("fmi2SetupExperiment");
        check(setup(instance, 0, 0.0, 0.0, 0, 0.0), "fmi2SetupExperiment");
        *(void **)&plain = need("fmi2EnterInitializationMode");
        check(plain(instance), "fmi2EnterInitializationMode");
    } else {
        int (*enter)(void *, bool, double, double, bool, double);
        *(void **)&enter = need("fmi3EnterInitializationMode");
        check(enter(instance, false, 0.0, 0.0, false, 0.0), "fmi3EnterInitializationMode");
    }
    const char *name = fmi == 2 ? "fmi2ExitInitializationMode" : "fmi3ExitInitializationMode";
    *(void **)&plain = need(name);
    check(plain(instance), name);
}

static void step(const Unit *unit, int k, double size)
{
    if (fmi == 2) {
        int (*call)(void *, double, double, int);
        *(void **)&call = need("fmi2DoStep");
        check(call(unit->instance, k * size, size, 1), "fmi2DoStep");
        return;
    }
    bool event, end, early;
    double last;
    int (*call)(void *, double, double, bool, bool *, bool *, bool *, double *);
    *(void **)&call = need("fmi3DoStep");
    check(call(unit->instance, k * size, size, true, &event, &end, &early, &last), "fmi3DoStep");
}

static void show(const Unit *unit)
{
    printf("ROW");
    for (int i = 0; i < unit->outputs; i++)
        printf(" %.17g", get(unit->instance, unit->references[i], unit->types[i]));
    printf("\n");
}

/* Saves the state of a unit, steps on, and goes back to it by its bytes. */
static void back(const Unit *unit, int from, int to, double size)
{
    void *state = NULL, *read = NULL;
    size_t length = 0;
    int (*save)(void *, void **), (*restore)(void *, void *), (*measure)(void *, void *, size_t *);
    int (*write)(void *, void *, unsigned char *, size_t), (*parse)(void *, const unsigned char *, size_t, void **);
    const char *names[2][5] = {{"fmi2GetFMUstate", "fmi2SetFMUstate", "fmi2SerializedFMUstateSize",
                                "fmi2SerializeFMUstate", "fmi2DeSerializeFMUstate"},
                               {"fmi3GetFMUState", "fmi3SetFMUState", "fmi3SerializedFMUStateSize",
                                "fmi3SerializeFMUState", "fmi3DeserializeFMUState"}};
    const char **name = names[fmi - 2];
    *(void **)&save = need(name[0]);
    *(void **)&restore = need(name[1]);
    *(void **)&measure = need(name[2]);
    *(void **)&write = need(name[3]);
    *(void **)&parse = need(name[4]);
    check(save(unit->instance, &state), name[0]);
    check(measure(unit->instance, state, &length), name[2]);
    unsigned char *bytes = malloc(length);
    check(write(unit->instance, state, bytes, length), name[3]);
    for (int k = from; k < to; k++)
        step(unit, k, size);
    check(parse(unit->instance, bytes, length, &read), name[4]);
    check(restore(unit->instance, read), name[1]);
    free(bytes);
    *(void **)&save = need(fmi == 2 ? "fmi2FreeFMUstate" : "fmi3FreeFMUState");
    check(save(unit->instance, &state), "FreeFMUState");
    check(save(unit->instance, &read), "FreeFMUState");
}

int main(int count, char **words)
{
    static Unit units[LONGEST];
    int number = 0;
    if (count < 9)
        return 2;
    library = dlopen(words[1], RTLD_NOW);
    if (!library) {
        printf("%s\n", dlerror());
        return 3;
    }
    fmi = atoi(words[2]);
    const double size = strtod(words[5], NULL);
    const int steps = atoi(words[6]);
    for (int i = 8; i < count; i++) {
        Unit *unit = &units[number - 1];
        char type = 0;
        int start = 0;
        unsigned reference = 0;
        if (words[i][0] == '(' && number < LONGEST) {
            units[number].instance = made(words[3], words[4]);
            if (!units[number++].instance) {
                printf("not instantiated\n");
                return 4;
            }
        } else if (sscanf(words[i], "p%u:%c=%n", &reference, &type, &start) == 2 && start) {
            set(unit->instance, reference, type, words[i] + start);
        } else if (sscanf(words[i], "o%u:%c", &reference, &type) == 2 && unit->outputs < MOST) {
            unit->references[unit->outputs] = reference;
            unit->types[unit->outputs++] = type;
        }
    }
    for (int n = 0; n < number; n++)
        initialize(units[n].instance);
    for (int k = 0; k < steps; k++) {
        if (atoi(words[7]) && k == steps / 2)
            back(&units[0], k, steps, size);
        for (int n = 0; n < number; n++) {
            step(&units[n], k, size);
            show(&units[n]);
        }
    }
    for (int n = 0; n < number; n++) {
        int (*terminate)(void *);
        void (*release)(void *);
        *(void **)&terminate = need(fmi == 2 ? "fmi2Terminate" : "fmi3Terminate");
        *(void **)&release = need(fmi == 2 ? "fmi2FreeInstance" : "fmi3FreeInstance");
        check(terminate(units[n].instance), "Terminate");
        release(units[n].instance);
    }
    return 0;
}
