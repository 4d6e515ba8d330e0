/* Arduino-ESP32's API on a computer, in simulated time; written from its public documentation. */
#ifndef Arduino_h
#define Arduino_h

#include <ctype.h>
#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <time.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include "board.h"
#include "esp_attr.h"
#include "esp_err.h"
#include "freertos/FreeRTOS.h"
#include "freertos/queue.h"
#include "freertos/semphr.h"
#include "freertos/task.h"
#include "libc.h"
#include "pgmspace.h"

#define ESP_ARDUINO_VERSION_VAL(major, minor, patch) ((major) << 16 | (minor) << 8 | (patch))
#define ESP_ARDUINO_VERSION_MAJOR 2
#define ESP_ARDUINO_VERSION_MINOR 0
#define ESP_ARDUINO_VERSION_PATCH 17
#define ESP_ARDUINO_VERSION ESP_ARDUINO_VERSION_VAL(2, 0, 17)
#define ESP_IDF_VERSION_VAL(major, minor, patch) ((major) << 16 | (minor) << 8 | (patch))
#define ESP_IDF_VERSION ESP_IDF_VERSION_VAL(4, 4, 7)
#define ESP_IDF_VERSION_MAJOR 4

typedef uint8_t byte;
typedef bool boolean;
typedef unsigned int word;

using std::abs;
using std::isinf;
using std::isnan;
using std::max;
using std::min;
using ::round;
/* Of two types, as sketches have them with widths that are one on the board. */
template <typename A, typename B> constexpr auto min(A a, B b) -> decltype(a < b ? a : b) { return a < b ? a : b; }
template <typename A, typename B> constexpr auto max(A a, B b) -> decltype(a > b ? a : b) { return a > b ? a : b; }

#define HIGH 0x1
#define LOW 0x0
#define INPUT 0x01
#define OUTPUT 0x03
#define PULLUP 0x04
#define INPUT_PULLUP 0x05
#define PULLDOWN 0x08
#define INPUT_PULLDOWN 0x09
#define OPEN_DRAIN 0x10
#define OUTPUT_OPEN_DRAIN 0x13
#define ANALOG 0xC0
#define DISABLED 0x00
#define RISING 0x01
#define FALLING 0x02
#define CHANGE 0x03
#define LSBFIRST 0
#define MSBFIRST 1
#define DEC 10
#define HEX 16
#define OCT 8
#define BIN 2
#define NOT_AN_INTERRUPT (-1)
#define NOT_A_PIN (-1)

#define PI 3.1415926535897932384626433832795
#define HALF_PI 1.5707963267948966192313216916398
#define TWO_PI 6.283185307179586476925286766559
#define DEG_TO_RAD 0.017453292519943295769236907684886
#define RAD_TO_DEG 57.295779513082320876798154814105
#define EULER 2.718281828459045235360287471352

#define constrain(x, low, high) ((x) < (low) ? (low) : ((x) > (high) ? (high) : (x)))
#define radians(deg) ((deg) * DEG_TO_RAD)
#define degrees(rad) ((rad) * RAD_TO_DEG)
#define sq(x) ((x) * (x))
#define lowByte(w) ((uint8_t)((w) & 0xff))
#define highByte(w) ((uint8_t)((w) >> 8))
#define _BV(b) (1UL << (b))
#define bit(b) (1UL << (b))
#define bitRead(value, b) (((value) >> (b)) & 0x01)
#define bitSet(value, b) ((value) |= (1UL << (b)))
#define bitClear(value, b) ((value) &= ~(1UL << (b)))
#define bitToggle(value, b) ((value) ^= (1UL << (b)))
#define bitWrite(value, b, to) ((to) ? bitSet(value, b) : bitClear(value, b))
#define clockCyclesPerMicrosecond() ((long)F_CPU / 1000000L)
#define digitalPinIsValid(pin) ((pin) >= 0 && (pin) < board::PINS)
#define digitalPinToInterrupt(pin) ((pin) >= 0 && (pin) < board::PINS ? (pin) : NOT_AN_INTERRUPT)
#define interrupts() sei()
#define noInterrupts() cli()
#define word(...) makeWord(__VA_ARGS__)

#include "pins_arduino.h"

unsigned long millis();
unsigned long micros();
void delay(uint32_t ms);
void delayMicroseconds(uint32_t us);
void yield();
void sei();
void cli();

void pinMode(uint8_t pin, uint8_t mode);
void digitalWrite(uint8_t pin, uint8_t level);
int digitalRead(uint8_t pin);
uint16_t analogRead(uint8_t pin);
uint32_t analogReadMilliVolts(uint8_t pin);
void analogReadResolution(uint8_t bits);
void analogSetWidth(uint8_t bits);
typedef enum { ADC_0db, ADC_2_5db, ADC_6db, ADC_11db, ADC_ATTENDB_MAX } adc_attenuation_t;
void analogSetAttenuation(adc_attenuation_t attenuation);
void analogSetPinAttenuation(uint8_t pin, adc_attenuation_t attenuation);
inline bool adcAttachPin(uint8_t) { return true; }
void dacWrite(uint8_t pin, uint8_t value);
/* Registers of a pin: each pin is bit 0 of a port of its own, and the rest of its 32 bits stays as it is. */
#define NOT_A_PORT 0
#define digitalPinToPort(pin) ((uint8_t)((pin) + 1))
#define digitalPinToBitMask(pin) (1UL)
volatile uint32_t *portInputRegister(uint8_t port);
volatile uint32_t *portModeRegister(uint8_t port);
volatile uint32_t *portOutputRegister(uint8_t port);
void attachInterrupt(uint8_t pin, void (*handler)(), int mode);
void attachInterrupt(uint8_t pin, std::function<void()> handler, int mode);
void attachInterruptArg(uint8_t pin, void (*handler)(void *), void *argument, int mode);
void detachInterrupt(uint8_t pin);

long map(long x, long in_min, long in_max, long out_min, long out_max);
long random(long most);
long random(long least, long most);
void randomSeed(unsigned long seed);
uint32_t esp_random();

#include "basics.h"
#include "binary.h"

void setup();
void loop();
void serialEvent() __attribute__((weak));
void serialEvent1() __attribute__((weak));
void serialEvent2() __attribute__((weak));

#include "Stream.h"
#include "WString.h"
inline const String emptyString;
#include "IPAddress.h"
#include "Client.h"
#include "Server.h"
#include "Udp.h"
#include "HardwareSerial.h"
#include "Esp.h"
#include "esp32-hal.h"

#define __unused __attribute__((unused)) /* of newlib; a computer's headers have members of this name */

#endif
