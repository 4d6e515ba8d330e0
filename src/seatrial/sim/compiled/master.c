/* The steps of a master over FMI 2.0 FMUs in C, as `Network`, `Feedthrough` and the algorithms of
   seatrial take them in Python: the same operations in the same order, so the same numbers.

   Python has loaded and initialised everything and wrote what a step does as a list of operations
   (`program.py` describes them; its structures are those of here, field by field). `master_run`
   carries them out, step by step, and returns to Python where it must decide: at a status other
   than ok, a message, a value that may be too large, a loop that does not settle, or an operation
   that only Python can do. Called again, it goes on behind that operation. It allocates nothing. */

#include <math.h>
#include <stdint.h>
#include <string.h>
#if !defined(UNTIMED)
#include <time.h>
#if defined(__x86_64__)
#include <x86intrin.h>
#endif
#endif

#if defined(EXPORT) /* by what includes this file */
#elif defined(_WIN32)
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

enum { OK, WARNING };
enum { WRITE, STEP, GET, STORE, ARRIVE, LOOP, CALL };
enum { REAL, INTEGER, BOOLEAN };
#define PATIENCE_NS 50000000
enum { DONE, ANSWERED, EXCESS, UNSETTLED, CALLED, DIVERGED, ASKED };

typedef int (*GetOrSet)(void *component, const uint32_t *references, size_t count, void *values);
typedef int (*DoStep)(void *component, double t, double h, int never_back);

typedef struct {
    int64_t count, total_ns, longest_ns, longest_at_ns, bins[64];
} Times;

typedef struct {
    int64_t kind, type;
    int64_t every, phase;  /* it acts where (steps + phase) is a multiple of `every` */
    int64_t mark;          /* of the call, in the trace */
    void *function, *component;
    const uint32_t *references;
    void *values;          /* as the FMU has them */
    int64_t count;
    int64_t start;         /* STORE: place of the first; STEP: its begin, ns after the step's */
    int64_t length;        /* STEP: ns; LOOP: operations in it */
    int32_t constant;      /* STEP: h is that of `length`, whatever t and the next t are as doubles */
    int32_t never_back;
    Times *times;
    const int64_t *places; /* WRITE: of the sources; LOOP: of its outputs */
    double *numbers;       /* WRITE: the sources' values, converted; LOOP: before, after, begun */
    int64_t scaled;        /* WRITE: how many are converted, which, and how */
    const int64_t *which;
    const double *factors, *offsets;
    int64_t continuous;    /* WRITE: how many are extrapolated, which, and what they were */
    const int64_t *moving;
    double *previous;
    int64_t has_previous;
    int64_t limited;       /* STORE: how many have a limit of their own, which, and what limit */
    const int64_t *bounded;
    const double *limits;
    const uint8_t *reals;  /* LOOP: which outputs are real numbers */
    double relaxation;
} Operation;

typedef struct { /* divergence.py says what is looked for; arrays of `count` */
    int64_t every, count;
    const int64_t *places;
    double *rows, *last, *first, *jump;
    int64_t *growing, *seen;
    int64_t worst;
} Pace;

typedef struct {
    Operation *operations;
    int64_t count, at;
    double *signals;
    int64_t steps, begin_ns, step_ns, time_ns;
    int64_t status, took_ns;  /* of the last call, and how long that step was */
    volatile int32_t *said;   /* an FMU has sent a message */
    volatile int64_t *cells;  /* the trace: asked, call; NULL if nobody keeps one */
    volatile double *times;   /* the same memory: time at [2] */
    Pace *paces;
    int64_t pace_count, diverged;
    double *rows;             /* of points between the first and the last: multiples of row_every */
    const int64_t *row_places;
    int64_t row_count, row_every, rows_kept;
    double any_quantity;
    const uint8_t *overridden; /* by signal: whether another value takes its place; NULL: none */
    const double *overrides;   /* that value, */
    double *own;               /* and what the signal is by itself */
} Master;

/* ------------------------------------------------------------------ durations */

