/* Messages between the WiFi and the sockets in the process that steps the board: see attached/network.py. */
#ifndef NETWORK_H
#define NETWORK_H

#include <stdint.h>

#include <string>

namespace network {

/* ADDRESS to PACKET are UDP's; of TCP a socket is a server (LISTEN, ACCEPT) or a connection. */
enum Kind : uint8_t { ADDRESS, OPEN, CLOSE, PACKET, LISTEN, ACCEPT, CONNECT, DATA, TAKEN, SHUT };
#pragma pack(push, 1)
struct Head {
    Kind kind;
    uint8_t socket;
    uint16_t port;
    uint32_t address;
};
#pragma pack(pop)

void put(Kind kind, int socket, uint16_t port, uint32_t address, const std::string &data = "");
void take_tcp(const Head &head, const char *data, size_t size);

} // namespace network

#endif
