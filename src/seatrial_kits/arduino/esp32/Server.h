/* A server, as libraries take it. */
#ifndef server_h
#define server_h

#include "Print.h"

class Server : public Print {
public:
    virtual void begin(uint16_t port = 0) = 0;
};

#endif
