/* A plant: equal Runge-Kutta sub-steps with inputs held, operation by operation as seatrial's; what
   surrounds it changes within them. */

#include <math.h>
#include <string.h>

#include "component.h"

#define SPACING 0.05 /* s: shorter steps share two evaluations that lie no further apart */

static void gather(const double *values, const int *references, int count, double *to) {
    for (int i = 0; i < count; i++) to[i] = values[references[i]];
}

static void publish(double *values, const int *references, int count, const double *from) {
    for (int i = 0; i < count; i++) values[references[i]] = from[i];
}

static void load(const State *state, double *u, double *p) {
    gather(state->values, model_u, INPUTS, u);
    gather(state->values, model_p, PARAMETERS, p);
}

/* ------------------------------------------------------------------ with nothing around */

static void advance_still(State *state, double h, long long count) {
    double u[INPUTS + 1], p[PARAMETERS + 1], next[STATES + 1];
    load(state, u, p);
    for (long long i = 0; i < count; i++) {
        model_rk4(state->memory.x, u, p, h / (double)count, next);
        memcpy(state->memory.x, next, STATES * sizeof *next);
    }
}

#if AROUND /* ------------------------------------------------- among waves, current and wind */

#if defined(_WIN32)
#define EXPORTED __declspec(dllexport)
#else
#define EXPORTED __attribute__((visibility("default")))
#endif

/* Let it meet surroundings from its next start on; NULL: nothing. */
EXPORTED void seatrial_surround(void *component, Surroundings met, const void *of) {
    Instance *self = component;
    self->met = met, self->of = of;
    self->state.restart = self->state.stale = 1;
}

static void load_among(const State *state, double *u, double *p) {
    load(state, u, p);
    memcpy(u + INPUTS, state->memory.around, AROUND * sizeof *u);
}

static void meet(Instance *self, double t, const double *x, double *around) {
    int has_value = self->met && self->met(self->of, t, x, around);
    for (int i = 0; i < AROUND && has_value; i++) has_value = isfinite(around[i]);
    if (has_value) return;
    fail(self, "%s: there is no value for what surrounds it at t = %s s", self->name, shown(self, t));
}

/* The plant without surroundings says what came before: it only looks ahead. */
static void start_among(Instance *self, double t) {
    Memory *memory = &self->state.memory;
    double u[INPUTS + 1], p[PARAMETERS + 1], dx[STATES + 1];
    memory->among = self->met != NULL;
    if (!memory->among) return;
    meet(self, t, memory->x, memory->around);
    load(&self->state, u, p);
    model_rates(memory->x, u, p, dx);
    for (int i = 0; i < STATES; i++) memory->before[i] = memory->x[i] - dx[i];
    memory->span = 1.0;
    memory->count = memory->steps = memory->done = 0;
}

/* Evaluate the surroundings ahead, if the step leaves what is evaluated: two before t, that at t
   and one ahead, from where the states go on as in the step before. */
static void look_ahead(Instance *self, double t, double h, long long count) {
    Memory *memory = &self->state.memory;
    const int again = memory->span == h && memory->count == count;
    double x[STATES + 1];
    if (again && memory->done < memory->steps) return;
    if (again)
        memmove(memory->met[0], memory->met[1], 3 * sizeof memory->met[0]);
    else
        memory->steps = h > SPACING ? 1 : (long long)fmax(1.0, floor(SPACING / h + 1e-9));
    const double apart = (double)memory->steps * h;
    for (int j = again ? 1 : -2; j < 2; j++) {
        for (int i = 0; i < STATES; i++)
            x[i] = memory->x[i] + (double)j * apart * ((memory->x[i] - memory->before[i]) / memory->span);
        meet(self, t + (double)j * apart, x, memory->met[j + 2]);
    }
    memory->span = h;
    memory->count = count;
    memory->done = 0;
}

/* Lagrange's cubic through the evaluations, at a half of a sub-step of the step that is taken. */
static void around_at(const Memory *memory, long long half, double *to) {
    const double s = (double)memory->done / (double)memory->steps +
                     (double)half / (double)(2 * memory->count * memory->steps);
    const double below = s + 2.0, before = s + 1.0, ahead = s - 1.0;
    const double shares[] = {-before * s * ahead / 6.0, below * s * ahead / 2.0,
                             -below * before * ahead / 2.0, below * before * s / 6.0};
    for (int i = 0; i < AROUND; i++)
        to[i] = shares[0] * memory->met[0][i] + shares[1] * memory->met[1][i] +
                shares[2] * memory->met[2][i] + shares[3] * memory->met[3][i];
}

