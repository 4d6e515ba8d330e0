/* EEPROM: erased at the start of every run. */
#ifndef EEPROM_h
#define EEPROM_h

#include "Arduino.h"

#ifdef BOARD_MEGA
#define EEPROM_SIZE 4096
#else
#define EEPROM_SIZE 1024
#endif

class EEPROMClass {
public:
    uint8_t read(int at);
    void write(int at, uint8_t value);
    void update(int at, uint8_t value) { if (read(at) != value) write(at, value); }
    uint16_t length() { return EEPROM_SIZE; }
    template <typename T> T &get(int at, T &to) { for (size_t i = 0; i < sizeof to; i++) ((uint8_t *)&to)[i] = read(at + (int)i); return to; }
    template <typename T> const T &put(int at, const T &from) { for (size_t i = 0; i < sizeof from; i++) update(at + (int)i, ((const uint8_t *)&from)[i]); return from; }
};

extern EEPROMClass EEPROM;

#endif
