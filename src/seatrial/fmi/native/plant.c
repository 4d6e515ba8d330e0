/* FMI 2.0 co-simulation of a plant. Its equations and tables are those of model.c.

   What seatrial's Plant does, operation by operation: equal Runge-Kutta sub-steps with inputs
   held, whole nanoseconds, outputs anew when an input changed. A step allocates nothing. */

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2Functions.h"
#include "model.h"

#define NS 1e9
#define LATEST 2e6 /* s, up to which a double gives its nanoseconds back */

typedef enum { INSTANTIATED, INITIALISING, RUNNING, TERMINATED } Phase;

typedef struct {
    double values[SCALARS];
    double x[STATES + 1];
    long long now_ns;
    Phase phase;
    int stale, restart, failed;
} State;

typedef struct {
    State state;
    fmi2CallbackLogger log;
    fmi2ComponentEnvironment environment;
    char name[256];
} Instance;

static void say(Instance *self, const char *format, ...) {
    char text[1024];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (self->log) self->log(self->environment, self->name, fmi2Error, "logStatusError", "%s", text);
}

/* ------------------------------------------------------------------ the component */

static void begin_anew(Instance *self) {
    memset(&self->state, 0, sizeof self->state);
    memcpy(self->state.values, model_starts, sizeof self->state.values);
    self->state.stale = self->state.restart = 1;
}

static void gather(const double *values, const int *references, int count, double *to) {
    for (int i = 0; i < count; i++) to[i] = values[references[i]];
}

static void publish(double *values, const int *references, int count, const double *from) {
    for (int i = 0; i < count; i++) values[references[i]] = from[i];
}

static int is_allowed(Instance *self, unsigned reference, double value) {
    if (model_lows[reference] <= value && value <= model_highs[reference]) return 1;
    say(self, "%s.%s is %.17g %s, allowed %.17g to %.17g %s", self->name, model_names[reference],
        value, model_units[reference], model_lows[reference], model_highs[reference],
        model_units[reference]);
    return 0;
}

static int set_outputs(Instance *self) {
    State *state = &self->state;
    double u[INPUTS + 1], p[PARAMETERS + 1], y[OUTPUTS + 1];
    publish(state->values, model_x, STATES, state->x);
    if (OUTPUTS > 0) {
        gather(state->values, model_u, INPUTS, u);
        gather(state->values, model_p, PARAMETERS, p);
        model_out(state->x, u, p, y);
        publish(state->values, model_y, OUTPUTS, y);
    }
    for (unsigned r = 0; r < SCALARS; r++) {
        if (model_kinds[r] != OUTPUT || isfinite(state->values[r])) continue;
        say(self, "%s: output %s is %g at t = %.17g s", self->name, model_names[r],
            state->values[r], (double)state->now_ns / NS);
        return 0;
    }
    state->stale = 0;
    return 1;
}

static int refresh(Instance *self) {
    State *state = &self->state;
    if (!state->stale || state->phase == INSTANTIATED) return 1;
    if (state->restart) {
        for (unsigned r = 0; r < SCALARS; r++)
            if (!is_allowed(self, r, state->values[r])) return 0;
        gather(state->values, model_x_start, STATES, state->x);
        state->restart = 0;
    }
    return set_outputs(self);
}

static void integrate(State *state, double h) {
    double u[INPUTS + 1], p[PARAMETERS + 1], next[STATES + 1];
    const double parts = ceil(h / state->values[MAX_STEP] - 1e-9);
    const long long count = parts > 1.0 ? (long long)parts : 1;
    const double part = h / (double)count;
    gather(state->values, model_u, INPUTS, u);
    gather(state->values, model_p, PARAMETERS, p);
    for (long long i = 0; i < count; i++) {
        model_rk4(state->x, u, p, part, next);
        memcpy(state->x, next, STATES * sizeof *next);
    }
}

/* Return why a variable cannot be set, or NULL. */
static const char *refusal(const State *state, unsigned reference, double value) {
    switch (model_kinds[reference]) {
    case OUTPUT:
        return "is an output and cannot be set";
    case BUILT_IN:
        return value == model_starts[reference] ? NULL : "is built into this FMU and cannot change";
    case FIXED:
        return state->phase == RUNNING
                   ? "is a fixed parameter and cannot change once the run has started"
                   : NULL;
    case TEXT:
        return "is a text, not a number";
    default:
        return NULL;
    }
}

