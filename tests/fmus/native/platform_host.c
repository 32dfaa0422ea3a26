/* Runs an FMU of FMI 2.0 in its library, without Python: platform_host LIBRARY TOKEN STEPS REFERENCE...
   The first reference is a Real input, the others are Real outputs; prints them after each step, exactly. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#ifdef _WIN32
#include <windows.h>
#define OPEN(path) ((void *)LoadLibraryA(path))
#define FIND(library, name) ((void *)GetProcAddress((HMODULE)library, name))
#else
#include <dlfcn.h>
#define OPEN(path) dlopen(path, RTLD_NOW)
#define FIND(library, name) dlsym(library, name)
#endif

#include "fmi2_types.h"

static void note(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category,
                 fmi2String text, ...)
{
    (void)environment;
    printf("%s %d %s %s\n", name, (int)status, category, text);
}

int main(int count, char **words)
{
    const fmi2CallbackFunctions callbacks = {note, NULL, NULL, NULL, NULL};
    fmi2Component (*make)(fmi2String, fmi2Type, fmi2String, fmi2String, const fmi2CallbackFunctions *, fmi2Boolean,
                          fmi2Boolean);
    fmi2Status (*setup)(fmi2Component, fmi2Boolean, fmi2Real, fmi2Real, fmi2Boolean, fmi2Real);
    fmi2Status (*enter)(fmi2Component), (*leave)(fmi2Component);
    fmi2Status (*set)(fmi2Component, const fmi2ValueReference[], size_t, const fmi2Real[]);
    fmi2Status (*get)(fmi2Component, const fmi2ValueReference[], size_t, fmi2Real[]);
    fmi2Status (*step)(fmi2Component, fmi2Real, fmi2Real, fmi2Boolean);
    fmi2ValueReference references[16];
    fmi2Real values[16];
    const size_t outputs = (size_t)count - 5;
    void *library = count > 5 && count < 20 ? OPEN(words[1]) : NULL;
    if (!library)
        return 2;
    *(void **)&make = FIND(library, "fmi2Instantiate");
    *(void **)&setup = FIND(library, "fmi2SetupExperiment");
    *(void **)&enter = FIND(library, "fmi2EnterInitializationMode");
    *(void **)&leave = FIND(library, "fmi2ExitInitializationMode");
    *(void **)&set = FIND(library, "fmi2SetReal");
    *(void **)&get = FIND(library, "fmi2GetReal");
    *(void **)&step = FIND(library, "fmi2DoStep");
    for (int k = 4; k < count; k++)
        references[k - 4] = (fmi2ValueReference)atoi(words[k]);
    fmi2Component unit = make("unit", fmi2CoSimulation, words[2], "", &callbacks, 0, 1);
    if (!unit || setup(unit, 0, 0.0, 0.0, 0, 0.0) || enter(unit) || leave(unit))
        return 3;
    for (int k = 0; k < atoi(words[3]); k++) {
        const fmi2Real input = k % 7 - 3;
        if (set(unit, references, 1, &input) || step(unit, 0.01 * k, 0.01, 1) ||
            get(unit, references + 1, outputs, values))
            return 4;
        for (size_t i = 0; i < outputs; i++)
            printf("%a%c", values[i], i + 1 < outputs ? ' ' : '\n');
    }
    set(unit, references + 1, 1, values); /* refused, with a message */
    return 0;
}
