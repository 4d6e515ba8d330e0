/* Square waves and servo pulses at input pins: when the next edge comes. */
#ifndef SEATRIAL_WAVES_H
#define SEATRIAL_WAVES_H

#include <math.h>
#include <stdint.h>

#define WAVES 16
#define NEVER UINT64_MAX
#define FRAME_S 0.02

typedef struct {
    uint8_t pin, level, pulse;
    double number; /* Hz of a square wave, or s of a pulse */
    double frame;  /* s, from pulse to pulse */
    double edge;   /* cycles: kept as a fraction, so that rounding does not add up */
} wave;

static wave waves[WAVES];
static int wave_count;

static double wave_length(const wave *one, double clock)
{
    if (!one->pulse)
        return clock / one->number / 2.0;
    return (one->level ? one->number : one->frame - one->number) * clock;
}

/* The wave at a pin, which begins now if there is none; 0 if there are too many. */
static wave *wave_at(uint8_t pin, int pulse)
{
    for (int each = 0; each < wave_count; each++)
        if (waves[each].pin == pin)
            return &waves[each];
    if (wave_count == WAVES)
        return 0;
    wave *one = &waves[wave_count++];
    one->pin = pin;
    one->level = 0;
    one->pulse = (uint8_t)pulse;
    one->number = 0.0;
    one->frame = FRAME_S;
    return one;
}

static void wave_frame(uint8_t pin, double frame)
{
    wave *one = wave_at(pin, 1);
    if (one)
        one->frame = frame;
}

/* A wave's number has been set at cycle `now`; a change takes effect at the next edge. */
static void wave_set(uint8_t pin, int pulse, double number, uint64_t now)
{
    wave *one = wave_at(pin, pulse);
    if (!one)
        return;
    if (one->number <= 0.0 && number > 0.0)
        one->edge = (double)now + 1.0;
    one->number = number;
}

static uint64_t wave_next(void)
{
    double next = 1e18;
    for (int each = 0; each < wave_count; each++)
        if (waves[each].number > 0.0 && waves[each].edge < next)
            next = waves[each].edge;
    return next < 1e18 ? (uint64_t)next : NEVER;
}

/* Turn over the first wave whose edge is due by `now`; returns it, or 0. */
static wave *wave_turn(uint64_t now, double clock)
{
    for (int each = 0; each < wave_count; each++) {
        wave *one = &waves[each];
        if (one->number > 0.0 && (uint64_t)one->edge <= now) {
            one->level = !one->level;
            one->edge += wave_length(one, clock);
            return one;
        }
    }
    return 0;
}

#endif
