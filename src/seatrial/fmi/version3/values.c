/* FMI 3.0: values of variables, which are arrays, by the scalars of FMI 2.0. */

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "front.h"

#define BATCH 1024 /* scalars of one call of FMI 2.0, at most */

typedef struct {
    const fmi3ValueReference *next, *end;
    unsigned element;
} Walk;

static size_t elements_of(fmi3ValueReference reference) {
    return IS_OF_BUS(reference) ? 1 : (reference >> MORE_THAN_ONE) + 1;
}

/* Take the next scalars of variables; return how many. Of a bus there are none: FMI 2.0 refuses. */
static size_t taken(Walk *walk, fmi2ValueReference scalars[BATCH]) {
    size_t count = 0;
    while (walk->next < walk->end && count < BATCH) {
        const fmi3ValueReference first = IS_OF_BUS(*walk->next) ? ~0u : *walk->next & TIME;
        scalars[count++] = first + walk->element;
        if (++walk->element == elements_of(*walk->next)) walk->next++, walk->element = 0;
    }
    return count;
}

static int are(Front *self, const fmi3ValueReference references[], size_t count, size_t values) {
    size_t elements = 0;
    for (size_t i = 0; i < count; i++) elements += elements_of(references[i]);
    if (elements == values) return 1;
    front_refuses(self, "%s: the variables have %zu elements, found %zu values", self->name,
                  elements, values);
    return 0;
}

/* Call a function of FMI 2.0 for as many scalars as it takes at once, again and again. */
#define BY_SCALARS(call)                                                                        \
    Walk walk = {references, references + count, 0};                                            \
    fmi2ValueReference scalars[BATCH];                                                          \
    if (!are(self, references, count, n)) return fmi3Error;                                     \
    for (size_t done = 0, some; (some = taken(&walk, scalars)) > 0; done += some) {             \
        const fmi3Status status = call;                                                         \
        if (status > fmi3Warning) return status;                                                \
    }                                                                                           \
    return fmi3OK;

#define GET(Type, Type2)                                                                        \
    static fmi3Status get_##Type(Front *self, const fmi3ValueReference references[],            \
                                 size_t count, fmi3##Type values[], size_t n) {                 \
        BY_SCALARS(shown_##Type2(self, scalars, some, values + done))                           \
    }