static int set_one(Instance *self, unsigned reference, double value) {
    State *state = &self->state;
    if (reference >= SCALARS) {
        say(self, "%s: there is no variable with value reference %u", self->name, reference);
        return 0;
    }
    const char *why = refusal(state, reference, value);
    if (why) {
        say(self, "%s.%s %s", self->name, model_names[reference], why);
        return 0;
    }
    if (!isfinite(value)) {
        say(self, "%s.%s: %g is not a finite number", self->name, model_names[reference], value);
        return 0;
    }
    if (state->phase == RUNNING && !is_allowed(self, reference, value)) return 0;
    if (state->phase == INITIALISING && model_kinds[reference] != INPUT) state->restart = 1;
    state->values[reference] = value;
    state->stale = 1;
    return 1;
}

/* ------------------------------------------------------------------ FMI: life */

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }

const char *fmi2GetVersion(void) { return fmi2Version; }

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *functions, fmi2Boolean visible,
                              fmi2Boolean logging) {
    (void)resources, (void)visible, (void)logging; /* errors are always reported */
    Instance *self = calloc(1, sizeof *self);
    if (!self) return NULL;
    if (functions) self->log = functions->logger, self->environment = functions->componentEnvironment;
    snprintf(self->name, sizeof self->name, "%s", name ? name : "");
    begin_anew(self);
    if (type == fmi2CoSimulation && guid && strcmp(guid, MODEL_GUID) == 0) return self;
    say(self, "%s: co-simulation of %s is what this FMU has", self->name, MODEL_GUID);
    free(self);
    return NULL;
}

void fmi2FreeInstance(fmi2Component c) { free(c); }

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t count,
                               const fmi2String categories[]) {
    (void)c, (void)on, (void)count, (void)categories;
    return fmi2OK;
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean has_tolerance, fmi2Real tolerance,
                               fmi2Real start, fmi2Boolean has_stop, fmi2Real stop) {
    (void)has_tolerance, (void)tolerance, (void)has_stop, (void)stop;
    Instance *self = c;
    if (!(fabs(start) < LATEST)) {
        say(self, "%s: start time is %g s; times are exact to the nanosecond up to %g s only",
            self->name, start, LATEST);
        return fmi2Error;
    }
    self->state.now_ns = llrint(start * NS);
    return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
    Instance *self = c;
    self->state.phase = INITIALISING;
    self->state.stale = self->state.restart = 1;
    return refresh(self) ? fmi2OK : fmi2Error;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
    Instance *self = c;
    if (!refresh(self)) return fmi2Error;
    self->state.phase = RUNNING;
    return fmi2OK;
}

fmi2Status fmi2Terminate(fmi2Component c) {
    ((Instance *)c)->state.phase = TERMINATED;
    return fmi2OK;
}

fmi2Status fmi2Reset(fmi2Component c) {
    begin_anew(c);
    return fmi2OK;
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real t, fmi2Real h, fmi2Boolean no_earlier) {
    (void)no_earlier;
    Instance *self = c;
    State *state = &self->state;
    if (state->phase != RUNNING || !(h >= 0.0 && h < LATEST) || !(fabs(t) < LATEST)) {
        say(self, "%s: no step from %g s over %g s is possible now", self->name, t, h);
        return fmi2Error;
    }
    if (state->failed) {
        say(self, "%s: step refused after an earlier error", self->name);
        return fmi2Discard;
    }
    const long long h_ns = llrint(h * NS), given = llrint(t * NS), grain = h_ns / 100;
    if (llabs(given - state->now_ns) > (grain > 1 ? grain : 1)) state->now_ns = given;
    integrate(state, (double)h_ns / NS);
    state->now_ns += h_ns;
    state->failed = !set_outputs(self);
    return state->failed ? fmi2Discard : fmi2OK;
}

fmi2Status fmi2CancelStep(fmi2Component c) {
    (void)c;
    return fmi2Error;
}

/* ------------------------------------------------------------------ FMI: values */

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                       fmi2Real value[]) {
    Instance *self = c;
    if (!refresh(self)) return fmi2Error;
    for (size_t i = 0; i < count; i++) {
        if (vr[i] >= SCALARS || model_kinds[vr[i]] == TEXT) {
            say(self, "%s: there is no Real with value reference %u", self->name, vr[i]);
            return fmi2Error;
        }
        value[i] = self->state.values[vr[i]];
    }
    return fmi2OK;
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                       const fmi2Real value[]) {
    for (size_t i = 0; i < count; i++)
        if (!set_one(c, vr[i], value[i])) return fmi2Error;
    return fmi2OK;
}

