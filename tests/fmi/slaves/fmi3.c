/* An FMI 3.0 slave: x' = -k x, stairs and a bouncing ball with events, arrays of every type.

It refuses calls that FMI 3.0 does not allow in its state. References: 1 to 9 parameters, 10 to
19 signals of the model, 100 + type inputs and 200 + type outputs of three elements, 120 and 220
a matrix and its transpose. */

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "fmi3FunctionTypes.h"

enum { K = 1, LARGEST_STEP, LONGEST_STEP, GAIN, END_TIME, STAIR, RESTITUTION, ROWS, RESTLESS };
enum { X = 10, HEIGHT, SPEED, STEPS, EVENTS };
enum { MATRIX = 120, TRANSPOSE = 220, MOST = 8 };
enum { FLOAT32, FLOAT64, INT8, UINT8, INT16, UINT16, INT32, UINT32, INT64, UINT64, BOOLEAN,
       STRING, BINARY, ENUMERATION };
enum { INSTANTIATED, INITIALISING, STEPPING, EVENT, CONFIGURATION };

typedef struct {
    fmi3LogMessageCallback log;
    fmi3InstanceEnvironment environment;
    int state;
    bool with_events, pending, again;
    double real[20], time, matrix[2 * MOST];
    float float32[3];
    double float64[3];
    int64_t integer[14][3];
    uint64_t rows;
    bool boolean[3], restless;
    int32_t steps, events;
    char text[3][64];
    uint8_t bytes[2][3][64];
    size_t sizes[3];
} Slave;

static fmi3Status fail(Slave *s, const char *message) {
    s->log(s->environment, fmi3Error, "all", message);
    return fmi3Error;
}

const char *fmi3GetVersion(void) { return "3.0"; }

fmi3Instance fmi3InstantiateCoSimulation(
    fmi3String name, fmi3String token, fmi3String place, fmi3Boolean visible, fmi3Boolean logging,
    fmi3Boolean with_events, fmi3Boolean early, const fmi3ValueReference r[], size_t n,
    fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
    fmi3IntermediateUpdateCallback update) {
#ifdef REFUSES_EVENTS
    if (with_events) {
        log(environment, fmi3Error, "all", "no event mode here");
        return NULL;
    }
#endif
    Slave *s = calloc(1, sizeof *s);
    s->log = log;
    s->environment = environment;
    s->with_events = with_events;
    s->real[K] = s->real[X] = s->real[HEIGHT] = 1.0;
    s->real[GAIN] = 2.0;
    s->rows = 3;
#ifdef SHOWS_FLAGS
    s->real[X] = logging + 2 * early + 4 * with_events + 8 * (n > 0) + 16 * (update != NULL);
#endif
    if (!early || strcmp(token, "{fmi3}")) {
        log(environment, fmi3Error, "all", "early return and the right token are needed");
        free(s);
        return NULL;
    }
    return s;
}
void fmi3FreeInstance(fmi3Instance c) {
#ifdef DIES_IN_THE_RELEASE
    abort();
#endif
    free(c);
}

fmi3Status fmi3EnterConfigurationMode(fmi3Instance c) {
    Slave *s = c;
    if (s->state != INSTANTIATED) return fail(s, "configured at a wrong time");
    s->state = CONFIGURATION;
    return fmi3OK;
}
fmi3Status fmi3ExitConfigurationMode(fmi3Instance c) {
    Slave *s = c;
    s->state = INSTANTIATED;
    return s->rows <= MOST ? fmi3OK : fail(s, "too many rows");
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean b, fmi3Float64 tolerance,
                                       fmi3Float64 start, fmi3Boolean stops, fmi3Float64 stop) {
    Slave *s = c;
    s->time = start;
    s->state = INITIALISING;
#ifdef SHOWS_TOLERANCE
    s->real[X] = b ? tolerance : -1.0;
#endif
    return fmi3OK;
}
fmi3Status fmi3ExitInitializationMode(fmi3Instance c) {
    Slave *s = c;
    s->state = s->with_events ? EVENT : STEPPING;
    return fmi3OK;
}
fmi3Status fmi3EnterEventMode(fmi3Instance c) {
    Slave *s = c;
    if (!s->with_events || s->state != STEPPING) return fail(s, "no event mode from here");
    s->state = EVENT;
    s->again = true;
    s->events++;
    return fmi3OK;
}
fmi3Status fmi3EnterStepMode(fmi3Instance c) {
    Slave *s = c;
    if (s->state != EVENT || s->again) return fail(s, "no step mode from here");
    s->state = STEPPING;
    return fmi3OK;
}
fmi3Status fmi3Terminate(fmi3Instance c) {
#ifdef DIES_AT_THE_END
    abort();
#endif
    return fmi3OK;
}

