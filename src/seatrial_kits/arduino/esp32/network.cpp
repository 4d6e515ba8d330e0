/* WiFi and UDP; their messages go to and come from the sockets in the process that steps the board. */
#include <deque>

#include "WiFi.h"
#include "machine.h"
#include "network.h"

using machine::charge;
using namespace network;

namespace {

constexpr int SOCKETS = 8;
constexpr size_t MOST = 1460, WAITING = 16; /* packets beyond are lost */

struct Socket {
    bool open = false;
    std::deque<std::string> packets; /* each with its head */
} sockets[SOCKETS];
uint32_t own_address; /* 0: alone */

void take(const uint8_t *data, size_t size)
{
    Head head;
    if (size < sizeof head)
        return;
    memcpy(&head, data, sizeof head);
    if (head.kind == ADDRESS)
        own_address = head.address;
    else if (head.kind >= LISTEN)
        take_tcp(head, (const char *)data + sizeof head, size - sizeof head);
    else if (head.socket < SOCKETS && sockets[head.socket].open && sockets[head.socket].packets.size() < WAITING)
        sockets[head.socket].packets.emplace_back((const char *)data, size);
}

bool listens = (machine::receive_messages(machine::NETWORK_MESSAGES, take), true);

} // namespace

void network::put(Kind kind, int socket, uint16_t port, uint32_t address, const std::string &data)
{
    Head head = {kind, (uint8_t)socket, port, address};
    std::string whole((const char *)&head, sizeof head);
    whole += data;
    machine::send_message(machine::NETWORK_MESSAGES, whole.data(), whole.size());
}

WiFiClass WiFi;

wl_status_t WiFiClass::begin(const char *ssid, const char *, int32_t, const uint8_t *, bool)
{
    charge(16000);
    ssid_ = ssid;
    joined_ = true;
    for (WiFiEvent_t event : {ARDUINO_EVENT_WIFI_STA_START, ARDUINO_EVENT_WIFI_STA_CONNECTED, ARDUINO_EVENT_WIFI_STA_GOT_IP})
        tell(event);
    return WL_CONNECTED;
}

void WiFiClass::tell(WiFiEvent_t event)
{
    for (const auto &[one, handler] : std::vector(handlers_))
        if (handler && (one == event || one == ARDUINO_EVENT_MAX))
            handler(event, WiFiEventInfo_t());
}

bool WiFiClass::softAP(const char *ssid, const char *, int, int, int, bool)
{
    charge(16000);
    ssid_ = ssid;
    tell(ARDUINO_EVENT_WIFI_AP_START);
    return true;
}

IPAddress WiFiClass::localIP() { return own_address ? IPAddress(own_address) : IPAddress(192, 168, 4, 1); }

int WiFiClass::hostByName(const char *host, IPAddress &found)
{
    if (!found.fromString(host))
        found = IPAddress(127, 0, 0, 1);
    return 1;
}

uint8_t WiFiUDP::begin(uint16_t port)
{
    stop();
    charge(800);
    for (int each = 0; each < SOCKETS; each++) {
        if (sockets[each].open)
            continue;
        sockets[socket_ = each].open = true;
        put(OPEN, each, port, 0);
        return 1;
    }
    return 0;
}

void WiFiUDP::stop()
{
    if (socket_ < 0)
        return;
    put(CLOSE, socket_, 0, 0);
    sockets[socket_] = Socket();
    socket_ = -1;
}

int WiFiUDP::beginPacket(IPAddress address, uint16_t port)
{
    if (socket_ < 0 && !begin(0))
        return 0;
    to_ = address;
    to_port_ = port;
    out_.clear();
    return 1;
}

int WiFiUDP::beginPacket(const char *host, uint16_t port)
{
    IPAddress found;
    return WiFi.hostByName(host, found) ? beginPacket(found, port) : 0;
}

int WiFiUDP::endPacket()
{
    charge(1600); /* 0.1 ms */
    if (socket_ < 0)
        return 0;
    put(PACKET, socket_, to_port_, to_, out_);
    out_.clear();
    return 1;
}

size_t WiFiUDP::write(const uint8_t *data, size_t size)
{
    charge(2);
    size_t taken = std::min(size, MOST - out_.size());
    out_.append((const char *)data, taken);
    return taken;
}

int WiFiUDP::parsePacket()
{
    charge(160);
    in_.clear();
    next_ = 0;
    if (socket_ < 0 || sockets[socket_].packets.empty())
        return 0;
    std::string whole = sockets[socket_].packets.front();
    sockets[socket_].packets.pop_front();
    Head head;
    memcpy(&head, whole.data(), sizeof head);
    in_ = whole.substr(sizeof head);
    from_ = IPAddress(head.address);
    from_port_ = head.port;
    return (int)in_.size();
}

int WiFiUDP::available() { charge(2); return (int)(in_.size() - next_); }
int WiFiUDP::read() { charge(2); return next_ < in_.size() ? (uint8_t)in_[next_++] : -1; }
int WiFiUDP::peek() { return next_ < in_.size() ? (uint8_t)in_[next_] : -1; }

int WiFiUDP::read(unsigned char *to, size_t size)
{
    size_t n = std::min(size, in_.size() - next_);
    memcpy(to, in_.data() + next_, n);
    next_ += n;
    return n ? (int)n : -1;
}
