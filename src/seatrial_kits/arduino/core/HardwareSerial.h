/* UARTs: 64 bytes each way, at the baud rate of the line. */
#ifndef HardwareSerial_h
#define HardwareSerial_h

#include "Stream.h"

#define SERIAL_8N1 0x06
#define SERIAL_8N2 0x0E
#define SERIAL_8E1 0x26
#define SERIAL_8O1 0x36

class HardwareSerial : public Stream {
public:
    explicit HardwareSerial(uint8_t number) : number_(number) {}
    void begin(uint32_t baud, uint8_t config = SERIAL_8N1);
    void end();
    int16_t available() override;
    int16_t read() override;
    int16_t peek() override;
    int availableForWrite() override;
    void flush() override;
    size_t write(uint8_t data) override;
    size_t write(int v) { return write((uint8_t)v); }
    size_t write(unsigned v) { return write((uint8_t)v); }
    size_t write(long v) { return write((uint8_t)v); }
    size_t write(unsigned long v) { return write((uint8_t)v); }
    using Print::write;
    operator bool() const { return true; }

private:
    uint8_t number_;
};

#define SERIAL_RX_BUFFER_SIZE 64
#define SERIAL_TX_BUFFER_SIZE 64
extern HardwareSerial Serial;
#ifdef BOARD_MEGA
extern HardwareSerial Serial1, Serial2, Serial3;
#endif

#endif
