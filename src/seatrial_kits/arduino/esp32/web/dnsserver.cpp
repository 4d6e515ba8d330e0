/* Answers of RFC 1035: the question as it came, and one address, or a refusal of other names. */
#include "DNSServer.h"

bool DNSServer::start(uint16_t port, const String &name, const IPAddress &address)
{
    name_ = name, address_ = address;
    name_.toLowerCase();
    return udp_.begin(port);
}

void DNSServer::processNextRequest()
{
    constexpr int HEAD = 12;
    uint8_t asked[512];
    int size = udp_.parsePacket();
    if (size <= HEAD || size > (int)sizeof asked || udp_.read(asked, (size_t)size) != size || asked[2] & 0x80)
        return;
    String name;
    int at = HEAD;
    for (; at < size && asked[at]; at += asked[at] + 1)
        name += String(name.length() ? "." : "") + String((char *)asked + at + 1, std::min((unsigned)asked[at], (unsigned)(size - at - 1)));
    name.toLowerCase();
    bool known = (name_ == "*" || name == name_ || name == "www." + name_) && at + 5 <= size;
    int question = std::min(at + 5, size);
    const uint8_t flags[] = {(uint8_t)(asked[2] | 0x80), (uint8_t)(known ? 0 : (uint8_t)refusal_), 0, 1, 0, (uint8_t)known, 0, 0, 0, 0};
    const uint8_t answer[] = {0xC0, HEAD, 0, 1, 0, 1, (uint8_t)(ttl_ >> 24), (uint8_t)(ttl_ >> 16), (uint8_t)(ttl_ >> 8), (uint8_t)ttl_, 0, 4, address_[0], address_[1], address_[2], address_[3]};
    udp_.beginPacket(udp_.remoteIP(), udp_.remotePort());
    udp_.write(asked, 2);
    udp_.write(flags, sizeof flags);
    udp_.write(asked + HEAD, (size_t)(question - HEAD));
    if (known)
        udp_.write(answer, sizeof answer);
    udp_.endPacket();
}
