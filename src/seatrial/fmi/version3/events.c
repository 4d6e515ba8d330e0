/* FMI 3.0: event mode, and CAN terminals of FMI-LS-BUS, in front of ports of bytes with their times.

   What a component does, it does in its steps: an event lets values change that are not
   continuous, and bus operations cross. They reach the component at its next step, with the time
   of the event; what it sent in a step crosses in the event at the step's end. */

#include <stdlib.h>
#include <string.h>

#include "front.h"

static const struct {
    fmi2ValueReference receives, sends;
} buses[BUSES + 1] = BUS_SCALARS;

enum { RX_DATA, RX_CLOCK, TX_DATA, TX_CLOCK, NOTIFIES, BIT_RATE, DATA_BIT_RATE };

#define CHUNK_HEAD 12 /* of a packed chunk: time and size */

/* ------------------------------------------------------------------ bytes that grow */

static int has_capacity(Bytes *to, size_t more) {
    if (to->size + more <= to->capacity) return 1;
    const size_t capacity = 2 * (to->size + more);
    unsigned char *const content = realloc(to->content, capacity);
    if (!content) return 0;
    to->content = content, to->capacity = capacity;
    return 1;
}

static int append(Bytes *to, const void *bytes, size_t size) {
    if (!has_capacity(to, size + 1)) return 0;
    if (size) memcpy(to->content + to->size, bytes, size);
    to->size += size;
    return 1;
}

static Bytes *rx_data(Front *self, int bus) { return &self->events.parts[3 * bus]; }
static Bytes *incoming(Front *self, int bus) { return &self->events.parts[3 * bus + 1]; }
static Bytes *outgoing(Front *self, int bus) { return &self->events.parts[3 * bus + 2]; }
static Bytes *held_text(Front *self, int i) { return &self->events.parts[3 * BUSES + i]; }

static fmi3Status no_memory(Front *self) {
    return front_refuses(self, "%s: there is no memory left", self->name);
}

/* ------------------------------------------------------------------ values held until an event */

