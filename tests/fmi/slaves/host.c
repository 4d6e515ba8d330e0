/* A host that is a C program alone: HOST LIBRARY GUID; with -DLINKED the FMU is a part of it. */
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include "fmi2FunctionTypes.h"

#ifdef LINKED
#include "fmi2Functions.h"
#define GET(name) name##TYPE *name##_ = name
#else
#include <dlfcn.h>
#define GET(name) name##TYPE *name##_ = (name##TYPE *)dlsym(library, #name)
#endif

static void log_it(fmi2ComponentEnvironment e, fmi2String name, fmi2Status status,
                   fmi2String category, fmi2String format, ...) {
    (void)e, (void)name, (void)status, (void)category;
    va_list arguments;
    va_start(arguments, format);
    vfprintf(stderr, format, arguments);
    va_end(arguments);
}

int main(int argc, char **argv) {
    if (argc != 3) return 2;
#ifndef LINKED
    void *library = dlopen(argv[1], RTLD_NOW | RTLD_LOCAL);
    if (!library) return fprintf(stderr, "%s\n", dlerror()), 3;
#endif
    GET(fmi2Instantiate);
    GET(fmi2SetupExperiment);
    GET(fmi2EnterInitializationMode);
    GET(fmi2ExitInitializationMode);
    GET(fmi2DoStep);
    GET(fmi2GetFMUstate);
    GET(fmi2SetFMUstate);
    GET(fmi2FreeFMUstate);
    GET(fmi2Terminate);
    GET(fmi2FreeInstance);
    fmi2CallbackFunctions functions = {log_it, calloc, free, NULL, NULL};
    fmi2Component c = fmi2Instantiate_("x", fmi2CoSimulation, argv[2], "", &functions, 0, 0);
    if (!c || fmi2SetupExperiment_(c, 0, 0.0, 0.0, 0, 0.0) != fmi2OK) return 4;
    if (fmi2EnterInitializationMode_(c) != fmi2OK || fmi2ExitInitializationMode_(c) != fmi2OK)
        return 5;
    fmi2FMUstate kept = NULL;
    if (fmi2GetFMUstate_(c, &kept) != fmi2OK) return 6;
    for (int twice = 0; twice < 2; twice++) {
        if (fmi2SetFMUstate_(c, kept) != fmi2OK) return 7;
        for (int k = 0; k < 100; k++)
            if (fmi2DoStep_(c, k * 0.01, 0.01, 1) != fmi2OK) return 8;
    }
    fmi2FreeFMUstate_(c, &kept);
    fmi2Terminate_(c);
    fmi2FreeInstance_(c);
    printf("stepped to 1 s\n");
    return 0;
}
