/* Levels that parts will drive at pins: when, where, and which. */
#ifndef SEATRIAL_DRIVES_H
#define SEATRIAL_DRIVES_H

#include <stdint.h>

#define DRIVES 256

typedef struct {
    uint64_t cycle;
    uint8_t pin, level; /* a level of DRIVE_NONE: the pin is left alone */
} drive_at;

enum { DRIVE_NONE = 2 };

static drive_at drives[DRIVES];
static int drive_count;

/* Add one, behind those of its cycle; a pin's later ones are dropped: a part says anew what comes. */
static void drive_add(uint8_t pin, uint8_t level, uint64_t cycle)
{
    int at = drive_count;
    if (drive_count == DRIVES)
        return;
    while (at > 0 && drives[at - 1].cycle > cycle) {
        drives[at] = drives[at - 1];
        at--;
    }
    drives[at].cycle = cycle;
    drives[at].pin = pin;
    drives[at].level = level;
    drive_count++;
}

/* Drop what is to come at a pin. */
static void drive_forget(uint8_t pin)
{
    int kept = 0;
    for (int each = 0; each < drive_count; each++)
        if (drives[each].pin != pin)
            drives[kept++] = drives[each];
    drive_count = kept;
}

static uint64_t drive_next(void) { return drive_count ? drives[0].cycle : UINT64_MAX; }

static drive_at drive_take(void)
{
    drive_at first = drives[0];
    for (int each = 1; each < drive_count; each++)
        drives[each - 1] = drives[each];
    drive_count--;
    return first;
}

#endif