static void advance_among(Instance *self, double t, double h, long long count) {
    State *state = &self->state;
    Memory *memory = &state->memory;
    double u[3][INPUTS + AROUND], p[PARAMETERS + 1], next[STATES + 1];
    look_ahead(self, t, h, count);
    memcpy(memory->before, memory->x, sizeof memory->x);
    for (int j = 0; j < 3; j++) load(state, u[j], p);
    around_at(memory, 0, u[2] + INPUTS);
    for (long long i = 0; i < count; i++) {
        memcpy(u[0] + INPUTS, u[2] + INPUTS, AROUND * sizeof u[0][0]);
        around_at(memory, 2 * i + 1, u[1] + INPUTS);
        around_at(memory, 2 * i + 2, u[2] + INPUTS);
        model_between(memory->x, u[0], u[1], u[2], p, h / (double)count, next);
        memcpy(memory->x, next, STATES * sizeof *next);
    }
    memcpy(memory->around, u[2] + INPUTS, AROUND * sizeof u[0][0]);
    memory->done++;
}

static int publish_among(State *state) {
    double u[INPUTS + AROUND], p[PARAMETERS + 1], y[OUTPUTS + 1];
    if (!state->memory.among) return 0;
    load_among(state, u, p);
    model_out_among(state->memory.x, u, p, y);
    publish(state->values, model_y, OUTPUTS, y);
    return 1;
}

static int derive_among(State *state, const double *dx, const double *du, const double *dp, double *dy) {
    double u[INPUTS + AROUND], p[PARAMETERS + 1], all[INPUTS + AROUND] = {0.0};
    if (!state->memory.among) return 0;
    load_among(state, u, p);
    memcpy(all, du, INPUTS * sizeof *du); /* the surroundings are held */
    model_along_among(state->memory.x, u, p, dx, all, dp, dy);
    return 1;
}

#define IS_AMONG(self) ((self)->state.memory.among)
#else
#define IS_AMONG(self) 0
#define start_among(self, t) ((void)(t))
#define advance_among(self, t, h, count) ((void)(t))
#define publish_among(state) 0
#define derive_among(state, dx, du, dp, dy) 0
#endif

/* ------------------------------------------------------------------ as a component */

void model_start(Instance *self, double t) {
    gather(self->state.values, model_x_start, STATES, self->state.memory.x);
    start_among(self, t);
}

void model_step(Instance *self, double t, double h) {
    const double parts = ceil(h / self->state.values[MAX_STEP] - 1e-9);
    const long long count = parts > 1.0 ? (long long)parts : 1;
    if (IS_AMONG(self)) advance_among(self, t, h, count);
    else advance_still(&self->state, h, count);
}

void model_outputs(Instance *self, double t) {
    (void)t;
    State *state = &self->state;
    double u[INPUTS + 1], p[PARAMETERS + 1], y[OUTPUTS + 1];
    publish(state->values, model_x, STATES, state->memory.x);
    if (OUTPUTS == 0 || publish_among(state)) return;
    load(state, u, p);
    model_out(state->memory.x, u, p, y);
    publish(state->values, model_y, OUTPUTS, y);
}

/* States are held over an instant; before the run they are the start values. */
int model_derivative(Instance *self, const double *seeds, double *along) {
    State *state = &self->state;
    double u[INPUTS + 1], p[PARAMETERS + 1];
    double dx[STATES + 1] = {0.0}, du[INPUTS + 1], dp[PARAMETERS + 1], dy[OUTPUTS + 1];
    if (state->phase != RUNNING) gather(seeds, model_x_start, STATES, dx);
    publish(along, model_x, STATES, dx);
    if (OUTPUTS == 0) return 1;
    gather(seeds, model_u, INPUTS, du);
    gather(seeds, model_p, PARAMETERS, dp);
    if (!derive_among(state, dx, du, dp, dy)) {
        load(state, u, p);
        model_along(state->memory.x, u, p, dx, du, dp, dy);
    }
    publish(along, model_y, OUTPUTS, dy);
    return 1;
}

void model_text(Instance *self, int text) { (void)self, (void)text; }
