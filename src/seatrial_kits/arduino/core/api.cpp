/* The API's functions in terms of the machine; costs in cycles are those of the AVR core, roughly. */
#include "Arduino.h"
#include "avr/wdt.h"
#include "machine.h"
#include "util/atomic.h"

using machine::charge;

/* ------------------------------------------------------------------ time */

uint32_t micros() { charge(50); return (uint32_t)(machine::now / 64 * 4); }

/* The board's timer overflows every 1.024 ms; every 42 times or so it counts two. */
uint32_t millis()
{
    charge(30);
    uint64_t overflows = machine::now / 16384;
    return (uint32_t)(overflows + overflows * 3 / 125);
}

void delay(uint32_t ms) { machine::pass_until(machine::now + ms * 16000ull); }
void delayMicroseconds(unsigned us) { machine::pass_until(machine::now + us * 16ull); }
void yield() { charge(8); }

/* ------------------------------------------------------------------ pins */

void pinMode(uint8_t pin, uint8_t mode)
{
    charge(60);
    machine::direct(pin, mode == OUTPUT);
    if (mode != OUTPUT)
        machine::drive(pin, mode == INPUT_PULLUP);
}

void digitalWrite(uint8_t pin, uint8_t level) { charge(70); machine::drive(pin, level != LOW); }
int16_t digitalRead(uint8_t pin) { charge(60); return machine::level(pin); }

volatile uint8_t *portInputRegister(uint8_t port) { return machine::register_of((uint8_t)(port - 1), 0); }
volatile uint8_t *portModeRegister(uint8_t port) { return machine::register_of((uint8_t)(port - 1), 1); }
volatile uint8_t *portOutputRegister(uint8_t port) { return machine::register_of((uint8_t)(port - 1), 2); }

static double reference = 5.0; /* V */

void analogReference(uint8_t which)
{
    charge(10);
#ifdef BOARD_MEGA
    reference = which == INTERNAL2V56 ? 2.56 : which == INTERNAL1V1 ? 1.1 : 5.0;
#else
    reference = which == INTERNAL ? 1.1 : 5.0;
#endif
}

int16_t analogRead(uint8_t pin)
{
    charge(1792);
    uint8_t channel = (uint8_t)((pin >= A0 ? pin - A0 : pin) % (NUM_ANALOG_INPUTS > 8 ? 16 : 8));
    double count = machine::volts(channel) / reference * 1024.0;
    return (int16_t)(count < 0.0 ? 0.0 : count > 1023.0 ? 1023.0 : count);
}

void analogWrite(uint8_t pin, int value)
{
#ifdef BOARD_MEGA
    bool able = (pin >= 2 && pin <= 13) || (pin >= 44 && pin <= 46), fast = pin == 4 || pin == 13;
#else
    bool able = pin == 3 || pin == 5 || pin == 6 || (pin >= 9 && pin <= 11), fast = pin == 5 || pin == 6;
#endif
    charge(100);
    machine::direct(pin, true);
    if (value <= 0 || value >= 255 || !able)
        machine::drive(pin, value >= (able ? 255 : 128));
    else
        machine::modulate(pin, value / 255.0, machine::CLOCK / (fast ? 976.5625 : 490.196));
}

/* Half a period by timer 2: its register of 8 bits after the first divider for which the period fits. */
void tone(uint8_t pin, unsigned frequency, uint32_t duration)
{
    charge(300);
    if (!machine::can_sound(pin))
        return;
    pinMode(pin, OUTPUT);
    if (!frequency)
        return;
    const uint32_t dividers[] = {1, 8, 32, 64, 128, 256, 1024};
    uint32_t count = 0, divider = 1;
    for (uint32_t each : dividers) {
        divider = each;
        count = F_CPU / frequency / 2 / divider - 1;
        if (count <= 255)
            break;
    }
    int64_t turns = duration ? (int64_t)(2ull * frequency * duration / 1000) : -1;
    machine::sound(pin, ((count & 255) + 1) * divider, turns);
}

void noTone(uint8_t pin) { charge(80); machine::hush(pin); }

/* ------------------------------------------------------------------ interrupts */

int16_t digitalPinToInterrupt(int pin)
{
    return (int16_t)board::interrupt_of(pin);
}

static void call(void *handler) { ((void (*)())handler)(); }

void attachInterrupt(uint8_t number, void (*handler)(), int mode)
{
    charge(40);
    machine::on_edge(number, handler ? call : nullptr, (void *)handler, mode);
}

void detachInterrupt(uint8_t number) { charge(40); machine::on_edge(number, nullptr, nullptr, 0); }
void interrupts() { machine::enable(true); charge(1); }
void noInterrupts() { machine::enable(false); charge(1); }
SketchStatus sketch_status;
SketchStatus::operator uint8_t() const { charge(1); return (uint8_t)(machine::enabled() << SREG_I); }

SketchStatus &SketchStatus::operator=(uint8_t status)
{
    charge(1);
    machine::enable(status >> SREG_I & 1);
    return *this;
}

bool interrupts_enabled() { return machine::enabled(); }

uint8_t &sketch_reset_flags = machine::reset_flags;

void wdt_enable(uint8_t timeout) { machine::watchdog((uint64_t)(240000ull << timeout)); }
void wdt_disable() { machine::watchdog(0); }
void wdt_reset() { charge(1); machine::feed(); }

/* ------------------------------------------------------------------ numbers */

int32_t map(int32_t x, int32_t in_min, int32_t in_max, int32_t out_min, int32_t out_max)
{
    int32_t span = in_max - in_min;
    int32_t product = (int32_t)((uint32_t)(x - in_min) * (uint32_t)(out_max - out_min));
    return span ? product / span + out_min : -1;
}
