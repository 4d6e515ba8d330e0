/* The task that calls the handlers of AsyncClient and AsyncServer. */
#include "AsyncTCP.h"

#include <algorithm>
#include <vector>

#include "WiFi.h"
#include "machine.h"
#include "tasks.h"

namespace {

constexpr uint64_t MS = 16000, ROUND_TRIP = 2 * MS, POLL = 125 * MS;
constexpr size_t SEND_BUFFER = 5744; /* of the board's IP stack */
constexpr unsigned PRIORITY = 10;

std::vector<AsyncClient *> clients; /* a handler may add and delete some */
std::vector<AsyncServer *> servers;

template <typename T> bool serve_one(std::vector<T *> &all)
{
    for (size_t each = 0; each < all.size(); each++)
        if (all[each]->serve())
            return true;
    return false;
}

void serve_all(void *)
{
    for (;;) {
        uint32_t seen = tcp::changes;
        while (serve_one(servers) || serve_one(clients))
            machine::charge(160);
        uint64_t soonest = UINT64_MAX;
        for (AsyncClient *one : clients)
            soonest = std::min(soonest, one->due());
        size_t count = clients.size();
        wait_until(soonest, [&] { return tcp::changes != seen || clients.size() != count; });
    }
}

void begin_serving()
{
    static bool begun = false;
    if (!begun)
        xTaskCreatePinnedToCore(serve_all, "async_tcp", 0, nullptr, PRIORITY, nullptr, tskNO_AFFINITY);
    begun = true;
}

template <typename T> void forget(std::vector<T *> &all, T *one) { all.erase(std::remove(all.begin(), all.end(), one), all.end()); }

} // namespace

AsyncClient::AsyncClient(tcp::Shared one) : one_(one), opened_(one != nullptr), poll_due_(machine::now + POLL), received_(machine::now)
{
    clients.push_back(this);
}

AsyncClient::~AsyncClient()
{
    if (one_)
        one_->close();
    forget(clients, this);
}

bool AsyncClient::connect(IPAddress address, uint16_t port)
{
    begin_serving();
    opened_ = false;
    one_ = tcp::connect(address, port);
    return one_ != nullptr;
}

bool AsyncClient::connect(const char *host, uint16_t port)
{
    IPAddress found;
    return WiFi.hostByName(host, found) && connect(found, port);
}

IPAddress AsyncClient::localIP() { return WiFi.localIP(); }

/* The handler of the end may delete this. */
void AsyncClient::close(bool)
{
    if (!one_)
        return;
    send();
    one_->close();
    one_.reset();
    if (end_)
        end_(end_with_, this);
}

int8_t AsyncClient::abort()
{
    if (one_)
        one_->close();
    one_.reset();
    return -13;
}

size_t AsyncClient::space() { return connected() ? SEND_BUFFER - std::min(SEND_BUFFER, unacknowledged_ + out_.size()) : 0; }

size_t AsyncClient::add(const char *data, size_t size, uint8_t)
{
    size_t taken = std::min(size, space());
    out_.append(data, taken);
    return taken;
}

bool AsyncClient::send()
{
    if (!connected() || out_.empty())
        return connected();
    std::string out;
    out.swap(out_);
    unacknowledged_ += out.size();
    sent_ = machine::now;
    ack_due_ = machine::now + ROUND_TRIP;
    one_->send(out.data(), out.size());
    tcp::changes++;
    return true;
}

size_t AsyncClient::write(const char *data, size_t size, uint8_t flags)
{
    size_t taken = add(data, size, flags);
    return taken && send() ? taken : 0;
}

uint64_t AsyncClient::due()
{
    return one_ ? std::min(poll_due_, unacknowledged_ ? ack_due_ : UINT64_MAX) : UINT64_MAX;
}

bool AsyncClient::serve()
{
    using machine::now;
    if (!one_ || one_->state == tcp::Connection::CONNECTING)
        return false;
    if (!opened_ && connected()) {
        opened_ = true;
        received_ = now;
        if (connect_)
            connect_(connect_with_, this);
    } else if (!opened_) {
        one_.reset();
        if (error_)
            error_(error_with_, this, -14);
        if (end_)
            end_(end_with_, this);
    } else if (!one_->in.empty()) {
        std::string data = one_->take(1436);
        received_ = now;
        if (data_)
            data_(data_with_, this, &data[0], data.size());
    } else if (one_->state != tcp::Connection::OPEN || (rx_timeout_ && now - received_ > rx_timeout_ * 1000 * MS)) {
        close();
    } else if (unacknowledged_ && now >= ack_due_) {
        size_t size = unacknowledged_;
        unacknowledged_ = 0;
        if (ack_)
            ack_(ack_with_, this, size, (uint32_t)((now - sent_) / MS));
    } else if (now >= poll_due_) {
        poll_due_ = now + POLL;
        if (poll_)
            poll_(poll_with_, this);
    } else {
        return false;
    }
    return true;
}

void AsyncServer::begin()
{
    if (server_ >= 0)
        return;
    server_ = tcp::listen(port_);
    servers.push_back(this);
    begin_serving();
}

void AsyncServer::end()
{
    tcp::stop_listening(server_);
    server_ = -1;
    forget(servers, this);
}

bool AsyncServer::serve()
{
    tcp::Shared one = tcp::accept(server_);
    if (!one)
        return false;
    if (client_)
        client_(with_, new AsyncClient(one));
    return true;
}
