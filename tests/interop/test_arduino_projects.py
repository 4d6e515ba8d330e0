"""Firmware of public projects, unmodified, where SEATRIAL_ARDUINO_PROJECTS names the folder of their clones.

A clone lies there under the name of its repository: pypilot (pypilot/pypilot), openrov-software-arduino
(OpenROV), ping-arduino (bluerobotics), multiwii-firmware (multiwii), boat_autopilot (KastB), freeboardPLC (rob42).
"""

from __future__ import annotations

import math
import os
import struct
from pathlib import Path

import pytest

from tests.kits.arduino.bench import Bench

pytestmark = [pytest.mark.interop, pytest.mark.long]
FOLDER = Path(os.environ.get("SEATRIAL_ARDUINO_PROJECTS", ""))

if not os.environ.get("SEATRIAL_ARDUINO_PROJECTS"):
    pytest.skip("SEATRIAL_ARDUINO_PROJECTS names no folder of clones", allow_module_level=True)


def board(place: str, backend: str = "simavr", **values: object) -> Bench:
    """Return a board with a project's sketch; skip without it."""
    if not (FOLDER / place).exists():
        pytest.skip(f"there is no {FOLDER / place}")
    return Bench(FOLDER / place, backend, **values)


# ---------------------------------------------------------------------- pypilot's motor controller

COMMAND, MAX_CURRENT, RUDDER_MAX, DISENGAGE = 0xC7, 0x1E, 0x4D, 0x68
CURRENT, VOLTAGE, RUDDER, FLAGS = 0x1C, 0xB3, 0xA7, 0x8F
SYNC, OVERCURRENT, ENGAGED, INVALID, BAD_VOLTAGE, MAX_RUDDER = 1, 4, 8, 16, 128, 512
STEP = 0.02
_LEVELS = "6 input 1; 7 input 2; 8 input 3; 4 input 4; 5 input 5; 12 input 6"
_VOLTAGES = "A0 voltage 1; A1 voltage 2; A2 voltage 3; A3 voltage 4; A4 voltage 5"


def crc8(data: bytes) -> int:
    """CRC-8 of polynomial 0x31, from 0xFF, highest bit first."""
    crc = 0xFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = (crc << 1 ^ (0x31 if crc & 0x80 else 0)) & 0xFF
    return crc


class Helm:
    """A boat whose rudder pypilot's controller turns, and who steers it over its serial line.

    Rudder: a motor whose rate is in proportion to the pulse, 10 deg/s at 2 ms, with a sensor of 0.55 V amidships
    and 0.01 V/deg. Yaw: Nomoto's first order, T = 2 s, K = 0.3 1/s.
    """

    def __init__(self) -> None:
        self.bench = board(
            "pypilot/arduino/motor",
            mcu="atmega328p",
            uarts="0 38400",
            wires=f"9 servo 1; 11 output 1; {_LEVELS}; {_VOLTAGES}",
        )
        for number in (1, 2, 3, 5, 6):
            self.bench.one.set(f"level.i{number}", True)  # jumpers open, end switches closed
        self.rudder = self.psi = self.r = 0.0
        self.amperes, self.volts = 0.0, 12.0
        self.read: dict[int, int] = {}
        self.packets = self.bad = 0
        self._taken = 0

    def step(self, *packets: bytes) -> None:
        """Let one communication step pass, with these packets on the line."""
        one = self.bench.one
        analogue = (
            self.volts * 560 / 10560,
            self.amperes * 0.01,  # ohm: the jumper of pin 4 is closed
            0.4545,
            0.4545,
            0.55 + 0.01 * self.rudder,
        )
        for number, value in enumerate(analogue, 1):
            one.set(f"voltage.v{number}", value)
        if packets:
            self.bench.receive(0, b"".join(packets))
        self.bench.run(STEP)
        pulse = one.get("pulse.s1")
        drive = (pulse - 0.0015) / 0.00075 if one.get("output.o1") and pulse else 0.0
        self.rudder += max(-1.0, min(1.0, drive)) * 10.0 * STEP
        self.r += (0.3 * self.rudder - self.r) / 2.0 * STEP
        self.psi += self.r * STEP
        self._take()

    def _take(self) -> None:
        sent = self.bench.sent[0]
        while self._taken + 4 <= len(sent):
            packet = sent[self._taken : self._taken + 4]
            good = crc8(packet[:3]) == packet[3]
            self._taken += 4 if good else 1
            self.packets += good
            self.bad += not good
            if good:
                self.read[packet[0]] = packet[1] | packet[2] << 8

    def command(self, wanted: float) -> bytes:
        """Return the packet that steers for a heading: heading, its rate and the rudder as it was read."""
        rudder = (self.read.get(RUDDER, 32736) / 65472 * 1.1 - 0.55) / 0.01
        aim = max(-20.0, min(20.0, 1.0 * (wanted - self.psi) - 2.0 * self.r))
        return packet(COMMAND, round(1000 + 1000 * max(-1.0, min(1.0, (aim - rudder) / 5.0))))


