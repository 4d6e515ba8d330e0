/* I2C, as its master. */
#ifndef Wire_h
#define Wire_h

#include "Arduino.h"

#pragma pack(push)
#pragma pack()

#define BUFFER_LENGTH 32
#define WIRE_HAS_END 1
#define WIRE_HAS_TIMEOUT 1

#define AS_SLAVE __attribute__((error("the board is the master of its I2C bus, and nothing there talks to it as a slave: leave it out")))

class TwoWire : public Stream {
public:
    void begin() {}
    void begin(int address) AS_SLAVE;
    void onReceive(void (*handler)(int16_t)) AS_SLAVE;
    void onRequest(void (*handler)()) AS_SLAVE;
    void end() {}
    void setClock(uint32_t hertz) { clock_ = hertz; }
    void setWireTimeout(uint32_t = 25000, bool = false) {}
    bool getWireTimeoutFlag() { return false; }
    void clearWireTimeoutFlag() {}
    void beginTransmission(uint8_t address);
    void beginTransmission(int address) { beginTransmission((uint8_t)address); }
    uint8_t endTransmission(bool stop = true);
    uint8_t requestFrom(uint8_t address, uint8_t count, uint8_t stop = 1);
    uint8_t requestFrom(int address, int count, int stop = 1) { return requestFrom((uint8_t)address, (uint8_t)count, (uint8_t)stop); }
    size_t write(uint8_t data) override;
    size_t write(int v) { return write((uint8_t)v); }
    size_t write(unsigned v) { return write((uint8_t)v); }
    size_t write(long v) { return write((uint8_t)v); }
    size_t write(unsigned long v) { return write((uint8_t)v); }
    using Print::write;
    int16_t available() override;
    int16_t read() override;
    int16_t peek() override;

private:
    void pass(unsigned bytes);
    uint32_t clock_ = 100000;
    uint8_t address_ = 0, out_[BUFFER_LENGTH], in_[BUFFER_LENGTH], written_ = 0, got_ = 0, next_ = 0;
};

extern TwoWire Wire;

#pragma pack(pop)

#endif
