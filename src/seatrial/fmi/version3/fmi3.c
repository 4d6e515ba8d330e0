/* FMI 3.0 co-simulation: life, steps, states and derivatives, by the functions of FMI 2.0.

   Values are in values.c, events and buses in events.c, what these FMUs do not have in absent.c. */

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "front.h"
#include "retired.h"
#include "seal.h"

static const char *const categories[] = {"", "logStatusWarning", "logStatusDiscard",
                                         "logStatusError", "logStatusFatal"};

static void logged(Front *self, int status, const char *message) {
    if (self->log && fmi3Warning <= status && status <= fmi3Fatal)
        self->log(self->environment, (fmi3Status)status, categories[status], message);
}

static void take_message(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status,
                         fmi2String category, fmi2String format, ...) {
    char message[4096];
    va_list arguments;
    (void)name, (void)category;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    logged(environment, (int)status, message);
}

fmi3Status front_refuses(Front *self, const char *format, ...) {
    char message[1024];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    logged(self, fmi3Error, message);
    return fmi3Error;
}

/* ------------------------------------------------------------------ life */

/* Return a folder's path as a URI, without a separator at its end, as FMI 2.0 has it. */
static char *uri_of(const char *path) {
    const char *const given = path ? path : "";
    const int is_uri = strncmp(given, "file:", 5) == 0;
    const size_t size = strlen(given) + sizeof "file:///";
    char *const uri = malloc(size);
    if (!uri) return NULL;
    const char *const start = is_uri ? "" : *given == '/' ? "file://" : "file:///";
    snprintf(uri, size, "%s%s", *given ? start : "", given);
#ifdef _WIN32
    for (char *c = uri; *c; c++)
        if (*c == '\\') *c = '/';
#endif
    for (size_t n = strlen(uri); n && uri[n - 1] == '/'; n--) uri[n - 1] = '\0';
    return uri;
}

fmi3Instance fmi3InstantiateCoSimulation(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
    fmi3Boolean logging, fmi3Boolean events, fmi3Boolean early, const fmi3ValueReference required[],
    size_t count, fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
    fmi3IntermediateUpdateCallback update) {
    (void)early, (void)required, (void)count, (void)update; /* nothing happens within a step */
    (void)logging;                                          /* errors are always reported */
    Front *self = calloc(1, sizeof *self);
    char *const uri = uri_of(resources);
    if (!self || !uri) {
        free(self);
        free(uri);
        return NULL;
    }
    self->log = log, self->environment = environment;
    self->fmu = seal_fmu(token ? token : "");
    snprintf(self->name, sizeof self->name, "%s", name ? name : "");
    self->functions = (fmi2CallbackFunctions){take_message, calloc, free, NULL, self};
    self->uses_events = events;
    events_reset(self);
    if (events && BUSES == 0)
        front_refuses(self, "%s: this FMU has no event mode", self->name);
    else
        self->inner = fmi2Instantiate(self->name, fmi2CoSimulation, token ? token : "", uri,
                                      &self->functions, visible, fmi2True);
    free(uri);
    if (self->inner) return self;
    free(self);
    return NULL;
}

void fmi3FreeInstance(fmi3Instance instance) {
    Front *self = instance;
    if (!self || !self->inner) return;
    fmi2FreeInstance(self->inner);
    free(self->buffer);
    events_free(&self->events);
    *self = (Front){0};
    retire(self);
}

const char *fmi3GetVersion(void) { return fmi3Version; }

fmi3Status fmi3SetDebugLogging(fmi3Instance instance, fmi3Boolean on, size_t count,
                               const fmi3String names[]) {
    (void)instance, (void)on, (void)count, (void)names; /* errors are always reported */
    return fmi3OK;
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance instance, fmi3Boolean has_tolerance,
                                       fmi3Float64 tolerance, fmi3Float64 start,
                                       fmi3Boolean has_stop, fmi3Float64 stop) {
    Front *self = instance;
    const fmi3Status status = passed(
        fmi2SetupExperiment(self->inner, has_tolerance, tolerance, start, has_stop, stop));
    if (status > fmi3Warning) return status;
    self->time = start;
    return passed(fmi2EnterInitializationMode(self->inner));
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance instance) {
    Front *self = instance;
    const fmi3Status status = passed(fmi2ExitInitializationMode(self->inner));
    return status <= fmi3Warning ? events_begin(self) : status;
}