def packet(code: int, value: int) -> bytes:
    """Return a packet: code, value from its low byte on, and their CRC."""
    head = struct.pack("<BH", code, value)
    return head + bytes([crc8(head)])


@pytest.fixture
def helm():
    one = Helm()
    with one.bench:
        yield one


def steer(helm: Helm, wanted: float, seconds: float) -> None:
    for _ in range(round(seconds / STEP)):
        helm.step(helm.command(wanted))


def test_pypilots_motor_controller_turns_a_boat_and_holds_its_heading(helm):
    steer(helm, 30.0, 40.0)
    assert helm.psi == pytest.approx(30.0, abs=1.5)
    assert abs(helm.rudder) < 2.0
    assert helm.read[FLAGS] & (SYNC | ENGAGED) == SYNC | ENGAGED
    assert not helm.read[FLAGS] & (OVERCURRENT | BAD_VOLTAGE | MAX_RUDDER | INVALID)
    assert helm.read[RUDDER] / 65472 * 1.1 == pytest.approx(0.55 + 0.01 * helm.rudder, abs=0.01)
    assert helm.read[VOLTAGE] / 100 == pytest.approx(12.0, abs=0.35)  # its own factor is 1.4 % low
    assert helm.packets > 1000
    assert helm.bad == 0


def test_pypilots_motor_controller_reports_faults_and_lets_go(helm):
    steer(helm, 0.0, 2.0)
    spoilt = bytearray(packet(COMMAND, 1800))
    spoilt[3] ^= 1
    seen = 0
    for _ in range(100):
        helm.step(bytes(spoilt))
        seen |= helm.read[FLAGS]
    assert seen & INVALID or not helm.read[FLAGS] & SYNC
    assert abs(helm.rudder) < 1.0  # no packet of a wrong CRC moves it
    steer(helm, 0.0, 3.0)
    assert helm.read[FLAGS] & ENGAGED
    helm.amperes = 12.0
    for _ in range(100):
        helm.step(packet(MAX_CURRENT, 1000), helm.command(90.0))
    assert helm.read[FLAGS] & OVERCURRENT
    assert helm.read[CURRENT] == pytest.approx(1200, rel=0.1)
    assert helm.bench.one.get("pulse.s1") == pytest.approx(0.0015, abs=2e-5)
    helm.amperes, helm.volts = 0.0, 8.0
    steer(helm, 0.0, 4.0)
    assert helm.read[FLAGS] & BAD_VOLTAGE
    assert not helm.bench.one.get("output.o1")  # the clutch


def test_pypilots_motor_controller_stops_at_the_end_of_the_rudder(helm):
    steer(helm, 0.0, 2.0)
    limit = round((0.55 + 0.01 * 10.0) / 1.1 * 65472)
    for _ in range(500):
        helm.step(packet(RUDDER_MAX, limit), packet(COMMAND, 1600))
    assert helm.read[FLAGS] & MAX_RUDDER
    assert 9.0 < helm.rudder < 14.0
    for _ in range(100):
        helm.step()
    assert not helm.bench.one.get("output.o1")  # silence: it lets go


def test_pypilots_motor_controller_lets_go_when_it_is_ordered_to_and_wakes_up_again(helm):
    steer(helm, 10.0, 2.0)
    assert helm.read[FLAGS] & ENGAGED
    for _ in range(100):
        helm.step(packet(DISENGAGE, 0))
    assert not helm.read[FLAGS] & ENGAGED
    assert not helm.bench.one.get("output.o1")
    rudder = helm.rudder
    for _ in range(600):  # silence of 12 s: it goes to sleep
        helm.step()
    assert helm.rudder == rudder
    steer(helm, 10.0, 30.0)
    assert helm.read[FLAGS] & ENGAGED
    assert helm.psi == pytest.approx(10.0, abs=1.5)


