/* Names of pins, as Arduino-ESP32's boards ESP32 Dev Module, ESP32-S3 and ESP32-C3 DevKit have them. */
#ifndef PINS_ARDUINO_H
#define PINS_ARDUINO_H

#include <stdint.h>

#if defined(BOARD_ESP32S3)
#define NUM_DIGITAL_PINS 49
enum : uint8_t { LED_BUILTIN = 48, TX = 43, RX = 44, SDA = 8, SCL = 9, SS = 10, MOSI = 11, MISO = 13, SCK = 12 };
enum : uint8_t { A0 = 1, A1, A2, A3, A4, A5, A6, A7, A8, A9, A10, A11, A12, A13, A14, A15, A16, A17, A18, A19 };
#elif defined(BOARD_ESP32C3)
#define NUM_DIGITAL_PINS 22
enum : uint8_t { LED_BUILTIN = 8, TX = 21, RX = 20, SDA = 8, SCL = 9, SS = 7, MOSI = 6, MISO = 5, SCK = 4 };
enum : uint8_t { A0, A1, A2, A3, A4, A5 };
#else
#define NUM_DIGITAL_PINS 40
enum : uint8_t { LED_BUILTIN = 2, TX = 1, RX = 3, SDA = 21, SCL = 22, SS = 5, MOSI = 23, MISO = 19, SCK = 18 };
enum : uint8_t { A0 = 36, A3 = 39, A4 = 32, A5, A6, A7, A10 = 4, A11 = 0, A12 = 2, A13 = 15, A14 = 13, A15 = 12, A16 = 14, A17 = 27, A18 = 25, A19 = 26 };
enum : uint8_t { DAC1 = 25, DAC2, T0 = 4, T1 = 0, T2 = 2, T3 = 15, T4 = 13, T5 = 12, T6 = 14, T7 = 27, T8 = 33, T9 = 32 };
#endif
#define LED_BUILTIN LED_BUILTIN
#define BUILTIN_LED LED_BUILTIN

#endif
