/* The Arduino API on a computer, in simulated time; written from its public documentation. */
#ifndef Arduino_h
#define Arduino_h

#include <ctype.h>
#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <string>

#include "board.h"
#include "avr/interrupt.h"
#include "avr/pgmspace.h"
#include "avr/wdt.h"
#include "avr_libc.h"

typedef uint8_t byte;
typedef bool boolean;
typedef uint16_t word;

#ifndef F_CPU
#define F_CPU 16000000UL
#endif

#define HIGH 1
#define LOW 0
#define INPUT 0
#define OUTPUT 1
#define INPUT_PULLUP 2
#define CHANGE 1
#define FALLING 2
#define RISING 3
#define LSBFIRST 0
#define MSBFIRST 1
#define DEFAULT 1
#define EXTERNAL 0
#ifdef BOARD_MEGA
#define INTERNAL1V1 2
#define INTERNAL2V56 3
#else
#define INTERNAL 3
#endif
#define DEC 10
#define HEX 16
#define OCT 8
#define BIN 2
#define LED_BUILTIN 13
#define NOT_AN_INTERRUPT (-1)

#define PI 3.1415926535897932384626433832795f
#define HALF_PI 1.5707963267948966192313216916398f
#define TWO_PI 6.283185307179586476925286766559f
#define DEG_TO_RAD 0.017453292519943295769236907684886f
#define RAD_TO_DEG 57.295779513082320876798154814105f
#define EULER 2.718281828459045235360287471352f

#define min(a, b) ((a) < (b) ? (a) : (b))
#define max(a, b) ((a) > (b) ? (a) : (b))
#undef abs
#define abs(x) ((x) > 0 ? (x) : -(x))
#define round(x) ((x) >= 0 ? (int32_t)((x) + 0.5f) : (int32_t)((x)-0.5f))
#define constrain(x, low, high) ((x) < (low) ? (low) : ((x) > (high) ? (high) : (x)))
#define radians(deg) ((deg) * DEG_TO_RAD)
#define degrees(rad) ((rad) * RAD_TO_DEG)
#define sq(x) ((x) * (x))
#define lowByte(w) ((uint8_t)((w) & 0xff))
#define highByte(w) ((uint8_t)((uint16_t)(w) >> 8))
#define _BV(b) (1 << (b))
#define bit(b) ((uint32_t)1 << (b))
#define bitRead(value, b) (((value) >> (b)) & 1)
#define bitSet(value, b) ((value) |= ((uint32_t)1 << (b)))
#define bitClear(value, b) ((value) &= ~((uint32_t)1 << (b)))
#define bitToggle(value, b) ((value) ^= ((uint32_t)1 << (b)))
#define bitWrite(value, b, to) ((to) ? bitSet(value, b) : bitClear(value, b))
#define clockCyclesPerMicrosecond() (F_CPU / 1000000L)
#define clockCyclesToMicroseconds(cycles) ((cycles) / clockCyclesPerMicrosecond())
#define microsecondsToClockCycles(us) ((us) * clockCyclesPerMicrosecond())

#ifdef BOARD_MEGA
enum { A0 = 54, A1, A2, A3, A4, A5, A6, A7, A8, A9, A10, A11, A12, A13, A14, A15 };
enum { SDA = 20, SCL = 21, SS = 53, MOSI = 51, MISO = 50, SCK = 52 };
#define NUM_DIGITAL_PINS 70
#define NUM_ANALOG_INPUTS 16
#else
enum { A0 = 14, A1, A2, A3, A4, A5, A6, A7 };
enum { SDA = 18, SCL = 19, SS = 10, MOSI = 11, MISO = 12, SCK = 13 };
#define NUM_DIGITAL_PINS 20
#define NUM_ANALOG_INPUTS 6
#endif

uint32_t millis();
uint32_t micros();
void delay(uint32_t ms);
void delayMicroseconds(unsigned us);
void yield();

void pinMode(uint8_t pin, uint8_t mode);
void digitalWrite(uint8_t pin, uint8_t level);
int16_t digitalRead(uint8_t pin);
int16_t analogRead(uint8_t pin);
void analogWrite(uint8_t pin, int value);
void analogReference(uint8_t mode);
void tone(uint8_t pin, unsigned frequency, uint32_t duration = 0);
void noTone(uint8_t pin);
/* Registers of a pin: each pin is bit 0 of a port of its own, and these follow each other in memory. */
#define NOT_A_PORT 0
#define digitalPinToPort(pin) ((uint8_t)((pin) + 1))
#define digitalPinToBitMask(pin) ((uint8_t)1)
volatile uint8_t *portInputRegister(uint8_t port);
volatile uint8_t *portModeRegister(uint8_t port);
volatile uint8_t *portOutputRegister(uint8_t port);

int16_t digitalPinToInterrupt(int pin);
void attachInterrupt(uint8_t interrupt, void (*handler)(), int mode);
void detachInterrupt(uint8_t interrupt);

int32_t map(int32_t x, int32_t in_min, int32_t in_max, int32_t out_min, int32_t out_max);
#define random sketch_random
int32_t random();
int32_t random(int32_t most);
int32_t random(int32_t least, int32_t most);
void randomSeed(uint32_t seed);

#include "basics.h"
#include "binary.h"
#define word(...) makeWord(__VA_ARGS__)

void setup();
void loop();
/* Called after loop() while their UART has received something. */
void serialEvent() __attribute__((weak));
void serialEvent1() __attribute__((weak));
void serialEvent2() __attribute__((weak));
void serialEvent3() __attribute__((weak));

#include "WString.h"

#include "Stream.h"

#include "HardwareSerial.h"

#endif
