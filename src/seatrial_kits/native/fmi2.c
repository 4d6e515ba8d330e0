/* FMI 2.0 co-simulation of a component. Its tables are those of model.c.

   What seatrial's Component does: whole nanoseconds, limits, outputs anew when an input changed.
   A step allocates nothing. */

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "component.h"
#include "seal.h"

#ifndef CALLED /* the name by which the host called the function */
#define CALLED(name) #name
#endif

#define LATEST 2e6 /* s, up to which a double gives its nanoseconds back */

static void report(Instance *self) {
    if (self->log)
        self->log(self->environment, self->name, fmi2Error, "logStatusError", "%s", self->error);
    self->is_wrong = self->shown_count = 0;
}

void fail(Instance *self, const char *format, ...) {
    va_list arguments;
    if (self->is_wrong) return; /* what follows from the first error says nothing new */
    self->is_wrong = 1;
    va_start(arguments, format);
    vsnprintf(self->error, ERROR_SIZE, format, arguments);
    va_end(arguments);
}

/* As Python shows a double: the fewest digits that read back, an exponent for what is far from 1. */
const char *shown(Instance *self, double value) {
    char *text = self->shown[self->shown_count++ % 8];
    int digits = 1;
    for (;; digits++) {
        snprintf(text, sizeof self->shown[0], "%.*e", digits - 1, value);
        if (digits == 17 || strtod(text, NULL) == value) break;
    }
    const char *tail = strchr(text, 'e');
    const int exponent = tail ? atoi(tail + 1) : 0, decimals = digits - 1 - exponent;
    if (isfinite(value) && -4 <= exponent && exponent < 16)
        snprintf(text, sizeof self->shown[0], "%.*f", decimals > 1 ? decimals : 1, value);
    return text;
}

#define say(self, ...) (fail(self, __VA_ARGS__), report(self))

/* ------------------------------------------------------------------ the component */

static double now(const Instance *self) { return (double)self->state.now_ns / NS; }

/* Set an input of text, and which of its words that is: their number for one that it does not know. */
static void take_text(Instance *self, int input, const char *text) {
    const int first = model_first_words[input], count = model_first_words[input + 1] - first;
    int word = 0;
    while (word < count && strcmp(model_words[first + word], text) != 0) word++;
    self->state.words[input] = word;
    snprintf(self->state.texts[input], TEXT_SIZE, "%s", text);
    model_text(self, input);
}

static void begin_anew(Instance *self) {
    State *state = &self->state;
    memset(state, 0, sizeof *state);
    state->fmu = seal_fmu(MODEL_GUID);
    memcpy(state->values, model_starts, SCALARS * sizeof *state->values);
    for (int i = 0; i < TEXTS; i++) take_text(self, i, model_texts[model_text_inputs[i]]);
    state->stale = state->restart = 1;
}

static int is_allowed(Instance *self, unsigned reference, double value) {
    const double low = model_lows[reference], high = model_highs[reference];
    if (low <= value && value <= high) return 1;
    const int both = isfinite(low) && isfinite(high);
    say(self, "%s.%s is %s %s, allowed %s%s%s%s %s", self->name, model_names[reference],
        shown(self, value), model_units[reference],
        both ? "" : isfinite(low) ? "at least " : "at most ", isfinite(low) ? shown(self, low) : "",
        both ? " to " : "", isfinite(high) ? shown(self, high) : "", model_units[reference]);
    return 0;
}

static int are_all_finite(const double *values) {
    double sum = 0.0;
    for (int i = 0; i < CHECKED; i++) sum += values[model_checked[i]] * 0.0;
    return sum == 0.0;
}

static int are_finite(Instance *self) {
    const double *values = self->state.values;
    if (are_all_finite(values)) return 1;
    for (int i = 0; i < CHECKED; i++) {
        const int r = model_checked[i];
        if (isfinite(values[r])) continue;
        say(self, "%s: output %s is %g at t = %s s", self->name, model_names[r], values[r],
            shown(self, now(self)));
    }
    return 0;
}