/* ------------------------------------------------------------------ model */

static double next_event(const Slave *s) {
    const double *x = s->real;
    double next = INFINITY;
    if (x[STAIR] > 0) next = (s->steps + 1) * x[STAIR];
    if (x[RESTITUTION] > 0) {
        double v = x[SPEED], g = 9.81;
        next = fmin(next, s->time + (v + sqrt(v * v + 2 * g * fmax(x[HEIGHT], 0))) / g);
    }
    return next;
}
static void advance(Slave *s, double to) {
    double h = to - s->time, *x = s->real;
    x[X] *= exp(-x[K] * h);
    if (x[RESTITUTION] > 0) {
        x[HEIGHT] += x[SPEED] * h - 9.81 / 2 * h * h;
        x[SPEED] -= 9.81 * h;
    }
    s->time = to;
}
static void happen(Slave *s) {
    double *x = s->real;
    if (x[STAIR] > 0 && s->time >= (s->steps + 1) * x[STAIR] - 1e-12) s->steps++;
    if (x[RESTITUTION] > 0 && x[HEIGHT] < 1e-9 && x[SPEED] < 0) {
        x[HEIGHT] = 0;
        x[SPEED] *= -x[RESTITUTION];
    }
}

fmi3Status fmi3UpdateDiscreteStates(fmi3Instance c, fmi3Boolean *more, fmi3Boolean *end,
                                    fmi3Boolean *nominals, fmi3Boolean *values,
                                    fmi3Boolean *defined, fmi3Float64 *next) {
    Slave *s = c;
    if (s->state != EVENT) return fail(s, "no event to update");
    if (s->pending) happen(s);
    s->pending = false;
    *more = s->restless || s->again; /* once more, to see that it is asked for */
    s->again = s->restless;
    *end = *nominals = *values = false;
    *defined = isfinite(next_event(s));
    *next = next_event(s);
    return fmi3OK;
}

fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 t, fmi3Float64 h, fmi3Boolean never_back,
                      fmi3Boolean *event, fmi3Boolean *end, fmi3Boolean *early,
                      fmi3Float64 *reached) {
    Slave *s = c;
    const double *x = s->real;
    double to = t + h;
    *event = *end = *early = false;
    *reached = t;
    if (s->state != STEPPING || s->pending) return fail(s, "a step without step mode");
    if (fabs(t - s->time) > 1e-9) return fail(s, "steps do not follow each other");
    if (x[LARGEST_STEP] > 0 && h > x[LARGEST_STEP] * (1 + 1e-9)) {
        s->log(s->environment, fmi3Warning, "all", "the step is too large");
        return fmi3Discard;
    }
    if (x[LONGEST_STEP] < -1) return (fmi3Status)(int)x[LONGEST_STEP];
    if (x[LONGEST_STEP] > 0) to = fmin(to, t + x[LONGEST_STEP]);
    if (x[LONGEST_STEP] < 0) to = t;
    while (next_event(s) <= to) {
        advance(s, next_event(s));
        if (s->with_events) {
            to = s->time;
            s->pending = *event = true;
            break;
        }
        happen(s);
    }
    advance(s, to);
    *early = to < t + h;
    *reached = to;
    *end = x[END_TIME] > 0 && to >= x[END_TIME];
    return fmi3OK;
}

/* ------------------------------------------------------------------ values */

static bool settable(Slave *s, fmi3ValueReference r, bool continuous) {
    if (r < 10 && r != GAIN) return s->state == INSTANTIATED || s->state == INITIALISING;
    return continuous || !s->with_events || s->state != STEPPING;
}

