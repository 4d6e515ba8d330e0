/* A sketch that goes round without calling anything or returning, and UARTs that stay at another rate than their lines. */
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
                 "calling anything: an endless loop (or a wait longer than its patience)", (double)patience / CLOCK);
        end_here(text);
    }
}

/* End the run if a UART stays open at another rate than its line's. */
static void line_check(void)
{
    static uint64_t since[UARTS];
    static double rates[UARTS];
    for (int uart = 0; uart < UARTS; uart++) {
        if (at_line_rate(uart) || rates[uart] != uart_rate(uart))
            since[uart] = ticks();
        rates[uart] = uart_rate(uart);
        if ((double)(ticks() - since[uart]) > OTHER_RATE_S * CLOCK) {
            char text[160];
            snprintf(text, sizeof text, "it has UART %d open at %.0f baud, and the line there has %.0f", uart,
                     uart_rate(uart), lines[uart].baud);
            end(text);
        }
    }
}

#endif
