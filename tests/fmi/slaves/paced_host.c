/* A host that is a C program alone, in real time:
   HOST LIBRARY GUID RESOURCES SECONDS [REFERENCE TEXT]... sets texts, and steps by 10 ms. */
#include <dlfcn.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "fmi2FunctionTypes.h"

#define GET(name) name##TYPE *name##_ = (name##TYPE *)dlsym(library, #name)

static void log_it(fmi2ComponentEnvironment e, fmi2String name, fmi2Status status,
                   fmi2String category, fmi2String format, ...) {
    (void)e, (void)name, (void)status, (void)category;
    va_list arguments;
    va_start(arguments, format);
    vfprintf(stderr, format, arguments);
    va_end(arguments);
    fputc('\n', stderr);
}

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec + 1e-9 * t.tv_nsec;
}

int main(int argc, char **argv) {
    if (argc < 5) return 2;
    double begun = now();
    void *library = dlopen(argv[1], RTLD_NOW | RTLD_LOCAL);
    if (!library) return fprintf(stderr, "%s\n", dlerror()), 3;
    GET(fmi2Instantiate);
    GET(fmi2SetupExperiment);
    GET(fmi2SetString);
    GET(fmi2EnterInitializationMode);
    GET(fmi2ExitInitializationMode);
    GET(fmi2DoStep);
    GET(fmi2Terminate);
    GET(fmi2FreeInstance);
    fmi2CallbackFunctions functions = {log_it, calloc, free, NULL, NULL};
    fmi2Component c =
        fmi2Instantiate_("x", fmi2CoSimulation, argv[2], argv[3], &functions, 0, 0);
    if (!c) return 4;
    for (int i = 5; i + 1 < argc; i += 2) {
        fmi2ValueReference reference = (fmi2ValueReference)atoi(argv[i]);
        fmi2String text = argv[i + 1];
        if (fmi2SetString_(c, &reference, 1, &text) != fmi2OK) return 5;
    }
    if (fmi2SetupExperiment_(c, 0, 0.0, 0.0, 0, 0.0) != fmi2OK) return 6;
    if (fmi2EnterInitializationMode_(c) != fmi2OK || fmi2ExitInitializationMode_(c) != fmi2OK)
        return 7;
    double first = now(), seconds = atof(argv[4]);
    for (int k = 0; 0.01 * k < seconds; k++) {
        if (fmi2DoStep_(c, 0.01 * k, 0.01, 1) != fmi2OK) return 8;
        double left = first + 0.01 * (k + 1) - now();
        struct timespec pause = {0, left > 0.0 ? (long)(left * 1e9) : 0};
        nanosleep(&pause, NULL);
    }
    fmi2Terminate_(c);
    fmi2FreeInstance_(c);
    printf("ready after %.2f s\n", first - begun);
    return 0;
}
