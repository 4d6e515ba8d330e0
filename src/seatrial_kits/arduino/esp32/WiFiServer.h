/* A server of TCP over the WiFi. */
#ifndef WIFISERVER_H
#define WIFISERVER_H

#include "WiFiClient.h"

class WiFiServer : public Server {
public:
    explicit WiFiServer(uint16_t port = 80, uint8_t = 4) : port_(port) {}
    WiFiServer(IPAddress, uint16_t port = 80, uint8_t = 4) : port_(port) {}
    ~WiFiServer() { end(); }
    void begin(uint16_t port = 0) override;
    void begin(uint16_t port, int) { begin(port); }
    WiFiClient available() { return accept(); }
    WiFiClient accept();
    bool hasClient();
    size_t write(uint8_t) override { return 0; } /* as the board's */
    size_t write(const uint8_t *, size_t) override { return 0; }
    using Print::write;
    void setNoDelay(bool) {}
    bool getNoDelay() { return true; }
    void end();
    void close() { end(); }
    void stop() { end(); }
    operator bool() { return server_ >= 0; }

private:
    uint16_t port_;
    int server_ = -1;
};

typedef WiFiServer NetworkServer;

#endif
