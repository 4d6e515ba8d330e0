"""Tasks, timers, flash, CAN bus and network of an ESP32 in the host back end."""

import socket

import pytest

from seatrial.errors import InputError, SimulationError
from seatrial_kits.can.component import CanBus
from seatrial_kits.can.frame import Frame
from seatrial_kits.can.node import CanNode
from seatrial_kits.can.operations import BitRate, Transmit

from .test_esp32 import printed, running

pytestmark = pytest.mark.interop

ALONE = "void loop() { vTaskDelete(NULL); }\n"


def test_tasks_of_both_cores_go_on_beside_a_loop_that_never_waits(tmp_path):
    source = """
volatile uint32_t turns, core = 9;
void beat(void *rate) {
  TickType_t last = xTaskGetTickCount();
  core = xPortGetCoreID();
  for (;;) { Serial.print((char)(uintptr_t)rate); vTaskDelayUntil(&last, pdMS_TO_TICKS(20)); }
}
void setup() {
  Serial.begin(115200);
  xTaskCreatePinnedToCore(beat, "a", 4096, (void *)'a', 2, NULL, 0);
  xTaskCreate([](void *) { delay(50); Serial.print('x'); vTaskDelete(NULL); }, "x", 4096, NULL, 1, NULL);
}
void loop() { turns++; }
"""
    with running(tmp_path, source) as bench:
        assert bench.run(0.1) == b"aaaxaa"


def test_a_queue_a_semaphore_and_a_notice_hand_over(tmp_path):
    source = """
QueueHandle_t numbers; SemaphoreHandle_t mutex; TaskHandle_t taker;
void take(void *) {
  int n;
  for (int i = 0; i < 3; i++) if (xQueueReceive(numbers, &n, portMAX_DELAY)) { xSemaphoreTake(mutex, portMAX_DELAY); Serial.print(n); Serial.print('@'); Serial.print(millis()); Serial.print(' '); xSemaphoreGive(mutex); }
  Serial.print(xQueueReceive(numbers, &n, 5)); Serial.print(ulTaskNotifyTake(pdTRUE, portMAX_DELAY)); Serial.print('@'); Serial.print(millis());
  vTaskDelete(NULL);
}
void setup() {
  Serial.begin(115200);
  numbers = xQueueCreate(2, sizeof(int)); mutex = xSemaphoreCreateMutex();
  xTaskCreatePinnedToCore(take, "take", 4096, NULL, 1, &taker, 1);
  for (int n = 1; n < 4; n++) { delay(10); xQueueSend(numbers, &n, 0); }
  delay(20); xTaskNotifyGive(taker);
}
void loop() { delay(1); }
"""
    with running(tmp_path, source) as bench:
        assert bench.run(0.1) == b"1@10 2@20 3@30 01@50"


def test_a_task_that_returns_and_a_foreign_mutex_end_it(tmp_path):
    body = 'xTaskCreate([](void *) {}, "short", 4096, NULL, 1, NULL); delay(10);'
    source = f"void setup() {{ Serial.begin(115200); {body} }}\nvoid loop() {{}}\n"
    with (
        running(tmp_path, source) as bench,
        pytest.raises(SimulationError, match="the task short returned from its function"),
    ):
        bench.run(0.1)


def test_timers_of_both_generations_and_of_esp_idf(tmp_path):
    """1 MHz by 80 MHz over 80: 2 ms; 100 Hz of esp_timer; a Ticker; critical sections hold them."""
    source = """
#include <Ticker.h>
volatile int hard, newer, soft, ticks; Ticker ticker; esp_timer_handle_t timer;
portMUX_TYPE mux = portMUX_INITIALIZER_UNLOCKED;
void IRAM_ATTR tick() { portENTER_CRITICAL_ISR(&mux); hard++; portEXIT_CRITICAL_ISR(&mux); }
void setup() {
  Serial.begin(115200);
  hw_timer_t *one = timerBegin(0, 80, true);
  timerAttachInterrupt(one, &tick, true); timerAlarmWrite(one, 2000, true); timerAlarmEnable(one);
  hw_timer_t *other = timerBegin(1000000);
  timerAttachInterrupt(other, [] { newer++; }); timerAlarm(other, 5000, true, 0);
  esp_timer_create_args_t given = {}; given.callback = [](void *) { soft++; };
  esp_timer_create(&given, &timer); esp_timer_start_periodic(timer, 10000);
  ticker.attach_ms(20, [] { ticks++; });
  while (esp_timer_get_time() < 200500) {}
  portENTER_CRITICAL(&mux); int before = hard; delayMicroseconds(5000); int held = hard - before; portEXIT_CRITICAL(&mux);
  Serial.printf("%d %d %d %d %d", before, newer, soft, ticks, held);
}
void loop() {}
"""
    with running(tmp_path, source) as bench:
        hard, newer, soft, ticks, held = map(int, bench.run(0.3).split())
        assert hard == pytest.approx(100, abs=1)
        assert newer == pytest.approx(40, abs=1)
        assert soft == pytest.approx(20, abs=1)
        assert ticks == pytest.approx(10, abs=1)
        assert held == 0


