/* An FMI 3.0 slave with clocks of every kind, which refuses what FMI 3.0 does not allow.

It knows by itself when its time-based clocks are to tick, and fails if one is missed, or set at
another time. Variables of a clock are refused unless it is active. References: 1 to 8 clocks, 10
and 20 + clock how often it was active and when last, 30 and more signals, 40 and more parameters. */

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "fmi3FunctionTypes.h"

enum { SAMPLE = 1, THIRD, TUNED, WIDENING, DELAYED, POKE, ALARM, SECOND, CLOCKS };
enum { COUNT = 10, WHEN = 20, U = 30, SUM, WORD, ANSWER, START, TIME, SECONDS };
enum { PACE = 40, DELAY, ALARM_EVERY, CHAIN };
enum { INSTANTIATED, INITIALISING, STEPPING, EVENT };

typedef struct {
    fmi3LogMessageCallback log;
    fmi3InstanceEnvironment environment;
    int state, alarms, seconds, chain, chained;
    bool active[CLOCKS], start, is_known, is_new, alarm_is_asked;
    double time, next[CLOCKS], when[CLOCKS], u, sum, pace, said_pace, delay, alarm_every;
    int count[CLOCKS];
    unsigned char word[64], answer[64];
    size_t length;
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
    if (!with_events) return NULL;
    Slave *s = calloc(1, sizeof *s);
    s->log = log;
    s->environment = environment;
    s->pace = 0.02;
    s->delay = 0.025;
    for (int k = 0; k < CLOCKS; k++) s->next[k] = INFINITY;
    return s;
}
void fmi3FreeInstance(fmi3Instance c) { free(c); }

fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean b, fmi3Float64 tolerance,
                                       fmi3Float64 start, fmi3Boolean stops, fmi3Float64 stop) {
    Slave *s = c;
    s->time = start;
    s->next[SAMPLE] = start + 0.01;
    s->next[THIRD] = start;
    s->next[TUNED] = start + 0.005;
    s->next[WIDENING] = start + 0.01;
    s->state = INITIALISING;
    return fmi3OK;
}
fmi3Status fmi3ExitInitializationMode(fmi3Instance c) {
    ((Slave *)c)->state = EVENT;
    return fmi3OK;
}
fmi3Status fmi3EnterEventMode(fmi3Instance c) {
    Slave *s = c;
    if (s->state != STEPPING) return fail(s, "no event mode from here");
    s->state = EVENT;
    return fmi3OK;
}
fmi3Status fmi3EnterStepMode(fmi3Instance c) {
    Slave *s = c;
    for (int k = 0; k < CLOCKS; k++)
        if (s->active[k]) return fail(s, "step mode with an active clock");
    if (s->state != EVENT) return fail(s, "no step mode from here");
    s->state = STEPPING;
    return fmi3OK;
}
fmi3Status fmi3Terminate(fmi3Instance c) { return fmi3OK; }

/* ------------------------------------------------------------------ time */

static double next_alarm(const Slave *s) {
    return s->alarm_every > 0 ? (s->alarms + 1) * s->alarm_every : INFINITY;
}

fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 t, fmi3Float64 h, fmi3Boolean never_back,
                      fmi3Boolean *event, fmi3Boolean *end, fmi3Boolean *early,
                      fmi3Float64 *reached) {
    Slave *s = c;
    *event = *end = *early = false;
    if (s->state != STEPPING || s->alarm_is_asked) return fail(s, "a step without step mode");
    if (fabs(t - s->time) > 1e-9) return fail(s, "steps do not follow each other");
    double to = t + h;
    if (next_alarm(s) <= to + 1e-12) {
        *early = next_alarm(s) < to - 1e-12;
        if (*early) to = next_alarm(s);
        s->alarms++;
        s->alarm_is_asked = *event = true;
    }
    for (int k = 0; k < CLOCKS; k++)
        if (s->next[k] < to - 1e-9 || s->next[k] <= t + 1e-12) return fail(s, "a tick was missed");
    s->time = *reached = to;
    return fmi3OK;
}

static void activate(Slave *s, int k) {
    s->active[k] = true;
    s->count[k]++;
    s->when[k] = s->time;
}

