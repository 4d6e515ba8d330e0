/* The machine's UARTs: bytes that wait on the line, in the ring of 64, and to be sent. */
#include "machine.h"
#include "rates.h"

#include <math.h>

#include <deque>

namespace machine {

namespace {

constexpr double NOT_DUE = 1e18;

struct Incoming {
    uint8_t data;
    uint64_t earliest;
};

struct Uart {
    double line_baud = 0.0, bit = 0.0; /* baud; cycles of a bit, 0 while closed */
    bool other_rate = false;           /* it is not open at its line's: what comes and goes is lost */
    uint64_t since = 0;                /* when it became so */
    int ring = board::RECEIVED;
    int rx_pin = -1, tx_pin = -1;      /* of a line at pins */
    bool muted = false, overflowed = false;
    std::deque<Incoming> line;
    double line_free = 0.0, arrival = NOT_DUE;
    std::deque<uint8_t> in, out;
    uint8_t shifting = 0;
    double sent = NOT_DUE; /* when the byte being shifted out is through */
} uarts[UARTS];

void schedule(Uart &uart)
{
    if (uart.line.empty()) {
        uart.arrival = NOT_DUE;
        return;
    }
    double begin = fmax((double)uart.line.front().earliest, uart.line_free);
    double bit = uart.line_baud > 0.0 ? CLOCK / uart.line_baud : uart.bit;
    uart.arrival = begin + 10.0 * bit;
}

void shift_next(Uart &uart, double from)
{
    if (uart.out.empty()) {
        uart.sent = NOT_DUE;
        return;
    }
    uart.shifting = uart.out.front();
    uart.out.pop_front();
    uart.sent = from + 10.0 * uart.bit;
}

} // namespace

/* ------------------------------------------------------------------ the line */

void put_on_line(uint8_t uart, uint8_t data, double earliest)
{
    Uart &one = uarts[uart];
    one.line.push_back({data, (uint64_t)fmax(earliest, (double)now)});
    if (one.line.size() == 1)
        schedule(one);
}

void set_line(uint8_t uart, double baud) { uarts[uart].line_baud = baud; }

void put_line_at(uint8_t uart, int rx_pin, int tx_pin)
{
    if (rx_pin >= 0)
        uarts[uart].rx_pin = rx_pin;
    if (tx_pin >= 0)
        uarts[uart].tx_pin = tx_pin;
}

double next_on_lines()
{
    double soonest = NOT_DUE;
    for (const Uart &one : uarts) {
        soonest = one.arrival < soonest ? one.arrival : soonest;
        soonest = one.sent < soonest ? one.sent : soonest;
    }
    return soonest;
}

static void arrive(Uart &uart)
{
    uint8_t data = uart.line.front().data;
    uart.line.pop_front();
    uart.line_free = uart.arrival;
    schedule(uart);
    if (uart.bit <= 0.0 || uart.muted || uart.other_rate)
        return;
    if ((int)uart.in.size() < uart.ring - 1)
        uart.in.push_back(data);
    else
        uart.overflowed = true;
}

void serve_lines()
{
    double due = next_on_lines();
    for (int each = 0; each < UARTS; each++) {
        Uart &one = uarts[each];
        if (one.arrival == due) {
            arrive(one);
            return;
        }
        if (one.sent == due) {
            if (!one.other_rate)
                report_byte((uint8_t)each, one.shifting);
            shift_next(one, one.sent);
            return;
        }
    }
}

/* ------------------------------------------------------------------ the sketch's side */

void open_uart(uint8_t uart, uint32_t baud)
{
    Uart &one = uarts[uart];
    one.other_rate = !rates_match(baud, one.line_baud);
    one.since = now;
    one.bit = baud ? CLOCK / baud : 0.0;
    one.in.clear();
    schedule(one);
    reschedule();
}

void refuse_other_rates()
{
    for (int uart = 0; uart < UARTS; uart++) {
        const Uart &one = uarts[uart];
        if (one.other_rate && (double)(now - one.since) > OTHER_RATE_S * CLOCK)
            end("it has UART %d open at %.0f baud, and the line there has %.0f", uart, CLOCK / one.bit, one.line_baud);
    }
}

int received(uint8_t uart) { return (int)uarts[uart].in.size(); }

int take(uint8_t uart, bool keep)
{
    Uart &one = uarts[uart];
    if (one.in.empty())
        return -1;
    int data = one.in.front();
    if (!keep)
        one.in.pop_front();
    return data;
}

int room(uint8_t uart) { return board::SENT - 1 - (int)uarts[uart].out.size(); }

void send(uint8_t uart, uint8_t data)
{
    Uart &one = uarts[uart];
    if (one.bit <= 0.0)
        return;
    while (room(uart) <= 0)
        wait(now + (uint64_t)(10.0 * one.bit) + 1);
    one.out.push_back(data);
    if (one.sent >= NOT_DUE)
        shift_next(one, (double)now);
    reschedule();
}

void drain(uint8_t uart)
{
    while (uarts[uart].sent < NOT_DUE)
        wait((uint64_t)uarts[uart].sent + 1);
}

static int line_with(int Uart::*end, int pin)
{
    for (int each = 0; each < UARTS; each++)
        if (uarts[each].*end >= 0 && uarts[each].*end == pin)
            return each;
    return -1;
}

int line_to(int rx_pin) { return line_with(&Uart::rx_pin, rx_pin); }
int line_from(int tx_pin) { return line_with(&Uart::tx_pin, tx_pin); }

double line_rate(uint8_t uart) { return uarts[uart].line_baud; }
bool placed(uint8_t uart, bool rx) { return (rx ? uarts[uart].rx_pin : uarts[uart].tx_pin) >= 0; }
void set_ring(uint8_t uart, int size) { uarts[uart].ring = size; }

bool overflowed(uint8_t uart)
{
    bool was = uarts[uart].overflowed;
    uarts[uart].overflowed = false;
    return was;
}

void listen(uint8_t uart, bool on) { uarts[uart].muted = !on; }

} // namespace machine