def test_preferences_and_files_outlast_the_run(tmp_path):
    body = """
  Preferences kept; kept.begin("helm", false); int runs = kept.getInt("runs", 0) + 1; kept.putInt("runs", runs);
  kept.putString("name", "otter"); kept.putFloat("gain", 1.5f); Serial.print(runs); Serial.print(kept.getString("name")); Serial.print(kept.getFloat("gain")); kept.end();
  LittleFS.begin(true); File log = LittleFS.open("/log/a.txt", FILE_APPEND, true); log.printf("run %d\\n", runs); log.close();
  File folder = LittleFS.open("/log"); File each = folder.openNextFile(); Serial.print(each.name()); Serial.print(each.size());
  while (each.available()) Serial.write(each.read());
  Serial.print(LittleFS.exists("/../../etc/passwd"));
"""
    before = "#include <Preferences.h>\n#include <LittleFS.h>\n"
    flash = tmp_path / "flash"
    first = printed(tmp_path, body, before, 0.3, flash_after=str(flash))
    assert first == b"1otter1.50a.txt6run 1\n0"
    assert (flash / "littlefs" / "log" / "a.txt").read_text() == "run 1\n"
    assert (flash / "nvs" / "helm" / "runs").read_bytes() == b"\x01\0\0\0"
    second = printed(tmp_path, body, before, 0.3, flash=str(flash))
    assert second == b"2otter1.50a.txt12run 1\nrun 2\n0"
    with pytest.raises(InputError, match=r"flash: .*nowhere"):
        printed(tmp_path, body, before, flash=str(tmp_path / "nowhere"))


CAN = """
#include <driver/twai.h>
void setup() {
  Serial.begin(115200);
  twai_general_config_t general = TWAI_GENERAL_CONFIG_DEFAULT(GPIO_NUM_5, GPIO_NUM_4, TWAI_MODE_NORMAL);
  twai_timing_config_t timing = TWAI_TIMING_CONFIG_250KBITS();
  twai_filter_config_t filter = ACCEPTED;
  twai_driver_install(&general, &timing, &filter); twai_start();
}
void loop() {
  twai_message_t message;
  while (twai_receive(&message, pdMS_TO_TICKS(10)) == ESP_OK) {
    Serial.printf("%x/%d/%d ", message.identifier, message.extd, message.data_length_code);
    message.identifier++; message.data[0]++;
    twai_transmit(&message, pdMS_TO_TICKS(100));
  }
}
"""


@pytest.mark.parametrize(
    ("accepted", "seen"),
    [
        ("TWAI_FILTER_CONFIG_ACCEPT_ALL()", b"123/0/2 9f80103/1/8 "),
        ("{0x123u << 21, ~(0x7FFu << 21), true}", b"123/0/2 "),
    ],
)
def test_twai_is_on_the_simulated_bus(tmp_path, accepted, seen):
    """A board echoes the frames of a node; the bus checks its rate, and confirms what it sent."""
    bus = CanBus("bus")
    bus.set("bit_rate", 250_000)
    bus.initialise()
    bus.begin()
    memory = {}
    with running(tmp_path, CAN.replace("ACCEPTED", accepted)) as bench:
        node, back = CanNode(memory), []
        node.send_operation(0, BitRate(250_000))
        for step in range(20):
            if step == 5:
                node.send(bench.now, Frame(0x123, b"\x01\x02"))
                node.send(bench.now, Frame(0x9F80103, bytes(8), extended=True))
            bus.set("tx.n1", bench.one.get("can_tx"))
            bus.set("tx.n2", node.flush())
            bus.advance(bench.now / 1e9, 0.02)
            bench.one.set("can_rx", bus.get("rx.n1"))
            found = node.receive(bus.get("rx.n2"))
            back += [each.frame for _, each in found if isinstance(each, Transmit)]
            bench.run(0.02)
        assert bench.sent[0] == seen
        assert back[0] == Frame(0x124, b"\x02\x02")
        assert len(back) == seen.count(b" ")


UDP = """
#include <WiFi.h>
WiFiUDP udp;
void setup() {
  Serial.begin(115200); WiFi.begin("boat", "secret");
  while (WiFi.status() != WL_CONNECTED) delay(100);
  udp.begin(8888); delay(30); Serial.print(WiFi.localIP());
}
void loop() {
  char text[20];
  if (int size = udp.parsePacket()) {
    udp.read(text, size);
    udp.beginPacket(udp.remoteIP(), udp.remotePort()); udp.write((uint8_t *)text, size); udp.print("!"); udp.endPacket();
  }
  delay(5);
}
"""


def test_udp_goes_to_a_program_of_this_machine(tmp_path):
    with (
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other,
        running(tmp_path, UDP, network="127.77.0.2") as bench,
    ):
        other.bind(("127.0.0.1", 0))
        other.settimeout(10.0)
        assert bench.run(0.1) == b"127.77.0.2"
        other.sendto(b"ahoy", ("127.77.0.2", 8888))
        bench.run(0.1)
        assert other.recv(100) == b"ahoy!"


def test_without_a_network_it_is_alone_and_beyond_needs_permission(tmp_path):
    with running(tmp_path, UDP) as bench:
        assert bench.run(0.1) == b"192.168.4.1"
    with pytest.raises(InputError, match="--network"):
        running(tmp_path, UDP, network="192.0.2.1")
    with pytest.raises(InputError, match="'here' is no IPv4 address"):
        running(tmp_path, UDP, network="here")
