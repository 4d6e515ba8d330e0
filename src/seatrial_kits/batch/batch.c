/* Copies of a rig in C: one program, as many memories, threads that share the copies.

   A copy that fails keeps its message and is passed over until it is started again. Rows of values
   are one copy's, in the order of the references. */

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#if !defined(_WIN32)
#include <pthread.h>
#endif

#include "fmi2Functions.h"
#include "rig.h"

#if defined(_WIN32)
#define EXPORTED __declspec(dllexport)
#else
#define EXPORTED __attribute__((visibility("default")))
#endif

#define MOST_THREADS 64

typedef struct {
    fmi2Component rig;
    fmi2CallbackFunctions functions;
    int64_t steps;
    int failed, started;
    char message[1024];
} Copy;

typedef struct {
    int64_t count;
    Copy *copies;
    Work *works[MOST_THREADS]; /* of each thread: copies share it, their own operations would fill the caches */
#if LANES
    Lockstep *locksteps[MOST_THREADS]; /* of each thread; NULL where copies step one by one */
#endif
} Batch;

typedef struct { /* what one thread does, for copies from `first`, before `last` */
    Batch *batch;
    Work *work;
#if LANES
    Lockstep *lockstep;
#endif
    int64_t first, last, steps;
    const uint8_t *mask; /* of the copies that step */
    const uint32_t *references;
    int64_t count;
    double *rows; /* of each copy `steps` rows of `count` values; NULL: none is kept */
} Share;

/* ------------------------------------------------------------------ copies */

static void log_message(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status,
                        fmi2String category, fmi2String format, ...) {
    Copy *copy = environment;
    va_list arguments;
    (void)name, (void)category;
    if (status <= fmi2Warning || copy->message[0]) return; /* the first error says why */
    va_start(arguments, format);
    vsnprintf(copy->message, sizeof copy->message, format, arguments);
    va_end(arguments);
}

static void check(Copy *copy, fmi2Status status) {
    if (status <= fmi2Warning) return;
    copy->failed = 1;
    if (!copy->message[0]) snprintf(copy->message, sizeof copy->message, "a component cannot go on");
}

EXPORTED void batch_free(Batch *batch) {
    if (!batch) return;
    for (int64_t i = 0; i < batch->count; i++) fmi2FreeInstance(batch->copies[i].rig);
    for (int k = 0; k < MOST_THREADS; k++) {
        free(batch->works[k]);
#if LANES
        rig_free_lockstep(batch->locksteps[k]);
#endif
    }
    free(batch->copies);
    free(batch);
}

EXPORTED Batch *batch_new(int64_t count) {
    Batch *batch = calloc(1, sizeof *batch);
    if (!batch) return NULL;
    batch->copies = calloc((size_t)count, sizeof *batch->copies);
    batch->works[0] = rig_new_work();
    if (batch->copies && batch->works[0])
        for (; batch->count < count; batch->count++) {
            Copy *copy = batch->copies + batch->count;
            const fmi2CallbackFunctions functions = {log_message, NULL, NULL, NULL, copy};
            memcpy(&copy->functions, &functions, sizeof functions); /* its fields are constant */
            copy->rig = fmi2Instantiate("", fmi2CoSimulation, RIG_GUID, "", &copy->functions, 0, 0);
            if (!copy->rig) break;
            rig_lend(copy->rig, batch->works[0]);
        }
    if (batch->count == count) return batch;
    batch_free(batch);
    return NULL;
}

/* ------------------------------------------------------------------ values */

static fmi2Status set_one(Copy *copy, uint32_t reference, double value) {
    const fmi2Integer whole = (fmi2Integer)value;
    switch (rig_variables[reference].type) {
    case REAL_TYPE:
        return fmi2SetReal(copy->rig, &reference, 1, &value);
    case INTEGER_TYPE:
        return fmi2SetInteger(copy->rig, &reference, 1, &whole);
    default:
        return fmi2SetBoolean(copy->rig, &reference, 1, &whole);
    }
}

static void set_row(Copy *copy, const uint32_t *references, int64_t count, const double *row) {
    for (int64_t k = 0; k < count && !copy->failed; k++)
        check(copy, set_one(copy, references[k], row[k]));
}

/* Let a component of a copy meet other surroundings from its next start on; NULL: nothing. */
EXPORTED void batch_surround(Batch *batch, int64_t i, int64_t node,
                             int (*met)(const void *, double, const double *, double *),
                             const void *of) {
    if (rig_nodes[node].carrier->surround)
        rig_nodes[node].carrier->surround(rig_component(batch->copies[i].rig, (int)node), met, of);
}

