/* What surrounds a craft at a time, as seatrial's `Around.at`, operation by operation. */

#include "weather.h"

#include <math.h>
#include <string.h>

#if defined(_WIN32)
#define EXPORTED __declspec(dllexport)
#else
#define EXPORTED __attribute__((visibility("default")))
#endif

#define PI 3.141592653589793
#define TAU 6.283185307179586
#define SLOPE 1e-3    /* s and m, of the differences of a current */
#define DEEPEST 600.0 /* of k z */
#define AIR_DENSITY 1.225

enum { ELEVATION, VELOCITY, ACCELERATION = 4, SHEAR = 7, WAVE = 9, WIND = 15, PARTS = 21 };

/* A table, made when it is first needed. Copies share it, and so may threads. */
static const double *table(const Weather *self, const double **place, int64_t kind, int64_t number) {
    const double *found = __atomic_load_n(place, __ATOMIC_ACQUIRE);
    if (!found && (found = self->make(kind, number))) __atomic_store_n(place, found, __ATOMIC_RELEASE);
    return found;
}

static double at_least(double x, double least) { return least > x ? least : x; }

/* ------------------------------------------------------------------ waves */

static double phase_at(const Weather *self, int64_t i, double t, double x, double y) {
    return self->omega[i] * t + self->north[i] * x + self->east[i] * y + self->phase[i];
}

/* Sums of what components contribute at two headings, of their cosines and sines. */
static inline __attribute__((always_inline)) void sum_loads(
    const Weather *self, int half, const double *near, const double *far, double t, double x, double y,
    double (*sums)[20]) {
    for (int64_t i = 0; i < self->count; i++, near += 2 * half, far += 2 * half) {
        const double theta = phase_at(self, i, t, x, y), c = cos(theta), s = sin(theta);
        for (int r = 0; r < half; r++) {
            sums[0][r] += near[r] * c;
            sums[1][r] += far[r] * c;
            sums[0][half + r] += near[half + r] * s;
            sums[1][half + r] += far[half + r] * s;
        }
    }
}

static int meet_loads(const Weather *self, double t, double x, double y, double heading, double *load) {
    static const int drifts[] = {0, 1, 5};
    const int half = (int)self->half;
    double sums[2][20] = {{0.0}}, turned = fmod(heading, TAU);
    if (!isfinite(heading)) return 0;
    if (turned < 0.0) turned += TAU;
    turned /= TAU / (double)self->headings;
    const double whole = floor(turned), share = turned - whole;
    const int64_t cell = (int64_t)whole % self->headings, next = (cell + 1) % self->headings;
    const double *near = table(self, self->loads + cell, HEADING, cell);
    const double *far = table(self, self->loads + next, HEADING, next);
    if (!near || !far) return 0;
    if (half == 6) sum_loads(self, 6, near, far, t, x, y, sums);
    else sum_loads(self, 10, near, far, t, x, y, sums);
    for (int r = 0; r < 2 * half; r++) sums[0][r] = (1.0 - share) * sums[0][r] + share * sums[1][r];
    const double *c = sums[0], *s = c + half;
    for (int r = 0; r < 6; r++) load[r] = c[r] + s[r];
    for (int r = 0; r < half - 7; r++) load[drifts[r]] += c[9] * c[6 + r] + s[9] * s[6 + r];
    return 1;
}

/* Elevation, and velocity and acceleration of the water in {n}. */
static void move(const Weather *self, double t, double x, double y, double z, double *elevation,
                 double *moved) {
    double c[self->count], s[self->count], sums[6] = {0.0}, height = 0.0;
    for (int64_t i = 0; i < self->count; i++) {
        const double theta = phase_at(self, i, t, x, y);
        c[i] = cos(theta), s[i] = sin(theta);
        height += self->amplitude[i] * c[i];
    }
    z = at_least(z + height, 0.0);
    const int is_deep = isinf(self->depth);
    if (!is_deep) z = z * self->depth / (self->depth + height);
    for (int64_t i = 0; i < self->count; i++) {
        const double *motion = self->motions + 6 * i, kz = self->k[i] * z;
        const double decay = exp(-(is_deep || kz < DEEPEST ? kz : DEEPEST));
        double level = decay, upright = decay;
        if (!is_deep) {
            const double rise = self->back[i] / decay;
            level = (decay + rise) / self->below[i];
            upright = (decay - rise) / self->below[i];
        }
        sums[0] += motion[0] * (c[i] * level);
        sums[1] += motion[1] * (c[i] * level);
        sums[2] += motion[2] * (c[i] * upright);
        sums[3] += motion[3] * (s[i] * upright);
        sums[4] += motion[4] * (s[i] * level);
        sums[5] += motion[5] * (s[i] * level);
    }
    *elevation = height;
    moved[0] = sums[0], moved[1] = sums[1], moved[2] = sums[3];
    moved[3] = sums[4], moved[4] = sums[5], moved[5] = sums[2];
}

