/* The simulated board: time in CPU cycles, and what happens when. */
#ifndef MACHINE_H
#define MACHINE_H

#include <stdint.h>

namespace machine {

constexpr double CLOCK = 16e6;
constexpr int UARTS = 4, PINS = 70;

extern uint64_t now; /* cycles since the start of the run */

/* Let `cycles` pass: what a call costs. Everything that falls due happens on the way. */
void charge(uint32_t cycles);
/* Let time pass until `when`, or, with `event`, until something has happened. */
void pass_until(uint64_t when, bool event = false);

void drive(uint8_t pin, bool level); /* of an input: whether it is pulled up */
void direct(uint8_t pin, bool output);
bool level(uint8_t pin);
double volts(uint8_t channel);
volatile uint8_t *register_of(uint8_t pin, int which); /* 0 to 2: PIN, DDR, PORT; its bit 0 is the pin */
void modulate(uint8_t pin, int share); /* PWM, 0 to 255 */

void open_uart(uint8_t uart, uint32_t baud);
int received(uint8_t uart); /* bytes that wait */
int take(uint8_t uart, bool keep);
int room(uint8_t uart);
void send(uint8_t uart, uint8_t data);
void drain(uint8_t uart);
bool overflowed(uint8_t uart); /* a byte found no room since this was last read */
int line_to(int rx_pin);   /* the UART whose line ends at this pin, or -1 */
int line_from(int tx_pin); /* the one whose line begins there */
void listen(uint8_t uart, bool on);  /* software receives one line at a time, and none while it sends */

bool can_sound(uint8_t pin); /* one pin at a time */
void sound(uint8_t pin, uint32_t half_period, int64_t turns); /* cycles; turns below 0: without end */
void hush(uint8_t pin);

int new_servo();
void set_servo(int servo, int pin, double us); /* pin -1: detached */

void on_edge(uint8_t interrupt, void (*handler)(), int mode);
void enable(bool interrupts);
bool enabled();
uint8_t remembered(uint16_t at); /* EEPROM */
void remember(uint16_t at, uint8_t value);
extern uint8_t reset_flags; /* MCUSR */
void watchdog(uint64_t cycles); /* 0: off */
void feed();

/* For the machine's own parts: lines, and what they need of it. */
void put_on_line(uint8_t uart, uint8_t data, double earliest);
void set_line(uint8_t uart, double baud);
void put_line_at(uint8_t uart, int rx_pin, int tx_pin); /* -1: as before */
double next_on_lines();                                 /* when a byte has arrived or left, in cycles */
void serve_lines();
void refuse_other_rates(); /* of UARTs and their lines, if they stay */
void report_byte(uint8_t uart, uint8_t data);
void reschedule();

[[noreturn]] void end(const char *format, ...);

} // namespace machine

#endif
