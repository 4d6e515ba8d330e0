/* An FMI 3.0 slave that is a CAN node of FMI-LS-BUS: it sends one kind of frame, and counts what comes.

Transmit clock: a countdown, or a triggered output if `surprises` is set, at which steps return early.
References: 1 to 4 the bus terminal, 10 and more parameters, 30 and more outputs. */

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "fmi3FunctionTypes.h"

enum { RX_DATA = 1, TX_DATA, RX_CLOCK, TX_CLOCK };
enum { ID = 10, KIND, FRAMES, SIZE, VALUE, FIRST, PERIOD, BIT_RATE, DISCARDS, SURPRISES, PARAMETERS };
enum { RECEIVED = 30, CONFIRMED, LOST, ERRORS, OWN_ERRORS, FORMAT_ERRORS, WAKEUPS, LAST_ID, LAST_KIND,
       LAST_SIZE, LAST_VALUE, WHEN, OUTPUTS };
enum { CLASSIC, EXTENDED, REMOTE, FD, WAKEUP, NONSENSE };

typedef struct {
    fmi3LogMessageCallback log;
    fmi3InstanceEnvironment environment;
    double time, next, parameter[PARAMETERS], output[OUTPUTS];
    uint64_t value, last_value;
    int sent;
    bool stepping, rx, tx, is_configured, is_new;
    unsigned char in[2048], out[2048];
    size_t received, filled;
} Node;

static fmi3Status fail(Node *n, const char *message) {
    n->log(n->environment, fmi3Error, "all", message);
    return fmi3Error;
}

const char *fmi3GetVersion(void) { return "3.0"; }

fmi3Instance fmi3InstantiateCoSimulation(
    fmi3String name, fmi3String token, fmi3String place, fmi3Boolean visible, fmi3Boolean logging,
    fmi3Boolean with_events, fmi3Boolean early, const fmi3ValueReference r[], size_t c,
    fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
    fmi3IntermediateUpdateCallback update) {
    Node *n = calloc(1, sizeof *n);
    n->log = log;
    n->environment = environment;
    n->is_new = true;
    n->parameter[ID] = 1;
    n->parameter[SIZE] = 8;
    n->parameter[FIRST] = n->parameter[PERIOD] = 0.01;
    n->parameter[BIT_RATE] = 250000;
    return n;
}
void fmi3FreeInstance(fmi3Instance c) { free(c); }

fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean b, fmi3Float64 tolerance,
                                       fmi3Float64 start, fmi3Boolean stops, fmi3Float64 stop) {
    Node *n = c;
    n->time = n->next = start; /* the configuration */
    return fmi3OK;
}
fmi3Status fmi3ExitInitializationMode(fmi3Instance c) { return fmi3OK; }
fmi3Status fmi3EnterEventMode(fmi3Instance c) {
    ((Node *)c)->stepping = false;
    return fmi3OK;
}
fmi3Status fmi3EnterStepMode(fmi3Instance c) {
    ((Node *)c)->stepping = true;
    return fmi3OK;
}
fmi3Status fmi3Terminate(fmi3Instance c) { return fmi3OK; }

/* ------------------------------------------------------------------ operations */

static void put(Node *n, uint64_t number, int bytes) {
    memcpy(n->out + n->filled, &number, bytes); /* little endian, as this machine */
    n->filled += bytes;
}

static void put_configuration(Node *n) {
    put(n, 0x40, 4), put(n, 13, 4), put(n, 1, 1), put(n, n->parameter[BIT_RATE], 4);
    put(n, 0x40, 4), put(n, 10, 4), put(n, 4, 1), put(n, n->parameter[DISCARDS] ? 2 : 1, 1);
}

static void put_frame(Node *n) {
    int kind = n->parameter[KIND], size = n->parameter[SIZE];
    if (kind == NONSENSE) {
        put(n, 0x77, 4), put(n, 11, 4), put(n, 0x030201, 3);
    } else if (kind == WAKEUP) {
        put(n, 0x42, 4), put(n, 8, 4);
    } else if (kind == FD) {
        put(n, 0x11, 4), put(n, 17 + size, 4), put(n, n->parameter[ID], 4);
        put(n, 0, 1), put(n, 1, 1), put(n, 0, 1), put(n, size, 2);
    } else {
        put(n, 0x10, 4), put(n, 16 + size, 4), put(n, n->parameter[ID], 4);
        put(n, n->parameter[ID] > 0x7FF, 1), put(n, kind == REMOTE, 1), put(n, size, 2);
    }
    if (kind == NONSENSE || kind == WAKEUP) return;
    for (int k = 0; k < size; k++) put(n, n->value >> 8 * (k % 8) & 0xFF, 1);
}

