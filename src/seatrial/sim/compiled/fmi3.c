/* FMUs of FMI 3.0 for `master.c`, which knows the signatures of FMI 2.0. Compiled behind it. */

#include <stdbool.h>

enum { RETURNED = 100 }; /* a step that ended early, with an event or for good: Python goes on */

typedef int (*Float64s)(void *component, const uint32_t *references, size_t count, double *values,
                        size_t value_count);
typedef int (*Int32s)(void *component, const uint32_t *references, size_t count, int32_t *values,
                      size_t value_count);
typedef int (*Booleans)(void *component, const uint32_t *references, size_t count, bool *values,
                        size_t value_count);

typedef struct { /* `Fmi3`: what a step leaves is the instance's own in Python */
    void *component;
    void *get_float64, *set_float64, *get_int32, *set_int32, *get_boolean, *set_boolean, *do_step;
    bool *truths; /* as many as it has variables */
    bool *event, *end, *early;
    double *reached;
} Fmi3;

/* References begin with their number: of an array there is one for all its values. */
static int float64s(const Fmi3 *f, void *function, const uint32_t *references, size_t n, void *values) {
    return ((Float64s)function)(f->component, references + 1, *references, values, n);
}

static int int32s(const Fmi3 *f, void *function, const uint32_t *references, size_t n, void *values) {
    return ((Int32s)function)(f->component, references + 1, *references, values, n);
}

static int booleans(const Fmi3 *f, void *function, const uint32_t *references, size_t n) {
    return ((Booleans)function)(f->component, references + 1, *references, f->truths, n);
}

EXPORT int fmi3_get_real(void *fmu, const uint32_t *references, size_t n, void *values) {
    return float64s(fmu, ((const Fmi3 *)fmu)->get_float64, references, n, values);
}

EXPORT int fmi3_set_real(void *fmu, const uint32_t *references, size_t n, void *values) {
    return float64s(fmu, ((const Fmi3 *)fmu)->set_float64, references, n, values);
}

EXPORT int fmi3_get_integer(void *fmu, const uint32_t *references, size_t n, void *values) {
    return int32s(fmu, ((const Fmi3 *)fmu)->get_int32, references, n, values);
}

EXPORT int fmi3_set_integer(void *fmu, const uint32_t *references, size_t n, void *values) {
    return int32s(fmu, ((const Fmi3 *)fmu)->set_int32, references, n, values);
}

EXPORT int fmi3_get_boolean(void *fmu, const uint32_t *references, size_t n, void *values) {
    const Fmi3 *f = fmu;
    const int status = booleans(f, f->get_boolean, references, n);
    for (size_t i = 0; i < n; i++) ((int *)values)[i] = f->truths[i];
    return status;
}

EXPORT int fmi3_set_boolean(void *fmu, const uint32_t *references, size_t n, void *values) {
    const Fmi3 *f = fmu;
    for (size_t i = 0; i < n; i++) f->truths[i] = ((const int *)values)[i] != 0;
    return booleans(f, f->set_boolean, references, n);
}

EXPORT int fmi3_step(void *fmu, double t, double h, int never_back) {
    typedef int (*Step)(void *, double, double, bool, bool *, bool *, bool *, double *);
    const Fmi3 *f = fmu;
    const int status = ((Step)f->do_step)(f->component, t, h, never_back != 0, f->event, f->end,
                                          f->early, f->reached);
    return is_accepted(status) && (*f->event || *f->end || *f->early) ? RETURNED : status;
}
