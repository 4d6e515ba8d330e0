/* A connection, as libraries take it. */
#ifndef client_h
#define client_h

#include "IPAddress.h"
#include "Stream.h"

class Client : public Stream {
public:
    virtual int connect(IPAddress address, uint16_t port) = 0;
    virtual int connect(const char *host, uint16_t port) = 0;
    virtual size_t write(uint8_t data) = 0;
    virtual size_t write(const uint8_t *data, size_t size) = 0;
    using Print::write;
    virtual int read(uint8_t *to, size_t size) = 0;
    using Stream::read;
    virtual void stop() = 0;
    virtual uint8_t connected() = 0;
    virtual operator bool() = 0;
};

#endif
