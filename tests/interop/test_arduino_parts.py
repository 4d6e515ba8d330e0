"""Shipped parts against their public driver libraries, as they are, where SEATRIAL_ARDUINO_LIBRARIES names the
folder of their clones.

A clone lies there under the name of its repository: lsm303-arduino (pololu), QMC5883LCompass (mprograms), AS5600
(RobTillaart), Adafruit_BNO055, Adafruit_BusIO, Adafruit_Sensor and Adafruit-PWM-Servo-Driver-Library (adafruit),
OneWire (PaulStoffregen), Arduino-Temperature-Control-Library (milesburton), SD (arduino-libraries), arduino-LoRa
(sandeepmistry).
"""

from __future__ import annotations

import math
import os
from pathlib import Path

import pytest

from tests.kits.arduino.bench import Bench, write_sketch

pytestmark = [pytest.mark.interop, pytest.mark.long]
FOLDER = Path(os.environ.get("SEATRIAL_ARDUINO_LIBRARIES", ""))

if not os.environ.get("SEATRIAL_ARDUINO_LIBRARIES"):
    pytest.skip("SEATRIAL_ARDUINO_LIBRARIES names no folder of clones", allow_module_level=True)

both = pytest.mark.parametrize("backend", ["host", "simavr"])
FIELD = {"magnetic_field.north": 2.1e-5, "magnetic_field.east": 3e-6, "magnetic_field.down": 4.2e-5}
DECLINATION = math.atan2(3e-6, 2.1e-5)
FORCE = [1.0, -2.0, -9.6]
GYRO = [0.1, -0.2, 0.3]
ATTITUDE = [0.1, -0.2, 1.2]


def said(tmp_path, backend, source, wires, *, libraries, seconds=1.0, **ports) -> list[float]:
    """Run a sketch with libraries as they are; return the numbers of its last whole line."""
    for library in libraries:
        if not (FOLDER / library).is_dir():
            pytest.skip(f"there is no {FOLDER / library}")
    sketch = write_sketch(tmp_path, source)
    with Bench(sketch, backend, wires=wires, libraries=str(FOLDER), **FIELD) as bench:
        for name, value in ports.items():
            bench.one.set(name, value)
        bench.run(seconds)
        lines = bench.sent[0].decode().split("\r\n")
    return [float(word) for word in lines[-2].split()]


LSM303 = """
#include <Wire.h>
#include <LSM303.h>
LSM303 compass;
void setup() { Serial.begin(115200); Wire.begin(); compass.init(); compass.enableDefault(); }
void loop() {
  compass.read();
  Serial.print(compass.a.x); Serial.print(' '); Serial.print(compass.a.y); Serial.print(' '); Serial.print(compass.a.z); Serial.print(' ');
  Serial.print(compass.m.x); Serial.print(' '); Serial.print(compass.m.y); Serial.print(' '); Serial.println(compass.m.z);
  delay(50);
}
"""


@both
def test_lsm303(tmp_path, backend):
    """By Pololu's notes 1 mg and 16 counts (12 bits on the left), 1100 and 980 counts per gauss."""
    wires = "0x19 lsm303_accelerometer; 0x1E lsm303_magnetometer"
    read = said(tmp_path, backend, LSM303, wires, libraries=["lsm303-arduino"], accelerometer=FORCE)
    assert [each / 16 for each in read[:3]] == pytest.approx(
        [each / 9.80665 * 1000 for each in FORCE], abs=1
    )
    assert read[3:] == pytest.approx([0.21 * 1100, 0.03 * 1100, 0.42 * 980], abs=1)


@both
def test_qmc5883l(tmp_path, backend):
    """8 G at 3000 counts per gauss: what init() sets."""
    source = """
#include <QMC5883LCompass.h>
QMC5883LCompass compass;
void setup() { Serial.begin(115200); compass.init(); }
void loop() {
  compass.read();
  Serial.print(compass.getX()); Serial.print(' '); Serial.print(compass.getY()); Serial.print(' '); Serial.println(compass.getZ());
  delay(50);
}
"""
    read = said(tmp_path, backend, source, "0x0D qmc5883l", libraries=["QMC5883LCompass"])
    assert read == pytest.approx([630, 90, 1260], abs=1)