/* Rows of the rotation from {b} to {n}. */
static void rotate(const double *attitude, double R[3][3]) {
    const double sphi = sin(attitude[0]), sth = sin(attitude[1]), spsi = sin(attitude[2]);
    const double cphi = cos(attitude[0]), cth = cos(attitude[1]), cpsi = cos(attitude[2]);
    const double rows[3][3] = {
        {cpsi * cth, -spsi * cphi + cpsi * sth * sphi, spsi * sphi + cpsi * cphi * sth},
        {spsi * cth, cpsi * cphi + sphi * sth * spsi, -cpsi * sphi + sth * spsi * cphi},
        {-sth, cth * sphi, cth * cphi},
    };
    memcpy(R, rows, sizeof rows);
}

static void meet_at_parts(const Weather *self, double t, const double *state, const double *own,
                          double *velocities) {
    double R[3][3], point[3], elevation, moved[6];
    rotate(state + self->psi - 2, R);
    for (int64_t k = 0; k < self->part_count; k++) {
        const double *r = self->part_positions + 3 * k;
        for (int i = 0; i < 3; i++)
            point[i] = state[self->x + i] + (R[i][0] * r[0] + R[i][1] * r[1] + R[i][2] * r[2]);
        move(self, t, point[0], point[1], point[2], &elevation, moved);
        for (int i = 0; i < 3; i++) velocities[3 * self->part_rows[k] + i] = moved[i] - own[i];
    }
}

/* ------------------------------------------------------------------ current */

static void towards(double speed, double direction, double *to) {
    to[0] = speed * cos(direction);
    to[1] = speed * sin(direction);
}

static int sample(const Weather *self, int which, int64_t number, double *to) {
    int64_t first = 0, size = FIRST_BLOCK;
    int block = 0;
    for (; number >= first + size; block++) first += size, size *= 2;
    if (block >= BLOCKS) return 0;
    const double *found = table(self, self->samples[which] + block, which, block);
    if (!found) return 0;
    *to = found[number - first];
    return 1;
}

static int vary(const Weather *self, int which, double t, double *to) {
    double before, after;
    const double at = t / self->sample_period, whole = floor(at), share = at - whole;
    if (!(at < 1e15)) return 0;
    if (!sample(self, which, (int64_t)whole, &before)) return 0;
    if (!sample(self, which, (int64_t)whole + 1, &after)) return 0;
    *to = (1.0 - share) * before + share * after;
    return 1;
}

static void layered(const Weather *self, double z, double *to) {
    int64_t after = 0;
    while (after < self->layers && self->layer_depths[after] <= z) after++;
    const double *before = self->layer_velocities + 2 * (after > 0 ? after - 1 : 0);
    memcpy(to, before, 2 * sizeof *to);
    if (after == 0 || after == self->layers) return;
    const double *depths = self->layer_depths + after - 1;
    const double share = (z - depths[0]) / (depths[1] - depths[0]);
    for (int i = 0; i < 2; i++) to[i] = before[i] + share * (before[2 + i] - before[i]);
}

static void turn(double by, double grown, double *stream) {
    const double c = cos(by), s = sin(by), north = stream[0], east = stream[1];
    const double size = sqrt(north * north + east * east);
    stream[0] = c * north - s * east;
    stream[1] = s * north + c * east;
    if (size == 0.0) return;
    stream[0] *= 1.0 + grown / size;
    stream[1] *= 1.0 + grown / size;
}

static void add_tide(const Weather *self, double t, double *velocity) {
    double along[2], across[2];
    const double angle = TAU * t / self->tide_period + self->tide_phase;
    towards(self->tide_minor * sin(angle), self->tide_axis + 0.5 * PI, across);
    towards(self->tide_major * cos(angle), self->tide_axis, along);
    for (int i = 0; i < 2; i++) velocity[i] += along[i] + across[i];
}

static int flow(const Weather *self, double t, double z, double *velocity) {
    double speed = self->speed, direction = self->direction, share = 1.0;
    if (self->sample_period > 0.0) {
        double fast, turned;
        if (!vary(self, SPEED_SAMPLES, at_least(t, 0.0), &fast)) return 0;
        if (!vary(self, DIRECTION_SAMPLES, at_least(t, 0.0), &turned)) return 0;
        speed = fabs(speed + fast);
        direction += turned;
    }
    if (self->profile == LAYERED) {
        layered(self, z, velocity);
        if (self->sample_period > 0.0)
            turn(direction - self->direction, speed - self->speed, velocity);
    } else {
        towards(speed, direction, velocity);
        if (self->profile == POWER)
            share = pow(at_least((self->reach - at_least(z, 0.0)) / self->reach, 0.0), 1.0 / 7.0);
        if (self->profile == LINEAR) {
            share = at_least(1.0 - z / self->reach, 0.0);
            share = share < 1.0 ? share : 1.0;
        }
        velocity[0] *= share;
        velocity[1] *= share;
    }
    if (self->has_tide) add_tide(self, t, velocity);
    return 1;
}