static uint64_t number(const unsigned char *from, int bytes) {
    uint64_t found = 0;
    memcpy(&found, from, bytes);
    return found;
}

static void take(Node *n, const unsigned char *at) {
    n->output[WHEN] = n->time;
    switch (number(at, 4)) {
    case 0x10:
    case 0x11: {
        int fd = at[0] == 0x11, size = number(at + 14 + fd, 2);
        n->output[RECEIVED]++;
        n->output[LAST_ID] = number(at + 8, 4);
        n->output[LAST_KIND] = fd ? FD : at[13] ? REMOTE : at[12] ? EXTENDED : CLASSIC;
        n->output[LAST_SIZE] = size;
        n->last_value = number(at + 16 + fd, size < 8 ? size : 8);
        break;
    }
    case 0x20: n->output[CONFIRMED]++; break;
    case 0x30: n->output[LOST]++; break;
    case 0x31: n->output[ERRORS]++, n->output[OWN_ERRORS] += at[14]; break;
    case 0x01: n->output[FORMAT_ERRORS]++, n->output[LAST_SIZE] = number(at + 8, 2); break;
    case 0x42: n->output[WAKEUPS]++; break;
    }
}

/* ------------------------------------------------------------------ time and events */

fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 t, fmi3Float64 h, fmi3Boolean never_back,
                      fmi3Boolean *event, fmi3Boolean *end, fmi3Boolean *early,
                      fmi3Float64 *reached) {
    Node *n = c;
    *event = *end = *early = false;
    if (fabs(t - n->time) > 1e-9) return fail(n, "steps do not follow each other");
    double to = t + h;
    if (n->next < to - 1e-9 || (n->parameter[SURPRISES] && n->next < to + 1e-9)) {
        if (!n->parameter[SURPRISES]) return fail(n, "a tick was missed");
        *event = n->tx = true;
        *early = n->next < to - 1e-9;
        to = n->next;
    }
    n->time = *reached = to;
    return fmi3OK;
}

static void fill(Node *n) {
    n->filled = 0;
    if (n->is_configured) put_frame(n), n->sent++;
    else put_configuration(n);
}

fmi3Status fmi3SetClock(fmi3Instance c, const fmi3ValueReference r[], size_t count,
                        const fmi3Clock v[]) {
    Node *n = c;
    for (size_t i = 0; i < count; i++) {
        if (n->stepping) return fail(n, "a clock outside of an event");
        if (r[i] == RX_CLOCK) n->rx = true;
        else if (r[i] != TX_CLOCK || n->parameter[SURPRISES] || fabs(n->next - n->time) > 1e-9)
            return fail(n, "a clock at a wrong time");
        else n->tx = true, fill(n);
    }
    return fmi3OK;
}
fmi3Status fmi3GetClock(fmi3Instance c, const fmi3ValueReference r[], size_t count, fmi3Clock v[]) {
    Node *n = c;
    if (!n->is_configured) n->tx = true;
    v[0] = n->tx;
    if (n->tx) fill(n);
    return fmi3OK;
}
fmi3Status fmi3GetIntervalDecimal(fmi3Instance c, const fmi3ValueReference r[], size_t count,
                                  fmi3Float64 v[], fmi3IntervalQualifier q[]) {
    Node *n = c;
    q[0] = isinf(n->next) ? fmi3IntervalNotYetKnown
           : n->is_new    ? fmi3IntervalChanged
                          : fmi3IntervalUnchanged;
    v[0] = n->next - n->time;
    n->is_new = false;
    return fmi3OK;
}
fmi3Status fmi3UpdateDiscreteStates(fmi3Instance c, fmi3Boolean *more, fmi3Boolean *end,
                                    fmi3Boolean *nominals, fmi3Boolean *values,
                                    fmi3Boolean *defined, fmi3Float64 *next) {
    Node *n = c;
    *more = *end = *nominals = *values = *defined = false;
    for (size_t at = 0; n->rx && at < n->received; at += number(n->in + at + 4, 4)) take(n, n->in + at);
    if (n->tx) {
        if (n->sent < n->parameter[FRAMES])
            n->next = n->parameter[FIRST] + n->sent * n->parameter[PERIOD];
        else n->next = INFINITY;
        n->is_configured = n->is_new = true;
    }
    n->rx = n->tx = false;
    n->received = 0;
    return fmi3OK;
}

