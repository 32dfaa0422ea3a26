/* A host that is no Python program: host LIBPYTHON FMU.so GUID RESOURCES NAME WAY...
 *
 * It loads libpython for all, then the FMU's library, and does a run of ten steps for each WAY that is "run";
 * "zero", "negative", "nan" and "ended" do one doStep more that must fail, "close" unloads the library,
 * "interrupt" sends SIGINT to itself. Messages of the FMU and statuses are printed.
 */
#include <dlfcn.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    void (*logger)(void *, const char *, int, const char *, const char *, ...);
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*finished)(void *, int);
    void *environment;
} Callbacks;

typedef void *(*Instantiate)(const char *, int, const char *, const char *, const Callbacks *, int, int);
typedef int (*Setup)(void *, int, double, double, int, double);
typedef int (*Plain)(void *);
typedef int (*Step)(void *, double, double, int);
typedef void (*Free)(void *);

static void logger(void *environment, const char *name, int status, const char *category, const char *text, ...) {
    printf("log %d %s\n", status, text);
    fflush(stdout);
}

static void own(int signal) {
    printf("the host's own handler\n");
    fflush(stdout);
}

static void *need(void *library, const char *name) {
    void *found = dlsym(library, name);
    if (!found) {
        printf("%s is missing\n", name);
        exit(3);
    }
    return found;
}

int main(int count, char **words) {
    if (!dlopen(words[1], RTLD_NOW | RTLD_GLOBAL)) {
        printf("%s\n", dlerror());
        return 3;
    }
    if (count > 6 && !strcmp(words[6], "handled")) signal(SIGINT, own);
    void *library = dlopen(words[2], RTLD_NOW);
    if (!library) {
        printf("%s\n", dlerror());
        return 3;
    }
    Callbacks callbacks = {logger, calloc, free, NULL, NULL};
    for (int i = 6; i < count; i++) {
        Instantiate instantiate = (Instantiate)need(library, "fmi2Instantiate");
        void *unit = instantiate("it", 1, words[3], words[4], &callbacks, 0, 1);
        if (!unit) {
            printf("not instantiated\n");
            return 4;
        }
        int bad = ((Setup)need(library, "fmi2SetupExperiment"))(unit, 0, 0.0, 0.0, 0, 0.0);
        bad |= ((Plain)need(library, "fmi2EnterInitializationMode"))(unit);
        bad |= ((Plain)need(library, "fmi2ExitInitializationMode"))(unit);
        Step step = (Step)need(library, "fmi2DoStep");
        for (int k = 0; k < 10; k++) bad |= step(unit, 0.01 * k, 0.01, 1);
        if (bad) printf("a call failed\n");
        if (!strcmp(words[i], "zero")) printf("status %d\n", step(unit, 0.1, 0.0, 1));
        if (!strcmp(words[i], "negative")) printf("status %d\n", step(unit, 0.1, -0.01, 1));
        if (!strcmp(words[i], "nan")) printf("status %d\n", step(unit, 0.1, NAN, 1));
        if (!strcmp(words[i], "interrupt") || !strcmp(words[i], "handled")) raise(SIGINT);
        if (((Plain)need(library, "fmi2Terminate"))(unit)) printf("not terminated\n");
        if (!strcmp(words[i], "ended")) printf("status %d\n", step(unit, 0.1, 0.01, 1));
        ((Free)need(library, "fmi2FreeInstance"))(unit);
        if (!strcmp(words[i], "close")) {
            dlclose(library);
            library = dlopen(words[2], RTLD_NOW);
        }
    }
    printf("done\n");
    return 0;
}
