/* UARTs, each at any pins: a line of the profile is at its UART, or at the pins that it names. */
#ifndef HardwareSerial_h
#define HardwareSerial_h

#include "Stream.h"

/* Of data bits, parity and stop bits: a byte takes 10 bits on the line with each. */
enum SerialConfig : uint32_t {
    SERIAL_5N1 = 0x8000010, SERIAL_6N1 = 0x8000014, SERIAL_7N1 = 0x8000018, SERIAL_8N1 = 0x800001c,
    SERIAL_5N2 = 0x8000030, SERIAL_6N2 = 0x8000034, SERIAL_7N2 = 0x8000038, SERIAL_8N2 = 0x800003c,
    SERIAL_5E1 = 0x8000012, SERIAL_6E1 = 0x8000016, SERIAL_7E1 = 0x800001a, SERIAL_8E1 = 0x800001e,
    SERIAL_5E2 = 0x8000032, SERIAL_6E2 = 0x8000036, SERIAL_7E2 = 0x800003a, SERIAL_8E2 = 0x800003e,
    SERIAL_5O1 = 0x8000013, SERIAL_6O1 = 0x8000017, SERIAL_7O1 = 0x800001b, SERIAL_8O1 = 0x800001f,
    SERIAL_5O2 = 0x8000033, SERIAL_6O2 = 0x8000037, SERIAL_7O2 = 0x800003b, SERIAL_8O2 = 0x800003f,
};

class HardwareSerial : public Stream {
public:
    explicit HardwareSerial(int number) : number_((uint8_t)number) {}
    void begin(unsigned long baud, uint32_t config = SERIAL_8N1, int8_t rx = -1, int8_t tx = -1, bool invert = false, unsigned long timeout = 20000, uint8_t full = 112);
    void end();
    void updateBaudRate(unsigned long baud);
    int available() override;
    int read() override;
    int peek() override;
    size_t read(uint8_t *to, size_t size);
    size_t read(char *to, size_t size) { return read((uint8_t *)to, size); }
    int availableForWrite() override;
    void flush() override;
    void flush(bool) { flush(); }
    size_t write(uint8_t data) override;
    size_t write(int v) { return write((uint8_t)v); }
    size_t write(unsigned v) { return write((uint8_t)v); }
    size_t write(long v) { return write((uint8_t)v); }
    size_t write(unsigned long v) { return write((uint8_t)v); }
    using Print::write;
    uint32_t baudRate() { return baud_; }
    operator bool() const { return baud_ != 0; }
    bool setPins(int8_t rx, int8_t tx, int8_t = -1, int8_t = -1) { rx_ = rx; tx_ = tx; return true; }
    void setDebugOutput(bool) {}
    size_t setRxBufferSize(size_t size);
    size_t setTxBufferSize(size_t size) { return size; }
    void setRxFIFOFull(uint8_t) {}
    void setRxTimeout(uint8_t) {}
    void setHwFlowCtrlMode(uint8_t = 0, uint8_t = 64) {}
    void onReceive(std::function<void()> handler, bool = false) { handler_ = handler; }
    const std::function<void()> &handler() const { return handler_; }

private:
    uint8_t number_;
    int8_t rx_ = -1, tx_ = -1;
    int from_ = -1, to_ = -1; /* the lines that it sends to and receives from */
    uint32_t baud_ = 0;
    std::function<void()> handler_;
};

extern HardwareSerial Serial, Serial1;
#ifndef BOARD_ESP32C3
extern HardwareSerial Serial2;
#endif
#define Serial0 Serial

#endif