fmi3Status fmi3GetFloat64(fmi3Instance c, const fmi3ValueReference r[], size_t n, fmi3Float64 v[],
                          size_t size) {
    Slave *s = c;
    for (size_t i = 0; i < n; i++) {
        if (r[i] < 20) *v++ = s->real[r[i]];
        else if (r[i] == 101 || r[i] == 201) {
            for (int k = 0; k < 3; k++) *v++ = s->float64[k] * (r[i] == 201 ? s->real[GAIN] : 1);
        } else if (r[i] == MATRIX) {
            for (uint64_t k = 0; k < 2 * s->rows; k++) *v++ = s->matrix[k];
        } else if (r[i] == TRANSPOSE) {
            for (int column = 0; column < 2; column++) {
                for (uint64_t row = 0; row < s->rows; row++) *v++ = s->matrix[2 * row + column];
            }
        } else return fail(s, "no such Float64");
    }
    return fmi3OK;
}
fmi3Status fmi3SetFloat64(fmi3Instance c, const fmi3ValueReference r[], size_t n,
                          const fmi3Float64 v[], size_t size) {
    Slave *s = c;
    for (size_t i = 0; i < n; i++) {
        if (!settable(s, r[i], r[i] > 100)) return fail(s, "a Float64 set at a wrong time");
        if (r[i] < 20) s->real[r[i]] = *v++;
        else if (r[i] == 101) for (int k = 0; k < 3; k++) s->float64[k] = *v++;
        else if (r[i] == MATRIX) for (uint64_t k = 0; k < 2 * s->rows; k++) s->matrix[k] = *v++;
        else return fail(s, "no such Float64");
    }
    return fmi3OK;
}
fmi3Status fmi3GetFloat32(fmi3Instance c, const fmi3ValueReference r[], size_t n, fmi3Float32 v[],
                          size_t size) {
    Slave *s = c;
    for (size_t i = 0; i < n; i++) {
        for (int k = 0; k < 3; k++) *v++ = s->float32[k] * (r[i] == 200 ? 2 : 1);
    }
    return fmi3OK;
}
fmi3Status fmi3SetFloat32(fmi3Instance c, const fmi3ValueReference r[], size_t n,
                          const fmi3Float32 v[], size_t size) {
    Slave *s = c;
    if (!settable(s, r[0], true)) return fail(s, "a Float32 set at a wrong time");
    for (size_t i = 0; i < 3 * n; i++) s->float32[i % 3] = v[i];
    return fmi3OK;
}

/* Outputs of integers are twice their inputs, as far as that fits the type; of an enumeration
   they are equal. */
#define INTEGERS(Type, own)                                                                        \
    fmi3Status fmi3Get##Type(fmi3Instance c, const fmi3ValueReference r[], size_t n,               \
                             fmi3##Type v[], size_t size) {                                        \
        Slave *s = c;                                                                              \
        for (size_t i = 0; i < n; i++) {                                                           \
            if (r[i] == STEPS) *v++ = s->steps;                                                    \
            else if (r[i] == EVENTS) *v++ = s->events;                                             \
            else if (r[i] == ROWS) *v++ = s->rows;                                                 \
            else if (r[i] % 100 == ENUMERATION) *v++ = s->integer[ENUMERATION - 1][0];             \
            else for (int k = 0; k < 3; k++) *v++ = s->integer[own][k] * (r[i] / 100);             \
        }                                                                                          \
        return fmi3OK;                                                                             \
    }                                                                                              \
    fmi3Status fmi3Set##Type(fmi3Instance c, const fmi3ValueReference r[], size_t n,               \
                             const fmi3##Type v[], size_t size) {                                  \
        Slave *s = c;                                                                              \
        for (size_t i = 0; i < n; i++) {                                                           \
            if (r[i] == ROWS && s->state == CONFIGURATION) { s->rows = *v++; continue; }           \
            if (!settable(s, r[i], false)) return fail(s, "a " #Type " set at a wrong time");      \
            if (r[i] % 100 == ENUMERATION) s->integer[ENUMERATION - 1][0] = *v++;                  \
            else for (int k = 0; k < 3; k++) s->integer[own][k] = *v++;                            \
        }                                                                                          \
        return fmi3OK;                                                                             \
    }
INTEGERS(Int8, INT8)
INTEGERS(UInt8, UINT8)
INTEGERS(Int16, INT16)
INTEGERS(UInt16, UINT16)
INTEGERS(Int32, INT32)
INTEGERS(UInt32, UINT32)
INTEGERS(Int64, INT64)
INTEGERS(UInt64, UINT64)

