#include "machine.h"

#include <execinfo.h>
#include <pthread.h>
#include <signal.h>
#include <stdarg.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/time.h>
#include <ucontext.h>

#include <initializer_list>

#include "link.h"
#include "drives.h"
#include "parts.h"
#include "waves.h"

void setup();
void loop();
void serve_serial_events();

namespace machine {

uint64_t now;
uint8_t reset_flags = 1;
void (*between)();
void (*wait)(uint64_t when) = [](uint64_t when) { pass_until(when, true); };

namespace {

using board::INTERRUPTS;
constexpr int CONFIGURED = 16, SERVOS = 16, ALARMS = 64;
constexpr int EEPROM_MOST = 4096;
constexpr size_t GUARD = 64 << 10;
constexpr uint64_t FRAME = (uint64_t)(0.02 * CLOCK);

uint64_t target, next_due = NEVER; /* nothing happens before main(): constructors only */
uint64_t last_call, patience;
bool others_wanted;
char *stack, *first_stack; /* the one in use; that of loop() */
size_t stack_size = board::STACK;

void plan_next();

#include "interrupts.h"
#include "messages.h"

uint64_t watchdog_cycles, watchdog_due = NEVER;
double adc[PINS];
uint8_t memory[EEPROM_MOST];
link_input configured[CONFIGURED]; /* lines: the same after a reset */
int configured_count;

#include "pins.h"
#include "servos.h"
#include "tones.h"

void configure(const link_input *input)
{
    uint8_t uart = input->index % UARTS;
    if (input->kind == IN_BAUD)
        set_line(uart, input->number);
    else if (input->kind == IN_RX_PIN)
        put_line_at(uart, input->value, -1);
    else
        put_line_at(uart, -1, input->value);
}

void take_input(const link_input *input)
{
    uint8_t index = input->index;
    switch (input->kind) {
    case IN_UART: put_on_line(index % UARTS, (uint8_t)input->value, input->number); break;
    case IN_BAUD:
    case IN_RX_PIN:
    case IN_TX_PIN:
        if (configured_count < CONFIGURED)
            configured[configured_count++] = *input;
        configure(input);
        break;
    case IN_EEPROM: memory[input->value % EEPROM_MOST] = (uint8_t)input->number; break;
    case IN_VOLTS: adc[index % PINS] = input->number; break;
    case IN_LEVEL: put_outside(index % PINS, input->number != 0.0); break;
    case IN_FREQUENCY: wave_set(index, 0, input->number, now); break;
    case IN_FRAME: wave_frame(index, input->number); break;
    case IN_PULSE: wave_set(index, 1, input->number, now); break;
    case IN_PART: part_add(input); watch_part(index); break;
    case IN_REGISTER: part_set(input); break;
    case IN_REGISTERS: part_store(input); break;
    case IN_REPLY: part_clear(input); break;
    case IN_DRIVE: drive_add(index % PINS, (uint8_t)input->value, (uint64_t)input->number); break;
    case IN_FORGET: drive_forget(index % PINS); break;
    case IN_MESSAGE: message_begin(input->index, input->value); break;
    case IN_MORE: message_add(input); break;
    case IN_WATCH: pins[index % PINS].watched = true; break;
    }
}

#include "reset.h"

/* When the first thing falls due, and, in `do_it`, let it happen at its time. */
uint64_t first(bool do_it)
{
    int which = -1; /* no pin: a line */
    double soonest = next_on_lines();
    for (int pin = 0; modulated && pin < PINS; pin++)
        if (pins[pin].share >= 0 && pins[pin].edge < soonest)
            soonest = pins[pin].edge, which = pin;
    uint64_t due = soonest < 1e18 ? (uint64_t)soonest : NEVER;
    uint64_t wave_due = wave_next();
    uint64_t all = due;
    all = wave_due < all ? wave_due : all;
    all = servo_next < all ? servo_next : all;
    all = tone_next < all ? tone_next : all;
    all = drive_next() < all ? drive_next() : all;
    all = alarm_next < all ? alarm_next : all;
    all = watchdog_due < all ? watchdog_due : all;
    all = target < all ? target : all;
    if (!do_it)
        return all;
    uint64_t late = now;
    now = all; /* what happens is stamped with its own time */
    if (all == due && which < 0) {
        serve_lines();
    } else if (all == due) {
        turn_modulated((uint8_t)which);
    } else if (all == wave_due) {
        wave *one = wave_turn(now, CLOCK);
        put_outside(one->pin, one->level);
    } else if (all == servo_next) {
        turn_servos();
    } else if (all == tone_next) {
        turn_tone();
    } else if (all == drive_next()) {
        drive_at one = drive_take();
        put_outside(one.pin, one.level == DRIVE_NONE ? -1 : one.level);
    } else if (all == alarm_next) {
        ring();
    } else if (all == watchdog_due) {
        reset();
    } else {
        refuse_other_rates();
        link_answer(now, "");
        target = link_read();
    }
    now = late > now ? late : now;
    return all;
}

/* At once if something may be at hand that has no time of its own. */
void plan_next() { next_due = by_registers || others_wanted ? 0 : first(false); }

void happen()
{
    if (by_registers)
        take_registers();
    if (by_registers || others_wanted) /* it was planned for at once, and nothing may be due */
        next_due = first(false);
    while (next_due <= now) {
        first(true);
        next_due = first(false);
    }
    interrupt();
    plan_next();
}

void refuse_hang()
{
    if (now - last_call > patience)
        end("it has run for %.3g s of its time without returning from loop() or calling anything: "
            "an endless loop (or a wait longer than its patience)",
            (double)(now - last_call) / CLOCK);
}

#include "crashes.h"

void *run(void *)
{
    catch_crashes();
    if (!resumed)
        target = link_read();
    plan_next();
    setup();
    for (;;) {
        last_call = now;
        loop();
        charge(16);
        serve_serial_events();
    }
}

} // namespace

void charge(uint32_t cycles)
{
    last_call = now;
    now += cycles;
    if (now >= next_due)
        happen();
}

volatile uint8_t *register_of(uint8_t pin, int which)
{
    need_pin(pin);
    by_registers = true;
    if (next_due != NEVER)
        next_due = 0;
    return &registers[pin][which];
}

void pass_until(uint64_t when, bool event)
{
    if (by_registers)
        take_registers();
    while (now < when) {
        uint64_t due = next_due = first(false); /* nothing is written meanwhile */
        now = due < when ? (due > now ? due : now) : when;
        last_call = now;
        if (now >= next_due)
            happen();
        if (event)
            return;
    }
}

void reschedule() { plan_next(); }
void report_byte(uint8_t uart, uint8_t data) { link_put(OUT_UART, uart, data, now); }

void drive(uint8_t pin, bool to)
{
    need_pin(pin);
    if (pins[pin].share >= 0)
        modulated--;
    pins[pin].share = -1;
    pins[pin].latch = to;
    settle_own(pin);
}

void direct(uint8_t pin, bool output)
{
    need_pin(pin);
    pins[pin].output = output;
    settle_own(pin);
}

bool level(uint8_t pin)
{
    need_pin(pin);
    return pins[pin].level;
}

uint8_t remembered(uint16_t at) { return memory[at % EEPROM_MOST]; }

void remember(uint16_t at, uint8_t value)
{
    if (memory[at % EEPROM_MOST] != value)
        link_put(OUT_EEPROM, value, at, now);
    memory[at % EEPROM_MOST] = value;
}

double volts(uint8_t channel) { return adc[channel % PINS]; }

void modulate(uint8_t pin, double share, double period)
{
    need_pin(pin);
    if (pins[pin].share < 0) {
        modulated++;
        put_output(pin, true);
        pins[pin].edge = (double)now + period * share;
    }
    pins[pin].share = share;
    pins[pin].period = period;
    plan_next();
}

bool can_sound(uint8_t pin) { return tone_pin == NO_TONE || tone_pin == pin; }

void sound(uint8_t pin, uint32_t half_period, int64_t turns)
{
    tone_pin = pin;
    tone_half = half_period;
    tone_turns = turns;
    tone_next = now + half_period;
    plan_next();
}

void hush(uint8_t pin)
{
    if (tone_pin == pin)
        end_tone();
    drive(pin, false);
    plan_next();
}

/* With a place before it that must not be touched. */
char *new_stack(size_t size)
{
    char *place = (char *)mmap(nullptr, GUARD + size, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    mprotect(place + GUARD, size, PROT_READ | PROT_WRITE);
    return place + GUARD;
}

void restart() { reset(); }
void let_others_go_on(bool on) { others_wanted = on; plan_next(); }
char *main_stack() { return first_stack; }
const char *folder() { return program[3]; }

void on_stack(char *begin, size_t size)
{
    stack = begin;
    stack_size = size;
}

void watchdog(uint64_t cycles)
{
    watchdog_cycles = cycles;
    watchdog_due = cycles ? now + cycles : NEVER;
    plan_next();
}

void feed()
{
    if (watchdog_cycles)
        watchdog(watchdog_cycles);
}

void end(const char *format, ...)
{
    char text[400];
    va_list values;
    va_start(values, format);
    vsnprintf(text, sizeof text, format, values);
    va_end(values);
    end_at(nullptr, text);
}

} // namespace machine

/* Called by the compiler in each stretch of the sketch's code that has no jumps. */
extern "C" void __sanitizer_cov_trace_pc()
{
    using namespace machine;
    now += board::STRETCH;
    if (now >= next_due) {
        refuse_hang();
        happen();
        if (others_wanted && !in_interrupt && interrupts_on)
            between();
    }
}

int main(int, char **arguments)
{
    using namespace machine;
    link_out = atoi(arguments[1]);
    link_take = take_input;
    patience = (uint64_t)(atof(arguments[2]) * CLOCK);
    memset(memory, 0xFF, sizeof memory);
    program = arguments;
    if (arguments[4])
        resume(atoi(arguments[4]));
    stack = first_stack = new_stack(stack_size);
    pthread_attr_t attributes;
    pthread_attr_init(&attributes);
    pthread_attr_setstack(&attributes, stack, stack_size);
    pthread_t thread;
    pthread_create(&thread, &attributes, run, nullptr);
    sigset_t ticks; /* the sketch's thread takes them: there they say where it is */
    sigemptyset(&ticks);
    sigaddset(&ticks, SIGVTALRM);
    pthread_sigmask(SIG_BLOCK, &ticks, nullptr);
    pthread_join(thread, nullptr);
    return 0;
}

extern "C" int part_link_begin(uint8_t address, int reading) { return part_begin(address, reading); }
extern "C" int part_link_write(uint8_t data) { return part_write(data); }
extern "C" uint8_t part_link_read() { return part_read(); }
extern "C" uint8_t part_link_transfer(uint8_t data) { return part_transfer(data); }

static uint64_t part_call(uint8_t call, part *one, uint16_t value)
{
    link_event event = {call, (uint8_t)(one - parts), value, machine::now};
    uint32_t count = one->sent_length;
    one->sent_length = 0;
    uint64_t result = link_call(event, one->sent, count);
    machine::reschedule(); /* it may have said what it drives, and when */
    return result;
}
