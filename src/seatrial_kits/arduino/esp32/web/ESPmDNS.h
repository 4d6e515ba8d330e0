/* The board's name in its network, which other programs do not ask for here: they have its address. */
#ifndef ESPMDNS_H
#define ESPMDNS_H

#include "WiFi.h"

class MDNSResponder {
public:
    bool begin(const String &) { return true; }
    bool begin(const char *) { return true; }
    void end() {}
    void setInstanceName(const String &) {}
    bool addService(const String &, const String &, uint16_t) { return true; }
    bool addServiceTxt(const String &, const String &, const String &, const String &) { return true; }
    void enableArduino(uint16_t = 3232, bool = false) {}
    void disableArduino() {}
    void enableWorkstation() {}
    IPAddress queryHost(const String &, uint32_t = 2000) { return IPAddress(); } /* nobody has a name */
    int queryService(const String &, const String &) { return 0; }
    String hostname(int) { return String(); }
    IPAddress IP(int) { return IPAddress(); }
    uint16_t port(int) { return 0; }
};

inline MDNSResponder MDNS;

#endif