#if defined(UNTIMED)
static int64_t ticks(void) { return 0; }
static void calibrate(void) {}
static int64_t in_ns(int64_t taken) { return taken; }
#else
static int64_t clock_ns(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

#if defined(__x86_64__)
static uint64_t first_tick;
static int64_t first_ns;
static double ns_per_tick;

static int64_t ticks(void) { return (int64_t)(__rdtsc() - first_tick); }

static void calibrate(void) { /* against the clock, since the first run began */
    if (!first_tick) {
        first_ns = clock_ns(), first_tick = __rdtsc();
        while (clock_ns() - first_ns < 200000) {}
    }
    ns_per_tick = (double)(clock_ns() - first_ns) / (double)ticks();
}

static int64_t in_ns(int64_t taken) { return (int64_t)((double)taken * ns_per_tick); }
#else
static int64_t ticks(void) { return clock_ns(); }
static void calibrate(void) {}
static int64_t in_ns(int64_t taken) { return taken; }
#endif
#endif

static void count_time(Times *times, int64_t taken, int64_t at_ns) {
    int bin = 0;
    if (taken < 0) taken = 0;
    times->count++;
    times->total_ns += taken;
    for (uint64_t rest = (uint64_t)taken; rest && bin < 63; rest >>= 1) bin++;
    times->bins[bin]++;
    if (taken > times->longest_ns || times->longest_at_ns < 0)
        times->longest_ns = taken, times->longest_at_ns = at_ns;
}

/* ------------------------------------------------------------------ sums */

typedef struct { /* `SumInstance`: references are of its inputs, those of each output, then of outputs */
    double *inputs;
    int64_t count, terms;
} Sum;

EXPORT int sum_set(void *component, const uint32_t *references, size_t count, void *values) {
    const Sum *sum = component;
    for (size_t i = 0; i < count; i++) sum->inputs[references[i]] = ((const double *)values)[i];
    return OK;
}

EXPORT int sum_get(void *component, const uint32_t *references, size_t count, void *values) {
    const Sum *sum = component;
    for (size_t i = 0; i < count; i++) {
        const int64_t output = (int64_t)references[i] - sum->count;
        double total = 0.0;
        for (int64_t k = 0; k < sum->terms && output >= 0; k++)
            total += sum->inputs[output * sum->terms + k];
        ((double *)values)[i] = output < 0 ? sum->inputs[references[i]] : total;
    }
    return OK;
}

EXPORT int sum_step(void *component, double t, double h, int never_back) {
    (void)component, (void)t, (void)h, (void)never_back;
    return OK;
}

/* ------------------------------------------------------------------ operations */

static void gather(Operation *o, const double *signals) {
    double *to = o->numbers;
    for (int64_t i = 0; i < o->count; i++) to[i] = signals[o->places[i]];
    for (int64_t i = 0; i < o->scaled; i++) {
        const int64_t k = o->which[i];
        to[k] = to[k] * o->factors[i] + o->offsets[i];
    }
}

static void extrapolate(Operation *o) {
    double *values = o->values; /* continuous inputs are real numbers */
    memcpy(values, o->numbers, (size_t)o->count * sizeof *values);
    if (o->has_previous)
        for (int64_t i = 0; i < o->continuous; i++) {
            const int64_t k = o->moving[i];
            values[k] += 0.5 * (o->numbers[k] - o->previous[k]);
        }
    memcpy(o->previous, o->numbers, (size_t)o->count * sizeof *values);
    o->has_previous = 1;
}

static int write_inputs(Operation *o, const double *signals) {
    gather(o, signals);
    if (o->type == REAL) {
        if (o->previous) extrapolate(o);
    } else {
        int *values = o->values;
        for (int64_t i = 0; i < o->count; i++)
            values[i] = o->type == INTEGER ? (int)o->numbers[i] : o->numbers[i] != 0.0;
    }
    return ((GetOrSet)o->function)(o->component, o->references, (size_t)o->count, o->values);
}

/* Take over what was read, unless it may be too large or is no number. */
static int take_values(const Operation *o, double *to, double any_quantity) {
    if (o->type != REAL) {
        const int *values = o->values;
        for (int64_t i = 0; i < o->count; i++)
            to[i] = o->type == INTEGER ? (double)values[i] : (double)(values[i] != 0);
        return 1;
    }
    const double *values = o->values;
    double sum = 0.0;
    for (int64_t i = 0; i < o->count; i++) sum += values[i];
    if (!(-any_quantity < sum && sum < any_quantity)) return 0;
    for (int64_t i = 0; i < o->limited; i++) {
        const double value = values[o->bounded[i]];
        if (!(-o->limits[i] <= value && value <= o->limits[i])) return 0;
    }
    memcpy(to, values, (size_t)o->count * sizeof *to);
    return 1;
}

static int store(const Operation *o, const Master *m) {
    if (!take_values(o, m->signals + o->start, m->any_quantity)) return 0;
    for (int64_t i = o->start; m->overridden && i < o->start + o->count; i++)
        if (m->overridden[i]) m->own[i] = m->signals[i], m->signals[i] = m->overrides[i];
    return 1;
}

static int is_accepted(int64_t status) { return status == OK || status == WARNING; }

static int acts(const Operation *o, int64_t steps) {
    return o->every == 1 || (steps + o->phase) % o->every == 0;
}

/* ------------------------------------------------------------------ loops */

/* Visit a loop once: DONE, EXCESS for a value that may be too large, ANSWERED if an FMU refuses. */
static int sweep(Master *m, Operation *loop) {
    for (Operation *o = loop + 1; o <= loop + loop->length; o++) {
        if (!acts(o, m->steps)) continue;
        if (o->kind == STORE) {
            if (!store(o, m)) return EXCESS;
            continue;
        }
        if (m->cells) m->cells[1] = o->mark;
        const int status =
            o->kind == WRITE
                ? write_inputs(o, m->signals)
                : ((GetOrSet)o->function)(o->component, o->references, (size_t)o->count, o->values);
        if (!is_accepted(status) || *m->said) return ANSWERED;
    }
    return DONE;
}

static double distance(double a, double b, int is_real) {
    return is_real ? fabs(b - a) : (double)(a != b);
}

static int is_close(double a, double b, int is_real) {
    if (!is_real) return a == b;
    const double size = fabs(a) > fabs(b) ? fabs(a) : fabs(b);
    return fabs(a - b) <= 1e-12 * (size > 1.0 ? size : 1.0);
}

/* `Feedthrough._iterate`: DONE, UNSETTLED, or why a sweep ended. */
static int iterate(Master *m, Operation *loop, double relaxation) {
    const int64_t n = loop->count;
    double *before = loop->numbers, change = 0.0;
    int growing = 0;
    for (int repetition = 0; repetition < 200; repetition++) {
        int all_close = 1;
        double largest = 0.0;
        for (int64_t i = 0; i < n; i++) before[i] = m->signals[loop->places[i]];
        const int why = sweep(m, loop);
        if (why != DONE) return why;
        for (int64_t i = 0; i < n; i++) {
            const double after = m->signals[loop->places[i]];
            const double moved = distance(before[i], after, loop->reals[i]);
            if (moved > largest) largest = moved;
            all_close &= is_close(before[i], after, loop->reals[i]);
        }
        if (all_close) return DONE;
        growing = change != 0.0 && largest / change > 1.0 ? growing + 1 : 0;
        change = largest;
        if (growing == 5) break;
        if (relaxation != 1.0)
            for (int64_t i = 0; i < n; i++)
                if (loop->reals[i]) {
                    double *value = m->signals + loop->places[i];
                    *value = before[i] + relaxation * (*value - before[i]);
                }
    }
    return UNSETTLED;
}

/* `Feedthrough.solve` without its acceleration: as the loop last settled, then in other ways. */
static int settles(Master *m, Operation *loop) {
    static const double tried[] = {1.0, 0.5, 0.25, 0.125, 0.0625};
    const int64_t n = loop->count;
    const double own = loop->relaxation;
    double *begun = loop->numbers + n;
    if (own == 0.0) return 0; /* it needs acceleration */
    for (int64_t i = 0; i < n; i++) begun[i] = m->signals[loop->places[i]];
    for (int k = -1; k < 5; k++) {
        const double relaxation = k < 0 ? own : tried[k];
        if (k >= 0 && relaxation == own) continue;
        const int why = iterate(m, loop, relaxation);
        if (why == DONE) {
            loop->relaxation = relaxation;
            return 1;
        }
        for (int64_t i = 0; i < n; i++) m->signals[loop->places[i]] = begun[i];
        if (why == ANSWERED) break;
    }
    return 0;
}

/* ------------------------------------------------------------------ divergence */

enum { BLOCK = 17, LOOKED_AT = 8, BLOCKS = 3, TURNS = 2 };

static int turns_of(const double *rows, int64_t n, int64_t i) {
    double last = rows[n + i] - rows[i];
    int found = 0;
    for (int k = 2; k < LOOKED_AT; k++) {
        const double next = rows[k * n + i] - rows[(k - 1) * n + i];
        found += (last < 0.0 && next > 0.0) || (last > 0.0 && next < 0.0);
        if (next != 0.0) last = next;
    }
    return found;
}

/* Return whether one connection diverges: `_Pace._evaluate` for its column. */
static double growth_of(Pace *p, int64_t i) {
    const double *rows = p->rows;
    const int64_t n = p->count;
    double change = 0.0, swing = 0.0, size = 0.0;
    for (int k = 0; k < LOOKED_AT; k++) {
        const double *x = rows + k * n + i;
        size = fmax(size, fabs(*x));
        if (k > 0) change = fmax(change, fabs(*x - x[-n]));
        if (k > 1) swing = fmax(swing, fabs((*x - x[-n]) - (x[-n] - x[-2 * n])));
    }
    const int rough = swing >= change && swing > 1e-6 * fmax(1.0, size) &&
                      turns_of(rows, n, i) >= TURNS;
    const int grows = rough && swing > p->last[i] && p->last[i] > 0.0;
    const double factor = grows ? swing / p->last[i] : 1.0;
    const int going_on = grows && p->growing[i] > 0;
    if (!going_on) p->first[i] = p->last[i];
    p->jump[i] = going_on ? fmax(p->jump[i], factor) : factor;
    p->growing[i] = grows ? p->growing[i] + 1 : 0;
    p->last[i] = rough ? swing : 0.0;
    return p->growing[i] >= BLOCKS ? swing / p->first[i] / p->jump[i] : 0.0;
}

static int diverges(Pace *p, const double *signals, int64_t steps) {
    const int64_t turn = steps / p->every % BLOCK;
    if (steps % p->every || turn >= LOOKED_AT) return 0;
    if (turn == 0) *p->seen = 0;
    double *row = p->rows + *p->seen * p->count;
    for (int64_t i = 0; i < p->count; i++) row[i] = signals[p->places[i]];
    if (++*p->seen < LOOKED_AT) return 0;
    double most = 100.0;
    p->worst = -1;
    for (int64_t i = 0; i < p->count; i++) {
        const double growth = growth_of(p, i);
        if (growth > most) most = growth, p->worst = i;
    }
    return p->worst >= 0;
}

/* ------------------------------------------------------------------ steps */

/* Say when a step of a component begins and how long it is, s. */
static inline void span_of(const Master *m, const Operation *o, double *t, double *h) {
    const int64_t at_ns = m->begin_ns + o->start;
    *t = (double)at_ns / 1e9;
    *h = o->constant ? (double)o->length / 1e9 : (double)(at_ns + o->length) / 1e9 - *t;
}

/* Carry out what is left of a step; return DONE at its end. */
static int finish_step(Master *m) {
    int64_t begun = -1; /* when the call before ended, if a step was the operation before */
    /* Of a step that is as long as the master's, as most are. */
    const double t_whole = (double)m->begin_ns / 1e9;
    const double h_whole = (double)(m->begin_ns + m->step_ns) / 1e9 - t_whole;
    while (m->at < m->count) {
        Operation *o = m->operations + m->at++;
        if (o->kind == LOOP) {
            if (!settles(m, o)) return UNSETTLED;
            m->at += o->length;
            continue;
        }
        if (o->kind == CALL) return CALLED;
        if (!acts(o, m->steps)) continue;
        switch (o->kind) {
        case WRITE:
            if (m->cells) m->cells[1] = o->mark;
            m->status = write_inputs(o, m->signals);
            begun = -1;
            break;
        case STEP: {
            double t = t_whole, h = h_whole;
            if (o->constant || o->start || o->length != m->step_ns) span_of(m, o, &t, &h);
            if (m->cells) m->times[2] = t, m->cells[1] = o->mark;
            if (begun < 0) begun = ticks();
            m->status = ((DoStep)o->function)(o->component, t, h, (int)o->never_back);
            const int64_t ended = ticks();
            m->took_ns = in_ns(ended - begun);
            if (is_accepted(m->status)) count_time(o->times, m->took_ns, m->begin_ns + o->start);
            begun = ended;
            break;
        }
        case GET:
            if (m->cells) m->cells[1] = o->mark;
            m->status = ((GetOrSet)o->function)(o->component, o->references, (size_t)o->count,
                                                o->values);
            break;
        case STORE:
            if (!store(o, m)) return EXCESS;
            continue;
        default: /* ARRIVE */
            m->time_ns = m->begin_ns + m->step_ns;
            continue;
        }
        if (!is_accepted(m->status) || *m->said) return ANSWERED;
    }
    return DONE;
}

/* Take steps until `until` of them were taken since the start, or Python must look: also after
   a while, for signals and progress. */
EXPORT int master_run(Master *m, int64_t until) {
    calibrate();
    const int64_t begun = ticks();
    for (;;) {
        const int why = finish_step(m);
        if (why != DONE) return why;
        m->at = 0;
        m->steps++;
        m->begin_ns += m->step_ns;
        for (int64_t i = 0; i < m->pace_count; i++)
            if (diverges(m->paces + i, m->signals, m->steps)) {
                m->diverged = i;
                return DIVERGED;
            }
        if (m->steps >= until) return DONE;
        if ((m->cells && m->cells[0]) || in_ns(ticks() - begun) > PATIENCE_NS) return ASKED;
        if (m->row_every && m->steps % m->row_every == 0) {
            double *row = m->rows + m->rows_kept++ * m->row_count;
            for (int64_t i = 0; i < m->row_count; i++) row[i] = m->signals[m->row_places[i]];
        }
    }
}

EXPORT int64_t master_size(int what) {
    return (int64_t)(what == 0 ? sizeof(Operation) : what == 1 ? sizeof(Pace) : sizeof(Master));
}
