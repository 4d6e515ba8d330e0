/* FMI 3.0 in front of functions of FMI 2.0, whoever has them: what these files have in common.

   A value reference is that of a variable's first scalar in FMI 2.0, and how many more follow
   it times 2^20. Those with 2^12 - 1 there are of terminals of buses, which only FMI 3.0 has. */

#ifndef FRONT_H
#define FRONT_H

#include <stdint.h>

#include "events.h" /* of this component: its buses, and its outputs that are not continuous */
#include "fmi2Functions.h"
#include "fmi3Functions.h"

#define MORE_THAN_ONE 20  /* the bits of a value reference above these: how many follow the first */
#define TIME 0xFFFFFu     /* value reference of the independent variable */

#define BUS_MEMBERS 8     /* value references of one terminal, at most */
#define IS_OF_BUS(reference) ((reference) >> MORE_THAN_ONE == 0xFFFu)

/* Bytes that grow. */
typedef struct {
    unsigned char *content;
    size_t size, capacity;
} Bytes;

#define USUAL_BIT_RATE 250000.0 /* that of our bus, if nobody says another, bit/s */

enum { BEFORE_THE_RUN, EVENT_MODE, STEP_MODE };

typedef struct {
    int mode, holds;                            /* outputs show what they were before the step */
    double Real[HELD_REALS + 1];
    fmi2Integer Integer[HELD_INTEGERS + 1];
    fmi2Boolean Boolean[HELD_BOOLEANS + 1];
    double rates[BUSES + 1][2];                 /* of a node, and of its CAN FD data, bit/s */
    uint64_t sent[BUSES + 1];                   /* number of the last text from the component */
    int ticks[BUSES + 1], listens[BUSES + 1];   /* whether Tx_Clock and Rx_Clock are active */
} Fixed;

#define PARTS (3 * BUSES + HELD_STRINGS)

/* What event mode remembers: of each bus Rx_Data, the operations to the component and from
   it; and the texts that outputs show. */
typedef struct {
    Fixed fixed;
    Bytes parts[PARTS + 1];
} Events;

typedef struct {
    fmi2Component inner;
    fmi2CallbackFunctions functions;
    fmi3LogMessageCallback log;
    fmi3InstanceEnvironment environment;
    double time;
    uint64_t fmu;
    char name[256];
    char *buffer; /* for values of Binary until the next call */
    size_t buffer_size;
    int uses_events;
    Events events;
} Front;

/* The status of a call that was passed on. */
static inline fmi3Status passed(fmi2Status status) {
    return status > fmi2Fatal ? fmi3Error : (fmi3Status)status;
}

/* Log an error and return it. */
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
fmi3Status front_refuses(Front *self, const char *format, ...);

/* Values of FMI 2.0, as they are shown: see `Fixed`. */
fmi3Status shown_Real(Front *self, const fmi2ValueReference scalars[], size_t some, fmi2Real values[]);
fmi3Status shown_Integer(Front *self, const fmi2ValueReference scalars[], size_t some,
                         fmi2Integer values[]);
fmi3Status shown_Boolean(Front *self, const fmi2ValueReference scalars[], size_t some,
                         fmi2Boolean values[]);
fmi3Status shown_String(Front *self, const fmi2ValueReference scalars[], size_t some,
                        fmi2String values[]);

/* Events before and after what the component does, and variables of buses (`IS_OF_BUS`). */
void events_reset(Front *self);
fmi3Status events_begin(Front *self);
fmi3Status events_before_step(Front *self);
fmi3Status events_after_step(Front *self, fmi3Boolean *event);
fmi3Status events_get_binary(Front *self, fmi3ValueReference reference, fmi3Binary *value,
                             size_t *size);
fmi3Status events_set_binary(Front *self, fmi3ValueReference reference, fmi3Binary value, size_t size);
fmi3Status events_get_number(Front *self, fmi3ValueReference reference, fmi3Float64 *value);
fmi3Status events_set_number(Front *self, fmi3ValueReference reference, fmi3Float64 value);
fmi3Status events_get_truth(Front *self, fmi3ValueReference reference, fmi3Boolean *value);

/* Copies of events; `events_read` returns how many bytes it took, 0 for what is no copy. */
int events_copy(Events *to, const Events *from);
void events_free(Events *events);
size_t events_size(const Events *events);
void events_write(const Events *events, unsigned char *to);
size_t events_read(Events *events, const unsigned char *from, size_t size);

/* Bytes with their times, as links of seatrial have them: from the text of a String to the
   content of a Binary and back. They return the size, or -1 for what is none of these; `to` is
   a buffer of MOST_BYTES or MOST_TEXT of it. */
#define MOST_BYTES(length) (8 + 4 * (length))
#define MOST_TEXT(size) (32 + 3 * (size))
long long chunks_from_text(const char *text, unsigned char *to);
long long chunks_to_text(const unsigned char *bytes, size_t size, char *to);

#endif