@both
def test_as5600(tmp_path, backend):
    source = """
#include <Wire.h>
#include <AS5600.h>
AS5600 encoder;
void setup() { Serial.begin(115200); Wire.begin(); encoder.begin(); }
void loop() {
  Serial.print(encoder.isConnected()); Serial.print(' '); Serial.print(encoder.detectMagnet()); Serial.print(' ');
  Serial.print(encoder.rawAngle()); Serial.print(' '); Serial.println(encoder.readAngle());
  delay(50);
}
"""
    ports = {"angle.a2": math.radians(100.0)}
    read = said(tmp_path, backend, source, "0x36 as5600 2", libraries=["AS5600"], **ports)
    assert read == [1, 1, round(100 / 360 * 4096), round(100 / 360 * 4096)]


@both
def test_bno055(tmp_path, backend):
    source = """
#include <Wire.h>
#include <Adafruit_BNO055.h>
Adafruit_BNO055 bno(55, 0x28);
void show(Adafruit_BNO055::adafruit_vector_type_t which) {
  imu::Vector<3> v = bno.getVector(which);
  for (int i = 0; i < 3; i++) { Serial.print((float)v[i], 4); Serial.print(' '); }
}
void setup() { Serial.begin(115200); Serial.println(bno.begin()); }
void loop() {
  show(Adafruit_BNO055::VECTOR_EULER); show(Adafruit_BNO055::VECTOR_ACCELEROMETER);
  show(Adafruit_BNO055::VECTOR_GYROSCOPE); show(Adafruit_BNO055::VECTOR_MAGNETOMETER);
  Serial.println(bno.getTemp());
  delay(50);
}
"""
    libraries = ["Adafruit_BNO055", "Adafruit_BusIO", "Adafruit_Sensor"]
    ports = {"accelerometer": FORCE, "gyro": GYRO, "attitude": ATTITUDE, "temperature.t1": 290.15}
    read = said(tmp_path, backend, source, "0x28 bno055", libraries=libraries, seconds=3.0, **ports)
    phi, theta, psi = (math.degrees(each) for each in ATTITUDE)
    euler = [psi - math.degrees(DECLINATION), phi, theta]
    assert read[:3] == pytest.approx(euler, abs=1 / 16)
    assert read[3:6] == pytest.approx(FORCE, abs=0.01)
    assert read[6:9] == pytest.approx([math.degrees(each) for each in GYRO], abs=1 / 16)
    field = sum(each**2 for each in read[9:12]) ** 0.5  # turned into body axes, as long as before
    assert field == pytest.approx(1e6 * math.hypot(2.1e-5, 3e-6, 4.2e-5), abs=0.2)
    assert read[12] == 17


@both
def test_pca9685(tmp_path, backend):
    source = """
#include <Adafruit_PWMServoDriver.h>
Adafruit_PWMServoDriver pwm;
void setup() {
  Serial.begin(115200);
  pwm.begin(); pwm.setOscillatorFrequency(25000000); pwm.setPWMFreq(50);
  pwm.setPWM(0, 0, 307); pwm.writeMicroseconds(3, 1800); Serial.println(pwm.readPrescale());
}
void loop() {}
"""
    libraries = ["Adafruit-PWM-Servo-Driver-Library", "Adafruit_BusIO"]
    for library in libraries:
        if not (FOLDER / library).is_dir():
            pytest.skip(f"there is no {FOLDER / library}")
    sketch = write_sketch(tmp_path, source)
    with Bench(sketch, backend, wires="0x40 pca9685 2", libraries=str(FOLDER)) as bench:
        assert bench.run(0.3) == b"121\r\n"
        count = 4096 * 122 / 25e6 / 4096
        assert bench.one.get("pulse.s2") == pytest.approx(307 * count)
        assert bench.one.get("pulse.s5") == pytest.approx(1.8e-3, abs=count)
        assert bench.one.get("pulse.s3") == 0.0


