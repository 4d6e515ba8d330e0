/* A client of HTTP/1.1: a request, its answer's head, and then its body. */
#ifndef HTTPCLIENT_H
#define HTTPCLIENT_H

#include <utility>
#include <vector>

#include "WiFi.h"
#include "WiFiClientSecure.h"

#define HTTPC_ERROR_CONNECTION_REFUSED (-1)
#define HTTPC_ERROR_SEND_HEADER_FAILED (-2)
#define HTTPC_ERROR_SEND_PAYLOAD_FAILED (-3)
#define HTTPC_ERROR_NOT_CONNECTED (-4)
#define HTTPC_ERROR_CONNECTION_LOST (-5)
#define HTTPC_ERROR_NO_STREAM (-6)
#define HTTPC_ERROR_NO_HTTP_SERVER (-7)
#define HTTPC_ERROR_TOO_LESS_RAM (-8)
#define HTTPC_ERROR_ENCODING (-9)
#define HTTPC_ERROR_STREAM_WRITE (-10)
#define HTTPC_ERROR_READ_TIMEOUT (-11)
#define HTTPCLIENT_DEFAULT_TCP_TIMEOUT 5000

typedef enum {
    HTTP_CODE_OK = 200, HTTP_CODE_CREATED, HTTP_CODE_ACCEPTED, HTTP_CODE_NO_CONTENT = 204, HTTP_CODE_PARTIAL_CONTENT = 206,
    HTTP_CODE_MOVED_PERMANENTLY = 301, HTTP_CODE_FOUND, HTTP_CODE_SEE_OTHER, HTTP_CODE_NOT_MODIFIED, HTTP_CODE_TEMPORARY_REDIRECT = 307, HTTP_CODE_PERMANENT_REDIRECT,
    HTTP_CODE_BAD_REQUEST = 400, HTTP_CODE_UNAUTHORIZED, HTTP_CODE_FORBIDDEN = 403, HTTP_CODE_NOT_FOUND, HTTP_CODE_METHOD_NOT_ALLOWED, HTTP_CODE_REQUEST_TIMEOUT = 408, HTTP_CODE_TOO_MANY_REQUESTS = 429,
    HTTP_CODE_INTERNAL_SERVER_ERROR = 500, HTTP_CODE_NOT_IMPLEMENTED, HTTP_CODE_BAD_GATEWAY, HTTP_CODE_SERVICE_UNAVAILABLE, HTTP_CODE_GATEWAY_TIMEOUT
} t_http_codes;
typedef enum { HTTPC_DISABLE_FOLLOW_REDIRECTS, HTTPC_STRICT_FOLLOW_REDIRECTS, HTTPC_FORCE_FOLLOW_REDIRECTS } followRedirects_t;

class HTTPClient {
public:
    ~HTTPClient() { end(); }
    bool begin(const String &url);
    bool begin(const String &url, const char *) { return begin(url); }
    bool begin(const String &host, uint16_t port, const String &uri = "/");
    bool begin(WiFiClient &client, const String &url);
    bool begin(WiFiClient &client, const String &host, uint16_t port, const String &uri = "/", bool https = false);
    void end();
    bool connected() { return client().connected(); }
    void setReuse(bool) {} /* a connection a request */
    void setUserAgent(const String &name) { agent_ = name; }
    void setAuthorization(const char *user, const char *password);
    void setAuthorization(const char *coded) { addHeader("Authorization", String("Basic ") + coded); }
    void setConnectTimeout(int32_t ms) { connect_ms_ = ms; }
    void setTimeout(uint16_t ms) { ms_ = ms; }
    void useHTTP10(bool = true) {}
    void setFollowRedirects(followRedirects_t follow) { follow_ = follow; }
    void setRedirectLimit(uint16_t limit) { limit_ = limit; }
    bool setURL(const String &url) { return begin(url); }
    void addHeader(const String &name, const String &value, bool first = false, bool replace = true);
    void collectHeaders(const char *names[], size_t count);

    int GET() { return sendRequest("GET"); }
    int POST(const String &body) { return sendRequest("POST", body); }
    int POST(uint8_t *body, size_t size) { return sendRequest("POST", body, size); }
    int PUT(const String &body) { return sendRequest("PUT", body); }
    int PUT(uint8_t *body, size_t size) { return sendRequest("PUT", body, size); }
    int PATCH(const String &body) { return sendRequest("PATCH", body); }
    int PATCH(uint8_t *body, size_t size) { return sendRequest("PATCH", body, size); }
    int sendRequest(const char *method, const String &body) { return sendRequest(method, (uint8_t *)body.c_str(), body.length()); }
    int sendRequest(const char *method, uint8_t *body = nullptr, size_t size = 0);

    int getSize() { return size_; } /* -1: to the end of the connection, or in chunks */
    const String &getLocation() { return location_; }
    WiFiClient &getStream() { return client(); }
    WiFiClient *getStreamPtr() { return client().connected() ? &client() : nullptr; }
    int writeToStream(Stream *to);
    String getString();
    static String errorToString(int error);
    String header(const char *name);
    String header(size_t each) { return each < collected_.size() ? collected_[each].second : String(); }
    String headerName(size_t each) { return each < collected_.size() ? collected_[each].first : String(); }
    int headers() { return (int)collected_.size(); }
    bool hasHeader(const char *name) { return header(name).length() > 0; }

private:
    WiFiClient &client() { return given_ ? *given_ : own_; }
    int ask(const char *method, const uint8_t *body, size_t size);
    int take_head();
    std::string body();

    WiFiClient own_, *given_ = nullptr;
    String host_, path_, added_, location_, agent_ = "ESP32HTTPClient";
    uint16_t port_ = 80, limit_ = 10;
    bool https_ = false, chunked_ = false;
    int32_t connect_ms_ = HTTPCLIENT_DEFAULT_TCP_TIMEOUT;
    uint32_t ms_ = HTTPCLIENT_DEFAULT_TCP_TIMEOUT;
    int size_ = -1;
    followRedirects_t follow_ = HTTPC_DISABLE_FOLLOW_REDIRECTS;
    std::vector<std::pair<String, String>> collected_;
};

#endif