/* Say what went wrong, if anything did. */
static int is_well(Instance *self) {
    if (!self->is_wrong) return 1;
    report(self);
    return 0;
}

/* Take outputs as they are published now, if they may be. */
static int take_outputs(Instance *self) {
    if (!is_well(self) || !are_finite(self)) return 0;
    self->state.stale = 0;
    return 1;
}

static int set_outputs(Instance *self) {
    model_outputs(self, now(self));
    return take_outputs(self);
}

static int refresh(Instance *self) {
    State *state = &self->state;
    if (!state->stale || state->phase == INSTANTIATED) return 1;
    if (state->restart) {
        for (unsigned r = 0; r < SCALARS; r++)
            if (!is_allowed(self, r, state->values[r])) return 0;
        model_start(self, now(self));
        if (!is_well(self)) return 0;
        state->restart = 0;
    }
    return set_outputs(self);
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
    default:
        return NULL;
    }
}

static int set_one(Instance *self, unsigned reference, int type, double value) {
    State *state = &self->state;
    if (reference < SCALARS && model_types[reference] == type && model_kinds[reference] == INPUT &&
        isfinite(value)) {
        state->stale |= __builtin_memcmp(&state->values[reference], &value, sizeof value) != 0;
        state->values[reference] = value;
        return 1;
    }
    if (reference >= SCALARS || model_types[reference] != type) {
        say(self, "%s: there is no %s with value reference %u", self->name, model_type_names[type],
            reference);
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
    if (__builtin_memcmp(&state->values[reference], &value, sizeof value) == 0) return 1;
    if (state->phase == RUNNING && !is_allowed(self, reference, value)) return 0;
    if (state->phase == INITIALISING && model_kinds[reference] != INPUT) state->restart = 1;
    state->values[reference] = value;
    state->stale = 1;
    return 1;
}

static int get_one(Instance *self, unsigned reference, int type, double *value) {
    if (reference >= SCALARS || model_types[reference] != type) {
        say(self, "%s: there is no %s with value reference %u", self->name, model_type_names[type],
            reference);
        return 0;
    }
    *value = self->state.values[reference];
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

static int is_in(Instance *self, Phase phase, const char *call) {
    static const char *const words[] = {"before", "during", "once", "once"};
    if (self->state.phase == phase) return 1;
    say(self, "%s: %s: not allowed %s the initialisation%s", self->name, call,
        words[self->state.phase], self->state.phase > INITIALISING ? " has ended" : "");
    return 0;
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean has_tolerance, fmi2Real tolerance,
                               fmi2Real start, fmi2Boolean has_stop, fmi2Real stop) {
    (void)has_tolerance, (void)tolerance, (void)has_stop, (void)stop;
    Instance *self = c;
    if (!is_in(self, INSTANTIATED, CALLED(fmi2SetupExperiment))) return fmi2Error;
    if (!(fabs(start) < LATEST)) {
        say(self, "%s: start time is %g s; times are exact to the nanosecond up to %g s only",
            self->name, start, LATEST);
        return fmi2Error;
    }
    self->state.now_ns = __builtin_llrint(start * NS);
    self->state.reached = start;
    return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
    Instance *self = c;
    if (!is_in(self, INSTANTIATED, CALLED(fmi2EnterInitializationMode))) return fmi2Error;
    self->state.phase = INITIALISING;
    self->state.stale = self->state.restart = 1;
    return refresh(self) ? fmi2OK : fmi2Error;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
    Instance *self = c;
    if (!is_in(self, INITIALISING, CALLED(fmi2ExitInitializationMode))) return fmi2Error;
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

/* Return whether a step is possible; time is that of its beginning then. */
static fmi2Status begin_step(Instance *self, double t, double h) {
    State *state = &self->state;
    const double slack = h / 100.0 > 1.0 / NS ? h / 100.0 : 1.0 / NS; /* of hosts that add up steps */
    if (state->phase != RUNNING || !(h > 0.0 && h < LATEST) || !(fabs(t) < LATEST)) {
        say(self, "%s: no step from %g s over %g s is possible now", self->name, t, h);
        return fmi2Error;
    }
    if (fabs(t - state->reached) > slack) {
        say(self, "%s: the step begins at %.12g s, but %.12g s was reached", self->name, t,
            state->reached);
        return fmi2Error;
    }
    if (state->failed) {
        say(self, "%s: step refused after an earlier error", self->name);
        return fmi2Discard;
    }
    const long long given = __builtin_llrint(t * NS), grain = __builtin_llrint(h * NS) / 100;
    if (llabs(given - state->now_ns) > (grain > 1 ? grain : 1)) state->now_ns = given;
    return fmi2OK;
}

static fmi2Status end_step(Instance *self, double t, double h, int has_outputs) {
    State *state = &self->state;
    state->failed = !has_outputs;
    if (!state->failed) state->reached = t + h;
    return state->failed ? fmi2Discard : fmi2OK;
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real t, fmi2Real h, fmi2Boolean no_earlier) {
    (void)no_earlier;
    Instance *self = c;
    const fmi2Status status = begin_step(self, t, h);
    if (status != fmi2OK) return status;
    const long long h_ns = __builtin_llrint(h * NS);
    model_step(self, now(self), (double)h_ns / NS);
    self->state.now_ns += h_ns;
    return end_step(self, t, h, is_well(self) && set_outputs(self));
}

fmi2Status fmi2CancelStep(fmi2Component c) {
    (void)c;
    return fmi2Error;
}

/* ------------------------------------------------------------------ FMI: values */

#define ACCESS(Type, number)                                                                   \
    fmi2Status fmi2Get##Type(fmi2Component c, const fmi2ValueReference vr[], size_t count,     \
                             fmi2##Type value[]) {                                             \
        double found = 0.0;                                                                    \
        if (!refresh(c)) return fmi2Error;                                                     \
        for (size_t i = 0; i < count; i++) {                                                   \
            if (!get_one(c, vr[i], number, &found)) return fmi2Error;                          \
            value[i] = (fmi2##Type)found;                                                      \
        }                                                                                      \
        return fmi2OK;                                                                         \
    }                                                                                          \
    fmi2Status fmi2Set##Type(fmi2Component c, const fmi2ValueReference vr[], size_t count,     \
                             const fmi2##Type value[]) {                                       \
        for (size_t i = 0; i < count; i++)                                                     \
            if (!set_one(c, vr[i], number, (double)value[i])) return fmi2Error;                \
        return fmi2OK;                                                                         \
    }
ACCESS(Real, REAL)
ACCESS(Integer, INTEGER)
ACCESS(Boolean, BOOLEAN)

static int is_text(Instance *self, unsigned reference) {
    if (reference < SCALARS && model_types[reference] == STRING) return 1;
    say(self, "%s: there is no String with value reference %u", self->name, reference);
    return 0;
}

/* Return the place of a text that changes, -1 for one that is built in. */
static int text_input(unsigned reference) {
    for (int i = 0; i < TEXTS; i++)
        if (model_text_inputs[i] == (int)reference) return i;
    return -1;
}

fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                         fmi2String value[]) {
    Instance *self = c;
    for (size_t i = 0; i < count; i++) {
        if (!is_text(c, vr[i])) return fmi2Error;
        const int input = text_input(vr[i]);
        value[i] = input < 0 ? model_texts[vr[i]] : self->state.texts[input];
    }
    return fmi2OK;
}

static int set_text(Instance *self, unsigned reference, const char *text) {
    const int input = text_input(reference);
    if (input < 0) {
        if (strcmp(text, model_texts[reference]) == 0) return 1;
        say(self, "%s.%s is '%s', built into this FMU, and cannot become '%s'", self->name,
            model_names[reference], model_texts[reference], text);
        return 0;
    }
    if (strlen(text) >= TEXT_SIZE) {
        say(self, "%s.%s: a text of %zu bytes is too long, at most %d fit", self->name,
            model_names[reference], strlen(text), TEXT_SIZE - 1);
        return 0;
    }
    if (strcmp(text, self->state.texts[input]) == 0) return 1;
    take_text(self, input, text);
    self->state.stale = 1;
    return 1;
}

fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                         const fmi2String value[]) {
    for (size_t i = 0; i < count; i++)
        if (!is_text(c, vr[i]) || !set_text(c, vr[i], value[i] ? value[i] : "")) return fmi2Error;
    return fmi2OK;
}

