"""A camera on I2C, pulses of a stepper motor, and a supply that fails: both back ends."""

import math

import pytest

from seatrial_kits.arduino.wiring import BLOCKS
from seatrial_kits.sailing.camera import SLOTS

from .bench import Bench, write_sketch

BACKENDS = ["host", pytest.param("simavr", marks=pytest.mark.interop)]
both = pytest.mark.parametrize("backend", BACKENDS)

# As the maker's porting guide reads a stream: words, a sync before each block, one more before a frame.
CAMERA = """
#include <Wire.h>
unsigned int word16() {
  Wire.requestFrom(0x54, 2);
  unsigned int low = Wire.read();
  return low | (unsigned int)Wire.read() << 8;
}
void setup() { Serial.begin(115200); Wire.begin(); }
void loop() {
  static unsigned int before = 0;
  unsigned int found = word16();
  if (found == 0xAA55 && before == 0xAA55) { Serial.print("frame "); }
  if (found && found != 0xAA55) {
    unsigned int words[6] = {found}, sum = 0;
    for (int i = 1; i < 6; i++) { words[i] = word16(); sum += words[i]; }
    Serial.print(sum == words[0] ? "good" : "bad");
    for (int i = 1; i < 6; i++) { Serial.print(' '); Serial.print(words[i]); }
    Serial.println();
  }
  before = found;
}
"""
STEPS = """
void setup() { pinMode(4, OUTPUT); pinMode(5, OUTPUT); pinMode(6, OUTPUT); digitalWrite(5, HIGH); }
void go(int pin, int count) {
  for (int i = 0; i < count; i++) {
    digitalWrite(pin, HIGH); delayMicroseconds(10);
    digitalWrite(pin, LOW); delayMicroseconds(90);
  }
}
void loop() { go(4, 500); digitalWrite(5, LOW); go(4, 200); go(6, 7); while (true) delay(10); }
"""
SUPPLY = """
#include <EEPROM.h>
void setup() { Serial.begin(9600); byte n = EEPROM.read(0) + 1; EEPROM.write(0, n); Serial.println(n); }
void loop() { if (Serial.available()) Serial.write(Serial.read()); }
"""


def test_it_takes_what_the_camera_gives():
    assert BLOCKS == SLOTS


@pytest.mark.slow
@both
def test_a_camera_as_its_maker_reads_it(tmp_path, backend):
    wires = {"wires": "0x54 pixy", "backend": backend}
    with Bench(write_sketch(tmp_path, CAMERA), **wires) as bench:
        bench.run(0.1)
        bearing, size = math.radians(10), math.radians(3)
        bench.one.set("sight_bearing", [bearing, -bearing, 0, 0, 0, 0])
        bench.one.set("sight_size", [size, 2 * size, 0, 0, 0, 0])
        bench.one.set("sight_kind", [1, 2, 0, 0, 0, 0])
        for frame, count in ((1, 2), (1, 2), (2, 0), (3, 1)):
            bench.one.set("sight_count", count)
            bench.one.set("sight_frame", frame)
            bench.run(0.2)
        said = bench.sent[0].decode().split("\r\n")
    focal = 160 / math.tan(math.radians(37.5))
    x, width = round(160 + focal * math.tan(bearing)), round(2 * focal * math.tan(size / 2))
    assert said[0] == f"frame good 1 {x} 100 {width} {width}"
    wide = round(2 * focal * math.tan(size))
    assert said[1] == f"good 2 {320 - x} 100 {wide} {wide}"
    assert said[2:] == [said[0], ""]  # a frame is read once, an empty one is silence


@pytest.mark.slow
@both
def test_pulses_are_counted_with_their_direction(tmp_path, backend):
    wires = {"wires": "4 step 1; 5 direction 1; 6 step 2", "backend": backend}
    with Bench(write_sketch(tmp_path, STEPS), **wires) as bench:
        bench.run(0.04)
        rising = bench.one.get("steps")[0]
        assert 250 < rising < 450
        bench.run(0.2)
        assert bench.one.get("steps") == [300, 7, 0, 0]


@both
def test_without_a_supply_it_is_off_and_then_begins_anew(tmp_path, backend):
    settings = {"uarts": "0 9600", "backend": backend, "supply_min": 3.7}
    with Bench(write_sketch(tmp_path, SUPPLY), **settings) as bench:
        assert bench.run(0.1) == b"0\r\n"
        bench.one.set("supply", 3.0)
        bench.receive(0, b"lost")
        assert bench.run(0.1) == b""
        assert (bench.one.get("powered"), bench.one.get("resets")) == (False, 0)
        bench.one.set("supply", 6.0)
        assert bench.run(0.1) == b"1\r\n"
        bench.receive(0, b"x")
        assert bench.run(0.1) == b"x"
        assert (bench.one.get("powered"), bench.one.get("resets")) == (True, 1)
        assert all(when > 2e8 for _, when, data in bench.stamps if data == b"x")