# ---------------------------------------------------------------------- others


def test_pypilots_rudder_sensor_sends_the_angle():
    """Its scale: 80 deg between counts of 5000 and 58000 of 65536, that are 5 V."""
    wanted = {
        0.0: b"",
        10.5: b"10",
        -25.5: b"-25",
    }  # whole degrees: its fraction of negative ones is none
    with board(
        "pypilot/arduino/rudderfeedback", mcu="atmega328p", uarts="0 38400", wires="A0 voltage 1"
    ) as bench:
        for angle, value in wanted.items():
            counts = 5000 + (angle / 80 + 0.5) * 53000 if angle else 0.0  # no sensor
            bench.one.set("voltage.v1", counts / 65536 * 5.0)
            *_, line, _ = bench.run(1.0).split(b"\r\n")
            body, _, checksum = line[1:].partition(b"*")
            assert f"{_xor(body):02X}".encode() == checksum.upper()
            assert body.split(b",")[1].partition(b".")[0] == value


def _xor(body: bytes) -> int:
    total = 0
    for byte in body:
        total ^= byte
    return total


def crc8_of_dallas(data: bytes) -> int:
    """CRC-8 of polynomial 0x31, from 0, lowest bit first."""
    crc = 0
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = crc >> 1 ^ (0x8C if crc & 1 else 0)
    return crc


def test_openrov_takes_commands_and_says_how_deep_it_is():
    """Its driver of the older sensor tries for 6 s before it leaves the address to that of the MS5837."""
    with board(
        "openrov-software-arduino/sketches/OpenROV2x",
        libraries="../../libraries",
        wires="0x76 ms5837; 6 servo 1; 7 servo 2; 8 servo 3",
    ) as bench:
        bench.one.set("depth", 3.0)
        said = bench.run(2.0)
        assert b"boot:1;" in said
        pulses = [0.00173, 0.00136, 0.00164]  # beyond its dead band of 50 us
        for command, answer in (
            (b"go(1700,1400,1600)", b"crc:pass;cmd:go"),
            (b"go(1,1)", b"crc:fail"),
        ):
            crc = crc8_of_dallas(command + b";") ^ (command == b"go(1,1)")
            bench.receive(0, bytes([crc]) + command + b";")
            assert answer in bench.run(0.4)
            assert bench.one.get("pulse")[:3] == pytest.approx(pulses, abs=6e-6)
        said = bench.run(7.0)
    last = said.rpartition(b"depth_d:")[2].partition(b";")[0]
    assert int(last) == pytest.approx(3000, abs=20)  # mm
    assert b"i2c.FAILED:0;" in said


@pytest.mark.parametrize("backend", ["host", "simavr"])
def test_ping_asks_its_sounder(backend):
    """A request of the Ping protocol: BR, length, message, source and destination, sum of all bytes."""
    with board(
        "ping-arduino/examples/ping1d-simple-mega",
        backend,
        libraries="../../..",
        uarts="0 115200; 1 115200",
    ) as bench:
        bench.run(1.0)
        asked = bench.sent[1]
    start = asked.index(b"BR")
    request = asked[start : start + 12]
    length = int.from_bytes(request[2:4], "little")
    assert length == 2
    assert sum(request[:10]) == int.from_bytes(request[10:12], "little")


def msp(bench: Bench, code: int) -> bytes:
    """Ask MultiWii for a message; return what it has."""
    before = len(bench.sent[0])
    bench.receive(0, b"$M<\x00" + bytes([code, code]))
    bench.run(0.2)
    answer = bench.sent[0][before:]
    head = answer.index(b"$M>")
    size = answer[head + 3]
    assert answer[head + 4] == code
    assert _xor(answer[head + 3 : head + 5 + size]) == answer[head + 5 + size]
    return answer[head + 5 : head + 5 + size]


IDENT, RAW_IMU, ATTITUDE, CALIBRATE = 100, 102, 108, 205
G = 9.80665