/* ------------------------------------------------------------------ variables */

fmi3Status fmi3GetBinary(fmi3Instance c, const fmi3ValueReference r[], size_t count, size_t sizes[],
                         fmi3Binary v[], size_t size) {
    Node *n = c;
    if (r[0] != TX_DATA || !n->tx) return fail(n, "bytes without their clock");
    sizes[0] = n->filled;
    v[0] = n->out;
    return fmi3OK;
}
fmi3Status fmi3SetBinary(fmi3Instance c, const fmi3ValueReference r[], size_t count,
                         const size_t sizes[], const fmi3Binary v[], size_t size) {
    Node *n = c;
    if (r[0] != RX_DATA || !n->rx) return fail(n, "bytes without their clock");
    if (sizes[0] > 100) return fail(n, "more than maxSize");
    memcpy(n->in, v[0], n->received = sizes[0]);
    return fmi3OK;
}
fmi3Status fmi3GetFloat64(fmi3Instance c, const fmi3ValueReference r[], size_t count, fmi3Float64 v[],
                          size_t size) {
    Node *n = c;
    for (size_t i = 0; i < count; i++) v[i] = r[i] < RECEIVED ? n->parameter[r[i]] : n->output[r[i]];
    return fmi3OK;
}
fmi3Status fmi3SetFloat64(fmi3Instance c, const fmi3ValueReference r[], size_t count,
                          const fmi3Float64 v[], size_t size) {
    for (size_t i = 0; i < count; i++) ((Node *)c)->parameter[r[i]] = v[i];
    return fmi3OK;
}
fmi3Status fmi3GetInt32(fmi3Instance c, const fmi3ValueReference r[], size_t count, fmi3Int32 v[],
                        size_t size) {
    Node *n = c;
    for (size_t i = 0; i < count; i++) v[i] = r[i] < RECEIVED ? n->parameter[r[i]] : n->output[r[i]];
    return fmi3OK;
}
fmi3Status fmi3SetInt32(fmi3Instance c, const fmi3ValueReference r[], size_t count,
                        const fmi3Int32 v[], size_t size) {
    for (size_t i = 0; i < count; i++) ((Node *)c)->parameter[r[i]] = v[i];
    return fmi3OK;
}
fmi3Status fmi3GetInt64(fmi3Instance c, const fmi3ValueReference r[], size_t count, fmi3Int64 v[],
                         size_t size) {
    v[0] = r[0] == VALUE ? ((Node *)c)->value : ((Node *)c)->last_value;
    return fmi3OK;
}
fmi3Status fmi3SetInt64(fmi3Instance c, const fmi3ValueReference r[], size_t count,
                         const fmi3Int64 v[], size_t size) {
    ((Node *)c)->value = v[0];
    return fmi3OK;
}
fmi3Status fmi3GetBoolean(fmi3Instance c, const fmi3ValueReference r[], size_t count, fmi3Boolean v[],
                          size_t size) {
    for (size_t i = 0; i < count; i++) v[i] = ((Node *)c)->parameter[r[i]];
    return fmi3OK;
}
fmi3Status fmi3SetBoolean(fmi3Instance c, const fmi3ValueReference r[], size_t count,
                          const fmi3Boolean v[], size_t size) {
    for (size_t i = 0; i < count; i++) ((Node *)c)->parameter[r[i]] = v[i];
    return fmi3OK;
}

/* ------------------------------------------------------------------ state */

fmi3Status fmi3GetFMUState(fmi3Instance c, fmi3FMUState *s) {
    if (!*s) *s = malloc(sizeof(Node));
    memcpy(*s, c, sizeof(Node));
    return fmi3OK;
}
fmi3Status fmi3SetFMUState(fmi3Instance c, fmi3FMUState s) {
    memcpy(c, s, sizeof(Node));
    return fmi3OK;
}
fmi3Status fmi3FreeFMUState(fmi3Instance c, fmi3FMUState *s) {
    free(*s);
    *s = NULL;
    return fmi3OK;
}
