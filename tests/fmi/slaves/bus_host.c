/* A host of FMI 3.0 for `events.c`, for sanitizers: in FMI 2.0 a component that sends back the bytes
   that it gets, and counts its steps. Value references: 0 text in, 1 text out, 2 count. */

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "front.h"

typedef struct {
    char in[1 << 16], out[1 << 16];
    int steps;
} Echo;

fmi2Component fmi2Instantiate(fmi2String n, fmi2Type type, fmi2String guid, fmi2String place,
                              const fmi2CallbackFunctions *f, fmi2Boolean v, fmi2Boolean l) {
    return calloc(1, sizeof(Echo));
}
void fmi2FreeInstance(fmi2Component c) { free(c); }
fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean b, fmi2Real x, fmi2Real t, fmi2Boolean s,
                               fmi2Real e) { return fmi2OK; }
fmi2Status fmi2EnterInitializationMode(fmi2Component c) { return fmi2OK; }
fmi2Status fmi2ExitInitializationMode(fmi2Component c) { return fmi2OK; }
fmi2Status fmi2Terminate(fmi2Component c) { return fmi2OK; }
fmi2Status fmi2Reset(fmi2Component c) { memset(c, 0, sizeof(Echo)); return fmi2OK; }
fmi2Status fmi2DoStep(fmi2Component c, fmi2Real t, fmi2Real h, fmi2Boolean last) {
    Echo *e = c;
    strcpy(e->out, e->in);
    e->steps++;
    return fmi2OK;
}
#define NUMBERS(Type)                                                                          \
    fmi2Status fmi2Get##Type(fmi2Component c, const fmi2ValueReference r[], size_t n,          \
                             fmi2##Type v[]) {                                                 \
        for (size_t i = 0; i < n; i++) {                                                       \
            if (r[i] != 2) return fmi2Error;                                                   \
            v[i] = (fmi2##Type)((Echo *)c)->steps;                                             \
        }                                                                                      \
        return fmi2OK;                                                                         \
    }                                                                                          \
    fmi2Status fmi2Set##Type(fmi2Component c, const fmi2ValueReference r[], size_t n,          \
                             const fmi2##Type v[]) { return n ? fmi2Error : fmi2OK; }
NUMBERS(Real)
NUMBERS(Integer)
NUMBERS(Boolean)
fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2String v[]) {
    for (size_t i = 0; i < n; i++) v[i] = r[i] ? ((Echo *)c)->out : ((Echo *)c)->in;
    return fmi2OK;
}
fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference r[], size_t n,
                         const fmi2String v[]) {
    for (size_t i = 0; i < n; i++) strcpy(((Echo *)c)->in, v[i]);
    return fmi2OK;
}
fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *s) {
    if (!*s) *s = malloc(sizeof(Echo));
    memcpy(*s, c, sizeof(Echo));
    return fmi2OK;
}
fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate s) {
    memcpy(c, s, sizeof(Echo));
    return fmi2OK;
}
fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *s) { free(*s); *s = NULL; return fmi2OK; }
fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate s, size_t *size) {
    *size = sizeof(Echo);
    return fmi2OK;
}
fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate s, fmi2Byte bytes[], size_t size) {
    memcpy(bytes, s, sizeof(Echo));
    return size == sizeof(Echo) ? fmi2OK : fmi2Error;
}
fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size,
                                   fmi2FMUstate *s) {
    if (size != sizeof(Echo)) return fmi2Error;
    *s = malloc(sizeof(Echo));
    memcpy(*s, bytes, size);
    return fmi2OK;
}
fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference u[], size_t nu,
                                        const fmi2ValueReference k[], size_t nk, const fmi2Real s[],
                                        fmi2Real v[]) { return fmi2Error; }

/* ------------------------------------------------------------------ the host */

static int complaints, place;
static void complain(fmi3InstanceEnvironment e, fmi3Status s, fmi3String c, fmi3String text) {
    complaints++;
}
#define MUST(is) if (place = __LINE__, !(is)) return printf("line %d\n", place), 1
#define OK(call) MUST((call) == fmi3OK)
#define REFUSED(call) do { int before = complaints; MUST((call) == fmi3Error && complaints > before); } while (0)

static const fmi3ValueReference RX = 0xFFF00000u, RX_CLOCK = RX + 1, TX = RX + 2, TX_CLOCK = RX + 3,
                                NOTIFIES = RX + 4, NONE = RX + 8, COUNT = 2, TEXT = 1;

static fmi3Instance x;
static int count(void) {
    fmi3Int32 n = -1;
    return fmi3GetInt32(x, &COUNT, 1, &n, 1) == fmi3OK ? n : -1;
}
static fmi3Status step(int k, fmi3Boolean *event) {
    fmi3Boolean ends, early;
    fmi3Float64 last;
    return fmi3DoStep(x, 0.125 * k, 0.125, 1, event, &ends, &early, &last);
}
static fmi3Status update(void) {
    fmi3Boolean more, ends, nominals, states, defined;
    fmi3Float64 next;
    return fmi3UpdateDiscreteStates(x, &more, &ends, &nominals, &states, &defined, &next);
}
static fmi3Status put(const unsigned char *bytes, size_t size) {
    fmi3Binary value = bytes;
    return fmi3SetBinary(x, &RX, 1, &size, &value, 1);
}
static int sent(const unsigned char *bytes, size_t size) {
    fmi3ValueReference both[] = {TEXT, TX};
    fmi3Binary found[2];
    size_t sizes[2];
    if (fmi3GetBinary(x, both, 2, sizes, found, 2) != fmi3OK) return 0;
    return sizes[1] == size && memcmp(found[1], bytes, size) == 0;
}

