/* TCP by callbacks, as ESPAsyncWebServer and its like take it; a task of its own makes the calls. */
#ifndef ASYNCTCP_H_
#define ASYNCTCP_H_

#include <deque>
#include <functional>

#include "Arduino.h"
#include "tcp.h"

#define ASYNC_WRITE_FLAG_COPY 0x01
#define ASYNC_WRITE_FLAG_MORE 0x02

class AsyncClient;
typedef std::function<void(void *, AsyncClient *)> AcConnectHandler;
typedef std::function<void(void *, AsyncClient *, size_t size, uint32_t ms)> AcAckHandler;
typedef std::function<void(void *, AsyncClient *, int8_t error)> AcErrorHandler;
typedef std::function<void(void *, AsyncClient *, void *data, size_t size)> AcDataHandler;
typedef std::function<void(void *, AsyncClient *, uint32_t ms)> AcTimeoutHandler;

class AsyncClient {
public:
    explicit AsyncClient(tcp::Shared one = nullptr);
    ~AsyncClient();
    AsyncClient(const AsyncClient &) = delete;
    bool connect(IPAddress address, uint16_t port);
    bool connect(const char *host, uint16_t port);
    void close(bool now = false);
    void stop() { close(); }
    int8_t abort();
    bool free() { return freeable(); }
    bool canSend() { return space() > 0; }
    size_t space();
    size_t add(const char *data, size_t size, uint8_t flags = ASYNC_WRITE_FLAG_COPY);
    bool send();
    size_t write(const char *data, size_t size, uint8_t flags = ASYNC_WRITE_FLAG_COPY);
    size_t write(const char *text) { return text ? write(text, strlen(text)) : 0; }
    uint8_t state() { return connected() ? 4 : connecting() ? 2 : 0; }
    bool connecting() { return one_ && one_->state == tcp::Connection::CONNECTING; }
    bool connected() { return one_ && one_->state == tcp::Connection::OPEN; }
    bool disconnecting() { return false; }
    bool disconnected() { return !connected() && !connecting(); }
    bool freeable() { return disconnected(); }
    uint16_t getMss() { return 1436; }
    uint32_t getRxTimeout() { return rx_timeout_; }
    void setRxTimeout(uint32_t seconds) { rx_timeout_ = seconds; }
    uint32_t getAckTimeout() { return 0; }
    void setAckTimeout(uint32_t) {} /* what is sent arrives, or the connection ends */
    void setNoDelay(bool) {}
    bool getNoDelay() { return true; }
    void setKeepAlive(uint32_t, uint8_t) {}
    IPAddress remoteIP() { return one_ ? one_->remote : IPAddress(); }
    uint16_t remotePort() { return one_ ? one_->remote_port : 0; }
    IPAddress localIP();
    uint16_t localPort() { return one_ ? one_->local_port : 0; }
    uint32_t getRemoteAddress() { return remoteIP(); }
    uint16_t getRemotePort() { return remotePort(); }
    uint32_t getLocalAddress() { return localIP(); }
    uint16_t getLocalPort() { return localPort(); }
    void onConnect(AcConnectHandler handler, void *with = nullptr) { connect_ = handler, connect_with_ = with; }
    void onDisconnect(AcConnectHandler handler, void *with = nullptr) { end_ = handler, end_with_ = with; }
    void onAck(AcAckHandler handler, void *with = nullptr) { ack_ = handler, ack_with_ = with; }
    void onError(AcErrorHandler handler, void *with = nullptr) { error_ = handler, error_with_ = with; }
    void onData(AcDataHandler handler, void *with = nullptr) { data_ = handler, data_with_ = with; }
    void onTimeout(AcTimeoutHandler, void * = nullptr) {}
    void onPoll(AcConnectHandler handler, void *with = nullptr) { poll_ = handler, poll_with_ = with; }
    size_t ack(size_t size) { return size; }
    void ackLater() {}
    const char *stateToString() { return connected() ? "Established" : "Closed"; }
    static const char *errorToString(int8_t error) { return error ? "Connection aborted" : "OK"; }

    bool serve();      /* one call of a handler that is due; returns whether there was one */
    uint64_t due();    /* when the next falls due by time */

private:
    tcp::Shared one_;
    bool opened_;
    std::string out_;
    size_t unacknowledged_ = 0;
    uint64_t ack_due_ = 0, poll_due_ = 0, received_ = 0, sent_ = 0;
    uint32_t rx_timeout_ = 0;
    AcConnectHandler connect_, end_, poll_;
    AcAckHandler ack_;
    AcErrorHandler error_;
    AcDataHandler data_;
    void *connect_with_ = nullptr, *end_with_ = nullptr, *poll_with_ = nullptr, *ack_with_ = nullptr, *error_with_ = nullptr, *data_with_ = nullptr;
};

class AsyncServer {
public:
    explicit AsyncServer(uint16_t port) : port_(port) {}
    AsyncServer(IPAddress, uint16_t port) : port_(port) {}
    ~AsyncServer() { end(); }
    void onClient(AcConnectHandler handler, void *with) { client_ = handler, with_ = with; }
    void begin();
    void end();
    void setNoDelay(bool) {}
    bool getNoDelay() { return true; }
    uint8_t status() { return server_ >= 0 ? 1 : 0; }

    bool serve();

private:
    uint16_t port_;
    int server_ = -1;
    AcConnectHandler client_;
    void *with_ = nullptr;
};

#endif
