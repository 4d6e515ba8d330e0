/* Functions that C from Python calls. */

#include "runtime.h"

#include <string.h>

/* ------------------------------------------------------------------ numbers */

#if PYTHON >= 312
/* The exact product of a with itself is high + low. */
static void squared(double a, double *high, double *low) {
    const double t = a * 134217729.0, upper = t - (t - a), lower = a - upper;
    *high = a * a;
    *low = ((upper * upper - *high) + 2.0 * upper * lower) + lower * lower;
}
#endif

static void add(double *sum, double *lost, double term) {
    const double before = *sum;
    *sum += term;
    *lost += (before - *sum) + term;
}

/* CPython's vector_norm: scaled, with the rounding errors of squares and sums carried along and one
   Newton step for the root. Before 3.12 the parts of each square are summed one by one. */
static double scaled_norm(int count, const double *values, double scale) {
    double sum = 1.0, lost[3] = {0.0, 0.0, 0.0};
    for (int i = 0; i < count; i++) {
        const double x = __builtin_fabs(values[i]) * scale;
#if PYTHON >= 312
        double high, low;
        squared(x, &high, &low);
        add(&sum, &lost[1], high);
        lost[0] += low;
#else
        const double t = x * 134217729.0, high = t - (t - x), low = x - high;
        add(&sum, &lost[0], high * high);
        add(&sum, &lost[1], 2.0 * high * low);
        lost[2] += low * low;
#endif
    }
#if PYTHON >= 312
    double root = sqrt(sum - 1.0 + (lost[0] + lost[1])), high, low;
    squared(root, &high, &low);
    add(&sum, &lost[1], -high);
    lost[0] -= low;
    root += (sum - 1.0 + (lost[0] + lost[1])) / (2.0 * root);
    return root / scale;
#else
    const double root = sqrt(sum - 1.0 + (lost[0] + lost[1] + lost[2]));
    const double t = root * 134217729.0, high = t - (t - root), low = root - high;
    add(&sum, &lost[0], -high * high);
    add(&sum, &lost[1], -2.0 * high * low);
    add(&sum, &lost[2], -low * low);
    return (root + (sum - 1.0 + (lost[0] + lost[1] + lost[2])) / (2.0 * root)) / scale;
#endif
}

double norm(int count, const double *values) {
    double most = 0.0;
    int is_nan = 0, exponent;
    for (int i = 0; i < count; i++) {
        const double size = __builtin_fabs(values[i]);
        is_nan |= isnan(size);
        if (size > most) most = size;
    }
    if (isinf(most)) return most;
    if (is_nan) return NAN;
    if (most == 0.0 || count <= 1) return most;
    frexp(most, &exponent);
    if (exponent >= -1023) return scaled_norm(count, values, ldexp(1.0, -exponent));
    double sum = 1.0, lost = 0.0;
    for (int i = 0; i < count; i++) {
        const double x = __builtin_fabs(values[i]) / most;
        add(&sum, &lost, x * x);
    }
    return most * sqrt(sum - 1.0 + lost);
}

double compensated(int count, const double *values) {
    double sum = 0.0, lost = 0.0;
    for (int i = 0; i < count; i++) {
        const double x = values[i], next = sum + x;
        lost += __builtin_fabs(sum) >= __builtin_fabs(x) ? (sum - next) + x : (x - next) + sum;
        sum = next;
    }
    return lost != 0.0 && isfinite(lost) ? sum + lost : sum;
}

int right_of(const double *table, int count, double x) {
    int low = 0, high = count;
    while (low < high) {
        const int middle = (low + high) / 2;
        if (x < table[middle]) high = middle;
        else low = middle + 1;
    }
    return low;
}

int left_of(const double *table, int count, double x) {
    int low = 0, high = count;
    while (low < high) {
        const int middle = (low + high) / 2;
        if (table[middle] < x) low = middle + 1;
        else high = middle;
    }
    return low;
}

double interpolated(double x, int count, const double *xs, const double *ys) {
    if (isnan(x)) return x;
    const int left = right_of(xs, count, x) - 1;
    if (left < 0) return ys[0];
    if (left >= count - 1 || xs[left] == x) return ys[left];
    const double slope = (ys[left + 1] - ys[left]) / (xs[left + 1] - xs[left]);
    return slope * (x - xs[left]) + ys[left];
}

/* ------------------------------------------------------------------ queues */

int appended(Instance *self, Queue *queue, void *entries, size_t bytes, const char *where) {
    if (queue->count == QUEUE_SIZE) {
        fail(self, "%s: more than %d entries wait for their time, at %s: shorten the delay, or "
                   "lengthen the period", self->name, QUEUE_SIZE, where);
        drop_first(*queue);
    } else if (queue->count == queue->size) { /* those before the first go on behind the last */
        memcpy((char *)entries + (size_t)queue->size * bytes, entries, (size_t)queue->first * bytes);
        queue->size = queue->size ? 2 * queue->size : 4;
    }
    return (queue->first + queue->count++) & (queue->size - 1);
}

/* ------------------------------------------------------------------ derivatives */

int model_derivative(Instance *self, const double *seeds, double *along) {
    (void)self, (void)seeds, (void)along;
    return 0;
}
