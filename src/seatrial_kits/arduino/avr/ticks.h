/* Time of the board: ticks of its 16 MHz, of which an instruction takes more when CLKPR divides them. */
#ifndef TICKS_H
#define TICKS_H

#define CLKPR 0x61

static uint64_t tick_mark, cycle_mark; /* where the clock was divided anew */
static int divider = 1;

static uint64_t ticks(void) { return tick_mark + (avr->cycle - cycle_mark) * (uint64_t)divider; }

static avr_cycle_count_t cycle_of(double tick)
{
    double since = ceil((tick - (double)tick_mark) / divider);
    avr_cycle_count_t cycle = cycle_mark + (avr_cycle_count_t)fmax(since, 0.0);
    return cycle > avr->cycle ? cycle : avr->cycle + 1;
}

static void later(double tick, avr_cycle_timer_t what, void *with)
{
    avr_cycle_timer_register(avr, cycle_of(tick) - avr->cycle, what, with);
}

/* What was due before the change keeps its cycle: it comes late or early once. */
static void clock_written(avr_t *of, avr_io_addr_t address, uint8_t value, void *unused)
{
    (void)of, (void)unused;
    avr->data[address] = value;
    if (value & 0x80)
        return; /* the change is announced */
    tick_mark = ticks();
    cycle_mark = avr->cycle;
    divider = 1 << ((value & 15) > 8 ? 8 : value & 15);
    avr->frequency = (uint32_t)(CLOCK / divider);
}

#endif
