/* EEPROM: its content at the start is the component's. */
#ifndef EEPROM_h
#define EEPROM_h

#include "Arduino.h"

#pragma pack(push)
#pragma pack()

#ifdef BOARD_MEGA
#define EEPROM_SIZE 4096
#else
#define EEPROM_SIZE 1024
#endif

/* One byte of it, as EEPROM[at] gives. */
class EERef {
public:
    explicit EERef(int at) : at_(at) {}
    operator uint8_t() const;
    EERef &operator=(uint8_t value);
    EERef &operator=(const EERef &other) { return *this = (uint8_t)other; }
    EERef &operator+=(uint8_t value) { return *this = (uint8_t)(*this + value); }
    EERef &operator-=(uint8_t value) { return *this = (uint8_t)(*this - value); }
    EERef &operator|=(uint8_t value) { return *this = (uint8_t)(*this | value); }
    EERef &operator&=(uint8_t value) { return *this = (uint8_t)(*this & value); }
    EERef &operator^=(uint8_t value) { return *this = (uint8_t)(*this ^ value); }
    EERef &operator++() { return *this += 1; }
    EERef &operator--() { return *this -= 1; }
    uint8_t operator++(int) { uint8_t before = *this; ++*this; return before; }
    uint8_t operator--(int) { uint8_t before = *this; --*this; return before; }
    EERef &update(uint8_t value) { return *this = value; }

private:
    int at_;
};

/* The place of a byte of it, for loops over all. */
struct EEPtr {
    int at;
    bool operator!=(const EEPtr &other) const { return at != other.at; }
    EERef operator*() const { return EERef(at); }
    EEPtr &operator++() { at++; return *this; }
};

class EEPROMClass {
public:
    EEPtr begin() { return {0}; }
    EEPtr end() { return {EEPROM_SIZE}; }
    EERef operator[](int at) { return EERef(at); }
    uint8_t read(int at);
    void write(int at, uint8_t value);
    void update(int at, uint8_t value) { if (read(at) != value) write(at, value); }
    uint16_t length() { return EEPROM_SIZE; }
    template <typename T> T &get(int at, T &to) { for (size_t i = 0; i < sizeof to; i++) ((uint8_t *)&to)[i] = read(at + (int)i); return to; }
    template <typename T> const T &put(int at, const T &from) { for (size_t i = 0; i < sizeof from; i++) update(at + (int)i, ((const uint8_t *)&from)[i]); return from; }
};

extern EEPROMClass EEPROM;

inline EERef::operator uint8_t() const { return EEPROM.read(at_); }
inline EERef &EERef::operator=(uint8_t value) { EEPROM.update(at_, value); return *this; }

#pragma pack(pop)

#endif
