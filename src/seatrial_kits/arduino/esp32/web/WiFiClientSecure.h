/* A connection with TLS, whose other ends are beyond this machine: none opens. */
#ifndef WIFICLIENTSECURE_H
#define WIFICLIENTSECURE_H

#include "WiFi.h"

class WiFiClientSecure : public WiFiClient {
public:
    int connect(IPAddress, uint16_t) override { return 0; }
    int connect(const char *, uint16_t) override { return 0; }
    int connect(IPAddress, uint16_t, int32_t) override { return 0; }
    int connect(const char *, uint16_t, int32_t) override { return 0; }
    void setInsecure() {}
    void setCACert(const char *) {}
    void setCACertBundle(const uint8_t *) {}
    void setCACertBundle(const uint8_t *, size_t) {}
    void setCertificate(const char *) {}
    void setPrivateKey(const char *) {}
    void setPreSharedKey(const char *, const char *) {}
    bool verify(const char *, const char *) { return false; }
    void setHandshakeTimeout(unsigned long) {}
    int lastError(char *to, size_t size) { strlcpy(to, "no TLS here", size); return -1; }
};

typedef WiFiClientSecure NetworkClientSecure;

#endif
