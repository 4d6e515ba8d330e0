"""An ESP32's Bluetooth, card, watchdog and ESP-IDF drivers, by Espressif's documentation."""

import hashlib

import pytest

from seatrial.errors import InputError

from .test_esp32 import printed, running

pytestmark = [pytest.mark.interop, pytest.mark.slow]

BLUETOOTH = """
#include <BluetoothSerial.h>
#if !defined(CONFIG_BT_ENABLED) || !defined(CONFIG_BLUEDROID_ENABLED)
#error
#endif
BluetoothSerial SerialBT;
void told(esp_spp_cb_event_t event, esp_spp_cb_param_t *) { if (event == ESP_SPP_SRV_OPEN_EVT) Serial.print("open "); }
void setup() { Serial.begin(115200); SerialBT.register_callback(told); SerialBT.begin("boat"); Serial.print(SerialBT.hasClient()); }
void loop() { if (SerialBT.available()) { String line = SerialBT.readStringUntil('\\n'); SerialBT.println("got " + line); Serial.print(line); } }
"""


def test_bluetooth_is_the_line_of_uart_3(tmp_path):
    with running(tmp_path, BLUETOOTH, uarts="0 115200; 3 115200") as bench:
        bench.run(0.1)
        bench.receive(3, b"F80\n")
        assert bench.run(0.2) == b"F80"
        assert bench.sent[3] == b"got F80\r\n"
        assert bench.sent[0] == b"open 1F80"
    (tmp_path / "alone").mkdir()
    with running(tmp_path / "alone", BLUETOOTH) as bench:
        assert bench.run(0.2) == b"0"


WATCHDOG = """
#include <esp_task_wdt.h>
void setup() { Serial.begin(115200); Serial.print("begin "); esp_task_wdt_init(1, true); esp_task_wdt_add(NULL); Serial.print(esp_task_wdt_status(NULL)); }
void loop() { if (millis() < 3000) esp_task_wdt_reset(); delay(10); }
"""


def test_a_task_that_is_late_restarts_the_board(tmp_path):
    with running(tmp_path, WATCHDOG) as bench:
        bench.run(3.8)
        assert bench.one.get("resets") == 0
        bench.run(0.4)
        assert bench.one.get("resets") == 1
        assert bench.sent[0] == b"begin 0begin 0"


def test_drivers_sha_card_and_frames_of_uarts(tmp_path):
    before = """
#include <SD.h>
#include <SD_MMC.h>
#include <driver/ledc.h>
#include <driver/adc.h>
#include <esp_adc_cal.h>
#include <sha/sha_parallel_engine.h>
#include <cbuf.h>
#include "soc/soc.h"
#include "soc/rtc_cntl_reg.h"
"""
    body = """
  WRITE_PERI_REG(RTC_CNTL_BROWN_OUT_REG, 0);
  Serial2.begin(100000, SERIAL_8E2, 16, 17, true);
  Serial.print(SD.begin(5)); File log = SD.open("/log.csv", FILE_APPEND); log.println("1,2"); log.close();
  Serial.print(SD.open("/log.csv").size()); Serial.print(SD.cardType() == CARD_SDHC); Serial.print(SD_MMC.begin());
  File root = SD.open("/"); Serial.print(root.openNextFile().name()); Serial.print(' ');
  ledc_timer_config_t timer = {LEDC_LOW_SPEED_MODE, LEDC_TIMER_10_BIT, LEDC_TIMER_1, 1000, LEDC_AUTO_CLK};
  ledc_channel_config_t channel = {12, LEDC_LOW_SPEED_MODE, LEDC_CHANNEL_2, LEDC_INTR_DISABLE, LEDC_TIMER_1, 256, 0};
  ledc_timer_config(&timer); ledc_channel_config(&channel);
  ledc_set_duty(LEDC_LOW_SPEED_MODE, LEDC_CHANNEL_2, 768); ledc_update_duty(LEDC_LOW_SPEED_MODE, LEDC_CHANNEL_2);
  esp_adc_cal_characteristics_t made; adc1_config_width(ADC_WIDTH_BIT_12); adc1_config_channel_atten(ADC1_CHANNEL_6, ADC_ATTEN_DB_11);
  esp_adc_cal_characterize(ADC_UNIT_1, ADC_ATTEN_DB_11, ADC_WIDTH_BIT_12, 1100, &made);
  Serial.print(esp_adc_cal_raw_to_voltage(adc1_get_raw(ADC1_CHANNEL_6), &made)); Serial.print(' ');
  cbuf ring(4); Serial.print(ring.write("abcdef", 6)); Serial.print((char)ring.read()); Serial.print(ring.room()); Serial.print(' ');
  for (int size : {3, 55, 56, 200}) {
    std::string text(size, 'x'); unsigned char sum[20]; esp_sha(SHA1, (const unsigned char *)text.data(), size, sum);
    for (int i = 0; i < 20; i++) Serial.printf("%02x", sum[i]);
    Serial.print(' ');
  }
"""
    source = f"{before}\nvoid setup() {{ Serial.begin(115200); delay(50);\n{body}\n}}\nvoid loop() {{}}\n"
    wires = "12 pwm 1; GPIO34 voltage 1"
    with running(tmp_path, source, wires=wires, uarts="0 115200; 2 100000") as bench:
        bench.one.set("voltage.v1", 1.5)
        said = bench.run(0.3).decode().split()
        assert bench.one.get("duty")[0] == pytest.approx(0.75, abs=1e-3)
    assert said[0] == "1511log.csv"
    assert int(said[1]) == pytest.approx(1500, abs=2)
    assert said[2] == "4a1"
    assert said[3:] == [hashlib.sha1(b"x" * size).hexdigest() for size in (3, 55, 56, 200)]


def test_events_of_the_wifi(tmp_path):
    body = """
  WiFi.onEvent([](WiFiEvent_t event) { Serial.print(event == ARDUINO_EVENT_WIFI_STA_GOT_IP ? "ip " : "other "); });
  WiFi.onEvent([](WiFiEvent_t, WiFiEventInfo_t) { Serial.print("joined "); }, ARDUINO_EVENT_WIFI_STA_CONNECTED);
  Serial.print(WiFi.scanNetworks()); WiFi.begin("net"); Serial.print(WiFi.SSID(0)); Serial.print(WiFi.scanNetworks());
"""
    said = printed(tmp_path, body, "#include <WiFi.h>")
    assert said == b"0other other joined ip net1"


def test_what_the_board_has_not_is_named(tmp_path):
    with pytest.raises(InputError, match="Bluetooth LE") as found:
        running(
            tmp_path,
            "#include <BLEDevice.h>\n#include <esp_camera.h>\nvoid setup() {}\nvoid loop() {}\n",
        )
    assert "the camera" in str(found.value)
