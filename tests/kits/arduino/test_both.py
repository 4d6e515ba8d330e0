"""The same sketch in both back ends: the firmware on an emulated AVR is the reference for the host's."""

import re
from pathlib import Path

import pytest

from .bench import Bench, write_sketch

pytestmark = pytest.mark.interop

BACKENDS = ("host", "simavr")
SKETCHES = Path(__file__).parent / "sketches"

SKETCH = r"""
#include <EEPROM.h>
#include <Servo.h>
#include <Wire.h>

const char TABLE[] PROGMEM = "flash";
volatile unsigned int edges = 0;
int overflowing = 32767;
Servo servos[3];

void setup() {
  Serial.begin(115200);
  Serial1.begin(38400);
  attachInterrupt(digitalPinToInterrupt(2), counted, FALLING);
  Wire.begin();
  wake(0x68, 0x6B, 0);
  for (int i = 0; i < 3; i++) servos[i].attach(9 + i);
  servos[0].writeMicroseconds(1433);
  servos[1].write(45);
  servos[2].writeMicroseconds(1905);
  analogWrite(6, 64);
  overflowing++;
  Serial.print(F("sizes "));
  Serial.print(sizeof(int)); Serial.print(sizeof(long)); Serial.print(sizeof(double)); Serial.println(sizeof(long long));
  Serial.print("over "); Serial.println(overflowing);
  Serial.print("hex "); Serial.print(-1, HEX); Serial.print(' '); Serial.print(200, BIN); Serial.print(' '); Serial.println((byte)77);
  Serial.print("floats "); Serial.print(3.14159, 4); Serial.print(' '); Serial.print(-0.005); Serial.print(' '); Serial.println(1e10);
  Serial.print("flash "); for (byte i = 0; i < 5; i++) Serial.print((char)pgm_read_byte(TABLE + i));
  Serial.println();
  char text[40];
  snprintf(text, sizeof(text), "%d %ld %u %5.2f|%04X|%s", -7, -70000L, 65535U, 1.5, 48879U, "end");
  Serial.print("printf "); Serial.println(text);
  Serial.print("random "); Serial.print(random(1000)); Serial.print(' '); randomSeed(7); Serial.println(random(10, 20));
  Serial.print("map "); Serial.print(map(512, 0, 1023, -90, 90)); Serial.print(' '); Serial.println(constrain(-5, 0, 10));
  String words = "one,two";
  words += ','; words += 3;
  Serial.print("string "); Serial.print(words.substring(words.indexOf(',') + 1)); Serial.print(' '); Serial.print(words.length()); Serial.print(' '); Serial.println(words.toInt());
  EEPROM.write(5, 99); Serial.print("eeprom "); Serial.print(EEPROM.read(5)); Serial.print(' '); Serial.println(EEPROM.read(6));
  unsigned long longest = 4294967295UL; longest += 2;
  Serial.print("long "); Serial.println(longest);
  Serial.print("binary "); Serial.println(B1010 | bit(4));
}

void loop() {
  delay(500);
  Wire.beginTransmission(0x68); Wire.write(0x47); Wire.endTransmission(false);
  Wire.requestFrom(0x68, 2);
  byte hi = Wire.read(), lo = Wire.read();
  int raw = (hi << 8) | lo;
  Serial.print("gyro "); Serial.println(raw);
  Serial.print("adc "); Serial.println(analogRead(A3));
  noInterrupts(); unsigned int n = edges; edges = 0; interrupts();
  Serial.print("edges "); Serial.println(n);
  Serial.print("pulse "); Serial.println(pulseIn(30, HIGH, 50000UL));
  Serial.print("level "); Serial.println(digitalRead(31));
  Serial.print("echo "); while (Serial1.available()) Serial.write(Serial1.read()); Serial.println();
  Serial.print("absent "); Wire.beginTransmission(0x20); Serial.println(Wire.endTransmission() != 0);
}

void wake(byte device, byte address, byte value) {
  Wire.beginTransmission(device); Wire.write(address); Wire.write(value); Wire.endTransmission();
}
void counted() { edges++; }
"""
WIRES = (
    "9 servo 1; 10 servo 2; 11 servo 3; 6 pwm 1; 0x68 mpu6050; A3 voltage 1; 2 anemometer 2; "
    "30 receiver 1; 31 input 1"
)