fmi3Status fmi3Terminate(fmi3Instance instance) {
    Front *self = instance;
    return passed(fmi2Terminate(self->inner));
}

fmi3Status fmi3Reset(fmi3Instance instance) {
    Front *self = instance;
    self->time = 0.0;
    events_reset(self);
    return passed(fmi2Reset(self->inner));
}

fmi3Status fmi3DoStep(fmi3Instance instance, fmi3Float64 t, fmi3Float64 h,
                      fmi3Boolean no_earlier, fmi3Boolean *event, fmi3Boolean *ends,
                      fmi3Boolean *early, fmi3Float64 *last) {
    Front *self = instance;
    *event = *ends = *early = fmi3False;
    *last = self->time;
    fmi3Status status = events_before_step(self);
    if (status > fmi3Warning) return status;
    status = passed(fmi2DoStep(self->inner, t, h, no_earlier));
    if (status > fmi3Warning) return status;
    *last = self->time = t + h;
    return events_after_step(self, event);
}

/* ------------------------------------------------------------------ states */

typedef struct {
    fmi2FMUstate inner;
    double time;
    Events events;
} Kept;

#define HEAD (sizeof(Seal) + sizeof(double)) /* of serialised states: events and FMI 2.0's follow */

/* Return the state at `place`, made if there is none; NULL without memory. */
static Kept *kept_at(fmi3FMUState *place) {
    if (!*place) *place = calloc(1, sizeof(Kept));
    return *place;
}

fmi3Status fmi3GetFMUState(fmi3Instance instance, fmi3FMUState *state) {
    Front *self = instance;
    Kept *const kept = kept_at(state);
    if (!kept) return fmi3Error;
    kept->time = self->time;
    if (!events_copy(&kept->events, &self->events)) return fmi3Error;
    return passed(fmi2GetFMUstate(self->inner, &kept->inner));
}

fmi3Status fmi3SetFMUState(fmi3Instance instance, fmi3FMUState state) {
    Front *self = instance;
    const Kept *const kept = state;
    if (!kept) return front_refuses(self, "%s: there is no state to restore", self->name);
    const fmi3Status status = passed(fmi2SetFMUstate(self->inner, kept->inner));
    if (status > fmi3Warning) return status;
    self->time = kept->time;
    return events_copy(&self->events, &kept->events) ? status : fmi3Error;
}

fmi3Status fmi3FreeFMUState(fmi3Instance instance, fmi3FMUState *state) {
    Front *self = instance;
    if (!state || !*state) return fmi3OK;
    Kept *const kept = *state;
    const fmi3Status status =
        kept->inner ? passed(fmi2FreeFMUstate(self->inner, &kept->inner)) : fmi3OK;
    events_free(&kept->events);
    free(kept);
    *state = NULL;
    return status;
}

fmi3Status fmi3SerializedFMUStateSize(fmi3Instance instance, fmi3FMUState state, size_t *size) {
    Front *self = instance;
    const Kept *const kept = state;
    if (!kept) return front_refuses(self, "%s: there is no state to serialise", self->name);
    const fmi3Status status =
        passed(fmi2SerializedFMUstateSize(self->inner, kept->inner, size));
    *size += HEAD + events_size(&kept->events);
    return status;
}

fmi3Status fmi3SerializeFMUState(fmi3Instance instance, fmi3FMUState state, fmi3Byte bytes[],
                                 size_t size) {
    Front *self = instance;
    const Kept *const kept = state;
    const size_t head = kept ? HEAD + events_size(&kept->events) : 0;
    if (!kept || !bytes || size < head)
        return front_refuses(self, "%s: fmi3SerializeFMUState: no state, or too few bytes for it",
                             self->name);
    memcpy(bytes + sizeof(Seal), &kept->time, sizeof kept->time);
    events_write(&kept->events, bytes + HEAD);
    const fmi3Status status = passed(fmi2SerializeFMUstate(
        self->inner, kept->inner, (fmi2Byte *)bytes + head, size - head));
    if (status <= fmi3Warning) seal_up(bytes, self->fmu, size - sizeof(Seal));
    return status;
}

