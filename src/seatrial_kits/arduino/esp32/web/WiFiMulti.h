/* Several networks, of which one is there: the first. */
#ifndef WIFIMULTI_H
#define WIFIMULTI_H

#include "WiFi.h"

class WiFiMulti {
public:
    bool addAP(const char *ssid, const char * = nullptr) { ssid_ = ssid_.length() ? ssid_ : String(ssid); return true; }
    uint8_t run(uint32_t = 5000) { return WiFi.isConnected() ? WL_CONNECTED : WiFi.begin(ssid_); }

private:
    String ssid_;
};

#endif
