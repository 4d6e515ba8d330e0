/* A UART in software, at the pins where the board has a line. */
#ifndef SoftwareSerial_h
#define SoftwareSerial_h

#include "Arduino.h"

#pragma pack(push)
#pragma pack()

#define _SS_MAX_RX_BUFF 64

class SoftwareSerial : public Stream {
public:
    SoftwareSerial(uint8_t rx, uint8_t tx, bool inverse = false) : rx_(rx), tx_(tx) { (void)inverse; }
    ~SoftwareSerial() { end(); }
    void begin(long baud);
    bool listen();
    bool stopListening();
    bool isListening() { return listener_ == this; }
    void end() { stopListening(); }
    bool overflow();
    int16_t available() override;
    int16_t read() override;
    int16_t peek() override;
    void flush() override {}
    size_t write(uint8_t data) override;
    using Print::write;
    operator bool() const { return true; }

private:
    static SoftwareSerial *listener_;
    void receive(bool on);
    uint8_t rx_, tx_;
    int to_ = -1, from_ = -1; /* the lines at its pins */
    uint32_t byte_us_ = 0;
};

#pragma pack(pop)

#endif