static int meet_current(const Weather *self, double t, double z, double *around) {
    double velocity[2], later[2], earlier[2];
    if (!flow(self, t, z, velocity)) return 0;
    for (int i = 0; i < 2; i++) around[VELOCITY + i] += velocity[i];
    if (!self->is_steady) {
        const double before = at_least(t - SLOPE, 0.0), span = t + SLOPE - before;
        if (!flow(self, t + SLOPE, z, later) || !flow(self, before, z, earlier)) return 0;
        for (int i = 0; i < 2; i++) around[ACCELERATION + i] += (later[i] - earlier[i]) / span;
    }
    if (self->profile != UNIFORM) {
        if (!flow(self, t, z + SLOPE, later) || !flow(self, t, z - SLOPE, earlier)) return 0;
        for (int i = 0; i < 2; i++) around[SHEAR + i] = (later[i] - earlier[i]) / (2.0 * SLOPE);
    }
    return 1;
}

/* ------------------------------------------------------------------ wind */

static double wind_speed(const Weather *self, double t) {
    double speed = self->wind_mean, sum = 0.0;
    for (int64_t i = 0; i < self->gust_count; i++)
        sum += self->gust_amplitude[i] * cos(self->gust_omega[i] * t + self->gust_phase[i]);
    if (self->gust_count) speed += sum;
    const double passed = (t - self->gust_start) / self->gust_duration;
    if (0.0 < passed && passed < 1.0) speed += 0.5 * self->gust_peak * (1.0 - cos(TAU * passed));
    return at_least(speed, 0.0);
}

/* X, Y, K, N of areas: frontal, lateral, ahead, height, along, across. */
static void load_areas(const double *n, double u, double v, double *load) {
    const double pressure = 0.5 * AIR_DENSITY * sqrt(u * u + v * v);
    load[0] = -pressure * n[4] * n[0] * u;
    load[1] = -pressure * n[5] * n[1] * v;
    load[2] = n[3] * load[1];
    load[3] = n[2] * load[1];
}

/* Coefficients of rows every 10 degrees. */
static int look_up(const double *rows, double gamma, double *load) {
    const double turned = remainder(gamma, TAU), at = fabs(turned * (180.0 / PI)) / 10.0;
    if (!(at < 19.0)) return 0;
    const int row = (int)at, next = row < 18 ? row + 1 : 18;
    const double share = at - (double)row, side = copysign(1.0, turned);
    for (int i = 0; i < 4; i++) {
        load[i] = (1.0 - share) * rows[4 * row + i] + share * rows[4 * next + i];
        if (i % 2) load[i] *= side;
    }
    return 1;
}

/* Those of across, from ahead, from astern, delta, kappa; frontal, lateral, length, ahead, height. */
static void blend(const double *n, double gamma, double *load) {
    gamma = remainder(gamma, TAU);
    const double along = fabs(gamma) <= 0.5 * PI ? n[1] : n[2];
    const double ratio = along * n[5] / n[6] / n[0], sine = sin(2.0 * gamma);
    const double below = 1.0 - 0.5 * n[3] * (1.0 - ratio) * (sine * sine);
    const double side = n[0] * sin(gamma) / below;
    const double lever = n[8] / n[7] - 0.18 * (fabs(gamma) - 0.5 * PI);
    load[0] = -along * cos(gamma) / below;
    load[1] = side;
    load[2] = n[4] * n[9] * n[7] / n[6] * side;
    load[3] = lever * side;
}

static int meet_wind(const Weather *self, double t, const double *state, double *to) {
    const double speed = wind_speed(self, t), c = cos(state[self->psi]), s = sin(state[self->psi]);
    const double north = speed * self->wind_cos, east = speed * self->wind_sin;
    const double u = state[self->u] - (c * north + s * east);
    const double v = state[self->v] - (c * east - s * north);
    double load[4];
    if (self->windage == AREAS) {
        load_areas(self->windage_numbers, u, v, load);
    } else {
        const double gamma = -atan2(v, u), through = sqrt(u * u + v * v);
        if (self->windage == BLENDERMANN) blend(self->windage_numbers, gamma, load);
        else if (!look_up(self->windage_numbers, gamma, load)) return 0;
        for (int i = 0; i < 4; i++)
            load[i] = 0.5 * AIR_DENSITY * (through * through) * load[i] * self->windage_scales[i];
    }
    to[0] = load[0], to[1] = load[1], to[3] = load[2], to[5] = load[3];
    return 1;
}

/* ------------------------------------------------------------------ all of it */

EXPORTED int64_t weather_size(void) { return (int64_t)sizeof(Weather); }

/* Returns 0 where there is no value. */
EXPORTED int weather_at(const void *weather, double t, const double *state, double *around) {
    const Weather *self = weather;
    const double x = state[self->x], y = state[self->y], depth = self->z < 0 ? 0.0 : state[self->z];
    memset(around, 0, (size_t)(PARTS + 3 * self->part_size) * sizeof *around);
    if (self->half && !meet_loads(self, t, x, y, state[self->psi], around + WAVE)) return 0;
    if (self->at_origin) move(self, t, x, y, depth, around + ELEVATION, around + VELOCITY);
    if (self->part_count) meet_at_parts(self, t, state, around + VELOCITY, around + PARTS);
    if (self->has_current && !meet_current(self, t, depth, around)) return 0;
    return !self->has_wind || meet_wind(self, t, state, around + WIND);
}
