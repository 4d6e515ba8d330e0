"""ESP-NOW of an ESP32, by Espressif's documentation; two boards as in its examples."""

import pytest

from seatrial.links.text import decode, encode

from .test_esp32 import running

pytestmark = pytest.mark.interop

REMOTE = """
#include <WiFi.h>
#include <esp_now.h>
uint8_t boat[] = {0x24, 0x6F, 0x28, 1, 2, 3};
int sent, received;
void on_sent(const uint8_t *, esp_now_send_status_t status) { sent += status == ESP_NOW_SEND_SUCCESS; }
void on_received(const uint8_t *mac, const uint8_t *data, int size) { received = data[0]; Serial.printf("%02X%02X %d %d;", mac[0], mac[5], size, received); }
void setup() {
  Serial.begin(115200); WiFi.mode(WIFI_STA);
  Serial.print(esp_now_send(boat, boat, 1) == ESP_ERR_ESPNOW_NOT_INIT);
  esp_now_init(); esp_now_register_send_cb(on_sent); esp_now_register_recv_cb(on_received);
  Serial.print(esp_now_send(boat, boat, 1) == ESP_ERR_ESPNOW_NOT_FOUND);
  esp_now_peer_info_t peer = {}; memcpy(peer.peer_addr, boat, 6);
  Serial.print(esp_now_add_peer(&peer)); Serial.print(esp_now_add_peer(&peer) == ESP_ERR_ESPNOW_EXIST);
  uint8_t much[251] = {}; Serial.print(esp_now_send(boat, much, 251) == ESP_ERR_ESPNOW_ARG); Serial.print(' ');
}
void loop() {
  char text[] = "12,-7";
  if (millis() % 100 == 50) { esp_now_send(boat, (uint8_t *)text, 5); delay(2); Serial.print(sent); Serial.print(' '); }
}
"""
BOAT = """
#include <WiFi.h>
#include <esp_now.h>
#include <esp_wifi.h>
void on_received(const esp_now_recv_info_t *info, const uint8_t *data, int size) {
  String text((const char *)data, size); Serial.print(text); Serial.print(' ');
  uint8_t volts = 74;
  if (!esp_now_is_peer_exist(info->src_addr)) {
    esp_now_peer_info_t peer = {}; memcpy(peer.peer_addr, info->src_addr, 6); esp_now_add_peer(&peer);
  }
  esp_now_send(info->src_addr, &volts, 1);
}
void setup() {
  Serial.begin(115200); WiFi.mode(WIFI_STA);
  esp_wifi_set_channel(1, WIFI_SECOND_CHAN_NONE);
  esp_now_init(); esp_now_register_recv_cb(on_received);
}
void loop() {}
"""


def test_frames_go_between_two_boards(tmp_path):
    (tmp_path / "a").mkdir()
    (tmp_path / "b").mkdir()
    with (
        running(tmp_path / "a", REMOTE, wires="uart3 espnow") as remote,
        running(tmp_path / "b", BOAT, wires="uart3 espnow") as boat,
    ):
        for _ in range(25):
            for one, other in ((remote, boat), (boat, remote)):
                one.run(0.02)
                other.one.set("rx.uart3", one.one.get("tx.uart3"))
        assert remote.sent[0].startswith(b"11011 1 A401 1 74;2 ")
        assert boat.sent[0].split()[:2] == [b"12,-7", b"12,-7"]


def test_a_frame_is_addresses_and_data_at_the_ports(tmp_path):
    with running(tmp_path, BOAT, wires="uart3 espnow") as boat:
        boat.run(0.1)
        frame = bytes(range(6)) + bytes.fromhex("CCDBA79813D0") + b"go"
        boat.one.set("rx.uart3", encode(1, [(boat.now, frame)]))
        assert boat.run(0.1) == b"go "
        _, chunks = decode(boat.one.get("tx.uart3"))
        assert [data for _, data in chunks] == [
            bytes.fromhex("CCDBA79813D0") + bytes.fromhex("A40000000001") + b"J"
        ]
