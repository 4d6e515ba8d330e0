/* The core's functions of pins, with a pin that the board has not refused. The linker puts these before
 * the core's, whose tables end with the board's pins. */
#include <Arduino.h>

#define NO_PIN (*(volatile uint8_t *)0xC7) /* the emulated board ends the run: see avr/stack.h */

void __real_pinMode(uint8_t pin, uint8_t mode);
void __real_digitalWrite(uint8_t pin, uint8_t level);
int __real_digitalRead(uint8_t pin);
void __real_analogWrite(uint8_t pin, int value);

static inline void need_pin(uint8_t pin)
{
    if (pin >= NUM_DIGITAL_PINS)
        NO_PIN = pin;
}

void __wrap_pinMode(uint8_t pin, uint8_t mode) { need_pin(pin); __real_pinMode(pin, mode); }
void __wrap_digitalWrite(uint8_t pin, uint8_t level) { need_pin(pin); __real_digitalWrite(pin, level); }
int __wrap_digitalRead(uint8_t pin) { need_pin(pin); return __real_digitalRead(pin); }
void __wrap_analogWrite(uint8_t pin, int value) { need_pin(pin); __real_analogWrite(pin, value); }
