/* A model of FMI 1.0, 2.0 or 3.0 (FMI = 1, 2, 3): x' = -k x, a ball that bounces, steps at times,
a relay that looks at its input in events only, and an end at a time. FMI 1.0 and 2.0 can be
stepped as slaves too. It refuses calls that FMI does not allow in its mode. */

#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#if FMI == 1
#include "fmi1Functions.h"
#define BOOLEAN fmi1Boolean
#elif FMI == 2
#include "fmi2FunctionTypes.h"
#define BOOLEAN fmi2Boolean
#else
#include "fmi3FunctionTypes.h"
#define BOOLEAN fmi3Boolean
#endif
#define EXPORT(name) API(FMI, name)
#define API(version, name) API_(version, name)
#define API_(version, name) API##version(name)
#define API1(name) model_fmi##name
#define API2(name) fmi2##name
#define API3(name) fmi3##name

enum { OK, WARNING, DISCARD, ERROR };
enum { K, X, DX, HEIGHT, SPEED, FALL, U, Y, END, TROUBLE, REALS };
enum { STEPS, RELAY, EVENTS, COMPLETED, INTEGERS };
enum { NONE, NO_DERIVATIVES, BEYOND, STEP_EVENT, RESTLESS };
enum { BEFORE, INITIAL, IN_EVENT, CONTINUOUS };
typedef int Status;

typedef struct {
    double real[REALS], time, next, reached;
    int integer[INTEGERS], mode, ended;
    BOOLEAN flag;
    char text[64], name[64];
#if FMI == 1
    fmi1CallbackFunctions calls;
#elif FMI == 2
    fmi2CallbackFunctions calls;
#else
    fmi3InstanceEnvironment environment;
    fmi3LogMessageCallback log;
#endif
} Model;

static Status say(Model *s, Status status, const char *text) {
#if FMI == 1
    s->calls.logger(s, s->name, status, "all", "%s", text);
#elif FMI == 2
    s->calls.logger(s->calls.componentEnvironment, s->name, status, "all", "%s", text);
#else
    s->log(s->environment, status, "all", text);
#endif
    return status;
}

static Model *made(const char *name) {
    Model *s = calloc(1, sizeof *s);
    strncpy(s->name, name, 63);
    s->real[K] = s->real[X] = s->real[HEIGHT] = 1.0;
    s->next = 0.25;
    return s;
}

static void handle(Model *s) {
    double *r = s->real;
    s->integer[EVENTS]++;
    while (s->time >= s->next - 1e-9) s->integer[STEPS]++, s->next += 0.25;
    if (r[HEIGHT] <= 0 && r[SPEED] < 0) r[HEIGHT] = 0, r[SPEED] *= -0.8;
    s->integer[RELAY] = r[U] > 0.5;
    s->ended = r[END] > 0 && s->time >= r[END] - 1e-9;
}
static double next_event(Model *s) {
    return s->real[END] > s->time && s->real[END] < s->next ? s->real[END] : s->next;
}

Status EXPORT(SetTime)(Model *s, double t) { s->time = t; return OK; }
Status EXPORT(GetContinuousStates)(Model *s, double x[], size_t n) {
    x[0] = s->real[X], x[1] = s->real[HEIGHT], x[2] = s->real[SPEED];
    return n == 3 ? OK : ERROR;
}
Status EXPORT(SetContinuousStates)(Model *s, const double x[], size_t n) {
    if (FMI > 1 && s->mode != CONTINUOUS) return say(s, ERROR, "states are set in an event");
    s->real[X] = x[0], s->real[HEIGHT] = x[1], s->real[SPEED] = x[2];
    return OK;
}
static Status derive(Model *s, double d[]) {
    double *r = s->real;
    if (r[TROUBLE] == NO_DERIVATIVES && s->time > 0.5) return say(s, ERROR, "no derivatives here");
    if (r[TROUBLE] == BEYOND && s->time > 0.75) return DISCARD;
    d[0] = r[DX] = -r[K] * r[X], d[1] = r[SPEED], d[2] = r[FALL] = -9.81;
    return OK;
}
Status EXPORT(GetEventIndicators)(Model *s, double z[], size_t n) {
    z[0] = s->real[HEIGHT];
    return OK;
}
static Status completed(Model *s, BOOLEAN *event) {
    *event = s->real[TROUBLE] == STEP_EVENT && ++s->integer[COMPLETED] == 5;
    return OK;
}
static Status nominals(double x[]) { x[0] = x[1] = x[2] = 1.0; return OK; }
static Status mode(Model *s, int from, int to) {
    if (s->mode != from) return say(s, ERROR, "a mode out of order");
    s->mode = to;
    return OK;
}

