/* An IPv4 address. */
#ifndef IPAddress_h
#define IPAddress_h

#include "WString.h"
#include "Print.h"

class IPAddress : public Printable {
public:
    IPAddress(uint32_t address = 0) : address_(address) {}
    IPAddress(uint8_t a, uint8_t b, uint8_t c, uint8_t d) : address_((uint32_t)d << 24 | c << 16 | b << 8 | a) {}
    operator uint32_t() const { return address_; }
    uint8_t operator[](int at) const { return (uint8_t)(address_ >> 8 * at); }
    uint8_t &operator[](int at) { return ((uint8_t *)&address_)[at]; }
    bool operator==(const IPAddress &other) const { return address_ == other.address_; }
    bool operator!=(const IPAddress &other) const { return address_ != other.address_; }
    bool fromString(const char *text);
    bool fromString(const String &text) { return fromString(text.c_str()); }
    String toString() const;
    size_t printTo(Print &to) const override { return to.print(toString()); }

private:
    uint32_t address_; /* the first byte lowest */
};

const IPAddress INADDR_NONE(0);

#endif
