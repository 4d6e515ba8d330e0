/* A connection of TCP over the WiFi; copies are the same connection. */
#ifndef WIFICLIENT_H
#define WIFICLIENT_H

#include "Arduino.h"
#include "tcp.h"

class WiFiClient : public Client {
public:
    WiFiClient() {}
    explicit WiFiClient(tcp::Shared one) : one_(one) {}
    int connect(IPAddress address, uint16_t port) override { return connect(address, port, 3000); }
    int connect(const char *host, uint16_t port) override { return connect(host, port, 3000); }
    virtual int connect(IPAddress address, uint16_t port, int32_t timeout_ms);
    virtual int connect(const char *host, uint16_t port, int32_t timeout_ms);
    size_t write(uint8_t data) override { return write(&data, 1); }
    size_t write(const uint8_t *data, size_t size) override;
    size_t write(Stream &from); /* to its end */
    using Print::write;
    int available() override;
    int read() override;
    int read(uint8_t *to, size_t size) override;
    int peek() override;
    void flush() override; /* drops what has come */
    void stop() override;
    uint8_t connected() override;
    operator bool() override { return connected(); }
    bool operator==(const WiFiClient &other) const { return one_ == other.one_; }
    bool operator!=(const WiFiClient &other) const { return one_ != other.one_; }
    int setTimeout(uint32_t seconds) { Stream::setTimeout(1000 * seconds); return 0; }
    int setNoDelay(bool) { return 0; }
    IPAddress remoteIP() const;
    uint16_t remotePort() const;
    IPAddress localIP() const;
    uint16_t localPort() const;

private:
    tcp::Shared one_;
};

typedef WiFiClient NetworkClient; /* Of Arduino-ESP32 3. */

#endif
