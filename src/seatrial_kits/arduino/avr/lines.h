/* Lines to and from UARTs, and to and from pins that software reads and drives bit by bit. */
#ifndef LINES_H
#define LINES_H

#define UART_BITS 11 /* simavr takes so many for a byte, always: a line at full rate would overrun it */

typedef struct {
    uint8_t *bytes;
    double *earliest;
    uint32_t first, count, room;
    double baud, free;
    avr_irq_t *input;
    int waiting;
    int rx_pin, tx_pin; /* of the board; 0: the UART's */
    int bit, received;  /* that arrives next; level at the pin where it does */
    double begun;       /* when its byte did */
    int level, sampled; /* of the pin that sends; which bit comes next, 0 between bytes */
    double began;       /* when its byte did */
    uint8_t sending;
} line;

static line lines[UARTS];

/* The rate of a UART by its registers, baud; 0 while it is closed. simavr has TXEN set at the start. */
static double uart_rate(int uart)
{
    static const uint16_t status[] = {0xC0, 0xC8, 0xD0, 0x130}; /* UCSRnA; UBRRn is 4 further */
    const uint8_t *at = avr->data + status[uart];
    double divisor = (at[4] | at[5] << 8) + 1.0;
    int open = at[1] & 0x10 || (at[1] & 0x08 && divisor > 1.0);
    return open ? CLOCK / divider / (at[0] & 2 ? 8.0 : 16.0) / divisor : 0.0;
}

static int has_uart(const line *one) { return one == lines || ports[0] == 'E'; }

static int at_line_rate(int uart)
{
    const line *one = &lines[uart];
    return !has_uart(one) || one->rx_pin || one->tx_pin || rates_match(uart_rate(uart), one->baud);
}

/* When the next byte that waits begins. */
static double begins(const line *one) { return fmax(one->earliest[one->first], one->free); }

/* Drop the byte that has arrived; return whether another waits. */
static int another(line *one, double when)
{
    one->free = when;
    one->first++;
    if (one->first < one->count)
        return 1;
    one->first = one->count = 0;
    return one->waiting = 0;
}

static void put_received(line *one, int level)
{
    static const uint8_t of_uarts[UARTS] = {0, 19, 17, 15};
    if (level != one->received && (one->rx_pin || has_uart(one)))
        pin_put(one->rx_pin ? (uint8_t)one->rx_pin : of_uarts[one - lines], level);
    one->received = level;
}

/* Start bit, data from the lowest on, stop bits, each for as long as the line has it; then the UART has it. */
static avr_cycle_count_t arrive(avr_t *of, avr_cycle_count_t cycle, void *which)
{
    line *one = (line *)which;
    double when = (double)ticks();
    (void)of, (void)cycle;
    if (one->bit == 0)
        one->begun = when;
    uint8_t data = one->bytes[one->first];
    int at = one->bit++;
    if (at < (one->rx_pin ? 10 : UART_BITS)) {
        put_received(one, (data << 1 | 0x600) >> at & 1);
        return cycle_of(one->begun + (at + 1) * CLOCK / one->baud);
    }
    one->bit = 0;
    if (!one->rx_pin && one->input && at_line_rate((int)(one - lines)))
        avr_raise_irq(one->input, data);
    return another(one, when) ? cycle_of(fmax(begins(one), when + 1)) : 0;
}

static void queue(line *one, uint8_t data, double earliest)
{
    if (one->count == one->room) {
        one->room = one->room ? 2 * one->room : 256;
        one->bytes = (uint8_t *)realloc(one->bytes, one->room);
        one->earliest = (double *)realloc(one->earliest, one->room * sizeof(double));
    }
    one->bytes[one->count] = data;
    one->earliest[one->count++] = earliest;
    if (!one->waiting && one->baud > 0.0) {
        one->waiting = 1;
        later(fmax(begins(one), (double)ticks()) + 1, arrive, one);
    }
}

static void transmitted(avr_irq_t *irq, uint32_t value, void *which)
{
    (void)irq;
    if (!lines[(intptr_t)which].tx_pin && at_line_rate((int)(intptr_t)which))
        link_put(OUT_UART, (uint8_t)(intptr_t)which, (uint16_t)(value & 0xFF), ticks());
}

static void connect_uart(int index)
{
    uint32_t flags = 0;
    char name = (char)('0' + index);
    if (avr_ioctl(avr, AVR_IOCTL_UART_GET_FLAGS(name), &flags) < 0)
        return;
    flags &= ~(uint32_t)(AVR_UART_FLAG_STDIO | AVR_UART_FLAG_POLL_SLEEP);
    avr_ioctl(avr, AVR_IOCTL_UART_SET_FLAGS(name), &flags);
    avr_irq_t *out = avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ(name), UART_IRQ_OUTPUT);
    avr_irq_register_notify(out, transmitted, (void *)(intptr_t)index);
    lines[index].input = avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ(name), UART_IRQ_INPUT);
}

/* ------------------------------------------------------------------ at pins */

/* In the middle of each bit of a byte that a pin sends, the stop bit the last. */
static avr_cycle_count_t sample(avr_t *of, avr_cycle_count_t cycle, void *which)
{
    line *one = (line *)which;
    (void)of, (void)cycle;
    if (one->sampled++ <= 8) {
        one->sending = (uint8_t)(one->sending >> 1 | (one->level ? 0x80 : 0));
        return cycle_of(one->began + (one->sampled + 0.5) * CLOCK / one->baud);
    }
    one->sampled = 0;
    link_put(OUT_UART, (uint8_t)(one - lines), one->sending, ticks());
    return 0;
}

static void driven(avr_irq_t *irq, uint32_t value, void *which)
{
    line *one = (line *)which;
    int fell = one->level && !value;
    (void)irq;
    one->level = value != 0;
    if (!fell || one->sampled || one->baud <= 0.0)
        return;
    one->began = (double)ticks();
    one->sampled = 1;
    later(one->began + 1.5 * CLOCK / one->baud, sample, one);
}

static void line_to_pin(line *one, uint8_t pin)
{
    one->rx_pin = pin;
    one->received = 0;
    put_received(one, 1);
}

static void line_at_rate(line *one, double baud)
{
    one->baud = baud;
    put_received(one, 1); /* at rest */
}

static void line_from_pin(line *one, uint8_t pin)
{
    one->tx_pin = pin;
    avr_irq_register_notify(pin_irq(pin), driven, one);
}

#endif
