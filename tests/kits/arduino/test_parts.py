"""Parts at a board's buses and pins, in both back ends, and parts of one's own."""

import math

import pytest

from seatrial.errors import InputError, SimulationError
from seatrial_kits.arduino.parts.ma3 import Ma3

from .bench import Bench, write_sketch

pytestmark = pytest.mark.interop

both = pytest.mark.parametrize("backend", ["host", "simavr"])
READ = """
#include <Wire.h>
void set(byte at, byte reg, byte value) { Wire.beginTransmission(at); Wire.write(reg); Wire.write(value); Wire.endTransmission(); }
void show(byte at, byte reg, byte count) {
  Wire.beginTransmission(at); Wire.write(reg); Serial.print(Wire.endTransmission()); Serial.print(' ');
  Serial.print(Wire.requestFrom(at, count)); Serial.print(' ');
  while (Wire.available()) { Serial.print(Wire.read()); Serial.print(' '); }
}
"""
OWN = '''
"""A light sensor with registers as of its data sheet, on the angle that it has to the sun."""
from seatrial_kits.arduino.part import I2CRegisters, PinPart, Register, SpiPart, UartPart


class Light(I2CRegisters):
    ports = ("angle",)
    registers = {
        "GAIN": Register(0x01, 1, access="acts"),
        "COUNT": Register(0x02, form="u16be", access="r"),
        "ONCE": Register(0x08, access="latches"),
    }
    seen = 0

    def measure(self):
        self.put("COUNT", 1000 * self.get("GAIN") * self.inputs["angle"])
        self.answers = self.inputs["angle"] >= 0

    def written(self, name, value):
        self.measure()
        return value != 99

    def reading(self, name):
        self.seen += 1
        self.put("ONCE", self.seen)


class Echo(SpiPart):
    def selected(self):
        self.last = 0x41

    def exchange(self, sent):
        self.last = sent[-1] + 1 if sent else self.last
        return bytes([self.last])


class Line(UartPart):
    def received(self, data):
        self.send(data[::-1])


class Late(PinPart):
    pins = 2

    def edge(self, level):
        self.drive(self.places[1], [(self.time + 1e-3, level)])


class Broken(I2CRegisters):
    def measure(self):
        raise ValueError("no light")


class Blind(I2CRegisters):
    ports = ("lihgt",)
'''


def own(tmp_path, source):
    """Write a sketch and, beside it, a file of parts; return the sketch."""
    (tmp_path / "parts.py").write_text(OWN, "utf-8")
    return write_sketch(tmp_path, source)


@both
def test_a_part_of_ones_own_has_registers_a_range_and_a_bus_fault(tmp_path, backend):
    source = (
        READ
        + """
void setup() { Serial.begin(115200); Wire.begin(); show(0x29, 2, 3); set(0x29, 1, 4); set(0x29, 2, 7); show(0x29, 2, 2);
  Wire.beginTransmission(0x29); Wire.write(1); Wire.write(99); Serial.print(Wire.endTransmission()); Serial.print(' ');
  show(0x29, 8, 1); show(0x29, 8, 1); set(0x29, 0x55, 12); show(0x29, 0x55, 1); }
void loop() { if (millis() > 100) { show(0x29, 2, 1); delay(1000); } }
"""
    )
    wires = "0x29 ../parts.py:Light 2"
    with Bench(own(tmp_path, source), backend, wires=wires) as bench:
        bench.one.set("angle.a2", 0.5)
        said = [int(each) for each in bench.run(0.08).split()]
        assert said[:5] == [0, 3, 1, 244, 0]  # 500, from the high byte on, and an empty register
        assert said[5:9] == [
            0,
            2,
            7,
            208,
        ]  # 2000: its gain acts at once, and it is not to be written
        assert said[9] == 3  # a byte of data that is not acknowledged
        assert said[10:] == [0, 1, 1, 0, 1, 2, 0, 1, 12]
        bench.one.set("angle.a2", -1.0)  # it is gone from the bus
        assert bench.run(0.1).split() == [b"2", b"0"]


@both
def test_a_part_at_the_spi_is_full_duplex_and_selected_by_its_pin(tmp_path, backend):
    source = """
#include <SPI.h>
void say(byte x) { Serial.print(x); Serial.print(' '); }
void setup() {
  Serial.begin(115200); pinMode(49, OUTPUT); digitalWrite(49, HIGH); SPI.begin();
  say(SPI.transfer(10)); digitalWrite(49, LOW); say(SPI.transfer(10)); say(SPI.transfer(20)); say(SPI.transfer(0));
  digitalWrite(49, HIGH); say(SPI.transfer(5)); digitalWrite(49, LOW); say(SPI.transfer(7)); digitalWrite(49, HIGH);
}
void loop() {}
"""
    with Bench(own(tmp_path, source), backend, wires="49 ../parts.py:Echo") as bench:
        said = [int(each) for each in bench.run(0.1).split()]
    alone = said[0], said[4]
    assert said[1:4] == [0x41, 11, 21]
    assert said[5] == 0x41
    assert alone == (255, 255) if backend == "host" else True  # simavr holds the last byte


