"""WebServer, HTTPClient and DNSServer of an ESP32, by the clients and servers of Python's standard library."""

import base64
import http.client
import http.server
import socket
import struct
import threading

import pytest

from .test_esp32 import running
from .test_esp32_tcp import stepping

pytestmark = [pytest.mark.interop, pytest.mark.slow]

SERVER = r"""
#include <WiFi.h>
#include <WebServer.h>
#include <uri/UriBraces.h>
#include <DNSServer.h>
#include <ESPmDNS.h>
#include <ArduinoOTA.h>
#include <LittleFS.h>
#include <esp_task_wdt.h>
WebServer server(80);
DNSServer dns;
String uploaded;
void left() {
  String all;
  for (int i = 0; i < server.args(); i++) all += server.argName(i) + "=" + server.arg(i) + ";";
  server.send(200, "text/plain", all + server.hasArg("speed") + server.arg("speed").toInt() + server.hostHeader());
}
void setup() {
  Serial.begin(115200); WiFi.softAP("boat"); MDNS.begin("boat"); ArduinoOTA.begin();
  dns.start(53, "*", IPAddress(192, 168, 4, 1));
  LittleFS.begin(); LittleFS.mkdir("/www");
  File page = LittleFS.open("/www/index.html", "w"); page.print("<h1>page</h1>"); page.close();
  const char *asked[] = {"X-Token"};
  server.collectHeaders(asked, 1);
  server.on("/left", left);
  server.on("/only", HTTP_POST, [] { server.sendHeader("X-Boat", "one"); server.send(201, "application/json", server.arg("plain")); });
  server.on(UriBraces("/motor/{}/speed/{}"), [] { server.send(200, "text/plain", server.pathArg(0) + ":" + server.pathArg(1) + server.header("X-Token")); });
  server.on("/many", [] {
    server.setContentLength(CONTENT_LENGTH_UNKNOWN); server.send(200, "text/html", "");
    for (int i = 0; i < 3; i++) server.sendContent(String(i) + " piece ");
  });
  server.on("/secret", [] { if (!server.authenticate("helm", "pa:ss")) return server.requestAuthentication(); server.send(200, "text/plain", "in"); });
  server.on("/file", HTTP_POST, [] { server.send(200, "text/plain", uploaded); }, [] {
    HTTPUpload &file = server.upload();
    if (file.status == UPLOAD_FILE_START) uploaded = file.filename + "|" + file.type + "|";
    if (file.status == UPLOAD_FILE_WRITE) uploaded += file.currentSize;
    if (file.status == UPLOAD_FILE_END) uploaded += String("|") + file.totalSize;
  });
  server.serveStatic("/www/", LittleFS, "/www/");
  server.onNotFound([] { server.send(404, "text/plain", "none: " + server.uri()); });
  server.begin();
}
void loop() { server.handleClient(); dns.processNextRequest(); ArduinoOTA.handle(); }
"""


def ask(method: str, path: str, body: bytes | None = None, **headers: str):
    """Return status, body and headers of an answer, as Python's client has them."""
    asking = http.client.HTTPConnection("127.77.1.1", 8080, timeout=60)
    asking.request(method, path, body, {k.replace("_", "-"): v for k, v in headers.items()})
    answer = asking.getresponse()
    found = answer.status, answer.read(), dict(answer.getheaders())
    asking.close()
    return found


FORM = "application/x-www-form-urlencoded"


def test_a_web_server_answers_pythons_client(tmp_path):
    with running(tmp_path, SERVER, network="127.77.1.1") as bench:
        bench.run(0.1)
        with stepping(bench):
            status, body, headers = ask("GET", "/left?speed=20&to=a%20b%2Bc+d")
            assert (status, body) == (200, b"speed=20;to=a b+c d;120127.77.1.1:8080")
            assert headers["Content-Type"] == "text/plain"
            assert ask("POST", "/left", b"speed=7&x=", Content_Type=FORM)[1].startswith(
                b"speed=7;x=;17"
            )
            status, body, headers = ask("POST", "/only", b'{"a": 1}', Content_Type="text/json")
            assert (status, body, headers["X-Boat"]) == (201, b'{"a": 1}', "one")
            assert ask("GET", "/only")[:2] == (404, b"none: /only")
            assert ask("GET", "/motor/2/speed/80", X_Token="t")[1] == b"2:80t"
            assert ask("GET", "/many")[1] == b"0 piece 1 piece 2 piece "
            status, _, headers = ask("GET", "/secret")
            assert (status, headers["WWW-Authenticate"]) == (401, 'Basic realm="Login Required"')
            right = base64.b64encode(b"helm:pa:ss").decode()
            assert ask("GET", "/secret", Authorization=f"Basic {right}")[1] == b"in"
            assert ask("GET", "/secret", Authorization="Basic eHg6eQ==")[0] == 401
            status, body, headers = ask("GET", "/www/")
            assert (body, headers["Content-Type"]) == (b"<h1>page</h1>", "text/html")
            assert ask("HEAD", "/left")[:2] == (200, b"")
            part = b'--b\r\nContent-Disposition: form-data; name="f"; filename="a.bin"\r\nContent-Type: x/y\r\n\r\n'
            data = part + b"z" * 2000 + b"\r\n--b--\r\n"
            kind = "multipart/form-data; boundary=b"
            assert ask("POST", "/file", data, Content_Type=kind)[1] == b"a.bin|x/y|1436564|2000"
            assert resolved("boat.local") == b"\xc0\xa8\x04\x01"