def test_multiwii_calibrates_itself_and_knows_how_it_leans():
    """By registers: its own I2C, UART and timers."""
    with board(
        "multiwii-firmware",
        flags="-DQUADX -DGY_521",
        uarts="0 115200; 1 115200; 2 115200; 3 115200",
        wires="0x68 mpu6050; 3 servo 1; 5 servo 2; 6 servo 3; 2 servo 4",
    ) as bench:
        bench.one.set("accelerometer.z", G)  # z up: it is mounted so
        bench.run(5.0)
        version, kind, *_ = msp(bench, IDENT)
        assert (kind, version >= 230) == (3, True)  # QUADX
        msp(bench, CALIBRATE)
        bench.run(4.0)
        assert struct.unpack("<9h", msp(bench, RAW_IMU))[:6] == (0, 0, 512, 0, 0, 0)
        bench.one.set("gyro.x", math.radians(20.0))
        for step in range(51):
            angle = math.radians(20.0 * step / 50)
            bench.one.set("accelerometer.y", G * math.sin(angle))
            bench.one.set("accelerometer.z", G * math.cos(angle))
            bench.run(0.02)
        bench.one.set("gyro.x", 0.0)
        bench.run(1.0)
        across, along, _ = struct.unpack("<3h", msp(bench, ATTITUDE))
        assert (across / 10, along / 10) == pytest.approx((0.0, -20.0), abs=1.5)
        assert bench.one.get("pulse")[:4] == pytest.approx([0.001] * 4, abs=5e-6)  # not armed


def test_boat_autopilot_drives_its_motor_to_a_position():
    """Position by an encoder of two voltages; the motor's bridge at pins 3 and 4, its speed at 7."""
    wires = "7 pwm 1; 3 output 1; 4 output 2; A9 voltage 1; A8 voltage 2; 44 input 1; 46 input 2; 48 input 3"
    with board(
        "boat_autopilot",
        flags="-DSERIAL_TX_BUFFER_SIZE=512",
        uarts="0 115200; 1 9600; 2 4800",
        wires="0x68 mpu6050; " + wires,
    ) as bench:
        count = 0.0
        for step in range(400):
            if step == 50:
                bench.receive(0, b"PM50\n")
            if step == 220:
                bench.receive(0, b"PM20\n")
            phase = int(count) % 4
            bench.one.set("voltage.v1", 5.0 * (phase in (2, 3)))
            bench.one.set("voltage.v2", 5.0 * (phase in (1, 2)))
            bench.run(0.02)
            one, other = bench.one.get("output")[:2]
            count += bench.one.get("duty")[0] * (one - other)
            if step == 210:
                assert count == pytest.approx(50.0, abs=3.0)
        said = bench.sent[0].splitlines()
    assert count == pytest.approx(20.0, abs=3.0)
    assert int(said[-2].split(b",")[1]) == pytest.approx(count, abs=1.0)
    assert bench.one.get("duty")[0] == 0.0


def test_freeboards_release_finds_the_rate_of_its_gps_and_keeps_its_settings(tmp_path):
    """The .hex of the project: its source needs a core with a 9-bit UART."""
    firmware = FOLDER / "freeboardPLC/Release2560/FreeBoardPLC.hex"
    if not firmware.exists():
        pytest.skip(f"there is no {firmware}")
    eeprom = str(tmp_path / "eeprom.bin")
    given = {
        "firmware": str(firmware),
        "uarts": "0 38400; 1 38400; 2 9600; 3 9600",
        "wires": "3 anemometer 1",
        "eeprom_after": eeprom,
    }
    body = b"GPRMC,123519,A,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W"
    sentence = b"$%s*%02X\r\n" % (body, _xor(body))
    with Bench("", "simavr", **given) as bench:
        for _ in range(12):
            bench.receive(1, sentence)
            bench.run(1.0)
        bench.receive(0, b"#SB3=4800\r\n")
        bench.run(1.0)
    said = bench.sent[0]
    assert b"OK at 38400" in said
    assert said.count(sentence.strip()) >= 3
    given |= {"eeprom": eeprom, "eeprom_after": "", "uarts": "0 38400; 1 38400; 2 9600; 3 4800"}
    with Bench("", "simavr", **given) as bench:
        for _ in range(12):
            bench.receive(1, sentence)
            bench.run(1.0)
    assert b"serial3 at 4800" in bench.sent[0]
