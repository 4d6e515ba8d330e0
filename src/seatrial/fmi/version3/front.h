/* FMI 3.0 in front of functions of FMI 2.0, whoever has them: what these files have in common.

   A value reference is that of a variable's first scalar in FMI 2.0, and how many more follow
   it times 2^20. */

#ifndef FRONT_H
#define FRONT_H

#include <stdint.h>

#include "fmi2Functions.h"
#include "fmi3Functions.h"

#define MORE_THAN_ONE 20  /* the bits of a value reference above these: how many follow the first */
#define TIME 0xFFFFFu     /* value reference of the independent variable */

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

/* Bytes with their times, as links of seatrial have them: from the text of a String to the
   content of a Binary and back. They return the size, or -1 for what is none of these; `to` is
   a buffer of MOST_BYTES or MOST_TEXT of it. */
#define MOST_BYTES(length) (8 + 4 * (length))
#define MOST_TEXT(size) (32 + 3 * (size))
long long chunks_from_text(const char *text, unsigned char *to);
long long chunks_to_text(const unsigned char *bytes, size_t size, char *to);

#endif
