/* A web server: handleClient() takes in a request, calls its handler and closes the connection. */
#ifndef WEBSERVER_H
#define WEBSERVER_H

#include <functional>
#include <list>
#include <memory>
#include <utility>
#include <vector>

#include "FS.h"
#include "HTTP_Method.h"
#include "Uri.h"
#include "WiFi.h"

enum HTTPUploadStatus { UPLOAD_FILE_START, UPLOAD_FILE_WRITE, UPLOAD_FILE_END, UPLOAD_FILE_ABORTED };
enum HTTPAuthMethod { BASIC_AUTH, DIGEST_AUTH };
#define HTTP_UPLOAD_BUFLEN 1436
#define CONTENT_LENGTH_UNKNOWN ((size_t)-1)
#define CONTENT_LENGTH_NOT_SET ((size_t)-2)

typedef struct {
    HTTPUploadStatus status;
    String filename, name, type;
    size_t totalSize, currentSize;
    uint8_t buf[HTTP_UPLOAD_BUFLEN];
} HTTPUpload;

class WebServer {
public:
    typedef std::function<void()> THandlerFunction;
    typedef std::vector<std::pair<String, String>> Pairs;

    explicit WebServer(int port = 80) : server_((uint16_t)port) {}
    WebServer(IPAddress, int port = 80) : server_((uint16_t)port) {}
    void begin() { server_.begin(); }
    void begin(uint16_t port) { server_.begin(port); }
    void handleClient();
    void close() { server_.end(); }
    void stop() { close(); }
    void enableDelay(bool on) { waits_ = on; }

    void on(const Uri &uri, THandlerFunction handler) { on(uri, HTTP_ANY, handler); }
    void on(const Uri &uri, HTTPMethod method, THandlerFunction handler) { on(uri, method, handler, upload_); }
    void on(const Uri &uri, HTTPMethod method, THandlerFunction handler, THandlerFunction upload);
    void onNotFound(THandlerFunction handler) { not_found_ = handler; }
    void onFileUpload(THandlerFunction handler) { upload_ = handler; }
    void serveStatic(const char *uri, fs::FS &files, const char *path, const char *cache = nullptr);

    bool authenticate(const char *user, const char *password);
    /* Digests are not computed: a browser is asked for Basic. */
    void requestAuthentication(HTTPAuthMethod = BASIC_AUTH, const char *realm = nullptr, const String &refusal = String());

    String uri() { return uri_; }
    HTTPMethod method() { return method_; }
    WiFiClient client() { return client_; }
    HTTPUpload &upload() { return file_; }
    String pathArg(unsigned each) { return each < places_.size() ? places_[each] : String(); }
    String arg(const String &name) { return of(args_, name, false); }
    String arg(int each) { return at(args_, each).second; }
    String argName(int each) { return at(args_, each).first; }
    int args() { return (int)args_.size(); }
    bool hasArg(const String &name) { return find(args_, name, false); }
    void collectHeaders(const char *names[], size_t count) { collected_.assign(names, names + count); }
    String header(const String &name) { return of(headers_, name, true); }
    String header(int each) { return at(headers_, each).second; }
    String headerName(int each) { return at(headers_, each).first; }
    int headers() { return (int)headers_.size(); }
    bool hasHeader(const String &name) { return find(headers_, name, true); }
    String hostHeader() { return host_; }

    void send(int code, const char *type = nullptr, const String &content = String());
    void send(int code, const String &type, const String &content) { send(code, type.c_str(), content); }
    void send(int code, const char *type, const char *content) { send(code, type, String(content)); }
    void send(int code, const char *type, const char *content, size_t size);
    void send_P(int code, const char *type, const char *content) { send(code, type, String(content)); }
    void send_P(int code, const char *type, const char *content, size_t size) { send(code, type, content, size); }
    void sendHeader(const String &name, const String &value, bool first = false);
    void setContentLength(size_t size) { length_ = size; }
    void enableCORS(bool on = true) { open_to_all_ = on; }
    void enableCrossOrigin(bool on = true) { enableCORS(on); }
    void sendContent(const String &content) { sendContent(content.c_str(), content.length()); }
    void sendContent(const char *content, size_t size);
    void sendContent_P(const char *content) { sendContent(content, strlen(content)); }
    void sendContent_P(const char *content, size_t size) { sendContent(content, size); }
    static String urlDecode(const String &text);

    template <typename T> size_t streamFile(T &file, const String &type, int code = 200)
    {
        setContentLength(file.size());
        if (String(file.name()).endsWith(".gz") && type != "application/x-gzip" && type != "application/octet-stream")
            sendHeader("Content-Encoding", "gzip");
        send(code, type, "");
        return client_.write(file);
    }

private:
    struct Handler {
        std::shared_ptr<Uri> uri;
        HTTPMethod method;
        THandlerFunction handler, upload;
    };
    static const std::pair<String, String> &at(const Pairs &pairs, int each);
    static const std::pair<String, String> *find(const Pairs &pairs, const String &name, bool any_case);
    static String of(const Pairs &pairs, const String &name, bool any_case);
    bool take_request();
    void take_header(const String &name, const String &value);
    void take_arguments(const String &text);
    void take_body(const String &type, size_t size, const Handler *handler);
    void take_part(const std::string &part, const Handler *handler);
    const Handler *chosen();
    void send_head(int code, const char *type, size_t size);
    void send_file(fs::FS &files, const String &path);

    WiFiServer server_;
    WiFiClient client_;
    unsigned long since_ = 0;
    bool waits_ = true, open_to_all_ = false, chunked_ = false;
    std::list<Handler> handlers_;
    THandlerFunction not_found_, upload_;
    std::vector<String> collected_;
    HTTPMethod method_ = HTTP_ANY;
    String uri_, host_, added_;
    std::vector<String> places_;
    Pairs args_, headers_;
    HTTPUpload file_ = {};
    size_t length_ = CONTENT_LENGTH_NOT_SET;
};

#endif