EXPORTED void batch_set(Batch *batch, const uint8_t *mask, const uint32_t *references,
                        int64_t count, const double *values) {
    for (int64_t i = 0; i < batch->count; i++)
        if (mask[i]) set_row(batch->copies + i, references, count, values + i * count);
}

EXPORTED void batch_set_text(Batch *batch, const uint8_t *mask, uint32_t reference, const char *text) {
    for (int64_t i = 0; i < batch->count; i++) {
        Copy *copy = batch->copies + i;
        if (mask[i] && !copy->failed) check(copy, fmi2SetString(copy->rig, &reference, 1, &text));
    }
}

/* Override outputs, each copy of the mask with its row of values; NULL: release them. */
EXPORTED void batch_override(Batch *batch, const uint8_t *mask, const uint32_t *references,
                             int64_t count, const double *values) {
    for (int64_t i = 0; i < batch->count; i++)
        for (int64_t k = 0; k < count && mask[i]; k++)
            rig_override(batch->copies[i].rig, references[k], values != NULL,
                         values ? values[i * count + k] : 0.0);
}

EXPORTED void batch_get(Batch *batch, const uint32_t *references, int64_t count, double *values) {
    for (int64_t i = 0; i < batch->count; i++) { /* of a copy that has failed: what it had */
        Copy *copy = batch->copies + i;
        check(copy, rig_read(copy->rig, references, (size_t)count, values + i * count));
    }
}

/* Let noise from now on be that of other seeds, each copy of the mask with its row. */
EXPORTED void batch_reseed(Batch *batch, const uint8_t *mask, const uint32_t *references,
                           int64_t count, const double *seeds) {
    for (int64_t i = 0; i < batch->count; i++)
        for (int64_t k = 0; k < count && mask[i]; k++)
            rig_reseed(batch->copies[i].rig, references[k], seeds[i * count + k]);
}

/* ------------------------------------------------------------------ life */

/* Start copies anew, each with its row of values. */
EXPORTED void batch_start(Batch *batch, const uint8_t *mask, const uint32_t *references,
                          int64_t count, const double *values) {
    for (int64_t i = 0; i < batch->count; i++) {
        Copy *copy = batch->copies + i;
        if (!mask[i]) continue;
        copy->failed = 0, copy->message[0] = '\0', copy->steps = 0;
        if (copy->started) check(copy, fmi2Reset(copy->rig));
        copy->started = 1;
        set_row(copy, references, count, values + i * count);
        if (!copy->failed) check(copy, fmi2SetupExperiment(copy->rig, 0, 0.0, 0.0, 0, 0.0));
        if (!copy->failed) check(copy, fmi2EnterInitializationMode(copy->rig));
        if (!copy->failed) check(copy, fmi2ExitInitializationMode(copy->rig));
    }
}

/* Step a copy and keep a row after each step, up to the one that fails. */
static void record(const Share *share, int64_t i) {
    Copy *copy = share->batch->copies + i;
    double *row = share->rows + i * share->steps * share->count;
    for (int64_t k = 0; k < share->steps && !copy->failed; k++, row += share->count) {
        check(copy, fmi2DoStep(copy->rig, (double)(copy->steps * STEP_NS) / 1e9, STEP_NS / 1e9, 1));
        copy->steps++;
        if (!copy->failed) check(copy, rig_read(copy->rig, share->references, (size_t)share->count, row));
    }
}

static void step_alone(const Share *share, int64_t i) {
    Copy *copy = share->batch->copies + i;
    const double h = (double)(share->steps * STEP_NS) / 1e9;
    if (copy->failed || !share->mask[i]) return;
    rig_lend(copy->rig, share->work);
    if (share->rows) {
        record(share, i);
    } else {
        check(copy, fmi2DoStep(copy->rig, (double)(copy->steps * STEP_NS) / 1e9, h, 1));
        copy->steps += share->steps;
    }
    rig_lend(copy->rig, share->batch->works[0]);
}

#if LANES
enum { WORTH = 3 }; /* so many copies in lanes are faster than one by one */

