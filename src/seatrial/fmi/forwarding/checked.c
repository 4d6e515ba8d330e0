/* FMI 2.0 co-simulation by pythonfmu's library, which gets no call that FMI does not allow.

   What a component logs as an error is an error of the call that runs: pythonfmu returns that all
   is well, or that everything is lost. A refused call changes nothing. */

#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "folder.h"
#include "forwarded.h"
#include "retired.h"
#include "seal.h"

#ifndef CALLED /* the name by which the host called the function */
#define CALLED(name) #name
#endif

enum { INSTANTIATED = 1, INITIALISING = 2, RUNNING = 4, TERMINATED = 8, LOST = 16, FREED = 32 };
#define BEFORE_THE_END (INSTANTIATED | INITIALISING | RUNNING)
#define ALIVE (BEFORE_THE_END | TERMINATED)

typedef struct {
    fmi2Component inner;
    fmi2CallbackFunctions functions; /* pythonfmu's */
    fmi2CallbackLogger log;          /* and the host's */
    fmi2ComponentEnvironment environment;
    uint64_t fmu;
    int phase;
    double time;    /* that was reached */
    int complained; /* in the call that runs */
    char name[256];
} Checked;

static const Forwarded *its;

/* ------------------------------------------------------------------ messages */

static void say(Checked *self, fmi2Status status, const char *text) {
    static const char *const categories[] = {"",               "logStatusWarning", "logStatusDiscard",
                                             "logStatusError", "logStatusFatal",   "logStatusPending"};
    self->complained |= status == fmi2Error || status == fmi2Fatal;
    if (self->log)
        self->log(self->environment, self->name, status,
                  status <= fmi2Pending ? categories[status] : "", "%s", text);
}

/* Pass a message of the component on. */
static void take_message(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status,
                         fmi2String category, fmi2String format, ...) {
    char text[4096];
    va_list arguments;
    (void)name, (void)category;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    say(environment, status, text);
}

#if defined(__GNUC__)
__attribute__((format(printf, 3, 4)))
#endif
static fmi2Status refuse(Checked *self, const char *function, const char *format, ...) {
    char text[LONGEST + 512];
    va_list arguments;
    const int begun = snprintf(text, sizeof text, "%s: %s: ", self->name, function);
    va_start(arguments, format);
    vsnprintf(text + begun, sizeof text - (size_t)begun, format, arguments);
    va_end(arguments);
    say(self, fmi2Error, text);
    return fmi2Error;
}

/* ------------------------------------------------------------------ calls */

static const char *word(int phase) {
    switch (phase) {
    case INSTANTIATED: return "before the initialisation";
    case INITIALISING: return "during the initialisation";
    case RUNNING: return "once the initialisation has ended";
    case TERMINATED: return "once the run has been terminated";
    default: return "after a fatal error";
    }
}

/* Return the instance if it may be called in its phase; NULL, and why is logged, if it may not. */
static Checked *entered(fmi2Component c, const char *function, int phases) {
    Checked *const self = c;
    if (!self || self->phase == FREED) return NULL; /* nobody listens any more */
    self->complained = 0;
    if (self->phase & phases) return self;
    refuse(self, function, "not allowed %s", word(self->phase));
    return NULL;
}

/* Return what a call of pythonfmu's library has come to. */
static fmi2Status outcome(Checked *self, fmi2Status status) {
    if (status == fmi2Fatal) self->phase = LOST; /* the library has freed what it had */
    return status <= fmi2Warning && self->complained ? fmi2Error : status;
}

#define ENTER(name, phases)                                     \
    Checked *const self = entered(c, CALLED(name), phases);     \
    if (!self) return fmi2Error

#define REFUSE(name, ...) return refuse(self, CALLED(name), __VA_ARGS__)

#define ACCESS(name, phases, Type)                                                                \
    fmi2Status name(fmi2Component c, const fmi2ValueReference vr[], size_t count, Type value[]) { \
        ENTER(name, phases);                                                                      \
        if (count && (!vr || !value)) REFUSE(name, "%zu variables without a place", count);       \
        return outcome(self, its->name(self->inner, vr, count, value));                           \
    }