#define SET(name, Type, Type2)                                                                  \
    name(fmi3Instance instance, const fmi3ValueReference references[], size_t count,            \
         const fmi3##Type values[], size_t n) {                                                 \
        Front *self = instance;                                                                 \
        BY_SCALARS(passed(fmi2Set##Type2(self->inner, scalars, some, values + done)))     \
    }

GET(Float64, Real)
GET(Int32, Integer)
GET(String, String)
SET(static fmi3Status set_Float64, Float64, Real)
SET(fmi3Status fmi3SetInt32, Int32, Integer)
SET(fmi3Status fmi3SetString, String, String)

/* Whether a variable is not the component's, but time or of a bus. */
static int is_front(fmi3ValueReference reference) {
    return reference == TIME || IS_OF_BUS(reference);
}

fmi3Status fmi3GetFloat64(fmi3Instance instance, const fmi3ValueReference references[],
                          size_t count, fmi3Float64 values[], size_t n) {
    Front *self = instance;
    size_t place = 0;
    while (place < count && !is_front(references[place])) place++;
    if (place == count) return get_Float64(self, references, count, values, n);
    if (!are(self, references, count, n)) return fmi3Error;
    for (size_t i = 0, size; i < count; i++, values += size) {
        fmi3Status status = fmi3OK;
        size = elements_of(references[i]);
        if (references[i] == TIME) *values = self->time;
        else if (IS_OF_BUS(references[i])) status = events_get_number(self, references[i], values);
        else status = get_Float64(self, &references[i], 1, values, size);
        if (status > fmi3Warning) return status;
    }
    return fmi3OK;
}

fmi3Status fmi3SetFloat64(fmi3Instance instance, const fmi3ValueReference references[],
                          size_t count, const fmi3Float64 values[], size_t n) {
    Front *self = instance;
    size_t place = 0;
    while (place < count && !IS_OF_BUS(references[place])) place++;
    if (place == count) return set_Float64(self, references, count, values, n);
    if (!are(self, references, count, n)) return fmi3Error;
    for (size_t i = 0, size; i < count; i++, values += size) {
        size = elements_of(references[i]);
        const fmi3Status status = IS_OF_BUS(references[i])
                                      ? events_set_number(self, references[i], *values)
                                      : set_Float64(self, &references[i], 1, values, size);
        if (status > fmi3Warning) return status;
    }
    return fmi3OK;
}

fmi3Status fmi3GetInt32(fmi3Instance instance, const fmi3ValueReference references[], size_t count,
                        fmi3Int32 values[], size_t n) {
    return get_Int32(instance, references, count, values, n);
}

fmi3Status fmi3GetString(fmi3Instance instance, const fmi3ValueReference references[], size_t count,
                         fmi3String values[], size_t n) {
    Front *self = instance;
    if (n > BATCH) /* a further call of FMI 2.0 would free the texts of the one before */
        return front_refuses(self, "%s: at most %d texts at once, found %zu", self->name, BATCH, n);
    return get_String(self, references, count, values, n);
}

static fmi3Status get_truths(Front *self, const fmi2ValueReference scalars[], size_t some,
                             fmi3Boolean values[]) {
    fmi2Boolean truths[BATCH] = {0};
    const fmi3Status status = shown_Boolean(self, scalars, some, truths);
    for (size_t i = 0; i < some; i++) values[i] = truths[i] != 0;
    return status;
}

static fmi3Status set_truths(Front *self, const fmi2ValueReference scalars[], size_t some,
                             const fmi3Boolean values[]) {
    fmi2Boolean truths[BATCH];
    for (size_t i = 0; i < some; i++) truths[i] = values[i];
    return passed(fmi2SetBoolean(self->inner, scalars, some, truths));
}

static fmi3Status get_Boolean(Front *self, const fmi3ValueReference references[], size_t count,
                              fmi3Boolean values[], size_t n) {
    BY_SCALARS(get_truths(self, scalars, some, values + done))
}

/* The same with some of buses among them. */
static fmi3Status get_mixed(Front *self, const fmi3ValueReference references[], size_t count,
                            fmi3Boolean values[], size_t n) {
    if (!are(self, references, count, n)) return fmi3Error;
    for (size_t i = 0, size; i < count; i++, values += size) {
        size = elements_of(references[i]);
        const fmi3Status status = IS_OF_BUS(references[i])
                                      ? events_get_truth(self, references[i], values)
                                      : get_Boolean(self, &references[i], 1, values, size);
        if (status > fmi3Warning) return status;
    }
    return fmi3OK;
}

fmi3Status fmi3GetBoolean(fmi3Instance instance, const fmi3ValueReference references[],
                          size_t count, fmi3Boolean values[], size_t n) {
    Front *self = instance;
    for (size_t i = 0; i < count; i++)
        if (IS_OF_BUS(references[i])) return get_mixed(self, references, count, values, n);
    return get_Boolean(self, references, count, values, n);
}

fmi3Status fmi3SetBoolean(fmi3Instance instance, const fmi3ValueReference references[],
                          size_t count, const fmi3Boolean values[], size_t n) {
    Front *self = instance;
    BY_SCALARS(set_truths(self, scalars, some, values + done))
}

/* ------------------------------------------------------------------ bytes */

static int fits(Front *self, size_t size) {
    if (size <= self->buffer_size) return 1;
    char *const buffer = realloc(self->buffer, size);
    if (!buffer) return 0;
    self->buffer = buffer, self->buffer_size = size;
    return 1;
}

fmi3Status fmi3GetBinary(fmi3Instance instance, const fmi3ValueReference references[], size_t count,
                         size_t sizes[], fmi3Binary values[], size_t n) {
    Front *self = instance;
    fmi3ValueReference plain[BATCH] = {0};
    fmi3String texts[BATCH], *text = texts;
    size_t plains = 0, needed = 0;
    if (n > BATCH)
        return front_refuses(self, "%s: at most %d values at once, found %zu", self->name, BATCH,
                             n);
    if (!are(self, references, count, n)) return fmi3Error;
    for (size_t i = 0; i < count; i++)
        if (!IS_OF_BUS(references[i])) plain[plains++] = references[i];
    /* In one call: a further one of FMI 2.0 would free these texts. */
    const size_t all = n - (count - plains);
    fmi3Status status = get_String(self, plain, plains, texts, all);
    if (status > fmi3Warning) return status;
    for (size_t i = 0; i < all; i++) needed += MOST_BYTES(strlen(texts[i]));
    if (!fits(self, needed)) return fmi3Error;
    unsigned char *to = (unsigned char *)self->buffer;
    for (size_t i = 0, place = 0; i < count && status <= fmi3Warning; i++)
        if (IS_OF_BUS(references[i])) {
            status = events_get_binary(self, references[i], &values[place], &sizes[place]);
            place++;
        } else {
            for (size_t k = elements_of(references[i]); k > 0; k--, place++, text++) {
                const long long size = chunks_from_text(*text, to);
                if (size < 0)
                    return front_refuses(self, "%s: this text is no bytes: '%.60s'", self->name,
                                         *text);
                values[place] = to, sizes[place] = (size_t)size;
                to += size;
            }
        }
    return status;
}

static fmi3Status set_bytes(Front *self, fmi2ValueReference scalar, fmi3Binary value, size_t size) {
    if (!fits(self, MOST_TEXT(size))) return fmi3Error;
    if (chunks_to_text(value, size, self->buffer) < 0)
        return front_refuses(self, "%s: %zu bytes are no chunks", self->name, size);
    const fmi2String text = self->buffer;
    return passed(fmi2SetString(self->inner, &scalar, 1, &text));
}

fmi3Status fmi3SetBinary(fmi3Instance instance, const fmi3ValueReference references[], size_t count,
                         const size_t sizes[], const fmi3Binary values[], size_t n) {
    Front *self = instance;
    fmi3Status status = fmi3OK;
    if (!are(self, references, count, n)) return fmi3Error;
    for (size_t i = 0, place = 0; i < count; i++)
        for (size_t k = 0; k < elements_of(references[i]); k++, place++) {
            const fmi2ValueReference scalar = (references[i] & TIME) + (unsigned)k;
            status = IS_OF_BUS(references[i])
                         ? events_set_binary(self, references[i], values[place], sizes[place])
                         : set_bytes(self, scalar, values[place], sizes[place]);
            if (status > fmi3Warning) return status;
        }
    return status;
}