static fmi2Status none_of(Instance *self, size_t count, const char *type) {
    if (count == 0) return fmi2OK;
    say(self, "%s: there is no %s in this FMU", self->name, type);
    return fmi2Error;
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

/* Whether the numbers of variables have derivatives with respect to each other. */
static int have_derivatives(Instance *self, const fmi2ValueReference references[], size_t count,
                            int are_outputs) {
    for (size_t i = 0; i < count; i++) {
        const unsigned r = references[i];
        const int fits = r < SCALARS && model_types[r] == REAL && model_kinds[r] != BUILT_IN &&
                         (model_kinds[r] == OUTPUT) == are_outputs;
        if (fits) continue;
        say(self, "%s: there is no derivative %s %s", self->name, are_outputs ? "of" : "by",
            r < SCALARS ? model_names[r] : "a variable that there is not");
        return 0;
    }
    return 1;
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknown[],
                                        size_t unknowns, const fmi2ValueReference known[],
                                        size_t knowns, const fmi2Real seed[], fmi2Real value[]) {
    Instance *self = c;
    double seeds[SCALARS + 1] = {0.0}, along[SCALARS + 1];
    if (!have_derivatives(self, unknown, unknowns, 1) || !have_derivatives(self, known, knowns, 0) ||
        !refresh(self))
        return fmi2Error;
    for (size_t i = 0; i < knowns; i++) seeds[known[i]] = seed[i];
    if (!model_derivative(self, seeds, along)) return none_of(self, unknowns, "directional derivative");
    for (size_t i = 0; i < unknowns; i++) value[i] = along[unknown[i]];
    return fmi2OK;
}

/* ------------------------------------------------------------------ FMI: state */

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *kept) {
    if (!*kept && !(*kept = malloc(sizeof(State)))) return fmi2Error;
    memcpy(*kept, &((Instance *)c)->state, sizeof(State));
    return fmi2OK;
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate kept) {
    Instance *self = c;
    if (!kept || ((State *)kept)->fmu != self->state.fmu) {
        say(self, "%s: %s: %s", self->name, CALLED(fmi2SetFMUstate),
            kept ? "the state is not of this FMU" : "there is no state");
        return fmi2Error;
    }
    memcpy(&self->state, kept, sizeof(State));
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
    *size = sizeof(Seal) + sizeof(State);
    return fmi2OK;
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate kept, fmi2Byte bytes[], size_t size) {
    Instance *self = c;
    if (!kept || !bytes || size < sizeof(Seal) + sizeof(State)) {
        say(self, "%s: %s: no state, or a buffer of less than its %zu bytes",
            self->name, CALLED(fmi2SerializeFMUstate), sizeof(Seal) + sizeof(State));
        return fmi2Error;
    }
    memcpy(bytes + sizeof(Seal), kept, sizeof(State));
    seal_up(bytes, self->state.fmu, sizeof(State));
    return fmi2OK;
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size,
                                   fmi2FMUstate *kept) {
    Instance *self = c;
    char why[128];
    if (!seal_holds(bytes, size, self->state.fmu, why, sizeof why)) {
        say(self, "%s: %s: %s", self->name, CALLED(fmi2DeSerializeFMUstate), why);
        return fmi2Error;
    }
    if (!*kept && !(*kept = malloc(sizeof(State)))) return fmi2Error;
    memcpy(*kept, bytes + sizeof(Seal), sizeof(State));
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
