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

/* Take the next scalars of variables; return how many. */
static size_t taken(Walk *walk, fmi2ValueReference scalars[BATCH]) {
    size_t count = 0;
    while (walk->next < walk->end && count < BATCH) {
        scalars[count++] = (*walk->next & TIME) + walk->element;
        if (walk->element++ == *walk->next >> MORE_THAN_ONE) walk->next++, walk->element = 0;
    }
    return count;
}

static int are(Front *self, const fmi3ValueReference references[], size_t count, size_t values) {
    size_t elements = 0;
    for (size_t i = 0; i < count; i++) elements += (references[i] >> MORE_THAN_ONE) + 1;
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
        BY_SCALARS(passed(fmi2Get##Type2(self->inner, scalars, some, values + done)))     \
    }
#define SET(Type, Type2)                                                                        \
    fmi3Status fmi3Set##Type(fmi3Instance instance, const fmi3ValueReference references[],      \
                             size_t count, const fmi3##Type values[], size_t n) {               \
        Front *self = instance;                                                                 \
        BY_SCALARS(passed(fmi2Set##Type2(self->inner, scalars, some, values + done)))     \
    }

GET(Float64, Real)
GET(Int32, Integer)
GET(String, String)
SET(Float64, Real)
SET(Int32, Integer)
SET(String, String)

fmi3Status fmi3GetFloat64(fmi3Instance instance, const fmi3ValueReference references[],
                          size_t count, fmi3Float64 values[], size_t n) {
    Front *self = instance;
    size_t place = 0;
    while (place < count && references[place] != TIME) place++;
    if (place == count) return get_Float64(self, references, count, values, n);
    if (!are(self, references, count, n)) return fmi3Error;
    for (size_t i = 0, size; i < count; i++, values += size) {
        size = (references[i] >> MORE_THAN_ONE) + 1;
        *values = self->time;
        if (references[i] == TIME) continue;
        const fmi3Status status = get_Float64(self, &references[i], 1, values, size);
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
    const fmi3Status status = passed(fmi2GetBoolean(self->inner, scalars, some, truths));
    for (size_t i = 0; i < some; i++) values[i] = truths[i] != 0;
    return status;
}

static fmi3Status set_truths(Front *self, const fmi2ValueReference scalars[], size_t some,
                             const fmi3Boolean values[]) {
    fmi2Boolean truths[BATCH];
    for (size_t i = 0; i < some; i++) truths[i] = values[i];
    return passed(fmi2SetBoolean(self->inner, scalars, some, truths));
}

fmi3Status fmi3GetBoolean(fmi3Instance instance, const fmi3ValueReference references[],
                          size_t count, fmi3Boolean values[], size_t n) {
    Front *self = instance;
    BY_SCALARS(get_truths(self, scalars, some, values + done))
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
    fmi3String texts[BATCH];
    size_t needed = 0, place = 0;
    if (n > BATCH)
        return front_refuses(self, "%s: at most %d values at once, found %zu", self->name, BATCH,
                             n);
    const fmi3Status status = get_String(self, references, count, texts, n);
    if (status > fmi3Warning) return status;
    for (size_t i = 0; i < n; i++) needed += MOST_BYTES(strlen(texts[i]));
    if (!fits(self, needed)) return fmi3Error;
    for (size_t i = 0; i < n; i++) {
        unsigned char *const to = (unsigned char *)self->buffer + place;
        const long long size = chunks_from_text(texts[i], to);
        if (size < 0)
            return front_refuses(self, "%s: this text is no bytes: '%.60s'", self->name, texts[i]);
        values[i] = to, sizes[i] = (size_t)size;
        place += sizes[i];
    }
    return status;
}

fmi3Status fmi3SetBinary(fmi3Instance instance, const fmi3ValueReference references[], size_t count,
                         const size_t sizes[], const fmi3Binary values[], size_t n) {
    Front *self = instance;
    Walk walk = {references, references + count, 0};
    fmi2ValueReference scalars[BATCH];
    if (!are(self, references, count, n)) return fmi3Error;
    for (size_t done = 0, some; (some = taken(&walk, scalars)) > 0; done += some)
        for (size_t i = 0; i < some; i++) {
            const size_t size = sizes[done + i];
            if (!fits(self, MOST_TEXT(size))) return fmi3Error;
            if (chunks_to_text(values[done + i], size, self->buffer) < 0)
                return front_refuses(self, "%s: %zu bytes are no chunks", self->name, size);
            const fmi2String text = self->buffer;
            const fmi3Status status =
                passed(fmi2SetString(self->inner, &scalars[i], 1, &text));
            if (status > fmi3Warning) return status;
        }
    return fmi3OK;
}