/* ------------------------------------------------------------------ variables */

#define VALUES(Type, T, GET, SET)                                                                  \
    Status EXPORT(Get##Type)(Model *s, const unsigned r[], size_t n, T v[] COUNT) {                \
        s->real[Y] = 2 * s->real[U], s->real[DX] = -s->real[K] * s->real[X];                       \
        for (size_t i = 0; i < n; i++) v[i] = GET;                                                 \
        return OK;                                                                                 \
    }                                                                                              \
    Status EXPORT(Set##Type)(Model *s, const unsigned r[], size_t n, const T v[] COUNT) {          \
        if (FMI > 1 && s->mode == CONTINUOUS) return say(s, ERROR, "set without an event");        \
        for (size_t i = 0; i < n; i++) SET;                                                        \
        return OK;                                                                                 \
    }
#if FMI == 3
#define COUNT , size_t count
VALUES(Float64, double, s->real[r[i]], s->real[r[i]] = v[i])
VALUES(Int32, int32_t, s->integer[r[i] - 100], s->integer[r[i] - 100] = v[i])
VALUES(Boolean, bool, r[i] == 200 ? s->flag : !s->flag, s->flag = v[i])
#else
#define COUNT
VALUES(Real, double, s->real[r[i]], s->real[r[i]] = v[i])
VALUES(Integer, int, s->integer[r[i] - 100], s->integer[r[i] - 100] = v[i])
VALUES(Boolean, BOOLEAN, r[i] == 200 ? s->flag : !s->flag, s->flag = v[i])
#endif
VALUES(String, char *, s->text, strncpy(s->text, v[i], 63))

/* ------------------------------------------------------------------ versions */

#define UNUSED(name) Status EXPORT(name)() { return ERROR; }