@both
def test_a_part_at_a_uart_and_one_at_pins(tmp_path, backend):
    source = """
volatile unsigned long at; void risen() { at = micros(); }
void setup() { Serial.begin(115200); Serial1.begin(38400); Serial1.print("abc"); pinMode(7, OUTPUT); pinMode(2, INPUT);
  attachInterrupt(digitalPinToInterrupt(2), risen, RISING); delay(5);
  unsigned long begin = micros(); digitalWrite(7, HIGH); delay(3); Serial.print((at - begin + 50) / 100); Serial.print(' '); }
void loop() { while (Serial1.available()) Serial.write(Serial1.read()); }
"""
    wires = "uart1 ../parts.py:Line; 7,2 ../parts.py:Late"
    with Bench(own(tmp_path, source), backend, wires=wires, uarts="0 115200; 1 38400") as bench:
        assert bench.run(0.2) == b"10 cba"


@pytest.mark.parametrize(
    ("wires", "expected"),
    [
        ("0x29 ../part.py:Light", r"there is no file .*part\.py"),
        ("0x29 ../parts.py:Dark", r"parts\.py has no class 'Dark'"),
        ("0x29 ../parts.py:OWN", r"has no class 'OWN'"),
        ("0x29 ../parts.py:Register", r"a class of seatrial_kits\.arduino\.part is needed"),
        ("0x29 ../parts.py:Light 9", r"the number 9 is not in 1 to 4"),
        ("0x29 ../parts.py:Blind", r"names the port 'lihgt'"),
        ("0x68 mpu605", r"kind 'mpu605'.*mpu6050"),
        ("7 mpu6050", r"an address, as 0x68 is needed, not '7'"),
        ("0x40 hcsr04", r"a pin is needed, not '0x40'"),
        ("7 hcsr04 1", r"2 pins are needed"),
        ("7,8 hcsr04 1; 8 input 1", r"this place is used twice"),
        ("0x68 mpu6050; 0x68 hmc5883l", r"this place is used twice"),
    ],
)
def test_wires_of_parts_that_cannot_be(tmp_path, wires, expected):
    sketch = own(tmp_path, "void setup() {}\nvoid loop() {}\n")
    with pytest.raises(InputError, match=expected):
        Bench(sketch, wires=wires)


def test_a_part_that_fails_ends_the_run_with_its_line(tmp_path):
    sketch = own(tmp_path, "void setup() {}\nvoid loop() {}\n")
    line = OWN.split("raise ValueError")[0].count("\n") + 1
    with (
        Bench(sketch, wires="0x29 ../parts.py:Broken") as bench,
        pytest.raises(
            SimulationError, match=rf"part Broken .*parts\.py:{line}\): ValueError: no light"
        ),
    ):
        bench.run(0.1)


@both
def test_an_ultrasonic_range_finder(tmp_path, backend):
    """Twice the distance at 343.4 m/s, 20 deg C; 38 ms if nothing comes back."""
    source = """
void setup() { Serial.begin(115200); pinMode(7, OUTPUT); pinMode(8, INPUT); }
void loop() {
  digitalWrite(7, LOW); delayMicroseconds(2); digitalWrite(7, HIGH); delayMicroseconds(10); digitalWrite(7, LOW);
  Serial.println(pulseIn(8, HIGH, 60000UL)); delay(60);
}
"""
    with Bench(write_sketch(tmp_path, source), backend, wires="7,8 hcsr04 1") as bench:
        for distance, width in ((1.5, 2 * 1.5 / 343.42 * 1e6), (0.3, 1747), (5.0, 38000)):
            bench.one.set("distance.d1", distance)
            bench.run(0.2)
            bench.sent[0] = b""
            read = [int(each) for each in bench.run(0.3).split()[1:-1]]
            assert read == pytest.approx([width] * len(read), rel=0.01, abs=20)
            assert read


@both
def test_a_compass_by_its_registers(tmp_path, backend):
    """CMPS12: bearing in 0.1 deg, pitch and roll in deg; 10 deg of declination are not in the bearing."""
    source = (
        READ
        + "void setup() { Serial.begin(115200); Wire.begin(); delay(30); show(0x60, 1, 5); }\nvoid loop() {}\n"
    )
    east = 2e-5 * math.tan(math.radians(10.0))
    field = {"magnetic_field.north": 2e-5, "magnetic_field.east": east, "magnetic_field.down": 4e-5}
    with Bench(write_sketch(tmp_path, source), backend, wires="0x60 cmps12", **field) as bench:
        bench.one.set("attitude", [math.radians(5.0), math.radians(-8.0), math.radians(100.0)])
        said = [int(each) for each in bench.run(0.1).split()]
    assert said == [0, 5, 64, 900 >> 8, 900 & 255, 256 - 8, 5]


