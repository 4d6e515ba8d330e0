/* The client of HTTP, and the texts of status codes. */
#include "HTTPClient.h"

#include "libb64/cencode.h"
#include "statuses.h"

bool HTTPClient::begin(const String &url)
{
    end();
    https_ = url.startsWith("https://");
    if (!https_ && !url.startsWith("http://"))
        return false;
    String rest = url.substring(https_ ? 8 : 7);
    int slash = rest.indexOf('/'), at = rest.indexOf('@');
    String host = slash < 0 ? rest : rest.substring(0, (unsigned)slash);
    path_ = slash < 0 ? String("/") : rest.substring((unsigned)slash);
    if (at >= 0 && (slash < 0 || at < slash)) {
        String user = host.substring(0, (unsigned)at);
        host = host.substring((unsigned)at + 1);
        int colon = user.indexOf(':');
        setAuthorization(user.substring(0, (unsigned)colon).c_str(), user.substring((unsigned)colon + 1).c_str());
    }
    int colon = host.indexOf(':');
    host_ = colon < 0 ? host : host.substring(0, (unsigned)colon);
    port_ = colon < 0 ? https_ ? 443 : 80 : (uint16_t)host.substring((unsigned)colon + 1).toInt();
    return true;
}

bool HTTPClient::begin(const String &host, uint16_t port, const String &uri)
{
    end();
    host_ = host, port_ = port, path_ = uri, https_ = false;
    return true;
}

bool HTTPClient::begin(WiFiClient &client, const String &host, uint16_t port, const String &uri, bool https)
{
    begin(host, port, uri);
    given_ = &client;
    https_ = https;
    return true;
}

bool HTTPClient::begin(WiFiClient &client, const String &url)
{
    bool good = begin(url);
    given_ = &client;
    return good;
}

void HTTPClient::end()
{
    client().stop();
    given_ = nullptr;
    added_.clear(), size_ = -1, chunked_ = false;
}

void HTTPClient::setAuthorization(const char *user, const char *password)
{
    std::string both = std::string(user) + ":" + password, coded(both.size() * 2 + 8, 0);
    coded.resize((size_t)base64_encode_chars(both.data(), (int)both.size(), &coded[0]));
    setAuthorization(coded.c_str());
}

void HTTPClient::addHeader(const String &name, const String &value, bool first, bool replace)
{
    String line = name + ": " + value + "\r\n";
    int old = replace ? added_.indexOf(name + ": ") : -1;
    if (old >= 0)
        added_.remove((unsigned)old, (unsigned)added_.indexOf('\n', (unsigned)old) + 1 - (unsigned)old);
    added_ = first ? line + added_ : added_ + line;
}

void HTTPClient::collectHeaders(const char *names[], size_t count)
{
    collected_.clear();
    for (size_t each = 0; each < count; each++)
        collected_.emplace_back(names[each], "");
}

String HTTPClient::header(const char *name)
{
    for (const auto &each : collected_)
        if (each.first.equalsIgnoreCase(name))
            return each.second;
    return String();
}

int HTTPClient::sendRequest(const char *method, uint8_t *body, size_t size)
{
    int code = ask(method, body, size);
    for (uint16_t times = 0; follow_ != HTTPC_DISABLE_FOLLOW_REDIRECTS && times < limit_; times++) {
        bool same = code == HTTP_CODE_TEMPORARY_REDIRECT || code == HTTP_CODE_PERMANENT_REDIRECT;
        bool moved = same || (code >= HTTP_CODE_MOVED_PERMANENTLY && code <= HTTP_CODE_SEE_OTHER);
        if (!moved || !location_.length())
            break;
        String kept = added_;
        WiFiClient *given = given_;
        if (location_.startsWith("/"))
            client().stop(), path_ = location_;
        else if (!begin(String(location_)))
            break;
        added_ = kept, given_ = given;
        code = same ? ask(method, body, size) : ask("GET", nullptr, 0);
    }
    return code;
}