ACCESS(fmi2GetReal, ALIVE, fmi2Real)
ACCESS(fmi2GetInteger, ALIVE, fmi2Integer)
ACCESS(fmi2GetBoolean, ALIVE, fmi2Boolean)
ACCESS(fmi2GetString, ALIVE, fmi2String)
ACCESS(fmi2SetReal, BEFORE_THE_END, const fmi2Real)
ACCESS(fmi2SetInteger, BEFORE_THE_END, const fmi2Integer)
ACCESS(fmi2SetBoolean, BEFORE_THE_END, const fmi2Boolean)

/* pythonfmu's library makes no str of what is no UTF-8, and ends the process over it. */
static int is_utf8(const char *text) {
    const unsigned char *c = (const unsigned char *)text;
    while (*c) {
        const int more = *c < 0x80 ? 0 : *c < 0xc2 ? -1 : *c < 0xe0 ? 1 : *c < 0xf0 ? 2 : *c < 0xf5 ? 3 : -1;
        if (more < 0 || (*c == 0xe0 && c[1] < 0xa0) || (*c == 0xed && c[1] > 0x9f) ||
            (*c == 0xf0 && c[1] < 0x90) || (*c == 0xf4 && c[1] > 0x8f))
            return 0;
        c++;
        for (int i = 0; i < more; i++, c++)
            if ((*c & 0xc0) != 0x80) return 0;
    }
    return 1;
}

fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                         const fmi2String value[]) {
    ENTER(fmi2SetString, BEFORE_THE_END);
    if (count && (!vr || !value)) REFUSE(fmi2SetString, "%zu variables without a place", count);
    for (size_t i = 0; i < count; i++)
        if (!value[i] || !is_utf8(value[i]))
            REFUSE(fmi2SetString, "value reference %u: %s", vr[i],
                   value[i] ? "the text is not UTF-8" : "there is no text");
    return outcome(self, its->fmi2SetString(self->inner, vr, count, value));
}

#define STATUS(name, Type)                                                                        \
    fmi2Status name(fmi2Component c, const fmi2StatusKind kind, Type *value) {                    \
        ENTER(name, ALIVE);                                                                       \
        return outcome(self, its->name(self->inner, kind, value));                                \
    }
STATUS(fmi2GetStatus, fmi2Status)
STATUS(fmi2GetRealStatus, fmi2Real)
STATUS(fmi2GetIntegerStatus, fmi2Integer)
STATUS(fmi2GetBooleanStatus, fmi2Boolean)
STATUS(fmi2GetStringStatus, fmi2String)

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknown[],
                                        size_t unknowns, const fmi2ValueReference known[],
                                        size_t knowns, const fmi2Real along[], fmi2Real value[]) {
    ENTER(fmi2GetDirectionalDerivative, ALIVE);
    return outcome(self, its->fmi2GetDirectionalDerivative(self->inner, unknown, unknowns, known,
                                                           knowns, along, value));
}

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                                       const fmi2Integer order[], const fmi2Real value[]) {
    ENTER(fmi2SetRealInputDerivatives, BEFORE_THE_END);
    return outcome(self, its->fmi2SetRealInputDerivatives(self->inner, vr, count, order, value));
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[],
                                        size_t count, const fmi2Integer order[], fmi2Real value[]) {
    ENTER(fmi2GetRealOutputDerivatives, ALIVE);
    return outcome(self, its->fmi2GetRealOutputDerivatives(self->inner, vr, count, order, value));
}

/* ------------------------------------------------------------------ life */

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }

const char *fmi2GetVersion(void) { return "2.0"; }

static int has_inner(Checked *self, fmi2Type type, fmi2String guid, fmi2String resources,
                     fmi2Boolean visible) {
    char folder[LONGEST], uri[LONGEST + 16], problem[LONGEST + 512] = "";
    if (type != fmi2CoSimulation)
        snprintf(problem, sizeof problem, "this FMU has co-simulation only");
    else if (!guid)
        snprintf(problem, sizeof problem, "there is no GUID");
    else if (folder_of(resources, folder, sizeof folder, problem, sizeof problem))
        its = library_of(folder, problem, sizeof problem);
    if (problem[0]) {
        refuse(self, CALLED(fmi2Instantiate), "%s", problem);
        return 0;
    }
    snprintf(uri, sizeof uri, "file://%s%s", *folder == '/' ? "" : "/", folder);
    self->fmu = seal_fmu(guid);
    self->inner = its->fmi2Instantiate(self->name, type, guid, uri, &self->functions, visible,
                                       fmi2True); /* errors are always reported */
    return self->inner && !self->complained;
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *functions, fmi2Boolean visible,
                              fmi2Boolean logging) {
    (void)logging;
    Checked *const self = calloc(1, sizeof *self);
    if (!self) return NULL;
    if (functions) self->log = functions->logger, self->environment = functions->componentEnvironment;
    self->functions = (fmi2CallbackFunctions){take_message, calloc, free, NULL, self};
    self->phase = INSTANTIATED;
    snprintf(self->name, sizeof self->name, "%s", name ? name : "");
    if (has_inner(self, type, guid, resources, visible)) return self;
    if (self->inner) its->fmi2FreeInstance(self->inner);
    free(self);
    return NULL;
}

