/* An FMI 2.0 co-simulation slave that passes its inputs on, and dies in the ways of C code. */

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "fmi2FunctionTypes.h"

enum { FINE, SEGFAULT, ABORT, EXIT, HANG, PRINT, LOG, REFUSE, DIE_AT_THE_END, DIE_IN_THE_RELEASE };

static double real_value;
static int integer_value, boolean_value, how;
static char text[256];
static fmi2CallbackFunctions calls;
static fmi2ComponentEnvironment environment;

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return "2.0"; }

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String place,
                              const fmi2CallbackFunctions *functions, fmi2Boolean visible,
                              fmi2Boolean logging) {
    calls = *functions;
    environment = functions->componentEnvironment;
    return &real_value;
}
void fmi2FreeInstance(fmi2Component c) {
    if (how == DIE_IN_THE_RELEASE) abort();
}
fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String k[]) {
    return fmi2OK;
}
fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean b, fmi2Real tolerance, fmi2Real start,
                               fmi2Boolean stops, fmi2Real stop) {
    return fmi2OK;
}
fmi2Status fmi2EnterInitializationMode(fmi2Component c) { return fmi2OK; }
fmi2Status fmi2ExitInitializationMode(fmi2Component c) { return fmi2OK; }
fmi2Status fmi2Terminate(fmi2Component c) {
    if (how == DIE_AT_THE_END) abort();
    return fmi2OK;
}
fmi2Status fmi2Reset(fmi2Component c) { return fmi2OK; }

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2Real v[]) {
    for (size_t i = 0; i < n; i++) v[i] = real_value;
    return real_value == -78.0 ? fmi2Error : fmi2OK;
}
fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2Integer v[]) {
    for (size_t i = 0; i < n; i++) v[i] = integer_value;
    return fmi2OK;
}
fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2Boolean v[]) {
    for (size_t i = 0; i < n; i++) v[i] = boolean_value;
    return fmi2OK;
}
fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2String v[]) {
    for (size_t i = 0; i < n; i++) v[i] = text;
    return fmi2OK;
}
fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2Real v[]) {
    if (v[0] == -77.0) {
        calls.logger(environment, "crash", fmi2Error, "error", "no such number");
        return fmi2Error;
    }
    real_value = v[0];
    return fmi2OK;
}
fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference r[], size_t n,
                          const fmi2Integer v[]) {
    for (size_t i = 0; i < n; i++) *(r[i] == 9 ? &how : &integer_value) = v[i];
    return fmi2OK;
}
fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference r[], size_t n,
                          const fmi2Boolean v[]) {
    boolean_value = v[0];
    return fmi2OK;
}
fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference r[], size_t n,
                         const fmi2String v[]) {
    strncpy(text, v[0], sizeof text - 1);
    return fmi2OK;
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real t, fmi2Real h, fmi2Boolean last) {
    if (t < 0.25) return fmi2OK;
    switch (how) {
    case SEGFAULT: *(volatile int *)8 = 1; break;
    case ABORT: abort();
    case EXIT: exit(7);
    case HANG: for (;;) pause();
    case PRINT: printf("printed at %g\n", t); break;
    case LOG:
        calls.logger(environment, "crash", fmi2OK, "info", "sailing at %g %%", t);
        calls.logger(environment, "crash", fmi2Warning, "warning", "reefing");
        break;
    case REFUSE: return fmi2Discard;
    }
    return fmi2OK;
}

#define UNUSED(function) fmi2Status function() { return fmi2Error; }
UNUSED(fmi2GetFMUstate)
UNUSED(fmi2SetFMUstate)
UNUSED(fmi2FreeFMUstate)
UNUSED(fmi2SerializedFMUstateSize)
UNUSED(fmi2SerializeFMUstate)
UNUSED(fmi2DeSerializeFMUstate)
UNUSED(fmi2GetDirectionalDerivative)
UNUSED(fmi2SetRealInputDerivatives)
UNUSED(fmi2GetRealOutputDerivatives)
UNUSED(fmi2CancelStep)
UNUSED(fmi2GetStatus)
UNUSED(fmi2GetRealStatus)
UNUSED(fmi2GetIntegerStatus)
UNUSED(fmi2GetBooleanStatus)
UNUSED(fmi2GetStringStatus)