fmi3Status fmi3DeserializeFMUState(fmi3Instance instance, const fmi3Byte bytes[], size_t size,
                                   fmi3FMUState *state) {
    Front *self = instance;
    char why[128] = "there is no state, or no place for it";
    if (!bytes || !state || !seal_holds(bytes, size, self->fmu, why, sizeof why))
        return front_refuses(self, "%s: fmi3DeserializeFMUState: %s", self->name, why);
    Kept *const kept = calloc(1, sizeof *kept);
    if (!kept) return fmi3Error;
    memcpy(&kept->time, bytes + sizeof(Seal), sizeof kept->time);
    const size_t taken = events_read(&kept->events, bytes + HEAD, size - HEAD);
    fmi3Status status = taken ? fmi3OK : fmi3Error;
    if (taken)
        status = passed(fmi2DeSerializeFMUstate(self->inner, (const fmi2Byte *)bytes + HEAD + taken,
                                                size - HEAD - taken, &kept->inner));
    fmi3FMUState failed = kept;
    fmi3FreeFMUState(instance, status > fmi3Warning ? &failed : state);
    if (status <= fmi3Warning) *state = kept;
    return status;
}

/* ------------------------------------------------------------------ derivatives */

/* Return the scalars of variables, NULL without memory; `count` is how many they are. */
static fmi2ValueReference *scalars_of(const fmi3ValueReference variables[], size_t some,
                                      size_t *count) {
    *count = 0;
    for (size_t i = 0; i < some; i++) *count += (variables[i] >> MORE_THAN_ONE) + 1;
    fmi2ValueReference *const scalars = malloc((*count + 1) * sizeof *scalars), *next = scalars;
    for (size_t i = 0; scalars && i < some; i++)
        for (unsigned k = 0; k <= variables[i] >> MORE_THAN_ONE; k++)
            *next++ = (variables[i] & TIME) + k;
    return scalars;
}

/* The product of the derivatives, `unknowns` by `knowns`, with a seed: of each of these alone. */
static fmi3Status adjoint(Front *self, const fmi2ValueReference *unknowns, size_t rows,
                          const fmi2ValueReference *knowns, size_t columns, const double *seed,
                          double *product) {
    double *const column = malloc((rows + 1) * sizeof *column);
    const double one = 1.0;
    fmi3Status status = column ? fmi3OK : fmi3Error;
    for (size_t k = 0; k < columns && status <= fmi3Warning; k++) {
        status = passed(fmi2GetDirectionalDerivative(self->inner, unknowns, rows, &knowns[k],
                                                           1, &one, column));
        product[k] = 0.0;
        for (size_t i = 0; i < rows && status <= fmi3Warning; i++)
            product[k] += column[i] * seed[i];
    }
    free(column);
    return status;
}

static fmi3Status derivative(Front *self, const fmi3ValueReference unknowns[], size_t some_unknowns,
                             const fmi3ValueReference knowns[], size_t some_knowns, int is_adjoint,
                             const double seed[], size_t seeds, double product[], size_t products) {
    size_t rows, columns;
    fmi2ValueReference *const of = scalars_of(unknowns, some_unknowns, &rows);
    fmi2ValueReference *const by = scalars_of(knowns, some_knowns, &columns);
    fmi3Status status = fmi3Error;
    if (seeds != (is_adjoint ? rows : columns) || products != (is_adjoint ? columns : rows))
        front_refuses(self, "%s: derivatives of %zu by %zu with %zu seeds and %zu results",
                      self->name, rows, columns, seeds, products);
    else if (of && by && is_adjoint)
        status = adjoint(self, of, rows, by, columns, seed, product);
    else if (of && by)
        status = passed(fmi2GetDirectionalDerivative(self->inner, of, rows, by, columns, seed,
                                                           product));
    free(of);
    free(by);
    return status;
}

fmi3Status fmi3GetDirectionalDerivative(fmi3Instance instance, const fmi3ValueReference unknowns[],
                                        size_t rows, const fmi3ValueReference knowns[],
                                        size_t columns, const fmi3Float64 seed[], size_t seeds,
                                        fmi3Float64 product[], size_t products) {
    return derivative(instance, unknowns, rows, knowns, columns, 0, seed, seeds, product, products);
}

fmi3Status fmi3GetAdjointDerivative(fmi3Instance instance, const fmi3ValueReference unknowns[],
                                    size_t rows, const fmi3ValueReference knowns[], size_t columns,
                                    const fmi3Float64 seed[], size_t seeds, fmi3Float64 product[],
                                    size_t products) {
    return derivative(instance, unknowns, rows, knowns, columns, 1, seed, seeds, product, products);
}