#define HELD(Type, COUNT, Value)                                                                 \
    static const fmi2ValueReference held_##Type[COUNT + 1] = COUNT##_SCALARS;                     \
    fmi3Status shown_##Type(Front *self, const fmi2ValueReference scalars[], size_t some,        \
                            Value values[]) {                                                    \
        const fmi3Status status = passed(fmi2Get##Type(self->inner, scalars, some, values));     \
        for (size_t i = 0; self->events.fixed.holds && i < some; i++)                            \
            for (int k = 0; k < COUNT; k++)                                                   \
                if (held_##Type[k] == scalars[i]) values[i] = self->events.fixed.Type[k];        \
        return status;                                                                           \
    }
HELD(Real, HELD_REALS, fmi2Real)
HELD(Integer, HELD_INTEGERS, fmi2Integer)
HELD(Boolean, HELD_BOOLEANS, fmi2Boolean)

static const fmi2ValueReference held_String[HELD_STRINGS + 1] = HELD_STRINGS_SCALARS;

fmi3Status shown_String(Front *self, const fmi2ValueReference scalars[], size_t some,
                        fmi2String values[]) {
    const fmi3Status status = passed(fmi2GetString(self->inner, scalars, some, values));
    for (size_t i = 0; self->events.fixed.holds && i < some; i++)
        for (int k = 0; k < HELD_STRINGS; k++)
            if (held_String[k] == scalars[i]) values[i] = (fmi2String)held_text(self, k)->content;
    return status;
}

/* Keep the values that outputs have now, to show them until there is an event. */
static fmi3Status hold(Front *self) {
    Fixed *const to = &self->events.fixed;
    fmi2String texts[HELD_STRINGS + 1];
    to->holds = 0;
    fmi3Status status = shown_Real(self, held_Real, HELD_REALS, to->Real);
    if (status <= fmi3Warning) status = shown_Integer(self, held_Integer, HELD_INTEGERS, to->Integer);
    if (status <= fmi3Warning) status = shown_Boolean(self, held_Boolean, HELD_BOOLEANS, to->Boolean);
    if (status <= fmi3Warning) status = shown_String(self, held_String, HELD_STRINGS, texts);
    if (status > fmi3Warning) return status;
    for (int i = 0; i < HELD_STRINGS; i++) {
        held_text(self, i)->size = 0;
        if (!append(held_text(self, i), texts[i], strlen(texts[i]) + 1)) return no_memory(self);
    }
    to->holds = 1;
    return fmi3OK;
}

/* Whether an output has another value than it shows. */
static fmi3Status compare(Front *self, int *differ) {
    Fixed *const held = &self->events.fixed;
    Fixed now = {0};
    fmi2String texts[HELD_STRINGS + 1];
    held->holds = 0;
    fmi3Status status = shown_Real(self, held_Real, HELD_REALS, now.Real);
    if (status <= fmi3Warning) status = shown_Integer(self, held_Integer, HELD_INTEGERS, now.Integer);
    if (status <= fmi3Warning) status = shown_Boolean(self, held_Boolean, HELD_BOOLEANS, now.Boolean);
    if (status <= fmi3Warning) status = shown_String(self, held_String, HELD_STRINGS, texts);
    if (status > fmi3Warning) return status;
    *differ = memcmp(now.Real, held->Real, HELD_REALS * sizeof *now.Real) != 0 ||
              memcmp(now.Integer, held->Integer, HELD_INTEGERS * sizeof *now.Integer) != 0 ||
              memcmp(now.Boolean, held->Boolean, HELD_BOOLEANS * sizeof *now.Boolean) != 0;
    for (int i = 0; i < HELD_STRINGS; i++)
        *differ |= strcmp(texts[i], (const char *)held_text(self, i)->content) != 0;
    held->holds = *differ;
    return fmi3OK;
}

/* ------------------------------------------------------------------ operations */

static uint64_t number_of(const char *text) { return *text ? strtoull(text, NULL, 10) : 0; }

static int put_number(Bytes *to, uint64_t number, int size) {
    unsigned char bytes[8];
    for (int i = 0; i < size; i++) bytes[i] = (unsigned char)(number >> 8 * i);
    return append(to, bytes, (size_t)size);
}

static uint64_t number_at(const unsigned char *from, int size) {
    uint64_t number = 0;
    for (int i = 0; i < size; i++) number |= (uint64_t)from[i] << 8 * i;
    return number;
}

/* Let the component have, in its next step, what is in Rx_Data if its clock is active: operation
   by operation, so that one that is damaged takes no other with it. */
static fmi3Status receive(Front *self, int bus) {
    const uint64_t now = self->time > 0.0 ? (uint64_t)(self->time * 1e9 + 0.5) : 0;
    const unsigned char *bytes = rx_data(self, bus)->content;
    size_t size = self->events.fixed.listens[bus] ? rx_data(self, bus)->size : 0;
    self->events.fixed.listens[bus] = 0;
    rx_data(self, bus)->size = 0;
    while (size > 0) {
        uint64_t own = size < 8 ? size : number_at(bytes + 4, 4);
        if (own < 8 || own > size) own = size;
        Bytes *const to = incoming(self, bus);
        if ((to->size == 0 && !put_number(to, 0, 8)) || !put_number(to, now, 8) ||
            !put_number(to, own, 4) || !append(to, bytes, (size_t)own))
            return no_memory(self);
        bytes += own, size -= (size_t)own;
    }
    return fmi3OK;
}

/* Set the text that the component receives by: one number more than that of the text before. */
static fmi3Status deliver(Front *self, int bus) {
    Bytes *const from = incoming(self, bus);
    fmi2String before;
    if (from->size == 0) return fmi3OK;
    fmi3Status status = passed(fmi2GetString(self->inner, &buses[bus].receives, 1, &before));
    if (status > fmi3Warning) return status;
    const uint64_t number = number_of(before) + 1;
    for (int i = 0; i < 8; i++) from->content[i] = (unsigned char)(number >> 8 * i);
    char *const text = malloc(MOST_TEXT(from->size));
    if (!text) return no_memory(self);
    chunks_to_text(from->content, from->size, text);
    from->size = 0;
    const fmi2String set = text;
    status = passed(fmi2SetString(self->inner, &buses[bus].receives, 1, &set));
    free(text);
    return status;
}

/* Take what the component has sent since the text before. */
static fmi3Status collect(Front *self, int bus) {
    fmi2String text;
    const fmi3Status status = passed(fmi2GetString(self->inner, &buses[bus].sends, 1, &text));
    if (status > fmi3Warning || number_of(text) == self->events.fixed.sent[bus]) return status;
    unsigned char *const chunks = malloc(MOST_BYTES(strlen(text)));
    if (!chunks) return no_memory(self);
    const long long size = chunks_from_text(text, chunks);
    int is_kept = size >= 8;
    for (long long place = 8; is_kept && place < size;) {
        const uint64_t own = number_at(chunks + place + 8, 4);
        is_kept = append(outgoing(self, bus), chunks + place + CHUNK_HEAD, (size_t)own);
        place += CHUNK_HEAD + (long long)own;
    }
    free(chunks);
    self->events.fixed.sent[bus] = number_of(text);
    self->events.fixed.ticks[bus] = outgoing(self, bus)->size > 0;
    if (is_kept) return fmi3OK;
    return front_refuses(self, "%s: this text is no bytes: '%.60s'", self->name, text);
}

/* Send a node's bit rates, if they are said: some buses wait for that of each node. */
static int configure(Front *self, int bus) {
    Bytes *const to = outgoing(self, bus);
    for (int i = 0; !ARE_BUSES && i < 2; i++) {
        const double rate = self->events.fixed.rates[bus][i];
        if (rate > 0.0 && !(put_number(to, 0x40, 4) && put_number(to, 13, 4) &&
                            put_number(to, (uint64_t)i + 1, 1) && put_number(to, (uint64_t)rate, 4)))
            return 0;
    }
    self->events.fixed.ticks[bus] = to->size > 0;
    return 1;
}

/* ------------------------------------------------------------------ steps */

void events_reset(Front *self) {
    events_free(&self->events);
    for (int bus = 0; bus < BUSES; bus++) self->events.fixed.rates[bus][0] = USUAL_BIT_RATE;
}

fmi3Status events_begin(Front *self) {
    fmi3Status status = fmi3OK;
    if (!self->uses_events) return status;
    self->events.fixed.mode = EVENT_MODE;
    for (int bus = 0; bus < BUSES && status <= fmi3Warning; bus++)
        status = configure(self, bus) ? collect(self, bus) : no_memory(self);
    return status;
}

fmi3Status events_before_step(Front *self) {
    fmi3Status status = fmi3OK;
    if (!self->uses_events) return status;
    if (self->events.fixed.mode != STEP_MODE)
        return front_refuses(self, "%s: fmi3DoStep is not allowed in event mode", self->name);
    for (int bus = 0; bus < BUSES && status <= fmi3Warning; bus++) status = deliver(self, bus);
    return status <= fmi3Warning ? hold(self) : status;
}

fmi3Status events_after_step(Front *self, fmi3Boolean *event) {
    int differ = 0;
    fmi3Status status = fmi3OK;
    if (!self->uses_events) return status;
    status = compare(self, &differ);
    for (int bus = 0; bus < BUSES && status <= fmi3Warning; bus++) {
        status = collect(self, bus);
        differ |= self->events.fixed.ticks[bus];
    }
    *event = differ != 0;
    return status;
}

/* ------------------------------------------------------------------ modes */

static fmi3Status enters(Front *self, const char *what, int from, int to) {
    if (!self->uses_events)
        return front_refuses(self, "%s: %s: %s", self->name, what,
                             BUSES ? "it was instantiated without event mode"
                                   : "this FMU has no event mode");
    if (self->events.fixed.mode != from)
        return front_refuses(self, "%s: %s is not allowed %s event mode", self->name, what,
                             from == EVENT_MODE ? "outside" : "in");
    self->events.fixed.mode = to;
    return fmi3OK;
}

fmi3Status fmi3EnterEventMode(fmi3Instance instance) {
    Front *self = instance;
    const fmi3Status status = enters(self, "fmi3EnterEventMode", STEP_MODE, EVENT_MODE);
    if (status == fmi3OK) self->events.fixed.holds = 0;
    return status;
}

fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance instance) {
    return enters(instance, "fmi3EvaluateDiscreteStates", EVENT_MODE, EVENT_MODE);
}

fmi3Status fmi3UpdateDiscreteStates(fmi3Instance instance, fmi3Boolean *more, fmi3Boolean *ends,
                                    fmi3Boolean *nominals, fmi3Boolean *states,
                                    fmi3Boolean *defined, fmi3Float64 *next) {
    Front *self = instance;
    *more = *ends = *nominals = *states = *defined = fmi3False;
    *next = 0.0;
    fmi3Status status = enters(self, "fmi3UpdateDiscreteStates", EVENT_MODE, EVENT_MODE);
    for (int bus = 0; status == fmi3OK && bus < BUSES; bus++) {
        status = receive(self, bus);
        if (!self->events.fixed.ticks[bus]) outgoing(self, bus)->size = 0;
    }
    return status;
}

/* An instant is over: what nobody has taken in it is gone. */
fmi3Status fmi3EnterStepMode(fmi3Instance instance) {
    Front *self = instance;
    fmi3Status status = enters(self, "fmi3EnterStepMode", EVENT_MODE, STEP_MODE);
    for (int bus = 0; status == fmi3OK && bus < BUSES; bus++) {
        status = receive(self, bus);
        self->events.fixed.ticks[bus] = 0;
        outgoing(self, bus)->size = 0;
    }
    return status;
}

/* ------------------------------------------------------------------ clocks and clocked variables */

/* Return what a value reference of a terminal stands for, -1 for one that there is not. */
static int member(fmi3ValueReference reference, int *bus) {
    *bus = (int)((reference & TIME) / BUS_MEMBERS);
    return *bus < BUSES ? (int)((reference & TIME) % BUS_MEMBERS) : -1;
}

static fmi3Status may(Front *self, fmi3ValueReference reference, int wanted, const char *function,
                      int *bus) {
    if (!IS_OF_BUS(reference) || member(reference, bus) != wanted)
        return front_refuses(self, "%s: %s: value reference %u is none for it", self->name, function,
                             reference);
    if (self->events.fixed.mode == EVENT_MODE) return fmi3OK;
    return front_refuses(self, "%s: %s is not allowed outside event mode", self->name, function);
}

/* An output clock is active until somebody has asked. */
fmi3Status fmi3GetClock(fmi3Instance instance, const fmi3ValueReference references[], size_t count,
                        fmi3Clock values[]) {
    Front *self = instance;
    int bus = 0;
    for (size_t i = 0; i < count; i++) {
        const fmi3Status status = may(self, references[i], TX_CLOCK, "fmi3GetClock", &bus);
        if (status != fmi3OK) return status;
        values[i] = self->events.fixed.ticks[bus] ? fmi3ClockActive : fmi3ClockInactive;
        self->events.fixed.ticks[bus] = 0;
    }
    return fmi3OK;
}

fmi3Status fmi3SetClock(fmi3Instance instance, const fmi3ValueReference references[], size_t count,
                        const fmi3Clock values[]) {
    Front *self = instance;
    int bus = 0;
    for (size_t i = 0; i < count; i++) {
        const fmi3Status status = may(self, references[i], RX_CLOCK, "fmi3SetClock", &bus);
        if (status != fmi3OK) return status;
        self->events.fixed.listens[bus] = values[i];
    }
    return fmi3OK;
}

fmi3Status events_get_binary(Front *self, fmi3ValueReference reference, fmi3Binary *value,
                             size_t *size) {
    static const unsigned char nothing[1];
    int bus = 0;
    const int what = member(reference, &bus);
    if (what != TX_DATA && what != RX_DATA)
        return front_refuses(self, "%s: there is no Binary with value reference %u", self->name,
                             reference);
    const Bytes *const sent = outgoing(self, bus);
    const int has = what == TX_DATA && self->events.fixed.mode == EVENT_MODE && sent->size > 0;
    *value = has ? sent->content : nothing;
    *size = has ? sent->size : 0;
    return fmi3OK;
}

fmi3Status events_set_binary(Front *self, fmi3ValueReference reference, fmi3Binary value,
                             size_t size) {
    int bus = 0;
    if (member(reference, &bus) != RX_DATA)
        return front_refuses(self, "%s: there is no Binary input with value reference %u", self->name,
                             reference);
    if (size > 0 && self->events.fixed.mode != EVENT_MODE)
        return front_refuses(self, "%s: fmi3SetBinary: Rx_Data is not allowed outside event mode",
                             self->name);
    rx_data(self, bus)->size = 0;
    return append(rx_data(self, bus), value, size) ? fmi3OK : no_memory(self);
}

/* Return where a node's bit rate is, NULL for a reference of none. */
static double *rate_at(Front *self, fmi3ValueReference reference) {
    int bus = 0;
    const int what = member(reference, &bus);
    if (!ARE_BUSES && what == BIT_RATE) return &self->events.fixed.rates[bus][0];
    if (!ARE_BUSES && what == DATA_BIT_RATE) return &self->events.fixed.rates[bus][1];
    front_refuses(self, "%s: there is no Float64 with value reference %u", self->name, reference);
    return NULL;
}

fmi3Status events_get_number(Front *self, fmi3ValueReference reference, fmi3Float64 *value) {
    const double *const rate = rate_at(self, reference);
    if (rate) *value = *rate;
    return rate ? fmi3OK : fmi3Error;
}

fmi3Status events_set_number(Front *self, fmi3ValueReference reference, fmi3Float64 value) {
    double *const rate = rate_at(self, reference);
    if (!rate) return fmi3Error;
    if (!(value >= 0.0 && value <= UINT32_MAX))
        return front_refuses(self, "%s: a bit rate of %g bit/s cannot be", self->name, value);
    if (self->events.fixed.mode != BEFORE_THE_RUN)
        return front_refuses(self, "%s: a bit rate is set before the run", self->name);
    *rate = value;
    return fmi3OK;
}

fmi3Status events_get_truth(Front *self, fmi3ValueReference reference, fmi3Boolean *value) {
    int bus = 0;
    if (!ARE_BUSES || member(reference, &bus) != NOTIFIES)
        return front_refuses(self, "%s: there is no Boolean with value reference %u", self->name,
                             reference);
    *value = fmi3True;
    return fmi3OK;
}

/* ------------------------------------------------------------------ states */

int events_copy(Events *to, const Events *from) {
    to->fixed = from->fixed;
    for (int i = 0; i < PARTS; i++) {
        to->parts[i].size = 0;
        if (!append(&to->parts[i], from->parts[i].content, from->parts[i].size)) return 0;
    }
    return 1;
}

void events_free(Events *events) {
    for (int i = 0; i < PARTS; i++) free(events->parts[i].content);
    *events = (Events){0};
}

size_t events_size(const Events *events) {
    size_t size = sizeof events->fixed + PARTS * sizeof(size_t);
    for (int i = 0; i < PARTS; i++) size += events->parts[i].size;
    return size;
}

void events_write(const Events *events, unsigned char *to) {
    memcpy(to, &events->fixed, sizeof events->fixed);
    to += sizeof events->fixed;
    for (int i = 0; i < PARTS; i++) {
        const Bytes *const part = &events->parts[i];
        memcpy(to, &part->size, sizeof part->size);
        to += sizeof part->size;
        if (part->size) memcpy(to, part->content, part->size);
        to += part->size;
    }
}

size_t events_read(Events *events, const unsigned char *from, size_t size) {
    size_t place = sizeof events->fixed;
    if (size < place) return 0;
    memcpy(&events->fixed, from, place);
    size_t own;
    for (int i = 0; i < PARTS; i++) {
        if (size - place < sizeof own) return 0;
        memcpy(&own, from + place, sizeof own);
        place += sizeof own;
        if (size - place < own || !append(&events->parts[i], from + place, own)) return 0;
        place += own;
    }
    return place;
}