void fmi2FreeInstance(fmi2Component c) {
    Checked *const self = c;
    if (!self || self->phase == FREED) return;
    if (self->phase != LOST) its->fmi2FreeInstance(self->inner);
    self->phase = FREED;
    retire(self);
}

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t count,
                               const fmi2String categories[]) {
    ENTER(fmi2SetDebugLogging, ALIVE);
    (void)on, (void)count, (void)categories; /* errors are always reported */
    return fmi2OK;
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean has_tolerance, fmi2Real tolerance,
                               fmi2Real start, fmi2Boolean has_stop, fmi2Real stop) {
    ENTER(fmi2SetupExperiment, INSTANTIATED);
    if (!__builtin_isfinite(start)) REFUSE(fmi2SetupExperiment, "the start time is %g s", start);
    const fmi2Status status = outcome(
        self, its->fmi2SetupExperiment(self->inner, has_tolerance, tolerance, start, has_stop, stop));
    if (status <= fmi2Warning) self->time = start;
    return status;
}

/* Go on to another phase, if a call was well. */
static fmi2Status gone_on(Checked *self, fmi2Status status, int phase) {
    status = outcome(self, status);
    if (status <= fmi2Warning) self->phase = phase;
    return status;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
    ENTER(fmi2EnterInitializationMode, INSTANTIATED);
    return gone_on(self, its->fmi2EnterInitializationMode(self->inner), INITIALISING);
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
    ENTER(fmi2ExitInitializationMode, INITIALISING);
    return gone_on(self, its->fmi2ExitInitializationMode(self->inner), RUNNING);
}

fmi2Status fmi2Terminate(fmi2Component c) {
    ENTER(fmi2Terminate, BEFORE_THE_END); /* a run that does not begin ends too */
    return gone_on(self, its->fmi2Terminate(self->inner), TERMINATED);
}

fmi2Status fmi2Reset(fmi2Component c) {
    ENTER(fmi2Reset, ALIVE);
    const fmi2Status status = gone_on(self, its->fmi2Reset(self->inner), INSTANTIATED);
    if (status <= fmi2Warning) self->time = 0.0;
    return status;
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real t, fmi2Real h, fmi2Boolean no_earlier) {
    ENTER(fmi2DoStep, RUNNING);
    if (!(h > 0.0) || !__builtin_isfinite(h))
        REFUSE(fmi2DoStep, "the step is %g s, allowed are finite ones greater than 0 s", h);
    const double slack = h / 100.0 > 1e-9 ? h / 100.0 : 1e-9; /* of hosts that add up steps */
    if (!(__builtin_fabs(t - self->time) <= slack))
        REFUSE(fmi2DoStep, "the step begins at %.12g s, but %.12g s was reached", t, self->time);
    const fmi2Status status = outcome(self, its->fmi2DoStep(self->inner, t, h, no_earlier));
    if (status <= fmi2Warning) self->time = t + h;
    return status;
}

fmi2Status fmi2CancelStep(fmi2Component c) {
    ENTER(fmi2CancelStep, RUNNING);
    return outcome(self, its->fmi2CancelStep(self->inner));
}

/* ------------------------------------------------------------------ states */

typedef struct {
    double time;
    int phase;
} Own;

typedef struct {
    uint64_t fmu;
    Own own;
    fmi2FMUstate inner;
} Kept;

#define HEAD (sizeof(Seal) + sizeof(Own)) /* of serialised states; pythonfmu's bytes follow */

/* Whether there is a state, and of this FMU. */
static int is_kept(Checked *self, const char *function, const Kept *kept) {
    if (kept && kept->fmu == self->fmu) return 1;
    refuse(self, function, kept ? "the state is not of this FMU" : "there is no state");
    return 0;
}