@both
def test_ds18b20(tmp_path, backend):
    """The library finds it, and waits for its conversion; OneWire is written in registers."""
    source = """
#include <OneWire.h>
#include <DallasTemperature.h>
OneWire bus(7);
DallasTemperature sensors(&bus);
void setup() { Serial.begin(115200); sensors.begin(); }
void loop() {
  DeviceAddress at; bool found = sensors.getAddress(at, 0);
  unsigned long begin = millis(); sensors.requestTemperatures(); long took = millis() - begin;
  Serial.print(sensors.getDeviceCount()); Serial.print(' '); Serial.print(found ? at[0] : 0); Serial.print(' ');
  Serial.print(took); Serial.print(' '); Serial.println(sensors.getTempCByIndex(0), 4);
}
"""
    libraries = ["OneWire", "Arduino-Temperature-Control-Library"]
    ports = {"temperature.t3": 273.15 - 1.5625}
    read = said(tmp_path, backend, source, "7 ds18b20 3", libraries=libraries, seconds=2.0, **ports)
    assert read[:2] == [1, 0x28]
    assert read[2] == pytest.approx(750, abs=20)
    assert read[3] == -1.5625


SD_CARD = """
#include <SPI.h>
#include <SD.h>
void setup() {
  Serial.begin(115200);
  if (!SD.begin(53)) { Serial.println("-1"); return; }
  File log = SD.open("trip.csv", FILE_WRITE);
  for (int i = 0; i < 100; i++) { log.print(i); log.println(",12.5,knots"); }
  log.close();
  log = SD.open("trip.csv");
  long sum = 0; while (log.available()) sum += log.read();
  Serial.print(log.size()); Serial.print(' '); Serial.print(sum); Serial.print(' '); Serial.println(SD.exists("none.csv"));
}
void loop() {}
"""


def test_sd_card(tmp_path):
    """A file that the library writes is on the image, and it goes on with it; SD.h is written in registers."""
    backend = "simavr"
    if not (FOLDER / "SD").is_dir():
        pytest.skip(f"there is no {FOLDER / 'SD'}")
    text = b"".join(b"%d,12.5,knots\r\n" % i for i in range(100))
    sketch = write_sketch(tmp_path, SD_CARD)
    image = tmp_path / "card.img"
    values = {"libraries": str(FOLDER), "card_after": str(image)}
    with Bench(sketch, backend, wires="53 sd_card", **values) as bench:
        assert bench.run(2.0).split() == [b"%d" % len(text), b"%d" % sum(text), b"0"]
    assert text[:400] in image.read_bytes()
    with Bench(sketch, backend, wires="53 sd_card", card=str(image), **values) as bench:
        assert bench.run(2.0).split()[0] == b"%d" % (2 * len(text))  # it appends
    with Bench(sketch, backend, libraries=str(FOLDER)) as bench:
        assert bench.run(3.0) == b"-1\r\n"  # no card


LORA = """
#include <SPI.h>
#include <LoRa.h>
void setup() {
  Serial.begin(115200);
  LoRa.setPins(53, 48, 2);
  if (!LoRa.begin(868E6)) { Serial.println("none"); return; }
  unsigned long begin = millis();
  LoRa.beginPacket(); LoRa.print("hello "); LoRa.print(42); LoRa.endPacket();
  Serial.println(millis() - begin);
  if (DIO0) { LoRa.onReceive([](int size) { while (LoRa.available()) Serial.write(LoRa.read()); }); LoRa.receive(); }
}
void loop() {
  if (DIO0) return;
  if (LoRa.parsePacket()) { while (LoRa.available()) Serial.write(LoRa.read()); Serial.print(LoRa.packetRssi()); }
}
"""


