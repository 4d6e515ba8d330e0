/* A plant: equal Runge-Kutta sub-steps with inputs held, operation by operation as seatrial's. */

#include <math.h>
#include <string.h>

#include "component.h"

static void gather(const double *values, const int *references, int count, double *to) {
    for (int i = 0; i < count; i++) to[i] = values[references[i]];
}

static void publish(double *values, const int *references, int count, const double *from) {
    for (int i = 0; i < count; i++) values[references[i]] = from[i];
}

void model_start(Instance *self, double t) {
    (void)t;
    gather(self->state.values, model_x_start, STATES, self->state.memory.x);
}

void model_step(Instance *self, double t, double h) {
    (void)t;
    State *state = &self->state;
    double u[INPUTS + 1], p[PARAMETERS + 1], next[STATES + 1];
    const double parts = ceil(h / state->values[MAX_STEP] - 1e-9);
    const long long count = parts > 1.0 ? (long long)parts : 1;
    const double part = h / (double)count;
    gather(state->values, model_u, INPUTS, u);
    gather(state->values, model_p, PARAMETERS, p);
    for (long long i = 0; i < count; i++) {
        model_rk4(state->memory.x, u, p, part, next);
        memcpy(state->memory.x, next, STATES * sizeof *next);
    }
}

void model_outputs(Instance *self, double t) {
    (void)t;
    State *state = &self->state;
    double u[INPUTS + 1], p[PARAMETERS + 1], y[OUTPUTS + 1];
    publish(state->values, model_x, STATES, state->memory.x);
    if (OUTPUTS == 0) return;
    gather(state->values, model_u, INPUTS, u);
    gather(state->values, model_p, PARAMETERS, p);
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
    gather(state->values, model_u, INPUTS, u);
    gather(state->values, model_p, PARAMETERS, p);
    gather(seeds, model_u, INPUTS, du);
    gather(seeds, model_p, PARAMETERS, dp);
    model_along(state->memory.x, u, p, dx, du, dp, dy);
    publish(along, model_y, OUTPUTS, dy);
    return 1;
}

void model_text(Instance *self, int text) { (void)self, (void)text; }
