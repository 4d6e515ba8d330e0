/* FMI 2.0 co-simulation of a rig: its components, and the steps of seatrial's compiled master.

   Of the operations the first read all outputs; the next are visits of the initialisation, if a step
   has none; the next write and read every component in turn; the rest is a step, with its
   feed-through visits at the end. A step allocates nothing. */

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2Functions.h"
#include "rig.h"

#define EXPORT static __attribute__((unused))
#define UNTIMED
#include "master.inc"

#define NS 1e9
#define LATEST 2e6 /* s, up to which a double gives its nanoseconds back */
#define ANY_QUANTITY 1e20
#define LINE 64 /* bytes of a cache's line */

typedef enum { INSTANTIATED, INITIALISING, RUNNING, TERMINATED } Phase;
typedef enum { CURRENT, TOUCHED, UNSETTLED_STATE } Freshness;

typedef struct { /* all that changes; the components' own states come behind it */
    int64_t steps, now_ns;
    Phase phase;
    Freshness freshness;
    int failed, are_overridden; /* how many signals */
    double signals[SIGNALS + 1], previous[PREVIOUS + 1], relaxations[LOOPS + 1];
    unsigned char touched[NODES + 1], has_previous[OPERATIONS + 1], overridden[SIGNALS + 1];
    double overrides[SIGNALS + 1], own[SIGNALS + 1];
} State;

struct Work { /* operations, bound to the instance that carries them out */
    Master master;
    double buffer[BUFFER + 1]; /* of values on their way: no longer than the operations take */
    Operation operations[OPERATIONS + 1];
    Times times; /* of nobody: nothing is timed */
};

typedef struct {
    Work *work, *own_work; /* where it carries out operations; that of its own, if it has one */
    volatile int32_t said;
    fmi2Component components[NODES + 1];
    State state;
    fmi2CallbackLogger log;
    fmi2ComponentEnvironment environment;
    char name[256];
} Rig;

static void say(Rig *self, const char *format, ...) {
    char text[1024];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (self->log) self->log(self->environment, self->name, fmi2Error, "logStatusError", "%s", text);
}

#include "operations.inc"
#include "values.inc"
#include "state.inc"

fmi2Status rig_read(fmi2Component c, const fmi2ValueReference vr[], size_t count, double values[]) {
    Rig *self = c;
    fmi2Status status = refresh(self);
    for (size_t i = 0; i < count && status <= fmi2Warning; i++) {
        const Variable *variable = rig_variables + vr[i];
        if (variable->kind == OUTPUT_VALUE) values[i] = self->state.signals[variable->place];
        else status = get_one(self, vr[i], variable->type, values + i, NULL);
    }
    return status;
}

void rig_reseed(fmi2Component c, fmi2ValueReference parameter, double seed) {
    const Variable *variable = rig_variables + parameter;
    for (int i = 0; i < variable->targets; i++) {
        const Target *target = rig_targets + variable->target + i;
        char *component = ((Rig *)c)->components[target->node];
        ((double *)(component + rig_nodes[target->node].carrier->values))[target->reference] = seed;
    }
}

/* Let another value take the place of an output for all its readers, or end that; between steps. */
void rig_override(fmi2Component c, fmi2ValueReference output, int begins, double value) {
    Rig *self = c;
    State *state = &self->state;
    const int place = rig_variables[output].place;
    if (begins) {
        if (!state->overridden[place]) state->own[place] = state->signals[place];
        state->signals[place] = state->overrides[place] = value;
    } else if (state->overridden[place]) {
        state->signals[place] = state->own[place];
    }
    state->are_overridden += !!begins - state->overridden[place];
    state->overridden[place] = (unsigned char)!!begins;
    state->touched[rig_variables[output].node] = 1;
    if (state->freshness == CURRENT) state->freshness = TOUCHED;
}

/* ------------------------------------------------------------------ life */

/* Let an instance carry out its operations where others do too, one after the other. */
void rig_lend(fmi2Component c, Work *work) {
    Rig *self = c;
    free(self->own_work);
    self->own_work = NULL, self->work = work;
}

