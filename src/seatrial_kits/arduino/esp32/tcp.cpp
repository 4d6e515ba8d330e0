/* TCP: connections, and WiFiClient and WiFiServer on them. */
#include "tcp.h"

#include <deque>
#include <map>

#include "WiFi.h"
#include "machine.h"
#include "network.h"
#include "tasks.h"

using machine::charge;

namespace tcp {

uint32_t changes;

namespace {

constexpr int SERVERS = 8, FIRST = 16, LAST = 127; /* sockets that the board opens; the other side's are above */
constexpr size_t SEGMENT = 1436;

struct Listener {
    uint16_t port = 0;
    std::deque<Shared> waiting;
} servers[SERVERS];
std::map<uint8_t, std::weak_ptr<Connection>> connections;

} // namespace

Shared connect(IPAddress address, uint16_t port)
{
    for (int socket = FIRST; socket <= LAST; socket++) {
        if (!connections[(uint8_t)socket].expired())
            continue;
        Shared made = std::make_shared<Connection>();
        made->socket = (uint8_t)socket;
        made->remote = address;
        made->remote_port = port;
        connections[made->socket] = made;
        network::put(network::CONNECT, socket, port, address);
        return made;
    }
    return nullptr;
}

int listen(uint16_t port)
{
    for (int server = 0; server < SERVERS; server++) {
        if (servers[server].port)
            continue;
        servers[server].port = port;
        network::put(network::LISTEN, server, port, 0);
        return server;
    }
    return -1;
}

void stop_listening(int server)
{
    if (server < 0)
        return;
    network::put(network::SHUT, server, 0, 0);
    servers[server] = Listener();
}

bool waiting(int server) { return server >= 0 && !servers[server].waiting.empty(); }

Shared accept(int server)
{
    if (!waiting(server))
        return nullptr;
    Shared one = servers[server].waiting.front();
    servers[server].waiting.pop_front();
    return one;
}

void Connection::send(const void *data, size_t size)
{
    charge((uint32_t)(1600 + 16 * size)); /* 0.1 ms, and 1 MB/s */
    for (size_t at = 0; at < size && state == OPEN; at += SEGMENT)
        network::put(network::DATA, socket, 0, 0, std::string((const char *)data + at, std::min(SEGMENT, size - at)));
}

std::string Connection::take(size_t size)
{
    std::string taken = in.substr(0, size);
    in.erase(0, size);
    if (!taken.empty() && state == OPEN)
        network::put(network::TAKEN, socket, (uint16_t)taken.size(), 0);
    return taken;
}

void Connection::close()
{
    if (state != CLOSED)
        network::put(network::SHUT, socket, 0, 0);
    state = CLOSED;
}

} // namespace tcp

void network::take_tcp(const Head &head, const char *data, size_t size)
{
    using namespace tcp;
    changes++;
    if (head.kind == ACCEPT && size) {
        Listener &server = servers[data[0] % SERVERS];
        Shared made = std::make_shared<Connection>();
        made->socket = head.socket;
        made->state = Connection::OPEN;
        made->remote = IPAddress(head.address);
        made->remote_port = head.port;
        made->local_port = server.port;
        connections[made->socket] = made;
        server.waiting.push_back(made);
        return;
    }
    Shared one = connections[head.socket].lock();
    if (!one || one->state == Connection::CLOSED)
        return;
    if (head.kind == CONNECT)
        one->state = Connection::OPEN, one->local_port = head.port;
    else if (head.kind == DATA)
        one->in.append(data, size);
    else if (head.kind == SHUT)
        one->state = one->state == Connection::OPEN ? Connection::ENDED : Connection::CLOSED;
}

/* ------------------------------------------------------------------ WiFiClient and WiFiServer */

int WiFiClient::connect(IPAddress address, uint16_t port, int32_t timeout_ms)
{
    charge(16000);
    one_ = tcp::connect(address, port);
    if (!one_)
        return 0;
    tcp::Connection &one = *one_;
    auto known = [&one] { return one.state != tcp::Connection::CONNECTING; };
    wait_until(machine::now + 16000ull * (uint64_t)timeout_ms, known);
    if (one.state != tcp::Connection::OPEN)
        one_.reset();
    return one_ != nullptr;
}

int WiFiClient::connect(const char *host, uint16_t port, int32_t timeout_ms)
{
    IPAddress found;
    return WiFi.hostByName(host, found) ? connect(found, port, timeout_ms) : 0;
}

size_t WiFiClient::write(const uint8_t *data, size_t size)
{
    if (!one_ || one_->state != tcp::Connection::OPEN)
        return 0;
    one_->send(data, size);
    return size;
}

size_t WiFiClient::write(Stream &from)
{
    size_t n = 0;
    for (uint8_t some[1436]; from.available() > 0;) {
        size_t size = 0;
        for (int c; size < sizeof some && (c = from.read()) >= 0;)
            some[size++] = (uint8_t)c;
        n += write(some, size);
        if (!size)
            break;
    }
    return n;
}

int WiFiClient::available() { charge(16); return one_ ? (int)one_->in.size() : 0; }
int WiFiClient::peek() { return one_ && !one_->in.empty() ? (uint8_t)one_->in[0] : -1; }
void WiFiClient::flush() { if (one_) one_->take(one_->in.size()); }

int WiFiClient::read()
{
    uint8_t byte;
    return read(&byte, 1) == 1 ? byte : -1;
}

int WiFiClient::read(uint8_t *to, size_t size)
{
    charge((uint32_t)(16 + 2 * size));
    if (!one_ || one_->in.empty())
        return -1;
    std::string taken = one_->take(size);
    memcpy(to, taken.data(), taken.size());
    return (int)taken.size();
}

uint8_t WiFiClient::connected()
{
    charge(16);
    return one_ && (one_->state == tcp::Connection::OPEN || !one_->in.empty());
}

void WiFiClient::stop() { if (one_) one_->close(); one_.reset(); }
IPAddress WiFiClient::remoteIP() const { return one_ ? one_->remote : IPAddress(); }
uint16_t WiFiClient::remotePort() const { return one_ ? one_->remote_port : 0; }
uint16_t WiFiClient::localPort() const { return one_ ? one_->local_port : 0; }
IPAddress WiFiClient::localIP() const { return WiFi.localIP(); }

void WiFiServer::begin(uint16_t port)
{
    charge(800);
    port_ = port ? port : port_;
    if (server_ < 0)
        server_ = tcp::listen(port_);
}

void WiFiServer::end() { tcp::stop_listening(server_); server_ = -1; }
bool WiFiServer::hasClient() { charge(16); return tcp::waiting(server_); }
WiFiClient WiFiServer::accept() { charge(160); return WiFiClient(tcp::accept(server_)); }