fmi3Status fmi3SetClock(fmi3Instance c, const fmi3ValueReference r[], size_t n,
                        const fmi3Clock v[]) {
    Slave *s = c;
    if (s->state != EVENT) return fail(s, "a clock outside of an event");
    for (size_t i = 0; i < n; i++) {
        if (r[i] >= ALARM || s->active[r[i]] || !v[i]) return fail(s, "no clock to set");
        if (r[i] != POKE && fabs(s->next[r[i]] - s->time) > 1e-9)
            return fail(s, "a clock at a wrong time");
        activate(s, r[i]);
        if (r[i] == POKE && s->count[POKE] % 2 == 0) s->seconds++;
    }
    return fmi3OK;
}
fmi3Status fmi3GetClock(fmi3Instance c, const fmi3ValueReference r[], size_t n, fmi3Clock v[]) {
    Slave *s = c;
    for (size_t i = 0; i < n; i++) {
        if (s->state != EVENT || (r[i] == SECOND && !s->active[POKE]))
            return fail(s, "a clock got at a wrong time");
        v[i] = r[i] == ALARM ? s->alarm_is_asked : s->count[POKE] % 2 == 0;
        if (v[i]) activate(s, r[i]);
        if (r[i] == ALARM) s->alarm_is_asked = false;
    }
    return fmi3OK;
}

fmi3Status fmi3UpdateDiscreteStates(fmi3Instance c, fmi3Boolean *more, fmi3Boolean *end,
                                    fmi3Boolean *nominals, fmi3Boolean *values,
                                    fmi3Boolean *defined, fmi3Float64 *next) {
    Slave *s = c;
    if (s->state != EVENT) return fail(s, "no event to update");
    *more = *end = *nominals = *values = *defined = false;
    if (s->active[SAMPLE]) {
        s->sum += s->u;
        s->next[SAMPLE] = 0.01 + s->count[SAMPLE] * 0.03;
    }
    if (s->active[THIRD]) s->next[THIRD] = s->count[THIRD] / 3.0;
    if (s->active[TUNED]) s->next[TUNED] = s->time + s->pace;
    if (s->pace != s->said_pace) s->next[TUNED] = INFINITY; /* until it is asked for */
    if (s->active[WIDENING]) s->next[WIDENING] = s->time + 0.01 * (s->count[WIDENING] + 1);
    if (s->active[DELAYED]) {
        s->next[DELAYED] = INFINITY;
        s->is_known = false;
        if (s->chained < s->chain) {
            s->chained++;
            s->is_known = s->is_new = true;
            s->delay = 0.0;
        }
    }
    if (s->start) {
        s->is_known = s->is_new = true;
        s->chained = 0;
        s->start = false;
    }
    memset(s->active, 0, sizeof s->active);
    return fmi3OK;
}

static fmi3Status interval(Slave *s, int k, double *v, fmi3IntervalQualifier *q) {
    *q = fmi3IntervalChanged;
    if (s->state != INITIALISING && s->state != EVENT) return fail(s, "an interval outside events");
    if (k == TUNED) {
        if (s->pace == s->said_pace) *q = fmi3IntervalUnchanged;
        else if (s->state == EVENT) s->next[TUNED] = s->time + s->pace;
        *v = s->said_pace = s->pace;
    } else if (k == WIDENING) {
        *v = 0.01 * (s->count[WIDENING] + 1);
    } else if (k == DELAYED) {
        *v = s->delay;
        *q = !s->is_known ? fmi3IntervalNotYetKnown
             : s->is_new  ? fmi3IntervalChanged
                          : fmi3IntervalUnchanged;
        if (s->is_new) s->next[DELAYED] = s->time + s->delay;
        s->is_new = false;
    } else return fail(s, "no interval to ask for");
    return fmi3OK;
}
fmi3Status fmi3GetIntervalDecimal(fmi3Instance c, const fmi3ValueReference r[], size_t n,
                                  fmi3Float64 v[], fmi3IntervalQualifier q[]) {
    for (size_t i = 0; i < n; i++) {
        if (r[i] == WIDENING) return fail(c, "widening has fractions");
        if (interval(c, r[i], &v[i], &q[i]) != fmi3OK) return fmi3Error;
    }
    return fmi3OK;
}
fmi3Status fmi3GetIntervalFraction(fmi3Instance c, const fmi3ValueReference r[], size_t n,
                                   fmi3UInt64 counters[], fmi3UInt64 resolutions[],
                                   fmi3IntervalQualifier q[]) {
    for (size_t i = 0; i < n; i++) {
        double v;
        if (r[i] != WIDENING) return fail(c, "only widening has fractions");
        if (interval(c, r[i], &v, &q[i]) != fmi3OK) return fmi3Error;
        counters[i] = ((Slave *)c)->count[WIDENING] + 1;
        resolutions[i] = 100;
    }
    return fmi3OK;
}
fmi3Status fmi3GetShiftDecimal(fmi3Instance c, const fmi3ValueReference r[], size_t n,
                               fmi3Float64 v[]) {
    for (size_t i = 0; i < n; i++) {
        if (r[i] != TUNED || ((Slave *)c)->state != INITIALISING) return fail(c, "no shift");
        v[i] = 0.005;
    }
    return fmi3OK;
}