int HTTPClient::ask(const char *method, const uint8_t *body, size_t size)
{
    if (https_ || !client().connect(host_.c_str(), port_, connect_ms_))
        return HTTPC_ERROR_CONNECTION_REFUSED;
    client().setTimeout((ms_ + 999) / 1000);
    String head = String(method) + " " + path_ + " HTTP/1.1\r\nHost: " + host_ + (port_ == 80 ? String() : String(":") + port_);
    head += "\r\nUser-Agent: " + agent_ + "\r\nConnection: close\r\n" + added_;
    if (body)
        head += String("Content-Length: ") + (unsigned long)size + "\r\n";
    head += "\r\n";
    if (client().print(head) != head.length())
        return HTTPC_ERROR_SEND_HEADER_FAILED;
    if (size && client().write(body, size) != size)
        return HTTPC_ERROR_SEND_PAYLOAD_FAILED;
    return take_head();
}

int HTTPClient::take_head()
{
    size_ = -1, chunked_ = false;
    location_.clear();
    for (auto &each : collected_)
        each.second.clear();
    String line = client().readStringUntil('\n');
    if (!line.length())
        return client().connected() ? HTTPC_ERROR_READ_TIMEOUT : HTTPC_ERROR_CONNECTION_LOST;
    if (!line.startsWith("HTTP/1."))
        return HTTPC_ERROR_NO_HTTP_SERVER;
    int code = (int)line.substring((unsigned)line.indexOf(' ') + 1).toInt();
    for (line = client().readStringUntil('\n'); line.length() > 1; line = client().readStringUntil('\n')) {
        int colon = line.indexOf(':');
        String name = line.substring(0, (unsigned)colon), value = line.substring((unsigned)colon + 1);
        value.trim();
        if (name.equalsIgnoreCase("Content-Length"))
            size_ = (int)value.toInt();
        if (name.equalsIgnoreCase("Transfer-Encoding"))
            chunked_ = value.equalsIgnoreCase("chunked");
        if (name.equalsIgnoreCase("Location"))
            location_ = value;
        for (auto &each : collected_)
            if (each.first.equalsIgnoreCase(name))
                each.second = value;
    }
    return code;
}

std::string HTTPClient::body()
{
    std::string whole;
    auto take = [&](size_t size) {
        size_t before = whole.size();
        whole.resize(before + size);
        whole.resize(before + client().readBytes(&whole[before], size));
    };
    if (chunked_) {
        for (long size; (size = strtol(client().readStringUntil('\n').c_str(), nullptr, 16)) > 0;) {
            take((size_t)size);
            client().readStringUntil('\n');
        }
    } else if (size_ >= 0) {
        take((size_t)size_);
    } else {
        for (int c; client().connected() && (c = client().readBytes((uint8_t *)&c, 1) ? c & 0xFF : -1) >= 0;)
            whole += (char)c;
    }
    return whole;
}

String HTTPClient::getString() { return body(); }

int HTTPClient::writeToStream(Stream *to)
{
    if (!to)
        return HTTPC_ERROR_NO_STREAM;
    std::string whole = body();
    return to->write(whole.data(), whole.size()) == whole.size() ? (int)whole.size() : HTTPC_ERROR_STREAM_WRITE;
}

String HTTPClient::errorToString(int error)
{
    const char *const texts[] = {"connection refused", "send header failed", "send payload failed", "not connected", "connection lost", "no stream", "no HTTP server", "too less ram", "Transfer-Encoding not supported", "Stream write error", "read Timeout"};
    return error < 0 && error >= HTTPC_ERROR_READ_TIMEOUT ? texts[-error - 1] : "";
}

const char *status_text(int code)
{
    static const struct {
        int code;
        const char *text;
    } texts[] = {{100, "Continue"}, {101, "Switching Protocols"}, {200, "OK"}, {201, "Created"}, {202, "Accepted"}, {204, "No Content"}, {206, "Partial Content"}, {301, "Moved Permanently"}, {302, "Found"}, {303, "See Other"}, {304, "Not Modified"}, {307, "Temporary Redirect"}, {308, "Permanent Redirect"}, {400, "Bad Request"}, {401, "Unauthorized"}, {403, "Forbidden"}, {404, "Not Found"}, {405, "Method Not Allowed"}, {408, "Request Timeout"}, {413, "Content Too Large"}, {429, "Too Many Requests"}, {500, "Internal Server Error"}, {501, "Not Implemented"}, {503, "Service Unavailable"}};
    for (const auto &each : texts)
        if (each.code == code)
            return each.text;
    return "";
}
