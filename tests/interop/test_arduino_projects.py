"""Firmware of public projects, unmodified, where SEATRIAL_ARDUINO_PROJECTS names the folder of their clones.

A clone lies there under the name of its repository: pypilot (pypilot/pypilot), openrov-software-arduino
(OpenROV), ping-arduino (bluerobotics), multiwii-firmware (multiwii).
"""

from __future__ import annotations

import os
import struct
from pathlib import Path

import pytest

from tests.links.arduino.bench import Bench

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

COMMAND, MAX_CURRENT, RUDDER_MAX = 0xC7, 0x1E, 0x4D
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


# ---------------------------------------------------------------------- others


def test_pypilots_rudder_sensor_says_nothing_without_a_sensor_and_the_angle_with_it():
    with board(
        "pypilot/arduino/rudderfeedback", mcu="atmega328p", uarts="0 38400", wires="A0 voltage 1"
    ) as bench:
        said = bench.run(2.0)
    lines = [line for line in said.split(b"\r\n") if b"$ARRSA" in line]
    assert len(lines) > 10
    for line in lines[:-1]:
        body, _, checksum = line.rpartition(b"$")[2].partition(b"*")
        assert f"{_xor(body):02X}".encode() == checksum.upper()


def _xor(body: bytes) -> int:
    total = 0
    for byte in body:
        total ^= byte
    return total


def test_openrov_begins_finds_its_depth_sensor_and_answers():
    with board(
        "openrov-software-arduino/sketches/OpenROV2x",
        libraries="../../libraries",
        wires="0x76 ms5837",
    ) as bench:
        said = bench.run(4.0)
    assert b"boot:1;" in said
    assert b"ms5837_init:1;" in said
    assert b"motorAttached:1;" in said


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


def test_multiwii_holds_its_motors_at_rest():
    with board(
        "multiwii-firmware",
        flags="-DQUADX -DMPU6050 -DHMC5883",
        wires="0x68 mpu6050; 0x1E hmc5883l; 3 servo 1; 5 servo 2; 6 servo 3; 2 servo 4",
    ) as bench:
        bench.run(1.0)
        pulses = bench.one.get("pulse")[:4]
        bench.receive(0, b"$M<\x00\x64\x64")  # MSP_IDENT
        bench.run(0.2)
        answer = bench.sent[0]
    assert pulses == pytest.approx([0.001] * 4, abs=5e-6)  # MINCOMMAND
    head = answer.index(b"$M>")
    size, code, version, kind = answer[head + 3 : head + 7]
    assert (size, code, kind) == (7, 100, 3)  # QUADX
    assert version >= 230
    assert _xor(answer[head + 3 : head + 5 + size]) == answer[head + 5 + size]