static int is_text(Instance *self, unsigned reference) {
    if (reference < SCALARS && model_kinds[reference] == TEXT) return 1;
    say(self, "%s: there is no String with value reference %u", self->name, reference);
    return 0;
}

fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                         fmi2String value[]) {
    for (size_t i = 0; i < count; i++) {
        if (!is_text(c, vr[i])) return fmi2Error;
        value[i] = model_texts[vr[i]];
    }
    return fmi2OK;
}

fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                         const fmi2String value[]) {
    Instance *self = c;
    for (size_t i = 0; i < count; i++) {
        if (!is_text(self, vr[i])) return fmi2Error;
        if (value[i] && strcmp(value[i], model_texts[vr[i]]) == 0) continue;
        say(self, "%s.%s is '%s', built into this FMU, and cannot become '%s'", self->name,
            model_names[vr[i]], model_texts[vr[i]], value[i] ? value[i] : "");
        return fmi2Error;
    }
    return fmi2OK;
}

/* A plant has neither whole numbers nor truth values: asking for none of them is right. */

static fmi2Status none_of(Instance *self, size_t count, const char *type) {
    if (count == 0) return fmi2OK;
    say(self, "%s: there is no %s in this FMU", self->name, type);
    return fmi2Error;
}

fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                          fmi2Integer value[]) {
    (void)vr, (void)value;
    return none_of(c, count, "Integer");
}

fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                          const fmi2Integer value[]) {
    (void)vr, (void)value;
    return none_of(c, count, "Integer");
}

fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                          fmi2Boolean value[]) {
    (void)vr, (void)value;
    return none_of(c, count, "Boolean");
}

fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                          const fmi2Boolean value[]) {
    (void)vr, (void)value;
    return none_of(c, count, "Boolean");
}

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                                       const fmi2Integer order[], const fmi2Real value[]) {
    (void)vr, (void)order, (void)value;
    return none_of(c, count, "input derivative");
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[],
                                        size_t count, const fmi2Integer order[], fmi2Real value[]) {
    (void)vr, (void)order, (void)value;
    return none_of(c, count, "output derivative");
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknown[],
                                        size_t unknowns, const fmi2ValueReference known[],
                                        size_t knowns, const fmi2Real seed[], fmi2Real value[]) {
    (void)unknown, (void)known, (void)knowns, (void)seed, (void)value;
    return none_of(c, unknowns, "directional derivative");
}

/* ------------------------------------------------------------------ FMI: state */

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *kept) {
    if (!*kept && !(*kept = malloc(sizeof(State)))) return fmi2Error;
    memcpy(*kept, &((Instance *)c)->state, sizeof(State));
    return fmi2OK;
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate kept) {
    if (!kept) return fmi2Error;
    memcpy(&((Instance *)c)->state, kept, sizeof(State));
    return fmi2OK;
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *kept) {
    (void)c;
    free(*kept);
    *kept = NULL;
    return fmi2OK;
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate kept, size_t *size) {
    (void)c, (void)kept;
    *size = sizeof(State);
    return fmi2OK;
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate kept, fmi2Byte bytes[], size_t size) {
    (void)c;
    if (size < sizeof(State)) return fmi2Error;
    memcpy(bytes, kept, sizeof(State));
    return fmi2OK;
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size,
                                   fmi2FMUstate *kept) {
    if (size != sizeof(State)) {
        say(c, "%s: a state has %zu bytes, found %zu", ((Instance *)c)->name, sizeof(State), size);
        return fmi2Error;
    }
    if (!*kept && !(*kept = malloc(sizeof(State)))) return fmi2Error;
    memcpy(*kept, bytes, sizeof(State));
    return fmi2OK;
}

/* ------------------------------------------------------------------ FMI: status */

#define STATUS(Type, type)                                                                   \
    fmi2Status fmi2Get##Type##Status(fmi2Component c, const fmi2StatusKind kind, type *value) { \
        (void)c, (void)kind, (void)value;                                                    \
        return fmi2Discard;                                                                  \
    }
STATUS(, fmi2Status)
STATUS(Real, fmi2Real)
STATUS(Integer, fmi2Integer)
STATUS(Boolean, fmi2Boolean)
STATUS(String, fmi2String)
