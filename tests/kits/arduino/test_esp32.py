"""Sketches for an ESP32 in the host back end: its API by Espressif's documentation."""

import pytest

from seatrial.errors import InputError, SimulationError
from seatrial_kits.arduino.sources.platformio import read_project
from tests.command import seatrial

from .bench import Bench, need, write_sketch

pytestmark = pytest.mark.interop

PIO = "[env:esp]\nplatform = espressif32\nboard = {}\nframework = arduino\n"


def running(folder, source, **values):
    """Return a board that is about to run ``source``."""
    need("host for ESP32")
    return Bench(write_sketch(folder, source), mcu="esp32", **values)


def printed(folder, body, before="", seconds=0.1, **values):
    """Return what `setup` with ``body`` prints."""
    source = f"{before}\nvoid setup() {{ Serial.begin(115200);\n{body}\n}}\nvoid loop() {{}}\n"
    with running(folder, source, **values) as bench:
        return bench.run(seconds)


def test_numbers_have_the_boards_widths(tmp_path):
    """Of the Xtensa ABI: 32 bits of int, long and pointers, 64 of double, char without a sign."""
    body = """
  struct Padded { char a; double b; unsigned long c; };
  Serial.printf("%u %u %u %u %u|", sizeof(int), sizeof(long), sizeof(void *), sizeof(double), sizeof(Padded));
  Serial.print((char)200 > 0); Serial.print(0xFFFFFFFFul + 1ul); Serial.print(' ');
  Serial.print(1.0 / 3.0, 9); Serial.print(' '); Serial.print(String(2.5, 1) + "V"); Serial.print(30000 * 60000ll);
"""
    assert printed(tmp_path, body) == b"4 4 4 8 24|10 0.333333333 2.5V1800000000"


def test_std_and_its_functions_are_there(tmp_path):
    body = """
  std::vector<int> all = {3, 1, 2}; std::sort(all.begin(), all.end());
  std::map<String, float> by = {{"b", 1.5f}, {"a", 0.5f}};
  std::function<int(int)> twice = [](int x) { return 2 * x; };
  Serial.print(all[0]); Serial.print(by.begin()->first); Serial.print(twice(21)); Serial.print(max(1, 2L)); Serial.print(std::min(3, 4));
"""
    assert printed(tmp_path, body, "#include <vector>\n#include <map>\n") == b"1a4223"


def test_pins_of_all_kinds(tmp_path):
    """An input's interrupt, the ADC of 12 bits at 3.3 V, and PWM of LEDC in both generations."""
    source = """
volatile int edges;
void IRAM_ATTR count() { edges++; }
void setup() {
  Serial.begin(115200);
  pinMode(4, INPUT_PULLUP);
  attachInterrupt(digitalPinToInterrupt(4), count, FALLING);
  ledcSetup(3, 5000, 10); ledcAttachPin(12, 3); ledcWrite(3, 256);
  ledcAttach(14, 1000, 8); ledcWrite(14, 192);
  analogWrite(27, 51);
  delay(500);
  Serial.print(edges); Serial.print(' '); Serial.print(analogRead(34)); Serial.print(' ');
  analogReadResolution(10); Serial.print(analogRead(A6)); Serial.print(' '); Serial.print(analogReadMilliVolts(34));
}
void loop() {}
"""
    wires = "4 anemometer 1; GPIO34 voltage 1; 12 pwm 1; 14 pwm 2; 27 pwm 3"
    with running(tmp_path, source, wires=wires) as bench:
        bench.one.set("voltage.v1", 1.65)
        bench.one.set("wind_speed", 100.0)
        edges, counts, coarse, millivolts = map(int, bench.run(0.6).split())
        assert edges == pytest.approx(50, abs=1)
        assert (counts, coarse, millivolts) == (2047, 511, 1650)
        assert bench.one.get("duty") == pytest.approx((0.25, 0.75, 0.2, 0, 0, 0, 0, 0), abs=1e-3)


def test_servos_have_their_pulses(tmp_path):
    """16 bits of 20 ms: steps of 0.3 us."""
    source = """
#include <ESP32Servo.h>
Servo one;
void setup() {
  one.setPeriodHertz(50); one.attach(13, 1000, 2000); one.write(45);
  ledcSetup(2, 50, 16); ledcAttachPin(25, 2); ledcWrite(2, 4915);
}
void loop() {}
"""
    with running(tmp_path, source, wires="13 servo 1; 25 servo 2") as bench:
        bench.run(0.1)
        assert bench.one.get("pulse.s1") == pytest.approx(1.25e-3, abs=0.4e-6)
        assert bench.one.get("pulse.s2") == pytest.approx(1.5e-3, abs=0.4e-6)


def test_a_uart_is_at_the_pins_that_it_is_opened_with(tmp_path):
    source = """
HardwareSerial gps(1);
void setup() { Serial.begin(115200); gps.begin(9600, SERIAL_8N1, 26, 27); }
void loop() { while (gps.available()) gps.write(toupper(gps.read())); }
"""
    for wires, sent in (
        ("", (b"$GP", b"")),
        ("26 soft_rx 2; 27 soft_tx 2", (b"", b"$GP")),
        ("32 soft_rx 2; 33 soft_tx 2", (b"", b"")),
    ):
        uarts = "0 115200; 1 9600" if not wires else "0 115200; 2 9600"
        with running(tmp_path, source, uarts=uarts, wires=wires) as bench:
            bench.run(0.1)
            bench.receive(2 if wires else 1, b"$gp")
            bench.run(0.1)
            assert (bench.sent[1], bench.sent[2]) == sent, wires


