/* PWM by timers. simavr does not turn these pins: their registers are read, at the end of a step. */
#ifndef MODULATION_H
#define MODULATION_H

static const struct output { uint8_t pin, timer, compare; } mega[] = {
    {2, 3, 1}, {3, 3, 2}, {4, 0, 1}, {5, 3, 0}, {6, 4, 0}, {7, 4, 1}, {8, 4, 2}, {9, 2, 1},
    {10, 2, 0}, {11, 1, 0}, {12, 1, 1}, {13, 0, 0}, {44, 5, 2}, {45, 5, 1}, {46, 5, 0}, {0, 0, 0},
}, uno[] = {{3, 2, 1}, {5, 0, 1}, {6, 0, 0}, {9, 1, 0}, {10, 1, 1}, {11, 2, 0}, {0, 0, 0}};
static const uint16_t control[] = {0x44, 0x80, 0xB0, 0x90, 0xA0, 0x120};
static const uint16_t compares[] = {0x47, 0x88, 0xB3, 0x98, 0xA8, 0x128};
static const uint16_t tops[] = {0, 0x86, 0, 0x96, 0xA6, 0x126}; /* ICR */
static int watched[PINS];
static double shares[PINS], widths[PINS];

static double word_at(uint16_t at) { return avr->data[at] | avr->data[at + 1] << 8; }

static double prescaler(int timer, uint8_t b)
{
    static const int usual[] = {0, 1, 8, 64, 256, 1024, 0, 0}, of_two[] = {0, 1, 8, 32, 64, 128, 256, 1024};
    return (timer == 2 ? of_two : usual)[b & 7];
}

/* Mode of a timer with 16 bits (ATmega640/2560 data sheet, table 17-2): its top, and whether it
 * counts down as well; a top of 0 is none of PWM. */
static double top_of_wide(int timer, int mode, int *both)
{
    *both = mode < 12;
    switch (mode) {
    case 5: case 6: case 7: *both = 0; return (1 << (mode + 3)) - 1;
    case 1: case 2: case 3: return (1 << (mode + 7)) - 1;
    case 8: case 10: case 14: return word_at(tops[timer]);
    case 9: case 11: case 15: return word_at(compares[timer]);
    }
    return 0.0;
}

/* Those with 8 bits (table 20-8). */
static double top_of_narrow(int timer, int mode, int *both)
{
    *both = mode == 1 || mode == 5;
    if (mode == 1 || mode == 3)
        return 255.0;
    return mode == 5 || mode == 7 ? avr->data[compares[timer]] : 0.0;
}

/* Share of time high, and how long at a time, s; a share of -1 is no modulation. */
static double modulation(const struct output *each, double *width)
{
    int wide = each->timer != 0 && each->timer != 2, both;
    uint8_t a = avr->data[control[each->timer]], b = avr->data[control[each->timer] + 1];
    int mode = (a & 3) | (wide ? b >> 1 & 0xC : b >> 1 & 4);
    double top = wide ? top_of_wide(each->timer, mode, &both) : top_of_narrow(each->timer, mode, &both);
    double scale = prescaler(each->timer, b) * divider;
    int output = a >> (6 - 2 * each->compare) & 3;
    *width = 0.0;
    if (!(output & 2) || top <= 0.0 || scale <= 0.0)
        return -1.0;
    uint16_t at = (uint16_t)(compares[each->timer] + each->compare * (wide ? 2 : 1));
    double compare = fmin(wide ? word_at(at) : avr->data[at], top);
    double high = both ? compare : compare + 1.0, period = both ? top : top + 1.0;
    if (output == 3)
        high = period - high;
    *width = high * scale * (both ? 2.0 : 1.0) / CLOCK;
    return high / period;
}

static void tell_modulated(void)
{
    for (const struct output *each = ports[0] == 'E' ? mega : uno; each->pin; each++) {
        if (!watched[each->pin])
            continue;
        double width, share = modulation(each, &width);
        if (share >= 0.0 && (share != shares[each->pin] || width != widths[each->pin])) {
            link_put(OUT_DUTY, each->pin, (uint16_t)lround(share * 65535.0), ticks());
            link_put(OUT_WIDTH, each->pin, (uint16_t)lround(fmin(width * 1e6, 65535.0)), ticks());
        }
        if (share < 0.0 && shares[each->pin] >= 0.0)
            link_put(OUT_EDGE, each->pin, 0, ticks());
        shares[each->pin] = share;
        widths[each->pin] = width;
    }
}

#endif
