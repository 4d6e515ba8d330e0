/* Pins: what is at them, from inside and from outside, and their modulation. */
#ifndef PINS_H
#define PINS_H

struct Pin {
    bool level = false, watched = false, part = false; /* a part follows the sketch's levels there */
    bool output = false, latch = false; /* DDR and PORT: of an input, whether it is pulled up */
    int outside = -1;                   /* level that is driven from outside; -1: nothing is there */
    double share = -1.0, period = 0.0;  /* of PWM, cycles; below 0: none */
    double edge = 0.0;
} pins[PINS];
int modulated;

void need_pin(uint8_t pin)
{
    if (pin >= PINS)
        end("it uses pin %d: the %s has 0 to %d", pin, board::NAME, PINS - 1);
}

/* PIN, DDR and PORT as libraries use them that take a pin's registers (portOutputRegister): each pin has
 * its own, of which bit 0 is the pin. Between stretches of code what was written there happens. */
enum { OF_INPUT, OF_MODE, OF_OUTPUT };
volatile uint8_t registers[PINS + 1][3]; /* one more: of the last pin, 32 bits may be read */
bool by_registers; /* one was taken */

void show(uint8_t pin)
{
    if (pins[pin].watched)
        link_put(OUT_EDGE, pin, pins[pin].level, now);
}

void put_level(uint8_t pin, bool to)
{
    if (pins[pin].level == to)
        return;
    pins[pin].level = to;
    registers[pin][OF_INPUT] = to;
    show(pin);
    int number = board::interrupt_of(pin);
    if (number < 0)
        return;
    Interrupt &one = externals[number];
    if (one.handler && (one.mode == 1 || one.mode == (to ? 3 : 2)))
        one.pending = true;
}

void settle(uint8_t pin)
{
    const Pin &one = pins[pin];
    registers[pin][OF_MODE] = one.output;
    registers[pin][OF_OUTPUT] = one.latch;
    put_level(pin, one.output || one.outside < 0 ? one.latch : one.outside > 0);
}

/* By the sketch's doing. */
void settle_own(uint8_t pin)
{
    bool before = pins[pin].level;
    settle(pin);
    if (pins[pin].part && pins[pin].level != before)
        part_edge(pin, pins[pin].level);
}

/* Let what was written to registers happen. */
void take_registers()
{
    for (uint8_t pin = 0; pin < PINS; pin++) {
        bool output = registers[pin][OF_MODE] & 1, latch = registers[pin][OF_OUTPUT] & 1;
        if (output == pins[pin].output && latch == pins[pin].latch)
            continue;
        pins[pin].output = output;
        pins[pin].latch = latch;
        settle_own(pin);
    }
}

void watch_part(uint8_t place)
{
    if (place < PINS && part_is_at(place))
        pins[place].part = true;
}

void put_output(uint8_t pin, bool to)
{
    pins[pin].output = true;
    pins[pin].latch = to;
    settle(pin);
}

/* A level is 0, 1, or below 0: nothing drives it. */
void put_outside(uint8_t pin, int to)
{
    pins[pin].outside = to;
    settle(pin);
}

void turn_modulated(uint8_t pin)
{
    Pin &one = pins[pin];
    put_output(pin, !one.level);
    one.edge += one.period * (one.level ? one.share : 1.0 - one.share);
}

#endif
