/* EEPROM: a copy in memory of bytes in the flash, written by commit(). Its content at the start is the component's. */
#ifndef EEPROM_h
#define EEPROM_h

#include "Arduino.h"

class EEPROMClass {
public:
    bool begin(size_t size);
    bool commit();
    void end() { commit(); data_.clear(); }
    uint8_t read(int at) { return at >= 0 && (size_t)at < data_.size() ? (uint8_t)data_[(size_t)at] : 0; }
    void write(int at, uint8_t value) { if (at >= 0 && (size_t)at < data_.size()) data_[(size_t)at] = (char)value; }
    void update(int at, uint8_t value) { write(at, value); }
    uint16_t length() { return (uint16_t)data_.size(); }
    uint8_t &operator[](int at) { return (uint8_t &)data_[(size_t)at]; }
    uint8_t *getDataPtr() { return (uint8_t *)&data_[0]; }

    template <typename T> T &get(int at, T &to) { move(at, &to, sizeof to, false); return to; }
    template <typename T> const T &put(int at, const T &from) { move(at, (void *)&from, sizeof from, true); return from; }
    size_t readBytes(int at, void *to, size_t size) { return move(at, to, size, false); }
    size_t writeBytes(int at, const void *from, size_t size) { return move(at, (void *)from, size, true); }
    String readString(int at) { return at >= 0 && (size_t)at < data_.size() ? String(data_.c_str() + at) : String(); }
    size_t writeString(int at, const String &text) { return move(at, (void *)text.c_str(), text.length() + 1, true) ? text.length() : 0; }
    template <typename T> T readAll(int at, T &to) { return get(at, to); }
    template <typename T> size_t writeAll(int at, const T &from) { put(at, from); return sizeof from; }
#define SKETCH_EEPROM(name, type) \
    type read##name(int at) { type value = {}; return get(at, value); } \
    size_t write##name(int at, type value) { put(at, value); return sizeof value; }
    SKETCH_EEPROM(Byte, uint8_t)
    SKETCH_EEPROM(Char, int8_t)
    SKETCH_EEPROM(UChar, uint8_t)
    SKETCH_EEPROM(Short, int16_t)
    SKETCH_EEPROM(UShort, uint16_t)
    SKETCH_EEPROM(Int, int32_t)
    SKETCH_EEPROM(UInt, uint32_t)
    SKETCH_EEPROM(Long, int32_t)
    SKETCH_EEPROM(ULong, uint32_t)
    SKETCH_EEPROM(Float, float)
    SKETCH_EEPROM(Double, double)
    SKETCH_EEPROM(Bool, bool)
#undef SKETCH_EEPROM

private:
    size_t move(int at, void *data, size_t size, bool in);
    std::string data_;
};

extern EEPROMClass EEPROM;

#endif