#if FMI == 1
const char *EXPORT(GetVersion)(void) { return "1.0"; }
Model *EXPORT(InstantiateModel)(const char *name, const char *guid, fmi1CallbackFunctions calls,
                                fmi1Boolean logging) {
    Model *s = made(name);
    s->calls = calls;
    if (strcmp(guid, "{model}")) return say(s, ERROR, "another guid"), NULL;
    return s;
}
Model *EXPORT(InstantiateSlave)(const char *name, const char *guid, const char *place,
                                const char *mime, double timeout, fmi1Boolean visible,
                                fmi1Boolean interactive, fmi1CallbackFunctions calls,
                                fmi1Boolean logging) {
    Model *s = EXPORT(InstantiateModel)(name, guid, calls, logging);
    if (s) strncpy(s->text, mime, 63);
    return s;
}
void EXPORT(FreeModelInstance)(Model *s) { free(s); }
void EXPORT(FreeSlaveInstance)(Model *s) { free(s); }
Status EXPORT(Terminate)(Model *s) { return OK; }
Status EXPORT(TerminateSlave)(Model *s) { return OK; }
Status EXPORT(SetDebugLogging)(Model *s, fmi1Boolean on) { return OK; }
Status EXPORT(GetDerivatives)(Model *s, double d[], size_t n) { return derive(s, d); }
Status EXPORT(GetNominalContinuousStates)(Model *s, double x[], size_t n) { return nominals(x); }
Status EXPORT(CompletedIntegratorStep)(Model *s, char *event) { return completed(s, event); }
Status EXPORT(EventUpdate)(Model *s, char intermediate, fmi1EventInfo *info) {
    handle(s);
    info->iterationConverged = s->real[TROUBLE] != RESTLESS;
    info->stateValueReferencesChanged = info->stateValuesChanged = 0;
    info->terminateSimulation = s->ended;
    info->upcomingTimeEvent = 1;
    info->nextEventTime = next_event(s);
    return OK;
}
Status EXPORT(Initialize)(Model *s, char controlled, double tolerance, fmi1EventInfo *info) {
    double trouble = s->real[TROUBLE];
    s->real[TROUBLE] = NONE;
    Status status = EXPORT(EventUpdate)(s, 0, info);
    s->real[TROUBLE] = trouble;
    return status;
}
Status EXPORT(InitializeSlave)(Model *s, double start, char stops, double stop) {
    s->time = start;
    s->integer[RELAY] = s->real[U] > 0.5;
    return s->real[K] < 0 ? say(s, ERROR, "k is negative") : OK;
}
Status EXPORT(DoStep)(Model *s, double t, double h, char is_new) {
    if (s->real[TROUBLE] == NO_DERIVATIVES) return say(s, ERROR, "no step");
    if (fabs(t - s->time) > 1e-9) return say(s, ERROR, "steps do not follow each other");
    s->real[X] *= exp(-s->real[K] * h);
    s->time = t + h;
    handle(s);
    return s->real[TROUBLE] == STEP_EVENT ? say(s, WARNING, "such a step") : OK;
}
UNUSED(GetModelTypesPlatform) UNUSED(GetTypesPlatform) UNUSED(GetStateValueReferences)
UNUSED(CancelStep) UNUSED(GetBooleanStatus) UNUSED(GetIntegerStatus) UNUSED(GetRealStatus)
UNUSED(GetStatus) UNUSED(GetStringStatus) UNUSED(ResetSlave) UNUSED(SetRealInputDerivatives)
UNUSED(GetRealOutputDerivatives)
#else
Status EXPORT(Terminate)(Model *s) { return OK; }
void EXPORT(FreeInstance)(Model *s) { free(s); }
Status EXPORT(EnterEventMode)(Model *s) { return mode(s, CONTINUOUS, IN_EVENT); }
Status EXPORT(EnterContinuousTimeMode)(Model *s) { return mode(s, IN_EVENT, CONTINUOUS); }
Status EXPORT(ExitInitializationMode)(Model *s) { return mode(s, INITIAL, IN_EVENT); }
Status EXPORT(GetNominalsOfContinuousStates)(Model *s, double x[], size_t n) { return nominals(x); }
Status EXPORT(CompletedIntegratorStep)(Model *s, BOOLEAN back, BOOLEAN *event, BOOLEAN *end) {
    *end = 0;
    return completed(s, event);
}
static Status saved(Model *s, void **state) {
    if (!*state) *state = malloc(sizeof *s);
    memcpy(*state, s, sizeof *s);
    return OK;
}
static Status restored(Model *s, void *state) { memcpy(s, state, sizeof *s); return OK; }
static Status freed(Model *s, void **state) { free(*state); *state = NULL; return OK; }
UNUSED(Reset) UNUSED(SetDebugLogging) UNUSED(GetDirectionalDerivative)
#endif