/* ------------------------------------------------------------------ variables */

static bool is_closed(const Slave *s, int clock) {
    return s->state > INITIALISING && !s->active[clock];
}

fmi3Status fmi3GetInt32(fmi3Instance c, const fmi3ValueReference r[], size_t n, fmi3Int32 v[],
                        size_t size) {
    Slave *s = c;
    for (size_t i = 0; i < n; i++) {
        if (r[i] != SECONDS && is_closed(s, r[i] - COUNT)) return fail(s, "a count of no active clock");
        v[i] = r[i] == SECONDS ? s->seconds : s->count[r[i] - COUNT];
    }
    return fmi3OK;
}
fmi3Status fmi3SetInt32(fmi3Instance c, const fmi3ValueReference r[], size_t n,
                        const fmi3Int32 v[], size_t size) {
    ((Slave *)c)->chain = v[0];
    return fmi3OK;
}
fmi3Status fmi3GetFloat64(fmi3Instance c, const fmi3ValueReference r[], size_t n, fmi3Float64 v[],
                          size_t size) {
    Slave *s = c;
    for (size_t i = 0; i < n; i++) {
        if (r[i] > WHEN && r[i] < WHEN + CLOCKS) {
            if (is_closed(s, r[i] - WHEN)) return fail(s, "a time of no active clock");
            v[i] = s->when[r[i] - WHEN];
        } else if (r[i] == SUM) {
            if (is_closed(s, SAMPLE)) return fail(s, "the sum without its clock");
            v[i] = s->sum + s->u;
        } else if (r[i] == TIME) v[i] = s->time;
        else if (r[i] == PACE) v[i] = s->pace;
        else if (r[i] == DELAY) v[i] = s->delay;
        else if (r[i] == ALARM_EVERY) v[i] = s->alarm_every;
        else return fail(s, "no such Float64");
    }
    return fmi3OK;
}
fmi3Status fmi3SetFloat64(fmi3Instance c, const fmi3ValueReference r[], size_t n,
                          const fmi3Float64 v[], size_t size) {
    Slave *s = c;
    for (size_t i = 0; i < n; i++) {
        if (r[i] == U) {
            if (is_closed(s, SAMPLE)) return fail(s, "an input without its clock");
            s->u = v[i];
        } else if (s->state == STEPPING) return fail(s, "a parameter outside of an event");
        else if (r[i] == PACE) s->pace = v[i];
        else if (r[i] == DELAY) s->delay = v[i];
        else if (r[i] == ALARM_EVERY) s->alarm_every = v[i];
        else return fail(s, "no such Float64");
    }
    return fmi3OK;
}
fmi3Status fmi3GetBoolean(fmi3Instance c, const fmi3ValueReference r[], size_t n, fmi3Boolean v[],
                          size_t size) {
    v[0] = ((Slave *)c)->start;
    return fmi3OK;
}
fmi3Status fmi3SetBoolean(fmi3Instance c, const fmi3ValueReference r[], size_t n,
                          const fmi3Boolean v[], size_t size) {
    Slave *s = c;
    if (s->state == STEPPING) return fail(s, "a Boolean outside of an event");
    s->start = v[0];
    return fmi3OK;
}
fmi3Status fmi3GetBinary(fmi3Instance c, const fmi3ValueReference r[], size_t n, size_t sizes[],
                         fmi3Binary v[], size_t size) {
    Slave *s = c;
    if (is_closed(s, POKE)) return fail(s, "bytes without their clock");
    sizes[0] = s->length;
    for (size_t b = 0; b < s->length; b++) s->answer[b] = s->word[s->length - 1 - b];
    v[0] = r[0] == WORD ? s->word : s->answer;
    return fmi3OK;
}
fmi3Status fmi3SetBinary(fmi3Instance c, const fmi3ValueReference r[], size_t n,
                         const size_t sizes[], const fmi3Binary v[], size_t size) {
    Slave *s = c;
    if (is_closed(s, POKE)) return fail(s, "bytes without their clock");
    s->length = sizes[0];
    memcpy(s->word, v[0], sizes[0]);
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