def parsed(text: bytes) -> dict[str, str]:
    """Return the last line of each word."""
    return dict(line.split(" ", 1) for line in text.decode("ascii").split("\r\n") if " " in line)


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """Output and pins of the sketch in both back ends."""
    sketch = write_sketch(tmp_path_factory.mktemp("sketch"), SKETCH)
    found = {}
    for backend in BACKENDS:
        with Bench(sketch, backend, wires=WIRES, uarts="0 115200; 1 38400") as bench:
            bench.one.set("gyro", [0.0, 0.0, -0.3])
            bench.one.set("voltage.v1", 3.3)
            bench.one.set("wind_speed", 5.0)
            bench.one.set("receiver.c1", 0.0016)
            bench.one.set("level.i1", True)
            bench.run(0.2)
            bench.receive(1, b"abc")
            bench.run(1.2)
            found[backend] = (
                parsed(bench.sent[0]),
                bench.one.get("pulse"),
                bench.one.get("duty"),
                bench.stamps,
            )
    return found


def test_they_send_the_same(runs):
    host, simavr = (runs[each][0] for each in BACKENDS)
    # What code takes and when an edge is seen differs by microseconds.
    near = {"pulse": 20, "adc": 1, "edges": 1}
    assert host.keys() == simavr.keys()
    for word, text in simavr.items():
        if word in near:
            assert abs(int(host[word]) - int(text)) <= near[word], word
        else:
            assert host[word] == text, word


@pytest.mark.parametrize("backend", BACKENDS)
def test_what_it_reads_is_what_is_there(runs, backend):
    sent = runs[backend][0]
    assert int(sent["gyro"]) == round(-0.3 * 57.29577951 * 131)
    assert int(sent["adc"]) == pytest.approx(3.3 / 5 * 1024, abs=1.5)
    assert int(sent["edges"]) == pytest.approx(5, abs=1)  # 10 Hz for half a second
    assert int(sent["pulse"]) == pytest.approx(1600, abs=20)  # pulseIn counts loops
    assert (sent["level"], sent["absent"], sent["sizes"]) == ("1", "1", "2448")
    assert sent["over"] == "-32768"


@pytest.mark.parametrize("backend", BACKENDS)
def test_pulses_are_those_commanded(runs, backend):
    pulses = [1e6 * each for each in runs[backend][1][:3]]
    assert pulses == pytest.approx([1433, 544 + (2400 - 544) * 45 / 180, 1905], abs=3.0)
    assert runs[backend][2][0] == pytest.approx(64 / 255, abs=0.005)


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_second_run_is_the_same(tmp_path, backend):
    sketch = write_sketch(tmp_path, SKETCH)
    stamps = []
    for _ in range(2):
        with Bench(sketch, backend, wires=WIRES, uarts="0 115200; 1 38400") as bench:
            bench.one.set("wind_speed", 3.0)
            bench.run(0.1)
            bench.receive(1, b"x")
            bench.run(0.7)
            stamps.append((bench.stamps, bench.one.get("pulse")))
    assert stamps[0] == stamps[1]


@pytest.mark.parametrize("backend", BACKENDS)
def test_bytes_leave_at_the_baud_rate(tmp_path, backend):
    source = 'void setup() { Serial.begin(9600); } void loop() { Serial.print(F("0123456789")); }'
    with Bench(write_sketch(tmp_path, source), backend, uarts="0 9600") as bench:
        bench.run(1.0)
        assert re.match(rb"(0123456789)+", bench.sent[0])
        bits = 10 if backend == "host" else 11  # simavr counts a parity bit
        assert len(bench.sent[0]) == pytest.approx(9600 / bits, rel=0.02)


RECEIVED = {
    "library": b"noise$-12.75,42,abc*xyz rest\nq",
    "language": b"noise$-12.75,42,abc*xyz rest\nq",
    "avrlibc": b"noise$$H 2123456789.5,x-1,234.75z abbbd*x;q",
}


@pytest.mark.parametrize("name", RECEIVED)
def test_they_print_the_same(name):
    """Firmware of Debian's core and avr-libc is the reference for the output of the host's API."""
    printed = []
    for backend in ("host", "simavr"):
        with Bench(SKETCHES / name, backend, uarts="0 57600", wires="0x68 mpu6050") as bench:
            bench.run(0.8)
            bench.receive(0, RECEIVED[name])
            bench.run(2.6)
            printed.append(bench.sent[0].decode().splitlines())
    assert printed[0] == printed[1]
    assert len(printed[0]) > 70
