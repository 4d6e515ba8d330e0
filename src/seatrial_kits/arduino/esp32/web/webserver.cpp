/* The web server of Arduino-ESP32: HTTP/1.1 (RFC 9112), a connection a request. */
#include "WebServer.h"

#include "libb64/cencode.h"
#include "machine.h"
#include "statuses.h"

using machine::charge;

namespace {

constexpr unsigned long WAIT_MS = 5000; /* for a request on a connection, and for the rest of one */

const struct {
    const char *name;
    HTTPMethod method;
} METHODS[] = {{"GET", HTTP_GET}, {"POST", HTTP_POST}, {"PUT", HTTP_PUT}, {"DELETE", HTTP_DELETE}, {"PATCH", HTTP_PATCH}, {"HEAD", HTTP_HEAD}, {"OPTIONS", HTTP_OPTIONS}};
const char *const TYPES[][2] = {{".html", "text/html"}, {".htm", "text/html"}, {".css", "text/css"}, {".txt", "text/plain"}, {".js", "application/javascript"}, {".json", "application/json"}, {".png", "image/png"}, {".gif", "image/gif"}, {".jpg", "image/jpeg"}, {".ico", "image/x-icon"}, {".svg", "image/svg+xml"}, {".xml", "text/xml"}, {".pdf", "application/pdf"}};

const char *type_of(const String &path)
{
    for (const auto &each : TYPES)
        if (path.endsWith(each[0]))
            return each[1];
    return "application/octet-stream";
}

/* Of a header such as `form-data; name="file"`: the value of a key. */
String value_in(const String &header, const String &key)
{
    int at = header.indexOf(key + "=\"");
    unsigned from = (unsigned)at + key.length() + 2;
    return at < 0 ? String() : header.substring(from, (unsigned)header.indexOf('"', from));
}

} // namespace

/* ------------------------------------------------------------------ handlers */

void WebServer::on(const Uri &uri, HTTPMethod method, THandlerFunction handler, THandlerFunction upload)
{
    handlers_.push_back({std::shared_ptr<Uri>(uri.clone()), method, handler, upload});
}

void WebServer::serveStatic(const char *uri, fs::FS &files, const char *path, const char *cache)
{
    struct Below : Uri {
        using Uri::Uri;
        Uri *clone() const override { return new Below(_uri); }
        bool canHandle(const String &asked, std::vector<String> &) override { return asked.startsWith(_uri); }
    };
    String base = uri, place = path, kept = cache ? cache : "";
    auto handler = [=, &files] {
        if (kept.length())
            sendHeader("Cache-Control", kept);
        String whole = files.open(place).isDirectory() ? place + uri_.substring(base.length()) : place;
        if (whole.endsWith("/"))
            whole += files.exists(whole + "index.htm") ? "index.htm" : "index.html";
        whole.replace("//", "/");
        send_file(files, whole);
    };
    handlers_.push_back({std::shared_ptr<Uri>(Below(uri).clone()), HTTP_GET, handler, nullptr});
}

void WebServer::send_file(fs::FS &files, const String &path)
{
    fs::File file = files.open(files.exists(path) ? path : path + ".gz");
    if (file && !file.isDirectory())
        streamFile(file, type_of(path));
    else
        send(404, "text/plain", "Not found: " + uri_);
}

const WebServer::Handler *WebServer::chosen()
{
    places_.clear();
    for (const Handler &each : handlers_)
        if ((each.method == HTTP_ANY || each.method == method_) && each.uri->canHandle(uri_, places_))
            return &each;
    return nullptr;
}

/* ------------------------------------------------------------------ requests */

void WebServer::handleClient()
{
    charge(160);
    if (!client_) {
        client_ = server_.accept();
        since_ = millis();
        if (!client_) {
            if (waits_)
                delay(1);
            return;
        }
        client_.setTimeout(WAIT_MS / 1000);
    }
    if (!client_.available()) {
        if (!client_.connected() || millis() - since_ > WAIT_MS)
            client_.stop();
        return;
    }
    if (take_request()) {
        const Handler *handler = chosen();
        if (handler)
            handler->handler();
        else if (not_found_)
            not_found_();
        else
            send(404, "text/plain", "Not found: " + uri_);
        if (chunked_)
            sendContent("", 0);
    }
    client_.stop();
    file_ = HTTPUpload();
}

