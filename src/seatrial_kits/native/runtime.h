/* What C from Python needs to do as Python does, to the bit. */

#ifndef RUNTIME_H
#define RUNTIME_H

#include <math.h>
#include <stdlib.h>

#include "component.h"

#define V (self->state.values)
#define M (self->state.memory)

/* ------------------------------------------------------------------ numbers */

static inline double divided(Instance *self, double a, double b, const char *where) {
    if (b == 0.0) fail(self, "%s: division by zero at %s", self->name, where);
    return a / b;
}

/* The nearest whole number, to even between two: what rint does, without a call. */
static inline double nearest(double x) {
    const double large = __builtin_copysign(4503599627370496.0, x); /* 2^52: no digits behind it */
    if (!(__builtin_fabs(x) < 4503599627370496.0)) return x;
    return __builtin_copysign((x + large) - large, x);
}

/* The result has the sign of the divisor. */
static inline double modulo(Instance *self, double a, double b, const char *where) {
    if (b == 0.0) fail(self, "%s: modulo by zero at %s", self->name, where);
    const double rest = fmod(a, b);
    if (rest == 0.0) return __builtin_copysign(0.0, b);
    return (b < 0.0) != (rest < 0.0) ? rest + b : rest;
}

/* The whole number of times that b goes into a, downwards; the rest is `modulo`. */
static inline double quotient(Instance *self, double a, double b, const char *where) {
    if (b == 0.0) fail(self, "%s: division by zero at %s", self->name, where);
    const double rest = fmod(a, b);
    const double times = (a - rest) / b - (rest != 0.0 && (b < 0.0) != (rest < 0.0) ? 1.0 : 0.0);
    if (times == 0.0) return __builtin_copysign(0.0, a / b);
    const double down = floor(times);
    return times - down > 0.5 ? down + 1.0 : down;
}

static inline double checked(Instance *self, double result, double x, const char *where) {
    if (!isfinite(result) && isfinite(x))
        fail(self, "%s: there is no value for %s at %s", self->name, shown(self, x), where);
    return result;
}

static inline double power(Instance *self, double a, double b, const char *where) {
    const double result = pow(a, b);
    if (isnan(result) && isfinite(a) && isfinite(b)) /* in Python a complex number */
        fail(self, "%s: %s to the power of %s is no real number at %s", self->name, shown(self, a),
             shown(self, b), where);
    return isfinite(b) ? checked(self, result, a, where) : result;
}

/* What has no value for an infinite x or a y of zero, and none for either. */
static inline double remaining(Instance *self, double rest, double x, double y, const char *where) {
    if (isnan(rest) && !isnan(x) && !isnan(y))
        fail(self, "%s: there is no remainder of %s and %s at %s", self->name, shown(self, x),
             shown(self, y), where);
    return rest;
}

/* Whether two floats are equal as items are: in Python a NaN is, if it is the same object. */
static inline int same(Instance *self, double a, double b, const char *where) {
    if (isnan(a) && isnan(b))
        fail(self, "%s: whether one NaN is another is unknown at %s", self->name, where);
    return a == b;
}

static inline long long whole(Instance *self, double x, const char *where) {
    if (__builtin_fabs(x) < 9.2e18) return (long long)x;
    fail(self, "%s: %s is too large a number at %s", self->name, shown(self, x), where);
    return 0;
}

/* A whole number for a port: Python takes none with digits behind the point, FMI 32 bits. */
static inline double integer(Instance *self, double x, const char *where) {
    if (__builtin_fabs(x) < 2147483648.0 && nearest(x) == x) return x + 0.0;
    fail(self, "%s: %s is no whole number of 32 bits at %s", self->name, shown(self, x), where);
    return 0.0;
}

static inline long long large(Instance *self, const char *where) {
    fail(self, "%s: a whole number of more than 64 bits at %s", self->name, where);
    return 0;
}

static inline long long plus(Instance *self, long long a, long long b, const char *where) {
    long long result;
    return __builtin_add_overflow(a, b, &result) ? large(self, where) : result;
}

static inline long long minus(Instance *self, long long a, long long b, const char *where) {
    long long result;
    return __builtin_sub_overflow(a, b, &result) ? large(self, where) : result;
}

static inline long long times(Instance *self, long long a, long long b, const char *where) {
    long long result;
    return __builtin_mul_overflow(a, b, &result) ? large(self, where) : result;
}

static inline long long size_of(Instance *self, long long a, const char *where) {
    return a < 0 ? minus(self, 0, a, where) : a;
}

/* A whole number as the double that it is: Python divides and compares those beyond 2^53 exactly. */
static inline double exact(Instance *self, long long a, const char *where) {
    if (-9007199254740992LL <= a && a <= 9007199254740992LL) return (double)a;
    fail(self, "%s: %lld is beyond 2^53 at %s", self->name, a, where);
    return 0.0;
}

static inline long long floored(Instance *self, long long a, long long b, const char *where) {
    if (b == 0) {
        fail(self, "%s: division by zero at %s", self->name, where);
        return 0;
    }
    if (b == -1) return minus(self, 0, a, where);
    return a / b - (a % b != 0 && (a < 0) != (b < 0));
}

static inline long long whole_modulo(Instance *self, long long a, long long b, const char *where) {
    if (b == -1) return 0;
    return a - floored(self, a, b, where) * b;
}

static inline int checked_index(Instance *self, long long index, int size) {
    const long long place = index < 0 ? index + size : index;
    if (0 <= place && place < size) return (int)place;
    fail(self, "%s: there is no item %lld of %d", self->name, index, size);
    return 0;
}

double norm(int count, const double *values);                /* math.hypot */
double compensated(int count, const double *values);         /* sum, from Python 3.12 on */
int right_of(const double *table, int count, double x);      /* bisect.bisect_right */
int left_of(const double *table, int count, double x);       /* bisect.bisect_left */
double interpolated(double x, int count, const double *xs, const double *ys); /* numpy.interp */

/* ------------------------------------------------------------------ queues */

/* The place of a new entry among `entries`, of so many bytes each. */
int appended(Instance *self, Queue *queue, void *entries, size_t bytes, const char *where);

static inline int entry_at(Instance *self, const Queue *queue, long long index) {
    const long long place = index < 0 ? index + queue->count : index;
    if (0 <= place && place < queue->count) return (int)((queue->first + place) & (queue->size - 1));
    fail(self, "%s: there is no entry %lld of %d", self->name, index, queue->count);
    return 0;
}

#define drop_first(queue) ((queue).first = ((queue).first + 1) & ((queue).size - 1), (queue).count--)
#define drop_last(queue) ((queue).count--)

/* ------------------------------------------------------------------ random numbers */

typedef struct {
    uint64_t counter[4], key[2], drawn[4];
    int used, has_half;
    uint64_t half; /* of a number, for the next 32 bits */
} Philox;

/* The generator of a sample, as seatrial's `Noise.generator`: NumPy's Philox by seed and kind. */
void begin_draws(Instance *self, Philox *draws, double seed, uint64_t kind, long long stream,
                 long long index);
double drawn_random(Philox *draws);
double drawn_standard_normal(Philox *draws);
long long drawn_integer(Philox *draws, long long low, long long high); /* below high, less than 2^32 */

/* ------------------------------------------------------------------ faults */

int present_fault(Instance *self); /* its number; fails for a text that is none */
int fault_index(Instance *self, int setting, long long index);

#endif