def test_wire_at_any_pins_has_the_parts(tmp_path):
    body = """
  Wire.begin(33, 32, 400000);
  Wire.beginTransmission(0x68); Wire.write(0x75); Serial.print(Wire.endTransmission(false));
  Serial.print(Wire.requestFrom(0x68, 1)); Serial.print(' '); Serial.print(Wire.read(), HEX); Serial.print(' ');
  Wire.beginTransmission(0x69); Serial.print(Wire.endTransmission());
"""
    found = printed(tmp_path, body, "#include <Wire.h>", wires="0x68 mpu6050")
    assert found == b"01 68 2"


def test_the_eeprom_keeps_what_is_committed(tmp_path):
    kept = tmp_path / "eeprom.bin"
    body = "EEPROM.begin(64); EEPROM.put(3, 1.5f); EEPROM.writeUInt(8, 7); EEPROM.commit(); EEPROM.write(0, 9);"
    printed(tmp_path, body, "#include <EEPROM.h>", eeprom_after=str(kept))
    assert kept.read_bytes()[:12] == b"\xff\xff\xff\x00\x00\xc0\x3f\xff\x07\x00\x00\x00"


def test_restart_begins_anew_and_says_why(tmp_path):
    body = "Serial.print(esp_reset_reason() == ESP_RST_SW); delay(20); if (esp_reset_reason() == ESP_RST_POWERON) ESP.restart();"
    with running(
        tmp_path, f"void setup() {{ Serial.begin(115200); {body} }}\nvoid loop() {{}}\n"
    ) as bench:
        assert bench.run(0.1) == b"01"
        assert bench.one.get("resets") == 1


def test_a_pin_that_is_none_ends_it(tmp_path):
    with (
        running(tmp_path, "void setup() { pinMode(40, OUTPUT); }\nvoid loop() {}\n") as bench,
        pytest.raises(SimulationError, match="uses pin 40: the ESP32 has 0 to 39"),
    ):
        bench.run(0.1)


def test_a_voltage_needs_an_adc(tmp_path):
    with pytest.raises(InputError, match="pin 5: the ESP32 has no ADC there"):
        running(tmp_path, "void setup() {}\nvoid loop() {}\n", wires="5 voltage 1")


@pytest.mark.parametrize(
    ("board", "mcu"), [("esp32dev", "esp32"), ("esp32-s3-devkitc-1", "esp32s3")]
)
def test_a_project_of_platformio_runs_as_it_is(tmp_path, board, mcu):
    need("host for ESP32")
    (tmp_path / "src").mkdir()
    (tmp_path / "platformio.ini").write_text(PIO.format(board), "utf-8")
    (tmp_path / "src" / "main.cpp").write_text(
        "#include <Arduino.h>\nvoid setup() { Serial.begin(115200); Serial.print(ESP.getChipModel()); }\nvoid loop() {}\n",
        "utf-8",
    )
    assert read_project(tmp_path / "platformio.ini").mcu == mcu
    with Bench(tmp_path) as bench:
        assert bench.run(0.1).startswith(b"ESP32-S3" if mcu == "esp32s3" else b"ESP32-D0")


def test_check_knows_the_board_of_arduino_cli_and_all_that_is_missing(tmp_path):
    need("host for ESP32")
    source = "#include <BLEDevice.h>\n#include <esp_event.h>\n#include <Absent.h>\nvoid setup() {}\nvoid loop() {}\n"
    sketch = write_sketch(tmp_path, source, sketch_dot_yaml="default_fqbn: esp32:esp32:esp32\n")
    done = seatrial("sketch", "check", str(sketch), cwd=tmp_path)
    assert done.returncode == 2
    assert "one on the ESP32 (esp32)" in done.stdout
    assert (
        "one.ino:1: <BLEDevice.h>: the back end 'host' of this board has not Bluetooth LE"
        in done.stderr
    )
    assert (
        "one.ino:2: <esp_event.h>: the back end 'host' of this board has not the radio"
        in done.stderr
    )
    assert "one.ino:3: the library of <Absent.h> is not there" in done.stderr


def test_simavr_has_no_esp32(tmp_path):
    sketch = write_sketch(tmp_path, "void setup() {}\nvoid loop() {}\n")
    with pytest.raises(InputError, match="emulates AVR microcontrollers, not the ESP32"):
        Bench(sketch, "simavr", mcu="esp32")


def test_registers_of_pins_are_pins(tmp_path):
    source = """
#include <soc/gpio_struct.h>
void setup() {
  Serial.begin(115200); pinMode(12, OUTPUT); pinMode(33, OUTPUT); pinMode(4, INPUT);
  GPIO.out_w1ts = 1 << 12; GPIO.out1_w1ts.val = 2;
  Serial.print(digitalRead(12)); Serial.print(digitalRead(33)); Serial.print(GPIO.in >> 4 & 1);
  GPIO.out_w1tc = 1 << 12; volatile uint32_t *out = portOutputRegister(digitalPinToPort(33));
  *out &= ~digitalPinToBitMask(33);
  delay(1); Serial.print(digitalRead(12)); Serial.print(digitalRead(33));
}
void loop() {}
"""
    with running(tmp_path, source, wires="4 input 1") as bench:
        bench.one.set("level.i1", True)
        assert bench.run(0.1) == b"11100"
