/* A sketch that goes round without calling anything or returning, and UARTs at another rate than their lines. */
#ifndef HANGS_H
#define HANGS_H

#define LOOP_BYTES 128 /* a loop that calls nothing, at most */

static uint64_t patience, hang_since;
static uint32_t hang_lowest, hang_highest;
static uint16_t hang_stack;
static uint32_t hang_events;

static void hang_forget(void)
{
    hang_since = ticks();
    hang_lowest = hang_highest = avr->pc;
    hang_stack = _avr_sp_get(avr);
}

/* Outside interrupts its stack neither grows nor shrinks, its program counter stays near, and
 * neither pins nor lines change. */
static void hang_observe(int state)
{
    int busy = link_count != hang_events;
    hang_events = link_count;
    if (state == cpu_Sleeping || busy)
        hang_forget();
    if (avr->interrupts.running_ptr)
        return;
    hang_lowest = avr->pc < hang_lowest ? avr->pc : hang_lowest;
    hang_highest = avr->pc > hang_highest ? avr->pc : hang_highest;
    if (_avr_sp_get(avr) != hang_stack || hang_highest - hang_lowest > LOOP_BYTES)
        hang_forget();
    if (ticks() - hang_since > patience) {
        char text[200];
        snprintf(text, sizeof text, "it has run for %.3g s of its time without returning from a function or "
                 "calling anything: an endless loop [at 0x%x]", (double)patience / CLOCK, avr->pc);
        end(text);
    }
}

static void line_check(void)
{
    static const uint16_t status[] = {0xC0, 0xC8, 0xD0, 0x130}; /* UCSRnA; UBRRn is 4 further */
    for (int uart = 0; uart < (ports[0] == 'E' ? UARTS : 1); uart++) {
        uint8_t a = avr->data[status[uart]], b = avr->data[status[uart] + 1];
        double divisor = word_at((uint16_t)(status[uart] + 4)) + 1.0;
        double baud = CLOCK / divider / (a & 2 ? 8.0 : 16.0) / divisor;
        double line_baud = lines[uart].baud;
        if (!(b & 0x18) || line_baud <= 0.0 || lines[uart].rx_pin || lines[uart].tx_pin)
            continue;
        if (fabs(baud / line_baud - 1.0) > 0.04) {
            char text[120];
            snprintf(text, sizeof text, "it opens UART %d at %.0f baud, and the line there has %.0f", uart, baud, line_baud);
            end(text);
        }
    }
}

#endif