def resolved(name: str) -> bytes:
    """Return the address that the board's name server has for a name (RFC 1035, section 4)."""
    labels = b"".join(bytes([len(each)]) + each.encode() for each in name.split("."))
    question = labels + b"\0" + struct.pack(">HH", 1, 1)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one:
        one.settimeout(60)
        one.sendto(struct.pack(">6H", 77, 0x100, 1, 0, 0, 0) + question, ("127.77.1.1", 8053))
        answer = one.recv(512)
    assert struct.unpack(">6H", answer[:12]) == (77, 0x8100, 1, 1, 0, 0)
    assert answer[12 : 12 + len(question)] == question
    return answer[-4:]


CLIENT = r"""
#include <WiFi.h>
#include <HTTPClient.h>
#include <WiFiClientSecure.h>
void said(HTTPClient &http, int code) { Serial.print(code); Serial.print(' '); Serial.print(http.getSize()); Serial.print(' '); Serial.println(http.getString()); http.end(); }
void setup() {
  Serial.begin(115200); WiFi.begin("net");
  WiFiClient client; HTTPClient http;
  http.begin(client, "http://192.168.4.1:PORT/depth?x=1"); said(http, http.GET());
  http.begin("http://192.168.4.1:PORT/chunks"); said(http, http.GET());
  http.begin("192.168.4.1", PORT, "/long"); http.addHeader("Content-Type", "text/plain"); said(http, http.POST("a=5"));
  http.begin("http://helm:secret@192.168.4.1:PORT/head"); http.addHeader("X-A", "1"); http.addHeader("X-A", "2");
  const char *kept[] = {"Server"}; http.collectHeaders(kept, 1);
  int code = http.sendRequest("PUT", "x"); Serial.print(http.hasHeader("Server")); said(http, code);
  http.setFollowRedirects(HTTPC_STRICT_FOLLOW_REDIRECTS); http.begin("http://192.168.4.1:PORT/moved"); said(http, http.GET());
  Serial.println(http.begin("ftp://x")); http.begin("http://127.77.1.9:1234/"); code = http.GET();
  Serial.println(HTTPClient::errorToString(code));
  WiFiClientSecure secure; secure.setInsecure(); Serial.print(secure.connect("192.168.4.1", 443));
  http.begin(secure, "https://192.168.4.1/"); Serial.println(http.GET());
}
void loop() {}
"""


class Answers(http.server.BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"

    def answer(self) -> None:
        body = self.rfile.read(int(self.headers.get("Content-Length", 0)))
        if self.path == "/moved":
            self.send_response(302)
            self.send_header("Location", "/depth")
            self.send_header("Content-Length", "0")
            self.end_headers()
            return
        whole = f"{self.command} {self.path} {body.decode()}".encode()
        if self.path == "/head":
            whole = f"{self.headers['Authorization']} {self.headers.get_all('X-A')}".encode()
        self.send_response(200)
        if self.path == "/chunks":
            self.send_header("Transfer-Encoding", "chunked")
            self.end_headers()
            self.wfile.write(b"4\r\nfour\r\nb\r\n and eleven\r\n0\r\n\r\n")
            return
        self.send_header("Content-Length", str(len(whole)))
        self.end_headers()
        self.wfile.write(whole)

    do_GET = do_POST = do_PUT = answer

    def log_message(self, *_: object) -> None:
        pass


def test_a_client_asks_pythons_server(tmp_path):
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), Answers) as server:
        beside = threading.Thread(target=server.serve_forever)
        beside.start()
        source = CLIENT.replace("PORT", str(server.server_port))
        with running(tmp_path, source, network="127.77.1.2") as bench:
            for _ in range(300):
                bench.run(0.1)
                if bench.sent[0].endswith(b"0-1\r\n"):
                    break
            lines = bench.sent[0].decode().splitlines()
        server.shutdown()
        beside.join()
    assert lines == [
        "200 16 GET /depth?x=1 ",
        "200 -1 four and eleven",
        "200 14 POST /long a=5",
        f"1200 {len(lines[3].split(' ', 2)[2])} Basic aGVsbTpzZWNyZXQ= ['2']",
        "200 12 GET /depth ",
        "0",
        "connection refused",
        "0-1",
    ]
