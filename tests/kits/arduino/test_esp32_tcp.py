"""TCP of an ESP32's WiFi, by the clients and servers of Python's standard library."""

import base64
import hashlib
import http.client
import http.server
import socket
import threading
from contextlib import contextmanager

import pytest

from seatrial.errors import SimulationError

from .bench import Bench
from .test_esp32 import running

pytestmark = pytest.mark.interop

PAGE = """
#include <WiFi.h>
WiFiServer server(80);
void setup() { Serial.begin(115200); WiFi.softAP("boat"); server.begin(); }
void loop() {
  WiFiClient client = server.available();
  if (!client) return;
  String line = client.readStringUntil('\\n');
  while (client.readStringUntil('\\n').length() > 1) {}
  client.print("HTTP/1.1 200 OK\\r\\nConnection: close\\r\\n\\r\\nasked for " + line.substring(4, line.indexOf(' ', 4)));
  client.stop();
}
"""
ECHO = """
#include <WiFi.h>
WiFiServer server(7777);
WiFiClient client;
void setup() { Serial.begin(115200); WiFi.begin("net"); server.begin(); }
void loop() {
  if (!client.connected()) client = server.available();
  uint8_t some[300];
  if (client.available()) client.write(some, client.read(some, sizeof some));
}
"""
GET = """
#include <WiFi.h>
void setup() {
  Serial.begin(115200); WiFi.begin("net");
  WiFiClient client;
  Serial.print(client.connect("192.168.4.1", PORT)); Serial.print(' ');
  client.print("GET /depth HTTP/1.0\\r\\n\\r\\n");
  while (client.connected() && !client.available()) delay(1);
  Serial.print(client.readStringUntil('\\r')); client.find("\\r\\n\\r\\n"); Serial.print(client.readString());
  Serial.print(client.connected()); Serial.print(client.connect("127.77.0.9", 1234));
}
void loop() {}
"""


ASYNC = """
#include <WiFi.h>
#include <AsyncTCP.h>
AsyncServer server(7778);
int acknowledged, polls, ends;
void setup() {
  Serial.begin(115200); WiFi.begin("net");
  server.onClient([](void *, AsyncClient *client) {
    client->onData([](void *, AsyncClient *one, void *data, size_t size) { one->write((char *)data, size); });
    client->onAck([](void *, AsyncClient *, size_t size, uint32_t) { acknowledged += size; });
    client->onPoll([](void *, AsyncClient *) { polls++; });
    client->onDisconnect([](void *, AsyncClient *one) { ends++; delete one; });
  }, nullptr);
  server.begin();
}
void loop() { delay(100); Serial.printf("%d %d %d\\n", acknowledged, polls, ends); }
"""
DIGESTS = """
#include <MD5Builder.h>
#include <libb64/cencode.h>
void setup() {
  Serial.begin(115200);
  for (int size : {0, 3, 55, 56, 64, 200}) {
    std::string text((size_t)size, 'x'); MD5Builder md5; char coded[300];
    md5.begin(); md5.add(text.c_str()); md5.calculate();
    base64_encode_chars(text.data(), size, coded);
    Serial.print(md5.toString() + coded + "\\n");
  }
}
void loop() {}
"""


@contextmanager
def stepping(bench: Bench):
    """Step the board beside, until the block is over."""
    over = threading.Event()

    def run() -> None:
        while not over.is_set():
            bench.run(0.1)

    beside = threading.Thread(target=run)
    beside.start()
    try:
        yield
    finally:
        over.set()
        beside.join()


def test_a_server_answers_http_above_the_privileged_ports(tmp_path):
    with running(tmp_path, PAGE, network="127.77.0.3") as bench:
        bench.run(0.1)
        with stepping(bench):
            for path in ("/left?speed=20", "/right"):
                asking = http.client.HTTPConnection("127.77.0.3", 8080, timeout=20)
                asking.request("GET", path)
                answer = asking.getresponse()
                assert (answer.status, answer.read()) == (200, f"asked for {path}".encode())
                asking.close()


def test_a_stream_comes_back_whole_and_the_other_end_may_go(tmp_path):
    data = bytes(range(256)) * 200
    with running(tmp_path, ECHO, network="127.77.0.4") as bench:
        bench.run(0.1)
        for _ in range(2):
            with stepping(bench), socket.create_connection(("127.77.0.4", 7777), 20) as one:
                threading.Thread(target=one.sendall, args=(data,)).start()
                back = b""
                while len(back) < len(data):
                    back += one.recv(4096)
            assert back == data


def test_a_client_asks_and_knows_a_refusal(tmp_path):
    class Depth(http.server.BaseHTTPRequestHandler):
        def do_GET(self):
            self.send_response(200)
            self.end_headers()
            self.wfile.write(f"{self.path} 12.5".encode())

        def log_message(self, *_: object) -> None:
            pass

    with http.server.HTTPServer(("127.0.0.1", 0), Depth) as server:
        beside = threading.Thread(target=server.serve_forever)
        beside.start()
        source = GET.replace("PORT", str(server.server_port))
        with running(tmp_path, source, network="127.77.0.5") as bench:
            for _ in range(200):
                bench.run(0.1)
                if bench.sent[0].endswith(b"00"):
                    break
            assert bench.sent[0] == b"1 HTTP/1.0 200 OK/depth 12.500"
        server.shutdown()
        beside.join()


def test_a_port_that_is_taken_ends_the_run(tmp_path):
    with socket.create_server(("127.77.0.6", 7777)):
        bench = running(tmp_path, ECHO, network="127.77.0.6")
        with bench, pytest.raises(SimulationError, match=r"TCP port 7777 at 127\.77\.0\.6"):
            bench.run(0.1)


def test_handlers_of_asynctcp_are_called(tmp_path):
    data = b"0123456789" * 50
    with running(tmp_path, ASYNC, network="127.77.0.7") as bench:
        bench.run(0.1)
        with stepping(bench), socket.create_connection(("127.77.0.7", 7778), 20) as one:
            one.sendall(data)
            back = b""
            while len(back) < len(data):
                back += one.recv(4096)
            assert back == data
        bench.run(1.0)
        acknowledged, polls, ends = map(int, bench.sent[0].splitlines()[-1].split())
        assert (acknowledged, ends) == (len(data), 1)
        assert polls >= 0


def test_digests_are_those_of_hashlib_and_base64(tmp_path):
    with running(tmp_path, DIGESTS) as bench:
        said = bench.run(0.3).decode().splitlines()
    for size, line in zip((0, 3, 55, 56, 64, 200), said, strict=True):
        text = b"x" * size
        assert line == hashlib.md5(text).hexdigest() + base64.b64encode(text).decode()