static void fetch_lines(const void *from, size_t size) {
    const char *const end = (const char *)from + size;
    for (const char *at = (const char *)((uintptr_t)from & ~(uintptr_t)(LINE - 1)); at < end; at += LINE)
        __builtin_prefetch(at, 0, 2); /* near the processor, beside what it works on */
}

/* Let the memory that a step of this instance touches come into the caches, while another steps. */
void rig_fetch(fmi2Component c) {
    Rig *self = c;
    fetch_lines(self, offsetof(Rig, state.overridden));
    for (int i = 0; i < NODES; i++) fetch_lines(self->components[i], rig_nodes[i].carrier->touched);
}

fmi2Component rig_component(fmi2Component c, int node) { return ((Rig *)c)->components[node]; }

/* Return to before the initialisation, with the values that the rig gives. */
static fmi2Status begin_anew(Rig *self) {
    memset(&self->state, 0, sizeof self->state);
    for (int i = 0; i < LOOPS; i++) self->state.relaxations[i] = 1.0;
    for (int i = 0; i < GIVEN; i++) {
        const Given *given = rig_given + i;
        const fmi2Status status =
            set_one(self, (fmi2ValueReference)given->variable, rig_variables[given->variable].type,
                    given->value, given->text);
        if (status > fmi2Warning) return status;
    }
    return fmi2OK;
}

static int has_components(Rig *self, const fmi2CallbackFunctions *functions) {
    char name[600];
    for (int i = 0; i < NODES; i++) {
        const Node *node = rig_nodes + i;
        snprintf(name, sizeof name, "%s%s%s", self->name, self->name[0] ? "." : "", node->name);
        self->components[i] = node->carrier->instantiate(name, fmi2CoSimulation,
                                                         node->carrier->guid, "", functions, 0, 0);
        if (!self->components[i]) return 0;
    }
    return 1;
}

void fmi2FreeInstance(fmi2Component c) {
    Rig *self = c;
    if (!self) return;
    for (int i = 0; i < NODES; i++)
        if (self->components[i]) rig_nodes[i].carrier->free_instance(self->components[i]);
    free(self->own_work);
    free(self);
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *functions, fmi2Boolean visible,
                              fmi2Boolean logging) {
    (void)resources, (void)visible, (void)logging; /* errors are always reported */
    Rig *self = calloc(1, sizeof *self);
    if (!self) return NULL;
    if (functions) self->log = functions->logger, self->environment = functions->componentEnvironment;
    snprintf(self->name, sizeof self->name, "%s", name ? name : "");
    if (type != fmi2CoSimulation || !guid || strcmp(guid, RIG_GUID) != 0) {
        say(self, "%s: co-simulation of %s is what this FMU has", self->name, RIG_GUID);
        free(self);
        return NULL;
    }
    if (!has_components(self, functions)) {
        fmi2FreeInstance(self);
        return NULL;
    }
    self->work = self->own_work = rig_new_work();
    if (!self->work) {
        fmi2FreeInstance(self);
        return NULL;
    }
    if (begin_anew(self) <= fmi2Warning) return self;
    fmi2FreeInstance(self);
    return NULL;
}

/* Call a function of every component; return the first answer that is no success. */
#define ALL(call)                                                     \
    do {                                                              \
        for (int i = 0; i < NODES; i++) {                             \
            const Carrier *carrier = rig_nodes[i].carrier;            \
            const fmi2Component component = self->components[i];      \
            const fmi2Status status = call;                           \
            if (status > fmi2Warning) return status;                  \
        }                                                             \
    } while (0)

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean has_tolerance, fmi2Real tolerance,
                               fmi2Real start, fmi2Boolean has_stop, fmi2Real stop) {
    Rig *self = c;
    if (!(fabs(start) < LATEST)) {
        say(self, "%s: start time is %g s; times are exact to the nanosecond up to %g s only",
            self->name, start, LATEST);
        return fmi2Error;
    }
    self->state.now_ns = __builtin_llrint(start * NS);
    ALL(carrier->set_up(component, has_tolerance, tolerance, start, has_stop, stop));
    return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
    Rig *self = c;
    ALL(carrier->enter(component));
    self->state.phase = INITIALISING;
    self->state.freshness = UNSETTLED_STATE;
    return refresh(self) <= fmi2Warning ? fmi2OK : fmi2Error;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
    Rig *self = c;
    if (refresh(self) > fmi2Warning) return fmi2Error;
    ALL(carrier->exit(component));
    self->state.phase = RUNNING;
    return settle(self) <= fmi2Warning ? fmi2OK : fmi2Error;
}

