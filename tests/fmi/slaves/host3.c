/* A host of FMI 3.0 with the FMU as a part of it: HOST TOKEN INPUT OUTPUT, variables by reference. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi3Functions.h"

static int complaints;

static void log_it(fmi3InstanceEnvironment e, fmi3Status status, fmi3String category,
                   fmi3String message) {
    (void)e, (void)status, (void)category;
    if (strlen(message)) complaints++;
}

#define NEEDS(condition)                                                                        \
    if (!(condition)) return fprintf(stderr, "%s\n", #condition), 1

/* All that is done wrong is refused, and does no harm. */
static int refuses(fmi3Instance c, fmi3ValueReference input) {
    fmi3Float64 values[8];
    fmi3Float32 single;
    fmi3String texts[2000];
    fmi3ValueReference references[2000] = {0}, nothing = 0xFFFFE;
    fmi3Binary bytes;
    size_t size;
    const int before = complaints;
    NEEDS(fmi3GetFloat64(c, &nothing, 1, values, 1) == fmi3Error);
    NEEDS(fmi3GetFloat64(c, &input, 1, values, 7) == fmi3Error);
    NEEDS(fmi3SetFloat64(c, &input, 1, values, 7) == fmi3Error);
    NEEDS(fmi3GetFloat32(c, &nothing, 1, &single, 1) == fmi3Error);
    NEEDS(fmi3GetFloat32(c, NULL, 0, NULL, 0) == fmi3OK);
    NEEDS(fmi3GetString(c, references, 2000, texts, 2000) == fmi3Error);
    NEEDS(fmi3GetBinary(c, &input, 1, &size, &bytes, 1) == fmi3Error);
    NEEDS(fmi3EnterEventMode(c) == fmi3Error);
    NEEDS(fmi3SetFMUState(c, NULL) == fmi3Error);
    NEEDS(complaints == before + 8);
    return 0;
}

int main(int argc, char **argv) {
    if (argc != 4) return 2;
    const fmi3ValueReference input = (fmi3ValueReference)strtoul(argv[2], NULL, 0);
    const fmi3ValueReference output = (fmi3ValueReference)strtoul(argv[3], NULL, 0);
    const size_t inputs = (input >> 20) + 1, outputs = (output >> 20) + 1;
    fmi3Float64 given[64] = {0.0}, found[2][64] = {{0.0}}, last;
    fmi3Boolean event, ends, early;
    NEEDS(!fmi3InstantiateModelExchange("x", argv[1], "", 0, 0, NULL, log_it));
    NEEDS(!fmi3InstantiateCoSimulation("x", argv[1], "", 0, 0, 1, 0, NULL, 0, NULL, log_it, NULL));
    NEEDS(!fmi3InstantiateCoSimulation("x", "other", "", 0, 0, 0, 0, NULL, 0, NULL, NULL, NULL));
    fmi3Instance c =
        fmi3InstantiateCoSimulation("x", argv[1], "/x y/", 0, 1, 0, 1, NULL, 0, NULL, log_it, NULL);
    NEEDS(c && fmi3EnterInitializationMode(c, 0, 0.0, 0.0, 1, 2.0) == fmi3OK);
    NEEDS(fmi3ExitInitializationMode(c) == fmi3OK);
    if (refuses(c, input)) return 1;
    fmi3FMUState kept = NULL, again = NULL;
    NEEDS(fmi3GetFMUState(c, &kept) == fmi3OK);
    size_t size;
    NEEDS(fmi3SerializedFMUStateSize(c, kept, &size) == fmi3OK);
    fmi3Byte *bytes = malloc(size);
    NEEDS(fmi3SerializeFMUState(c, kept, bytes, size) == fmi3OK);
    NEEDS(fmi3SerializeFMUState(c, kept, bytes, 4) == fmi3Error);
    NEEDS(fmi3DeserializeFMUState(c, bytes, size - 1, &again) == fmi3Error);
    NEEDS(fmi3DeserializeFMUState(c, bytes, size, &again) == fmi3OK);
    for (int twice = 0; twice < 2; twice++) {
        NEEDS(fmi3SetFMUState(c, twice ? again : kept) == fmi3OK);
        for (int k = 0; k < 100; k++) {
            for (size_t i = 0; i < inputs; i++) given[i] = 0.1 * (double)(k % 7) - 0.02 * (double)i;
            NEEDS(fmi3SetFloat64(c, &input, 1, given, inputs) == fmi3OK);
            NEEDS(fmi3DoStep(c, k * 0.01, 0.01, 0, &event, &ends, &early, &last) == fmi3OK);
            NEEDS(!event && !ends && !early && last > k * 0.01);
        }
        NEEDS(fmi3GetFloat64(c, &output, 1, found[twice], outputs) == fmi3OK);
    }
    NEEDS(memcmp(found[0], found[1], sizeof found[0]) == 0);
    const fmi3ValueReference time = 0xFFFFF, both[2] = {output, time};
    NEEDS(fmi3GetFloat64(c, both, 2, found[0], outputs + 1) == fmi3OK);
    NEEDS(found[0][outputs] == 1.0 || found[0][outputs] == 99 * 0.01 + 0.01);
    free(bytes);
    fmi3FreeFMUState(c, &again);
    fmi3FreeFMUState(c, &kept);
    NEEDS(fmi3Terminate(c) == fmi3OK && fmi3Reset(c) == fmi3OK);
    fmi3FreeInstance(c);
    printf("%d complaints\n", complaints);
    return 0;
}
