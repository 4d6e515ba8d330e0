/* Connections of TCP, for what the API and libraries call them. */
#ifndef TCP_H
#define TCP_H

#include <functional>
#include <memory>
#include <string>

#include "IPAddress.h"

namespace tcp {

struct Connection {
    enum State { CONNECTING, OPEN, ENDED, CLOSED }; /* ENDED: the other end has; what has come is there yet */
    uint8_t socket = 0;
    State state = CONNECTING;
    IPAddress remote;
    uint16_t remote_port = 0, local_port = 0;
    std::string in;

    void send(const void *data, size_t size);
    std::string take(size_t size);
    void close();
    ~Connection() { close(); }
};
typedef std::shared_ptr<Connection> Shared;

Shared connect(IPAddress address, uint16_t port);
int listen(uint16_t port); /* a server's number, -1 without room */
void stop_listening(int server);
bool waiting(int server);
Shared accept(int server); /* null if none waits */
extern uint32_t changes;   /* counts what has come */

} // namespace tcp

#endif