/* Let copies from `first` on step together, as many as can; return how many were passed. */
static int64_t step_lanes(const Share *share, int64_t first) {
    Copy *copies = share->batch->copies + first;
    fmi2Component rigs[LANES] = {NULL};
    unsigned char active[LANES] = {0};
    double *rows[LANES] = {NULL};
    int64_t taken[LANES], steps = -1, count = share->last - first;
    fmi2Status found[LANES];
    int together = 0;
    if (count > LANES) count = LANES;
    for (int64_t i = 0; i < count; i++) {
        if (copies[i].failed || !share->mask[first + i]) continue;
        if (steps < 0) steps = copies[i].steps;
        if (copies[i].steps != steps) return 0;
        active[i] = 1, together++;
        rigs[i] = copies[i].rig;
        if (share->rows) rows[i] = share->rows + (first + i) * share->steps * share->count;
    }
    if (together < WORTH) return 0;
    for (int64_t i = first + count; i < share->last && i < first + 2 * count; i++)
        if (share->mask[i]) rig_fetch(share->batch->copies[i].rig);
    rig_step_together(share->lockstep, rigs, active, share->steps, share->references,
                      (size_t)share->count, share->rows ? rows : NULL, taken, found);
    for (int64_t i = 0; i < count; i++) {
        if (!active[i]) continue;
        check(copies + i, found[i]);
        copies[i].steps += share->rows ? taken[i] : share->steps;
    }
    return count;
}
#endif

static void *worked(void *given) {
    const Share *share = given;
    for (int64_t i = share->first; i < share->last; i++) {
#if LANES
        const int64_t passed = share->lockstep ? step_lanes(share, i) : 0;
        if (passed) {
            i += passed - 1;
            continue;
        }
#endif
        if (i + 1 < share->last && share->mask[i + 1]) rig_fetch(share->batch->copies[i + 1].rig);
        step_alone(share, i);
    }
    return NULL;
}

/* Let copies of the mask take steps; `rows`, if it is not NULL, gets `count` values after each, copy
   by copy. */
EXPORTED void batch_step(Batch *batch, const uint8_t *mask, int64_t steps, int64_t threads,
                         const uint32_t *references, int64_t count, double *rows) {
    Share shares[MOST_THREADS];
#if defined(_WIN32)
    threads = 1;
#else
    pthread_t running[MOST_THREADS];
    int begun[MOST_THREADS] = {0};
#endif
    if (threads > MOST_THREADS) threads = MOST_THREADS;
    for (int64_t k = 0; k < threads; k++) {
        if (!batch->works[k] && !(batch->works[k] = rig_new_work())) threads = k;
        shares[k].work = batch->works[k];
#if LANES
        if (!batch->locksteps[k]) batch->locksteps[k] = rig_new_lockstep();
        shares[k].lockstep = batch->locksteps[k];
#endif
    }
    for (int64_t k = 0; k < threads; k++) {
        shares[k].batch = batch, shares[k].mask = mask, shares[k].steps = steps;
        shares[k].references = references, shares[k].count = count, shares[k].rows = rows;
        shares[k].first = batch->count * k / threads;
        shares[k].last = batch->count * (k + 1) / threads;
    }
#if !defined(_WIN32)
    for (int64_t k = 1; k < threads; k++)
        begun[k] = pthread_create(running + k, NULL, worked, shares + k) == 0;
#endif
    worked(shares);
#if !defined(_WIN32)
    for (int64_t k = 1; k < threads; k++) {
        if (begun[k]) pthread_join(running[k], NULL);
        else worked(shares + k);
    }
#endif
}

EXPORTED const char *batch_message(const Batch *batch, int64_t i) {
    return batch->copies[i].failed ? batch->copies[i].message : NULL;
}

EXPORTED void batch_times(const Batch *batch, int64_t *steps, uint8_t *failed) {
    for (int64_t i = 0; i < batch->count; i++) {
        steps[i] = batch->copies[i].steps;
        failed[i] = (uint8_t)batch->copies[i].failed;
    }
}

/* ------------------------------------------------------------------ states */

EXPORTED void batch_free_states(Batch *batch, void **states) {
    for (int64_t i = 0; i < batch->count; i++)
        if (states[i]) fmi2FreeFMUstate(batch->copies[i].rig, states + i);
}

EXPORTED int batch_save(Batch *batch, void **states) {
    for (int64_t i = 0; i < batch->count; i++)
        if (fmi2GetFMUstate(batch->copies[i].rig, states + i) > fmi2Warning) return 0;
    return 1;
}

/* Copy i goes on from the state of copy from[i], after so many steps; negative: it goes on as it is. */
EXPORTED void batch_restore(Batch *batch, void **states, const int64_t *from, const int64_t *steps) {
    for (int64_t i = 0; i < batch->count; i++) {
        Copy *copy = batch->copies + i;
        if (from[i] < 0) continue;
        copy->failed = 0, copy->message[0] = '\0', copy->started = 1;
        check(copy, fmi2SetFMUstate(copy->rig, states[from[i]]));
        copy->steps = steps[from[i]];
    }
}
