/* The simulated board: time in CPU cycles, and what happens when. */
#ifndef MACHINE_H
#define MACHINE_H

#include <stddef.h>
#include <stdint.h>

#include "board.h"

namespace machine {

/* What time is counted in, of any board: the cycles of an AVR. */
constexpr double CLOCK = 16e6;
using board::PINS, board::UARTS;

extern uint64_t now; /* cycles since the start of the run */

/* Let `cycles` pass: what a call costs. Everything that falls due happens on the way. */
void charge(uint32_t cycles);
/* Let time pass until `when`, or, with `event`, until something has happened. */
void pass_until(uint64_t when, bool event = false);

void drive(uint8_t pin, bool level); /* of an input: whether it is pulled up */
void direct(uint8_t pin, bool output);
bool level(uint8_t pin);
double volts(uint8_t channel); /* of an ADC: see Mcu.channel */
volatile uint8_t *register_of(uint8_t pin, int which); /* 0 to 2: PIN, DDR, PORT; its bit 0 is the pin */
void modulate(uint8_t pin, double share, double period); /* PWM: share of time high, of a period in cycles */

void open_uart(uint8_t uart, uint32_t baud);
int received(uint8_t uart); /* bytes that wait */
int take(uint8_t uart, bool keep);
int room(uint8_t uart);
void send(uint8_t uart, uint8_t data);
void drain(uint8_t uart);
bool overflowed(uint8_t uart); /* a byte found no room since this was last read */
double line_rate(uint8_t uart); /* of its line, baud; 0 without one */
int line_to(int rx_pin);   /* the UART whose line ends at this pin, or -1 */
int line_from(int tx_pin); /* the one whose line begins there */
bool placed(uint8_t uart, bool rx); /* whether that end of its line is at a pin of the profile */
void set_ring(uint8_t uart, int size); /* how many bytes wait for it at most */
void listen(uint8_t uart, bool on);  /* software receives one line at a time, and none while it sends */

bool can_sound(uint8_t pin); /* one pin at a time */
void sound(uint8_t pin, uint32_t half_period, int64_t turns); /* cycles; turns below 0: without end */
void hush(uint8_t pin);

int new_servo();
void set_servo(int servo, int pin, double us); /* pin -1: detached */

/* Modes are 1 for each edge, 2 for falling ones and 3 for rising ones. */
typedef void (*Handler)(void *argument);
void on_edge(int interrupt, Handler handler, void *argument, int mode);
/* Calls at a time, as interrupts: timers. UINT64_MAX is off. */
int new_alarm(Handler handler, void *argument);
void set_alarm(int alarm, uint64_t when);
/* Lets time pass until `when` or until something has happened: others may go on meanwhile. */
extern void (*wait)(uint64_t when);
/* Called between stretches of code, outside of interrupts, while it is wanted: another task may go on there. */
extern void (*between)();
void let_others_go_on(bool wanted);
char *new_stack(size_t size);
char *main_stack();
const char *folder(); /* of the files in its flash; '' if it has none */
void on_stack(char *begin, size_t size);
/* Messages of a device to and from the process that steps the board. */
enum { CAN_MESSAGES, NETWORK_MESSAGES, RADIO_MESSAGES };
typedef void (*Received)(const uint8_t *data, size_t size);
void receive_messages(int channel, Received handler);
void send_message(int channel, const void *data, size_t size);
void enable(bool interrupts);
bool enabled();
bool interrupted(); /* whether a handler of an interrupt runs */
[[noreturn]] void restart();
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
