/* A tone at a pin: turned by timer 2 on the board, one at a time. */
#ifndef TONES_H
#define TONES_H

constexpr int NO_TONE = -1;

int tone_pin = NO_TONE;
uint32_t tone_half;  /* cycles of half a period */
int64_t tone_turns;  /* that are left; below 0: until it is switched off */
uint64_t tone_next = NEVER;

void end_tone()
{
    tone_pin = NO_TONE;
    tone_next = NEVER;
}

void turn_tone()
{
    uint8_t pin = (uint8_t)tone_pin;
    tone_next += tone_half;
    if (!tone_turns) {
        end_tone();
        put_output(pin, false);
        return;
    }
    tone_turns -= tone_turns > 0;
    pins[pin].latch = !pins[pin].latch;
    settle(pin);
}

#endif