@both
@pytest.mark.parametrize("by_interrupt", [0, 1])
def test_rfm95(tmp_path, backend, by_interrupt):
    """8 bytes at SF7, 125 kHz, 4/5, with 8 symbols of preamble: 36.1 ms (data sheet, 4.1.1.7)."""
    if not (FOLDER / "arduino-LoRa").is_dir():
        pytest.skip(f"there is no {FOLDER / 'arduino-LoRa'}")
    sketch = write_sketch(tmp_path, LORA)
    values = {"libraries": str(FOLDER), "flags": f"-DDIO0={by_interrupt}"}
    with Bench(sketch, backend, wires="53,2 rfm95 3", **values) as bench:
        took = int(bench.run(0.3))
        assert took == pytest.approx(36, abs=6)
        assert bench.sent[3] == b"hello 42"
        bench.receive(3, b"to you")
        assert bench.run(0.2).startswith(b"to you")
    with Bench(sketch, backend, **values) as bench:
        assert bench.run(0.3) == b"none\r\n"


HAND = """
#include <SPI.h>
#include <RF24.h>
RF24 radio(49, 53);
struct { int16_t throttle, rudder; } sticks = {700, -20};
void setup() {
  Serial.begin(115200);
  if (!radio.begin() || !radio.isChipConnected()) { Serial.println("none"); return; }
  radio.setChannel(80); radio.setDataRate(RF24_250KBPS);
  if (ANSWERS) { radio.enableDynamicPayloads(); radio.enableAckPayload(); } else radio.setPayloadSize(sizeof sticks);
  radio.openWritingPipe((const uint8_t *)"00001"); radio.stopListening();
}
void loop() {
  sticks.throttle++;
  Serial.print(radio.write(&sticks, sizeof sticks));
  if (ANSWERS && radio.isAckPayloadAvailable()) { int16_t volts; radio.read(&volts, sizeof volts); Serial.print(volts); }
  Serial.println(); delay(50);
}
"""
BOAT = """
#include <SPI.h>
#include <RF24.h>
RF24 radio(49, 53);
struct { int16_t throttle, rudder; } sticks;
int16_t volts = 740;
void setup() {
  Serial.begin(115200); radio.begin(); radio.setChannel(80); radio.setDataRate(RF24_250KBPS);
  if (ANSWERS) { radio.enableDynamicPayloads(); radio.enableAckPayload(); } else radio.setPayloadSize(sizeof sticks);
  radio.openReadingPipe(1, (const uint8_t *)"00001"); radio.startListening();
  if (ANSWERS) radio.writeAckPayload(1, &volts, sizeof volts);
}
void loop() {
  if (!radio.available()) return;
  radio.read(&sticks, sizeof sticks);
  Serial.print(sticks.throttle); Serial.print(' '); Serial.println(sticks.rudder);
  if (ANSWERS) radio.writeAckPayload(1, &volts, sizeof volts);
}
"""


@both
@pytest.mark.parametrize("answers", [0, 1])
def test_nrf24_between_two_boards(tmp_path, backend, answers):
    """Sticks go to the boat in each packet, and her voltage comes back with acknowledgements."""
    if not (FOLDER / "RF24").is_dir():
        pytest.skip(f"there is no {FOLDER / 'RF24'}")
    values = {"libraries": str(FOLDER), "flags": f"-DANSWERS={answers}"}
    wires = "53 nrf24 3"
    with (
        Bench(write_sketch(tmp_path, HAND, "hand"), backend, wires=wires, **values) as hand,
        Bench(write_sketch(tmp_path, BOAT, "boat"), backend, wires=wires, **values) as boat,
    ):
        for _ in range(50):
            for one, other in ((hand, boat), (boat, hand)):
                one.run(0.02)
                other.one.set("rx.uart3", one.one.get("tx.uart3"))
        assert hand.sent[3].startswith(b"00001")
        said = hand.sent[0].decode().split()
        received = [
            tuple(map(int, line.split())) for line in boat.sent[0].decode().splitlines()[:-1]
        ]
    assert len(received) > 10
    assert [throttle for throttle, _ in received] == list(
        range(received[0][0], received[0][0] + len(received))
    )
    assert {rudder for _, rudder in received} == {-20}
    assert set(said[:-1]) <= ({"1", "1740"} if answers else {"1"})
    assert said.count("1740") > 8 or not answers
    with Bench(tmp_path / "hand", backend, **values) as alone:
        assert alone.run(1.0).startswith(b"none")