static fmi2Status freed(Checked *self, fmi2FMUstate *state) {
    Kept *const kept = *state;
    const fmi2Status status =
        kept->inner ? outcome(self, its->fmi2FreeFMUstate(self->inner, &kept->inner)) : fmi2OK;
    kept->fmu = 0;
    free(kept);
    *state = NULL;
    return status;
}

/* Put a state at `place`, instead of one that is there. */
static fmi2Status kept_at(Checked *self, fmi2FMUstate *place, Own own, fmi2FMUstate inner) {
    if (*place) freed(self, place);
    Kept *const kept = calloc(1, sizeof *kept);
    if (!kept) return fmi2Error;
    *kept = (Kept){self->fmu, own, inner};
    *place = kept;
    return fmi2OK;
}

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state) {
    ENTER(fmi2GetFMUstate, ALIVE);
    if (!state) REFUSE(fmi2GetFMUstate, "there is no place for a state");
    if (*state && !is_kept(self, CALLED(fmi2GetFMUstate), *state)) return fmi2Error;
    fmi2FMUstate inner = NULL;
    const fmi2Status status = outcome(self, its->fmi2GetFMUstate(self->inner, &inner));
    if (status <= fmi2Warning) return kept_at(self, state, (Own){self->time, self->phase}, inner);
    if (inner && self->phase != LOST) its->fmi2FreeFMUstate(self->inner, &inner);
    return status;
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state) {
    ENTER(fmi2SetFMUstate, ALIVE);
    const Kept *const kept = state;
    if (!is_kept(self, CALLED(fmi2SetFMUstate), kept)) return fmi2Error;
    const fmi2Status status = outcome(self, its->fmi2SetFMUstate(self->inner, kept->inner));
    if (status <= fmi2Warning) self->time = kept->own.time, self->phase = kept->own.phase;
    return status;
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state) {
    ENTER(fmi2FreeFMUstate, ALIVE);
    if (!state || !*state) return fmi2OK;
    return is_kept(self, CALLED(fmi2FreeFMUstate), *state) ? freed(self, state) : fmi2Error;
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t *size) {
    ENTER(fmi2SerializedFMUstateSize, ALIVE);
    const Kept *const kept = state;
    if (!is_kept(self, CALLED(fmi2SerializedFMUstateSize), kept)) return fmi2Error;
    const fmi2Status status =
        outcome(self, its->fmi2SerializedFMUstateSize(self->inner, kept->inner, size));
    *size += HEAD;
    return status;
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size) {
    ENTER(fmi2SerializeFMUstate, ALIVE);
    const Kept *const kept = state;
    size_t inner = 0;
    if (!is_kept(self, CALLED(fmi2SerializeFMUstate), kept)) return fmi2Error;
    fmi2Status status =
        outcome(self, its->fmi2SerializedFMUstateSize(self->inner, kept->inner, &inner));
    if (status > fmi2Warning) return status;
    if (!bytes || size < HEAD + inner)
        REFUSE(fmi2SerializeFMUstate, "the state has %zu bytes, the buffer %zu", HEAD + inner, size);
    memcpy(bytes + sizeof(Seal), &kept->own, sizeof(Own));
    status = outcome(self,
                     its->fmi2SerializeFMUstate(self->inner, kept->inner, bytes + HEAD, inner));
    if (status <= fmi2Warning) seal_up(bytes, self->fmu, sizeof(Own) + inner);
    return status;
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size,
                                   fmi2FMUstate *state) {
    ENTER(fmi2DeSerializeFMUstate, ALIVE);
    char why[128];
    Own own;
    fmi2FMUstate inner = NULL;
    if (!bytes || !state) REFUSE(fmi2DeSerializeFMUstate, "there is no state, or no place for it");
    if (!seal_holds(bytes, size, self->fmu, why, sizeof why))
        REFUSE(fmi2DeSerializeFMUstate, "%s", why);
    if (*state && !is_kept(self, CALLED(fmi2DeSerializeFMUstate), *state)) return fmi2Error;
    memcpy(&own, bytes + sizeof(Seal), sizeof own);
    const fmi2Status status = outcome(
        self, its->fmi2DeSerializeFMUstate(self->inner, bytes + HEAD, size - HEAD, &inner));
    return status <= fmi2Warning ? kept_at(self, state, own, inner) : status;
}
