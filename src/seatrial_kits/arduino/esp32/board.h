/* An ESP32: a sketch's numbers are a computer's with 32 bits. */
#ifndef BOARD_H
#define BOARD_H

#include <stddef.h>
#include <stdint.h>

typedef int sketch_int; /* int and double of a sketch */
typedef double sketch_real;
typedef unsigned long sketch_ulong;

namespace board {

#if defined(BOARD_ESP32S3)
constexpr int PINS = 49;
constexpr char NAME[] = "ESP32-S3";
#elif defined(BOARD_ESP32C3)
constexpr int PINS = 22;
constexpr char NAME[] = "ESP32-C3";
#else
constexpr int PINS = 40;
constexpr char NAME[] = "ESP32";
#endif
constexpr int INTERRUPTS = PINS, UARTS = 4; /* one line is for SoftwareSerial */
constexpr char MEMORY[] = "320 kB";
constexpr int RECEIVED = 256, SENT = 128; /* bytes of a UART's rings */
constexpr int STRETCH = 1;                /* of a stretch of code without jumps: 15 cycles at 240 MHz */
constexpr int INTERRUPT = 32;             /* 2 us, as measured on boards */
constexpr size_t STACK = 256 << 10;

inline int interrupt_of(int pin) { return pin; }

} // namespace board

#endif