@both
def test_a_programmed_range_of_an_angle(tmp_path, backend):
    """AS5600: from ZPOS on, a quarter turn has all counts."""
    source = (
        READ
        + """
void setup() { Serial.begin(115200); Wire.begin(); show(0x36, 0x0C, 4); set(0x36, 2, 0); set(0x36, 1, 1); set(0x36, 5, 4);
  show(0x36, 0x0E, 2); }
void loop() {}
"""
    )
    with Bench(write_sketch(tmp_path, source), backend, wires="0x36 as5600") as bench:
        bench.one.set("angle.a1", math.radians(33.75))  # 384 counts
        said = [int(each) for each in bench.run(0.1).split()]
    assert said[2:6] == [1, 128, 1, 128]  # its pointer comes round
    assert said[8] << 8 | said[9] == (384 - 256) * 4


@both
def test_a_card_by_its_commands(tmp_path, backend):
    """SD Physical Layer 6.00, 7.3: reset, interface, initialising, reading the boot sector, writing a sector."""
    source = """
#include <SPI.h>
byte answer(byte at) { byte x = 255; for (int i = 0; i < 20 && x == 255; i++) x = SPI.transfer(255); return x; }
byte command(byte number, uint32_t argument) {
  SPI.transfer(0x40 | number);
  for (int shift = 24; shift >= 0; shift -= 8) SPI.transfer(argument >> shift);
  SPI.transfer(0x95); return answer(0);
}
void say(int x) { Serial.print(x); Serial.print(' '); }
void setup() {
  Serial.begin(115200); pinMode(53, OUTPUT); SPI.begin(); digitalWrite(53, LOW);
  say(command(0, 0)); say(command(8, 0x1AA)); for (int i = 0; i < 4; i++) say(SPI.transfer(255));
  for (int i = 0; i < 3; i++) { command(55, 0); say(command(41, 0x40000000UL)); }
  say(command(17, 0)); say(answer(0)); long sum = 0;
  for (int i = 0; i < 510; i++) SPI.transfer(255);
  say(SPI.transfer(255)); say(SPI.transfer(255)); SPI.transfer(255); SPI.transfer(255);
  say(command(24, 1000)); SPI.transfer(0xFE); for (int i = 0; i < 514; i++) SPI.transfer(i); say(SPI.transfer(255) & 31);
  while (SPI.transfer(255) != 255) {}
  say(command(17, 1000)); say(answer(0)); for (int i = 0; i < 514; i++) { byte x = SPI.transfer(255); if (i == 77) say(x); }
  say(command(17, 4000000000UL)); say(command(63, 0)); digitalWrite(53, HIGH);
}
void loop() {}
"""
    image = tmp_path / "card.img"
    sketch = write_sketch(tmp_path, source)
    with Bench(sketch, backend, wires="53 sd_card", card_after=str(image)) as bench:
        said = [int(each) for each in bench.run(0.3).split()]
    assert said[:6] == [1, 1, 0, 0, 1, 0xAA]
    assert said[6:9] == [1, 0, 0]
    assert said[9:13] == [0, 0xFE, 0x55, 0xAA]
    assert said[13:18] == [0, 5, 0, 0xFE, 77]
    assert said[18:] == [0x40, 4]
    assert image.read_bytes()[1000 * 512 + 77] == 77
    assert image.stat().st_size == 32 << 20


@both
def test_a_wind_vane_by_its_pulses(tmp_path, backend):
    """MA3, 12 bits: position = 4098 t_on / (t_on + t_off) - 1."""
    source = """
void setup() { Serial.begin(115200); pinMode(5, INPUT); }
void loop() {
  long high = pulseIn(5, HIGH), low = pulseIn(5, LOW);
  Serial.println(high * 4098.0 / (high + low) - 1.0); delay(5);
}
"""
    with Bench(write_sketch(tmp_path, source), backend, wires="5 ma3") as bench:
        for blows_to, position in ((math.radians(-90.0), 1024), (math.radians(60.0), 2731)):
            bench.one.set("wind_angle", blows_to)
            bench.run(0.1)
            read = [float(each) for each in bench.run(0.2).split()[1:-1]]
            assert read == pytest.approx([position] * len(read), rel=0.01)
            assert len(read) > 3


@pytest.mark.parametrize(
    ("number", "angle", "width", "period"),
    [(1, 0.0, 2049, 4098), (10, 0.0, 513, 1026), (10, -math.pi, 1, 1026), (10, 3.136, 1025, 1026)],
)
def test_a_pwm_vane_has_the_pulses_of_its_bits(number, angle, width, period):
    """By the data sheet of MA3-P12 and MA3-P10."""
    pulses = []

    class Kept(Ma3):
        def pulse(self, pin, width, period):
            pulses.append((pin, round(width * 1e6), round(period * 1e6)))

    part = Kept((7,), number)
    part.inputs = {"wind_angle": angle}
    part.measure()
    assert pulses == [(7, width, period)]


def test_a_pwm_vane_has_12_or_10_bits():
    with pytest.raises(InputError, match="ma3 8: 12 or 10 bits"):
        Ma3((7,), 8)