fmi2Status fmi2Terminate(fmi2Component c) {
    Rig *self = c;
    ALL(carrier->terminate(component));
    self->state.phase = TERMINATED;
    return fmi2OK;
}

fmi2Status fmi2Reset(fmi2Component c) {
    Rig *self = c;
    ALL(carrier->reset(component));
    return begin_anew(self);
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real t, fmi2Real h, fmi2Boolean no_earlier) {
    (void)no_earlier;
    Rig *self = c;
    State *state = &self->state;
    Master *m = &self->work->master;
    if (state->phase != RUNNING || !(h >= 0.0 && h < LATEST) || !(fabs(t) < LATEST)) {
        say(self, "%s: no step from %g s over %g s is possible now", self->name, t, h);
        return fmi2Error;
    }
    if (state->failed) {
        say(self, "%s: step refused after an earlier error", self->name);
        return fmi2Discard;
    }
    const int64_t h_ns = __builtin_llrint(h * NS), given = __builtin_llrint(t * NS);
    const int64_t count = (h_ns + STEP_NS / 2) / STEP_NS;
    if (llabs(h_ns - count * STEP_NS) > 1) { /* a host's own sums of steps are not exact */
        say(self, "%s: a step of %.9g s is no whole multiple of this rig's, %.9g s", self->name, h,
            (double)STEP_NS / NS);
        return fmi2Discard;
    }
    if (llabs(given - state->now_ns) > STEP_NS / 100 + 1) state->now_ns = given;
    if (count == 0) return fmi2OK;
    fmi2Status status = refresh(self);
    if (status <= fmi2Warning) {
        bind(self, STEPS, OPERATIONS);
        m->steps = state->steps, m->begin_ns = state->now_ns;
        status = outcome(self, master_run(m, m->steps + count));
        unbind(self, STEPS, OPERATIONS);
        state->steps = m->steps, state->now_ns = m->begin_ns;
    }
    state->failed = status > fmi2Warning;
    return status;
}

/* ------------------------------------------------------------------ what it has not */

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }

const char *fmi2GetVersion(void) { return fmi2Version; }

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t count,
                               const fmi2String categories[]) {
    (void)c, (void)on, (void)count, (void)categories;
    return fmi2OK;
}

fmi2Status fmi2CancelStep(fmi2Component c) {
    (void)c;
    return fmi2Error;
}

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                                       const fmi2Integer order[], const fmi2Real value[]) {
    (void)c, (void)vr, (void)order, (void)value;
    return count == 0 ? fmi2OK : fmi2Error;
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[],
                                        size_t count, const fmi2Integer order[], fmi2Real value[]) {
    (void)c, (void)vr, (void)order, (void)value;
    return count == 0 ? fmi2OK : fmi2Error;
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknown[],
                                        size_t unknowns, const fmi2ValueReference known[],
                                        size_t knowns, const fmi2Real seed[], fmi2Real value[]) {
    (void)c, (void)unknown, (void)known, (void)knowns, (void)seed, (void)value;
    return unknowns == 0 ? fmi2OK : fmi2Error;
}

#define STATUS(Type, type)                                                                      \
    fmi2Status fmi2Get##Type##Status(fmi2Component c, const fmi2StatusKind kind, type *value) { \
        (void)c, (void)kind, (void)value;                                                       \
        return fmi2Discard;                                                                     \
    }
STATUS(, fmi2Status)
STATUS(Real, fmi2Real)
STATUS(Integer, fmi2Integer)
STATUS(Boolean, fmi2Boolean)
STATUS(String, fmi2String)

#if LANES
#include "lockstep.inc"
#endif