bool WebServer::take_request()
{
    String line = client_.readStringUntil('\n');
    int first = line.indexOf(' '), second = line.indexOf(' ', (unsigned)first + 1);
    args_.clear(), headers_.clear(), added_.clear(), host_.clear();
    length_ = CONTENT_LENGTH_NOT_SET, chunked_ = false, method_ = HTTP_ANY;
    for (const auto &each : METHODS)
        if (line.substring(0, (unsigned)first) == each.name)
            method_ = each.method;
    if (first < 0 || second < 0 || method_ == HTTP_ANY)
        return false;
    String asked = line.substring((unsigned)first + 1, (unsigned)second);
    int query = asked.indexOf('?');
    uri_ = urlDecode(query < 0 ? asked : asked.substring(0, (unsigned)query));
    size_t size = 0;
    String type;
    for (line = client_.readStringUntil('\n'); line.length() > 1; line = client_.readStringUntil('\n')) {
        int colon = line.indexOf(':');
        String name = line.substring(0, (unsigned)colon), value = line.substring((unsigned)colon + 1);
        value.trim();
        take_header(name, value);
        if (name.equalsIgnoreCase("Content-Length"))
            size = (size_t)value.toInt();
        if (name.equalsIgnoreCase("Content-Type"))
            type = value;
    }
    if (query >= 0)
        take_arguments(asked.substring((unsigned)query + 1));
    take_body(type, size, chosen());
    return true;
}

void WebServer::take_header(const String &name, const String &value)
{
    if (name.equalsIgnoreCase("Host"))
        host_ = value;
    bool kept = name.equalsIgnoreCase("Authorization");
    for (const String &each : collected_)
        kept = kept || each.equalsIgnoreCase(name);
    if (kept)
        headers_.emplace_back(name, value);
}

void WebServer::take_arguments(const String &text)
{
    for (unsigned from = 0; from < text.length();) {
        int end = text.indexOf('&', from), equal = text.indexOf('=', from);
        unsigned last = end < 0 ? text.length() : (unsigned)end;
        unsigned middle = equal < 0 || (unsigned)equal > last ? last : (unsigned)equal;
        if (last > from)
            args_.emplace_back(urlDecode(text.substring(from, middle)), urlDecode(text.substring(middle + 1, std::max(middle + 1, last))));
        from = last + 1;
    }
}

void WebServer::take_body(const String &type, size_t size, const Handler *handler)
{
    std::string body(size, 0);
    body.resize(client_.readBytes(&body[0], size));
    if (type.startsWith("application/x-www-form-urlencoded")) {
        take_arguments(body.c_str());
    } else if (type.startsWith("multipart/")) {
        String boundary = type.substring((unsigned)type.indexOf("boundary=") + 9);
        boundary.replace("\"", "");
        std::string mark = std::string("--") + boundary.c_str();
        for (size_t from = body.find(mark), to; from != std::string::npos; from = to) {
            from += mark.size() + 2; /* and the end of the line */
            to = body.find(mark, from);
            if (to != std::string::npos)
                take_part(body.substr(from, to - from - 2), handler);
        }
    } else if (size) {
        args_.emplace_back("plain", String(body.data(), (unsigned)body.size()));
    }
}

/* A field of a form, or a file, for the upload's handler: in pieces. */
void WebServer::take_part(const std::string &part, const Handler *handler)
{
    size_t end = part.find("\r\n\r\n");
    if (end == std::string::npos)
        return;
    String head(part.substr(0, end).c_str());
    std::string data = part.substr(end + 4);
    if (head.indexOf("filename=\"") < 0) {
        args_.emplace_back(value_in(head, "name"), String(data.data(), (unsigned)data.size()));
        return;
    }
    if (!handler || !handler->upload)
        return;
    file_ = HTTPUpload();
    file_.filename = value_in(head, "filename");
    file_.name = value_in(head, " name");
    int type = head.indexOf("Content-Type: ");
    file_.type = type < 0 ? String("text/plain") : head.substring((unsigned)type + 14);
    file_.type = file_.type.substring(0, std::min(file_.type.length(), (unsigned)file_.type.indexOf('\r')));
    file_.status = UPLOAD_FILE_START;
    handler->upload();
    for (size_t at = 0; at < data.size(); at += file_.currentSize) {
        file_.status = UPLOAD_FILE_WRITE;
        file_.currentSize = std::min(data.size() - at, (size_t)HTTP_UPLOAD_BUFLEN);
        memcpy(file_.buf, data.data() + at, file_.currentSize);
        handler->upload();
        file_.totalSize += file_.currentSize;
    }
    file_.status = UPLOAD_FILE_END;
    handler->upload();
}

