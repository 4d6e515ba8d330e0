"""The ROV's sketch as its serial port shows it, with packets captured at a real Pro 4."""

import random
from pathlib import Path

import pytest

from seatrial_kits.videoray import registers as csr
from seatrial_kits.videoray.frame import READ_BIT, ROV, Frame, encode
from seatrial_kits.videoray.identity import CONFIG_LENGTH, PRO4_ROV, read_config
from seatrial_kits.videoray.parser import Parser
from seatrial_kits.videoray.replies import FIELDS, read, read_memory

from ..videoray.bench import PACKETS
from .bench import Bench

SKETCH = Path(__file__).parents[3] / "harness/kits/arduino/firmware" / "rov_controller"
WIRES = "5 servo 1; 6 servo 2; 7 servo 3; 0x68 mpu6050; 0x1E hmc5883l; 0x76 ms5837"
BACKENDS = ["host", pytest.param("simavr", marks=pytest.mark.interop)]
PRIMARY = next(packet for packet in PACKETS if packet.hex().startswith("faaf0105000f"))


@pytest.fixture(params=BACKENDS)
def rov(request):
    field = {"magnetic_field.north": 2.3e-5}  # no variation, which the sketch does not know
    with Bench(SKETCH, request.param, wires=WIRES, **field) as bench:
        bench.one.set("depth", 2.0)
        bench.one.set("attitude", [0.05, 0.0, -0.5])
        bench.one.set("accelerometer", [0.0, -0.49, -9.79])
        bench.run(1.0)
        yield bench


def exchange(bench: Bench, data: bytes, seconds: float = 0.2) -> list[Frame]:
    bench.receive(0, data)
    return [frame for _, frame in Parser(10**9).feed(bench.run(seconds), 0)]


def test_it_answers_the_captured_detection_and_command_block(rov):
    (found,) = exchange(rov, PACKETS[0])
    assert (found.is_response, found.id, found.flags, found.address) == (True, ROV, 1, 0)
    assert (found.payload[0], len(found.payload)) == (PRO4_ROV, 9)
    (found,) = exchange(rov, PRIMARY)
    assert len(found.payload) == 34
    values = read(5, found.payload[1:]).values
    assert values["pressure"] == pytest.approx(1013.25 + 2 * 98.0665, abs=1.0)
    assert values["heading"] == pytest.approx(-28.65, abs=0.3)  # 250 counts of the compass
    assert values["roll"] == pytest.approx(2.87, abs=0.1)
    assert values["heave_acceleration"] == pytest.approx(-9.79, abs=0.01)
    assert values["water_temperature"] == pytest.approx(20.0, abs=0.05)


@pytest.mark.parametrize("number", FIELDS)
def test_every_reply_has_its_fields(rov, number):
    (found,) = exchange(rov, encode(Frame(False, ROV, number, 0)))
    assert read(number, found.payload[1:]).values["pressure"] == pytest.approx(1209, abs=1.0)


def test_memory_and_configuration_are_read(rov):
    (found,) = exchange(rov, encode(Frame(False, ROV, READ_BIT, 0)))
    assert len(found.payload) == 1 + csr.TOP
    assert read_memory(0, found.payload[1:]).values["pressure"] == pytest.approx(1209, abs=1.0)
    (found,) = exchange(rov, encode(Frame(False, ROV, READ_BIT | 2, 0x66)))
    assert (found.address, len(found.payload)) == (0x66, 3)
    (found,) = exchange(rov, encode(Frame(False, ROV, READ_BIT, csr.CONFIG)))
    assert len(found.payload) == 1 + CONFIG_LENGTH
    serial, boards = read_config(found.payload[1:])
    assert serial == "ARDUINO-ROV"
    assert set(boards.values()) == {"Arduino Mega"}


def test_without_requests_it_sends_nothing_and_commands_stop_after_two_seconds(rov):
    block = bytes.fromhex("3200ceff") + bytes(7) + b"\xff" * 4  # port 50 %, starboard -50 %
    assert exchange(rov, encode(Frame(False, 2, 1, 0, block))) == []
    assert rov.one.get("pulse.s1") == pytest.approx(1500e-6, abs=15e-6)
    assert exchange(rov, encode(Frame(False, 0xFF, 1, 0, block))) == []  # broadcast: obeyed only
    assert rov.one.get("pulse.s1") == pytest.approx(1700e-6, abs=15e-6)
    assert rov.one.get("pulse.s2") == pytest.approx(1300e-6, abs=15e-6)
    rov.run(1.5)
    assert rov.one.get("pulse.s1") == pytest.approx(1700e-6, abs=15e-6)
    rov.run(0.5)
    assert rov.one.get("pulse.s1") == pytest.approx(1500e-6, abs=15e-6)


def test_it_finds_requests_in_noise(rov):
    """A frame inside or behind a broken one is found; after a gap, whatever came before."""
    good, rng = encode(Frame(False, ROV, 2, 0)), random.Random(5)
    for junk in (b"\xfa", b"\xfa\xaf", good[:-1] + b"\x01", b"\xfa\xaf\x01\x01\x00\x05", good[:5]):
        assert len(exchange(rov, junk + good)) == 1, junk
    for _ in range(20):
        exchange(rov, rng.randbytes(rng.randrange(1, 60)), 0.1)
        assert len(exchange(rov, good, 0.1)) == 1