#if FMI == 2
const char *EXPORT(GetVersion)(void) { return "2.0"; }
const char *EXPORT(GetTypesPlatform)(void) { return "default"; }
Model *EXPORT(Instantiate)(const char *name, fmi2Type type, const char *guid, const char *place,
                           const fmi2CallbackFunctions *calls, int visible, int logging) {
    Model *s = made(name);
    s->calls = *calls;
    return s;
}
Status EXPORT(SetupExperiment)(Model *s, int b, double tolerance, double start, int c, double d) {
    s->time = start;
    return OK;
}
Status EXPORT(EnterInitializationMode)(Model *s) { return mode(s, BEFORE, INITIAL); }
Status EXPORT(GetDerivatives)(Model *s, double d[], size_t n) { return derive(s, d); }
Status EXPORT(NewDiscreteStates)(Model *s, fmi2EventInfo *info) {
    handle(s);
    memset(info, 0, sizeof *info);
    info->newDiscreteStatesNeeded = s->real[TROUBLE] == RESTLESS;
    info->terminateSimulation = s->ended;
    info->nextEventTimeDefined = 1;
    info->nextEventTime = next_event(s);
    return OK;
}
Status EXPORT(DoStep)(Model *s, double t, double h, int back) {
    double end = s->real[END], to = end > 0 && t + h > end + 1e-9 ? end : t + h;
    s->mode = IN_EVENT;
    s->real[X] *= exp(-s->real[K] * (to - t));
    s->time = to;
    handle(s);
    return s->ended ? say(s, DISCARD, "this is the end") : OK;
}
Status EXPORT(GetBooleanStatus)(Model *s, int kind, int *value) {
    *value = s->ended;
    return kind == fmi2Terminated ? OK : ERROR;
}
Status EXPORT(GetRealStatus)(Model *s, int kind, double *value) {
    *value = s->time;
    return kind == fmi2LastSuccessfulTime ? OK : ERROR;
}
Status fmi2GetFMUstate(Model *s, void **state) { return saved(s, state); }
Status fmi2SetFMUstate(Model *s, void *state) { return restored(s, state); }
Status fmi2FreeFMUstate(Model *s, void **state) { return freed(s, state); }
UNUSED(SerializedFMUstateSize) UNUSED(SerializeFMUstate) UNUSED(DeSerializeFMUstate)
UNUSED(CancelStep) UNUSED(GetStatus) UNUSED(GetIntegerStatus) UNUSED(GetStringStatus)
UNUSED(SetRealInputDerivatives) UNUSED(GetRealOutputDerivatives)
#endif

#if FMI == 3
const char *EXPORT(GetVersion)(void) { return "3.0"; }
Model *EXPORT(InstantiateModelExchange)(const char *name, const char *token, const char *place,
                                        bool visible, bool logging, void *environment,
                                        fmi3LogMessageCallback log) {
    Model *s = made(name);
    s->environment = environment;
    s->log = log;
    return s;
}
Status EXPORT(EnterInitializationMode)(Model *s, bool b, double tolerance, double start, bool c,
                                       double d) {
    s->time = start;
    return mode(s, BEFORE, INITIAL);
}
Status EXPORT(GetContinuousStateDerivatives)(Model *s, double d[], size_t n) { return derive(s, d); }
Status EXPORT(GetNumberOfContinuousStates)(Model *s, size_t *n) { *n = 3; return OK; }
Status EXPORT(GetNumberOfEventIndicators)(Model *s, size_t *n) { *n = 1; return OK; }
Status EXPORT(UpdateDiscreteStates)(Model *s, bool *more, bool *end, bool *a, bool *b,
                                    bool *defined, double *next) {
    handle(s);
    *more = s->real[TROUBLE] == RESTLESS;
    *a = *b = false;
    *end = s->ended;
    *defined = true;
    *next = next_event(s);
    return OK;
}
Status fmi3GetFMUState(Model *s, void **state) { return saved(s, state); }
Status fmi3SetFMUState(Model *s, void *state) { return restored(s, state); }
Status fmi3FreeFMUState(Model *s, void **state) { return freed(s, state); }
#define UNUSED_TYPE(T) UNUSED(Get##T) UNUSED(Set##T)
UNUSED_TYPE(Float32) UNUSED_TYPE(Int8) UNUSED_TYPE(UInt8) UNUSED_TYPE(Int16) UNUSED_TYPE(UInt16)
UNUSED_TYPE(UInt32) UNUSED_TYPE(Int64) UNUSED_TYPE(UInt64) UNUSED_TYPE(Binary) UNUSED_TYPE(Clock)
UNUSED_TYPE(IntervalDecimal) UNUSED_TYPE(IntervalFraction) UNUSED_TYPE(ShiftDecimal)
UNUSED_TYPE(ShiftFraction)
UNUSED(ActivateModelPartition) UNUSED(DeserializeFMUState) UNUSED(DoStep) UNUSED(EnterStepMode)
UNUSED(EnterConfigurationMode) UNUSED(EvaluateDiscreteStates) UNUSED(ExitConfigurationMode)
UNUSED(GetAdjointDerivative) UNUSED(GetNumberOfVariableDependencies) UNUSED(GetOutputDerivatives)
UNUSED(GetVariableDependencies) UNUSED(InstantiateCoSimulation) UNUSED(SerializeFMUState)
UNUSED(InstantiateScheduledExecution) UNUSED(SerializedFMUStateSize)
#endif
