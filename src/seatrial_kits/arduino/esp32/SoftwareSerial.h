/* The library EspSoftwareSerial as far as a line of the profile at its pins goes. */
#ifndef SoftwareSerial_h
#define SoftwareSerial_h

#include "Arduino.h"

enum Config { SWSERIAL_8N1 = 3 };

class SoftwareSerial : public HardwareSerial {
public:
    SoftwareSerial() : HardwareSerial(board::UARTS - 1) {}
    SoftwareSerial(int8_t rx, int8_t tx = -1, bool = false) : HardwareSerial(board::UARTS - 1) { setPins(rx, tx); }
    void begin(unsigned long baud) { HardwareSerial::begin(baud); }
    void begin(unsigned long baud, Config, int8_t rx = -1, int8_t tx = -1, bool = false, int = 64) { HardwareSerial::begin(baud, SERIAL_8N1, rx, tx); }
    bool listen() { return true; }
    bool isListening() { return true; }
    bool stopListening() { return true; }
    void enableIntTx(bool) {}
    bool overflow() { return false; }
};

namespace EspSoftwareSerial { typedef SoftwareSerial UART; }

#endif
