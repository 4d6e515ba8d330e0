/* A name server that says the board's address to each question, as pages of an access point have it. */
#ifndef DNSSERVER_H
#define DNSSERVER_H

#include "WiFi.h"

enum class DNSReplyCode : uint8_t { NoError, FormError, ServerFailure, NonExistentDomain, NotImplemented, Refused };

class DNSServer {
public:
    bool start(uint16_t port, const String &name, const IPAddress &address);
    bool start() { return start(53, "*", WiFi.softAPIP()); }
    void processNextRequest();
    void stop() { udp_.stop(); }
    void setErrorReplyCode(const DNSReplyCode &code) { refusal_ = code; }
    void setTTL(uint32_t seconds) { ttl_ = seconds; }

private:
    WiFiUDP udp_;
    String name_;
    IPAddress address_;
    uint32_t ttl_ = 60;
    DNSReplyCode refusal_ = DNSReplyCode::NonExistentDomain;
};

#endif
