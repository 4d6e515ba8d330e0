/* UDP over the WiFi. */
#ifndef WIFIUDP_H
#define WIFIUDP_H

#include "Udp.h"

class WiFiUDP : public UDP {
public:
    ~WiFiUDP() { stop(); }
    uint8_t begin(uint16_t port) override;
    uint8_t begin(IPAddress, uint16_t port) { return begin(port); }
    uint8_t beginMulticast(IPAddress, uint16_t port) { return begin(port); }
    void stop() override;
    int beginPacket() { return beginPacket(from_, from_port_); }
    int beginPacket(IPAddress address, uint16_t port) override;
    int beginPacket(const char *host, uint16_t port) override;
    int endPacket() override;
    size_t write(uint8_t data) override { return write(&data, 1); }
    size_t write(const uint8_t *data, size_t size) override;
    using Print::write;
    int parsePacket() override;
    int available() override;
    int read() override;
    int peek() override;
    int read(unsigned char *to, size_t size) override;
    int read(char *to, size_t size) override { return read((unsigned char *)to, size); }
    void flush() override {}
    IPAddress remoteIP() override { return from_; }
    uint16_t remotePort() override { return from_port_; }

private:
    int socket_ = -1;
    IPAddress to_, from_;
    uint16_t to_port_ = 0, from_port_ = 0;
    std::string out_, in_;
    size_t next_ = 0;
};

typedef WiFiUDP NetworkUDP;

#endif
