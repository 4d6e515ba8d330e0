/* I2C, as its master: the parts of the profile are on every bus, at any pins. */
#ifndef TwoWire_h
#define TwoWire_h

#include "Arduino.h"

#define I2C_BUFFER_LENGTH 128

class TwoWire : public Stream {
public:
    explicit TwoWire(uint8_t) {}
    bool begin() { return begin(SDA, SCL); }
    bool begin(int sda, int scl, uint32_t hertz = 0);
    bool begin(uint8_t address, int sda, int scl, uint32_t hertz) __attribute__((error("the board is the master of its I2C bus, and nothing there talks to it as a slave: leave it out")));
    bool setPins(int, int) { return true; }
    bool end() { return true; }
    bool setClock(uint32_t hertz) { clock_ = hertz; return true; }
    uint32_t getClock() { return clock_; }
    void setTimeOut(uint16_t) {}
    size_t setBufferSize(size_t size) { return size; }
    void beginTransmission(int address);
    uint8_t endTransmission(bool stop = true);
    size_t requestFrom(int address, int count, int stop = 1);
    size_t write(uint8_t data) override;
    size_t write(int v) { return write((uint8_t)v); }
    size_t write(unsigned v) { return write((uint8_t)v); }
    size_t write(long v) { return write((uint8_t)v); }
    size_t write(unsigned long v) { return write((uint8_t)v); }
    using Print::write;
    int available() override;
    int read() override;
    int peek() override;

private:
    void pass(size_t bytes);
    uint32_t clock_ = 100000;
    uint8_t address_ = 0;
    std::string out_, in_;
    size_t next_ = 0;
};

extern TwoWire Wire, Wire1;

#endif