bool WebServer::authenticate(const char *user, const char *password)
{
    std::string both = std::string(user) + ":" + password, coded(both.size() * 2 + 8, 0);
    coded.resize((size_t)base64_encode_chars(both.data(), (int)both.size(), &coded[0]));
    return header("Authorization") == String("Basic ") + coded.c_str();
}

void WebServer::requestAuthentication(HTTPAuthMethod, const char *realm, const String &refusal)
{
    sendHeader("WWW-Authenticate", String("Basic realm=\"") + (realm ? realm : "Login Required") + "\"");
    send(401, "text/html", refusal);
}

/* ------------------------------------------------------------------ replies */

void WebServer::sendHeader(const String &name, const String &value, bool first)
{
    String line = name + ": " + value + "\r\n";
    added_ = first ? line + added_ : added_ + line;
}

void WebServer::send_head(int code, const char *type, size_t size)
{
    String head = String("HTTP/1.1 ") + code + " " + status_text(code) + "\r\n";
    head += String("Content-Type: ") + (type && *type ? type : "text/html") + "\r\n" + added_;
    if (open_to_all_)
        head += "Access-Control-Allow-Origin: *\r\nAccess-Control-Allow-Methods: *\r\nAccess-Control-Allow-Headers: *\r\n";
    chunked_ = length_ == CONTENT_LENGTH_UNKNOWN;
    if (chunked_)
        head += "Transfer-Encoding: chunked\r\n";
    else
        head += String("Content-Length: ") + (unsigned long)(length_ == CONTENT_LENGTH_NOT_SET ? size : length_) + "\r\n";
    client_.print(head + "Connection: close\r\n\r\n");
    added_.clear();
    length_ = CONTENT_LENGTH_NOT_SET;
}

void WebServer::send(int code, const char *type, const String &content) { send(code, type, content.c_str(), content.length()); }

void WebServer::send(int code, const char *type, const char *content, size_t size)
{
    send_head(code, type, size);
    if (size)
        sendContent(content, size);
}

void WebServer::sendContent(const char *content, size_t size)
{
    if (chunked_)
        client_.print(String((unsigned long)size, 16) + "\r\n");
    if (method_ != HTTP_HEAD)
        client_.write((const uint8_t *)content, size);
    if (chunked_)
        client_.print("\r\n");
    chunked_ = chunked_ && size; /* an empty one is the last */
}

/* ------------------------------------------------------------------ names and values */

const std::pair<String, String> &WebServer::at(const Pairs &pairs, int each)
{
    static const std::pair<String, String> none;
    return each >= 0 && each < (int)pairs.size() ? pairs[(size_t)each] : none;
}

const std::pair<String, String> *WebServer::find(const Pairs &pairs, const String &name, bool any_case)
{
    for (const auto &each : pairs)
        if (any_case ? each.first.equalsIgnoreCase(name) : each.first == name)
            return &each;
    return nullptr;
}

String WebServer::of(const Pairs &pairs, const String &name, bool any_case)
{
    const auto *found = find(pairs, name, any_case);
    return found ? found->second : String();
}

String WebServer::urlDecode(const String &text)
{
    String decoded;
    for (unsigned at = 0; at < text.length(); at++) {
        char c = text.charAt(at) == '+' ? ' ' : text.charAt(at);
        if (c == '%' && at + 2 < text.length()) {
            c = (char)strtol(text.substring(at + 1, at + 3).c_str(), nullptr, 16);
            at += 2;
        }
        decoded += c;
    }
    return decoded;
}