fmi3Status fmi3GetBoolean(fmi3Instance c, const fmi3ValueReference r[], size_t n, fmi3Boolean v[],
                          size_t size) {
    Slave *s = c;
    for (size_t i = 0; i < n; i++) {
        for (int k = 0; k < 3; k++) *v++ = s->boolean[k] != (r[i] > 200);
    }
    return fmi3OK;
}
fmi3Status fmi3SetBoolean(fmi3Instance c, const fmi3ValueReference r[], size_t n,
                          const fmi3Boolean v[], size_t size) {
    Slave *s = c;
    if (!settable(s, r[0], false)) return fail(s, "a Boolean set at a wrong time");
    for (size_t i = 0; i < n; i++) {
        if (r[i] == RESTLESS) s->restless = *v++;
        else for (int k = 0; k < 3; k++) s->boolean[k] = *v++;
    }
    return fmi3OK;
}
fmi3Status fmi3GetString(fmi3Instance c, const fmi3ValueReference r[], size_t n, fmi3String v[],
                         size_t size) {
    for (size_t i = 0; i < size; i++) v[i] = ((Slave *)c)->text[i % 3];
    return fmi3OK;
}
fmi3Status fmi3SetString(fmi3Instance c, const fmi3ValueReference r[], size_t n,
                         const fmi3String v[], size_t size) {
    Slave *s = c;
    if (!settable(s, r[0], false)) return fail(s, "a String set at a wrong time");
    for (size_t i = 0; i < size; i++) strncpy(s->text[i % 3], v[i], 63);
    return fmi3OK;
}
fmi3Status fmi3GetBinary(fmi3Instance c, const fmi3ValueReference r[], size_t n, size_t sizes[],
                         fmi3Binary v[], size_t size) {
    Slave *s = c;
    for (size_t i = 0; i < size; i++) {
        int k = i % 3;
        sizes[i] = s->sizes[k];
        for (size_t b = 0; b < sizes[i]; b++) s->bytes[1][k][b] = s->bytes[0][k][sizes[i] - 1 - b];
        v[i] = sizes[i] ? s->bytes[r[i / 3] / 200][k] : NULL;
    }
    return fmi3OK;
}
fmi3Status fmi3SetBinary(fmi3Instance c, const fmi3ValueReference r[], size_t n,
                         const size_t sizes[], const fmi3Binary v[], size_t size) {
    Slave *s = c;
    if (!settable(s, r[0], false)) return fail(s, "a Binary set at a wrong time");
    for (size_t i = 0; i < size; i++) {
        s->sizes[i % 3] = sizes[i];
        memcpy(s->bytes[0][i % 3], v[i], sizes[i]);
    }
    return fmi3OK;
}

/* ------------------------------------------------------------------ state */

fmi3Status fmi3GetFMUState(fmi3Instance c, fmi3FMUState *s) {
    if (!*s) *s = malloc(sizeof(Slave));
    memcpy(*s, c, sizeof(Slave));
    return fmi3OK;
}
fmi3Status fmi3SetFMUState(fmi3Instance c, fmi3FMUState s) {
    memcpy(c, s, sizeof(Slave));
    return fmi3OK;
}
fmi3Status fmi3FreeFMUState(fmi3Instance c, fmi3FMUState *s) {
    free(*s);
    *s = NULL;
    return fmi3OK;
}

#define UNUSED(function) fmi3Status function() { return fmi3Error; }
UNUSED(fmi3SetDebugLogging)
UNUSED(fmi3Reset)
UNUSED(fmi3GetClock)
UNUSED(fmi3SetClock)
UNUSED(fmi3GetNumberOfVariableDependencies)
UNUSED(fmi3GetVariableDependencies)
UNUSED(fmi3SerializedFMUStateSize)
UNUSED(fmi3SerializeFMUState)
UNUSED(fmi3DeserializeFMUState)
UNUSED(fmi3GetDirectionalDerivative)
UNUSED(fmi3GetAdjointDerivative)
UNUSED(fmi3GetIntervalDecimal)
UNUSED(fmi3GetIntervalFraction)
UNUSED(fmi3GetShiftDecimal)
UNUSED(fmi3GetShiftFraction)
UNUSED(fmi3SetIntervalDecimal)
UNUSED(fmi3SetIntervalFraction)
UNUSED(fmi3SetShiftDecimal)
UNUSED(fmi3SetShiftFraction)
UNUSED(fmi3EvaluateDiscreteStates)
UNUSED(fmi3EnterContinuousTimeMode)
UNUSED(fmi3CompletedIntegratorStep)
UNUSED(fmi3SetTime)
UNUSED(fmi3SetContinuousStates)
UNUSED(fmi3GetContinuousStateDerivatives)
UNUSED(fmi3GetEventIndicators)
UNUSED(fmi3GetContinuousStates)
UNUSED(fmi3GetNominalsOfContinuousStates)
UNUSED(fmi3GetNumberOfEventIndicators)
UNUSED(fmi3GetNumberOfContinuousStates)
UNUSED(fmi3GetOutputDerivatives)
UNUSED(fmi3ActivateModelPartition)
UNUSED(fmi3InstantiateModelExchange)
UNUSED(fmi3InstantiateScheduledExecution)
