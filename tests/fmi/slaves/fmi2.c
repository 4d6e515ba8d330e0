/* An FMI 2.0 slave: x' = -k x, a gain on every type, steps refused on demand, whole state. */

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2FunctionTypes.h"

enum { K, INTERNAL_STEP, GAIN, LARGEST_STEP, U, Q1, Q2, X, Y, P1, P2, SPEED, ECHO, TROUBLE_TIME, REALS };
enum { TROUBLE, I, J, MODE_IN, MODE, NEVER_BACK, INTEGERS };
enum { FINE, NOT_A_NUMBER, DISCARD, ERROR, FATAL, WARN, BAD_START, NEGATIVE, BEYOND, END };

typedef struct {
    fmi2CallbackFunctions calls;
    double real[REALS], time, stop, step;
    int integer[INTEGERS], boolean[2];
    char text[2][64];
} Slave;

static fmi2Status say(Slave *s, fmi2Status status, const char *message) {
    s->calls.logger(s->calls.componentEnvironment, "fmi2", status, "all", "%s", message);
    return status;
}

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return "2.0"; }

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String place,
                              const fmi2CallbackFunctions *functions, fmi2Boolean visible,
                              fmi2Boolean logging) {
    Slave *s = calloc(1, sizeof *s);
    s->calls = *functions;
    s->real[K] = s->real[X] = 1.0;
    s->real[GAIN] = 2.0;
#ifdef SHOWS_FLAGS
    s->real[X] = logging;
#endif
    return s;
}
void fmi2FreeInstance(fmi2Component c) { free(c); }
fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String k[]) {
    return fmi2OK;
}
fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean b, fmi2Real tolerance, fmi2Real start,
                               fmi2Boolean stops, fmi2Real stop) {
    Slave *s = c;
    s->time = start;
    s->stop = stops ? stop : INFINITY;
#ifdef SHOWS_TOLERANCE
    s->real[X] = b ? tolerance : -1.0;
#endif
    return fmi2OK;
}
fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
    Slave *s = c;
    return s->integer[TROUBLE] == BAD_START ? say(s, fmi2Error, "there is no start") : fmi2OK;
}
fmi2Status fmi2ExitInitializationMode(fmi2Component c) { return fmi2OK; }
fmi2Status fmi2Terminate(fmi2Component c) { return fmi2OK; }
fmi2Status fmi2Reset(fmi2Component c) { return fmi2OK; }

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2Real v[]) {
    Slave *s = c;
    double *x = s->real;
    x[Y] = x[GAIN] * x[U];
    x[P1] = x[GAIN] * x[Q1];
    x[P2] = x[GAIN] * x[Q2];
    x[ECHO] = x[SPEED];
    for (size_t i = 0; i < n; i++) v[i] = x[r[i]];
    return fmi2OK;
}
fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2Integer v[]) {
    Slave *s = c;
    s->integer[J] = 2 * s->integer[I];
    s->integer[MODE] = s->integer[MODE_IN];
    for (size_t i = 0; i < n; i++) v[i] = s->integer[r[i]];
    return fmi2OK;
}
fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2Boolean v[]) {
    Slave *s = c;
    s->boolean[1] = !s->boolean[0];
    for (size_t i = 0; i < n; i++) v[i] = s->boolean[r[i]];
    return fmi2OK;
}
fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2String v[]) {
    Slave *s = c;
    strcpy(s->text[1], s->text[0]);
    for (size_t i = 0; i < n; i++) v[i] = s->text[r[i]];
    return fmi2OK;
}
fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2Real v[]) {
    for (size_t i = 0; i < n; i++) ((Slave *)c)->real[r[i]] = v[i];
    return fmi2OK;
}
fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference r[], size_t n,
                          const fmi2Integer v[]) {
    for (size_t i = 0; i < n; i++) ((Slave *)c)->integer[r[i]] = v[i];
    return fmi2OK;
}
fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference r[], size_t n,
                          const fmi2Boolean v[]) {
    for (size_t i = 0; i < n; i++) ((Slave *)c)->boolean[r[i]] = v[i];
    return fmi2OK;
}
fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference r[], size_t n,
                         const fmi2String v[]) {
    for (size_t i = 0; i < n; i++) strncpy(((Slave *)c)->text[r[i]], v[i], 63);
    return fmi2OK;
}

static fmi2Status trouble(Slave *s) {
    switch (s->integer[TROUBLE]) {
    case NOT_A_NUMBER: s->real[X] = NAN; return fmi2OK;
    case DISCARD: return say(s, fmi2Discard, "not such a step");
    case ERROR: return say(s, fmi2Error, "100% wrong");
    case FATAL: free(s); return fmi2Fatal;
    case NEGATIVE: return (fmi2Status)-1;
    case BEYOND: return (fmi2Status)6;
    case END: return fmi2Discard;
    case WARN: return say(s, fmi2Warning, "reefing");
    }
    return fmi2OK;
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real t, fmi2Real h, fmi2Boolean never_back) {
    Slave *s = c;
    double *x = s->real;
    s->integer[NEVER_BACK] = never_back;
    if (fabs(t - s->time) > 1e-9) return say(s, fmi2Error, "steps do not follow each other");
#ifdef STRICT /* as some tools' FMUs are */
    if (t != s->time) return say(s, fmi2Error, "it is another time");
    if (t + h > s->stop) return say(s, fmi2Error, "it is beyond the stop time");
#endif
#ifdef COUNTS /* steps of another length than the one before */
    if (s->step != 0.0 && h != s->step) s->integer[I]++;
    s->step = h;
#endif
#ifdef COMMITS /* it keeps a step only if nobody goes back before it */
    if (!never_back) {
        s->time = t + h;
        return fmi2OK;
    }
#endif
    if (x[LARGEST_STEP] > 0 && h > x[LARGEST_STEP] * (1 + 1e-9)) {
        return say(s, fmi2Discard, "the step is too large");
    }
    if (x[INTERNAL_STEP] > 0) {
        long steps = lround(h / x[INTERNAL_STEP]);
        for (long i = 0; i < steps; i++) x[X] -= x[K] * x[X] * x[INTERNAL_STEP];
    } else {
        x[X] *= exp(-x[K] * h);
    }
    s->time = t + h;
    return s->time > x[TROUBLE_TIME] ? trouble(s) : fmi2OK;
}

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *s) {
    if (!*s) *s = malloc(sizeof(Slave));
    memcpy(*s, c, sizeof(Slave));
    return fmi2OK;
}
fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate s) {
    memcpy(c, s, sizeof(Slave));
    return fmi2OK;
}
fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *s) {
    free(*s);
    *s = NULL;
    return fmi2OK;
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *ends) {
    *ends = fmi2True;
    return ((Slave *)c)->integer[TROUBLE] == END ? fmi2OK : fmi2Error;
}
fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *time) {
    *time = ((Slave *)c)->time;
    return ((Slave *)c)->integer[TROUBLE] == END ? fmi2OK : fmi2Error;
}

#define UNUSED(function) fmi2Status function() { return fmi2Error; }
UNUSED(fmi2SerializedFMUstateSize)
UNUSED(fmi2SerializeFMUstate)
UNUSED(fmi2DeSerializeFMUstate)
UNUSED(fmi2GetDirectionalDerivative)
UNUSED(fmi2SetRealInputDerivatives)
UNUSED(fmi2GetRealOutputDerivatives)
UNUSED(fmi2CancelStep)
UNUSED(fmi2GetStatus)
UNUSED(fmi2GetIntegerStatus)
UNUSED(fmi2GetStringStatus)