int main(void) {
    /* Two operations, a header that says more than there is, and one byte. */
    static unsigned char bytes[] = {0x42, 0, 0, 0, 8, 0, 0, 0, 0x20, 0, 0, 0, 12, 0, 0, 0, 5, 0, 0, 0,
                                    0x10, 0, 0, 0, 99, 0, 0, 0, 1};
    const size_t size = sizeof bytes;
    fmi3Clock clock = 1;
    fmi3Boolean event, truth;
    x = fmi3InstantiateCoSimulation("x", "{}", "", 0, 0, 1, 0, NULL, 0, NULL, complain, NULL);
    MUST(x);
    OK(fmi3EnterInitializationMode(x, 0, 0, 0, 0, 0));
    REFUSED(put(bytes, size));
    OK(fmi3ExitInitializationMode(x));
    OK(fmi3GetClock(x, &TX_CLOCK, 1, &clock));
    MUST(!clock && sent(bytes, 0));
    REFUSED(step(0, &event));
    clock = 1;
    OK(put(bytes, size));
    OK(fmi3SetClock(x, &RX_CLOCK, 1, &clock));
    REFUSED(fmi3SetClock(x, &TX_CLOCK, 1, &clock));
    REFUSED(fmi3GetClock(x, &RX_CLOCK, 1, &clock));
    REFUSED(fmi3GetClock(x, &NONE, 1, &clock));
    OK(update());
    OK(put(bytes, 8)); /* its clock is not active any more */
    OK(fmi3EnterStepMode(x));
    REFUSED(put(bytes, size));
    REFUSED(fmi3EnterStepMode(x));
    REFUSED(update());
    OK(step(0, &event));
    MUST(event && count() == 0); /* until there is an event */
    MUST(sent(bytes, 0));
    fmi3FMUState state = NULL, other = NULL;
    OK(fmi3GetFMUState(x, &state));
    OK(fmi3EnterEventMode(x));
    MUST(count() == 1);
    OK(fmi3GetClock(x, &TX_CLOCK, 1, &clock));
    MUST(clock && sent(bytes, size));
    OK(fmi3GetClock(x, &TX_CLOCK, 1, &clock));
    MUST(!clock && sent(bytes, size));
    OK(update());
    MUST(sent(bytes, 0));
    OK(fmi3EnterStepMode(x));
    OK(step(1, &event));
    MUST(event); /* it counts */
    /* Back to after the first step, through bytes. */
    size_t needed;
    OK(fmi3SerializedFMUStateSize(x, state, &needed));
    fmi3Byte *kept = malloc(needed);
    OK(fmi3SerializeFMUState(x, state, kept, needed));
    REFUSED(fmi3SerializeFMUState(x, state, kept, 40));
    for (size_t cut = 0; cut < needed; cut += 97) REFUSED(fmi3DeserializeFMUState(x, kept, cut, &other));
    OK(fmi3DeserializeFMUState(x, kept, needed, &other));
    OK(fmi3SetFMUState(x, other));
    MUST(count() == 0);
    OK(fmi3EnterEventMode(x));
    OK(fmi3GetClock(x, &TX_CLOCK, 1, &clock));
    MUST(clock && sent(bytes, size) && count() == 1);
    OK(fmi3GetFMUState(x, &state)); /* into one that there is */
    OK(fmi3EnterStepMode(x));
    OK(fmi3SetFMUState(x, state));
    MUST(sent(bytes, size));
    OK(fmi3FreeFMUState(x, &state));
    OK(fmi3FreeFMUState(x, &other));
    free(kept);
    /* Many events for one step, and bytes that are none of a variable. */
    for (int k = 0; k < 100; k++) {
        clock = 1;
        OK(fmi3SetClock(x, &RX_CLOCK, 1, &clock));
        OK(put(bytes, 20));
        OK(update());
    }
    OK(fmi3EnterStepMode(x));
    OK(step(1, &event));
    OK(fmi3EnterEventMode(x));
    fmi3Binary found;
    size_t all;
    OK(fmi3GetBinary(x, &TX, 1, &all, &found, 1));
    MUST(all == 100 * 20 && memcmp(found + 99 * 20, bytes, 20) == 0);
    REFUSED(fmi3GetBinary(x, &NONE, 1, &all, &found, 1));
    REFUSED(fmi3GetBoolean(x, &NONE, 1, &truth, 1));
    OK(fmi3GetBoolean(x, &NOTIFIES, 1, &truth, 1));
    MUST(truth);
    fmi3Float64 number;
    MUST(fmi3GetFloat64(x, &TX, 1, &number, 1) == fmi3Error);
    OK(fmi3Reset(x));
    fmi3FreeInstance(x);
    /* Without event mode there are no buses, and outputs change with a step. */
    x = fmi3InstantiateCoSimulation("x", "{}", "", 0, 0, 0, 0, NULL, 0, NULL, complain, NULL);
    OK(fmi3EnterInitializationMode(x, 0, 0, 0, 0, 0));
    OK(fmi3ExitInitializationMode(x));
    OK(step(0, &event));
    MUST(!event && count() == 1);
    REFUSED(fmi3EnterEventMode(x));
    REFUSED(put(bytes, size));
    REFUSED(fmi3GetClock(x, &TX_CLOCK, 1, &clock));
    fmi3FreeInstance(x);
    return 0;
}
