/* CPU time of an FMU's steps of 10 ms with all real inputs set before and outputs read after:
   STEPS LIBRARY GUID COUNT INPUTS OUTPUTS [value reference] ...; prints us. */
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "fmi2FunctionTypes.h"

#define MOST 1000
#define GET(name) name##TYPE *name##_ = (name##TYPE *)dlsym(library, #name)

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

int main(int argc, char **argv) {
    if (argc < 6) return 2;
    void *library = dlopen(argv[1], RTLD_NOW);
    if (!library) return fprintf(stderr, "%s\n", dlerror()), 3;
    GET(fmi2Instantiate);
    GET(fmi2SetupExperiment);
    GET(fmi2EnterInitializationMode);
    GET(fmi2ExitInitializationMode);
    GET(fmi2DoStep);
    GET(fmi2GetReal);
    GET(fmi2SetReal);
    const int steps = atoi(argv[3]);
    const size_t inputs = (size_t)atoi(argv[4]), outputs = (size_t)atoi(argv[5]);
    if (inputs > MOST || outputs > MOST || argc != 6 + (int)(inputs + outputs)) return 4;
    fmi2ValueReference set[MOST], get[MOST];
    fmi2Real values[MOST], found[MOST];
    for (size_t i = 0; i < inputs; i++) set[i] = (fmi2ValueReference)atoi(argv[6 + i]);
    for (size_t i = 0; i < outputs; i++) get[i] = (fmi2ValueReference)atoi(argv[6 + inputs + i]);
    const fmi2CallbackFunctions functions = {NULL, calloc, free, NULL, NULL};
    fmi2Component c = fmi2Instantiate_("x", fmi2CoSimulation, argv[2], "", &functions, 0, 0);
    if (!c || fmi2SetupExperiment_(c, 0, 0.0, 0.0, 0, 0.0) != fmi2OK) return 5;
    if (fmi2EnterInitializationMode_(c) != fmi2OK || fmi2ExitInitializationMode_(c) != fmi2OK)
        return 6;
    if (fmi2GetReal_(c, set, inputs, values) != fmi2OK) return 7;
    double begun = 0.0;
    for (int k = -steps / 10; k < steps; k++) {
        if (k == 0) begun = now();
        for (size_t i = 0; i < inputs; i++) values[i] += 1e-9;
        if (fmi2SetReal_(c, set, inputs, values) != fmi2OK) return 8;
        if (fmi2DoStep_(c, (k + steps / 10) * 0.01, 0.01, 1) != fmi2OK) return 9;
        if (fmi2GetReal_(c, get, outputs, found) != fmi2OK) return 10;
    }
    printf("%.6f\n", (now() - begun) / steps * 1e6);
    return 0;
}
