"""M5 thrusters on their line."""

import math
import struct

import pytest

from seatrial.errors import InputError
from seatrial_kits.videoray.frame import VRCSR, Frame
from seatrial_kits.videoray.m5_thrusters import OVERTEMPERATURE, M5Thrusters
from seatrial_kits.videoray.vrcsr import propulsion_request, read_health

from .bench import STEP, Line


def exchange(line, frame, steps=1):
    return line.exchange(frame, steps, VRCSR)


def keep(line, powers, seconds, node=1):
    """Command at 10 Hz for a time; return the last health."""
    health = None
    for _ in range(round(seconds * 10)):
        (answer,) = exchange(line, propulsion_request(powers, node), 10)
        health = read_health(answer)
    return health


def test_each_takes_its_place_in_the_list_and_one_answers():
    line = Line(M5Thrusters, nodes="4 9 2")
    (answer,) = exchange(line, propulsion_request([0.5, -1.0], 9), 3)
    assert answer.id == 9
    keep(line, [0.5, -1.0], 3.0, node=9)
    assert line["thrust"][:3] == pytest.approx([0.25, -1.0, 0.0], abs=1e-6)
    assert exchange(line, propulsion_request([0.0], 77), 3) == []


def test_speed_current_voltage_and_warmth():
    line = Line(M5Thrusters, nodes="1")
    exchange(line, propulsion_request([1.0], 1))
    line.step(14)
    passed = 15 * STEP
    assert line["speed"][0] == pytest.approx(3000 * (1 - math.exp(-passed / 0.15)), rel=1e-9)
    health = keep(line, [1.0], 3.0)
    assert (health.rpm, health.current) == pytest.approx((3000.0, 10.0), rel=1e-3)
    assert health.voltage == pytest.approx(47.0, rel=1e-3)
    assert health.fault == 0
    keep(line, [1.0], 60.0)
    rest = 0.05 * 47.0 * 10.0
    risen = line["temperature"][0] - 288.15
    assert risen == pytest.approx(rest * (1 - math.exp(-63.15 / 120.0)), rel=0.01)


def test_too_warm_or_set_to_be_faulty_it_stands_still():
    line = Line(M5Thrusters, nodes="1 2", greatest_temperature=288.5, thermal_time=1.0)
    line.component.set("fault", [0, 2, 0, 0, 0, 0])
    health = keep(line, [1.0, 1.0], 3.0)
    assert health.fault == OVERTEMPERATURE
    assert line["faults"][:2] == [OVERTEMPERATURE, 2]
    assert line["speed"][:2] == pytest.approx([0.0, 0.0], abs=1.0)


def test_without_commands_it_stops():
    line = Line(M5Thrusters, nodes="1")
    keep(line, [1.0], 1.0)
    line.step(250)
    assert abs(line["thrust"][0]) < 1e-6


def test_its_memory_is_read_and_written():
    line = Line(M5Thrusters, nodes="1 2")
    exchange(line, Frame(False, 2, 0, 0x04, struct.pack("<f", 0.5)), 100)
    assert line["thrust"][:2] == pytest.approx([0.0, 0.25], abs=1e-2)
    (answer,) = exchange(line, Frame(False, 2, 0x84, 0x08), 3)
    assert answer.flags == 0x80
    assert answer.payload[0] == 0x81
    assert struct.unpack("<f", answer.payload[1:])[0] > 100.0
    exchange(line, Frame(False, 2, 0, 0x08, bytes(4)), 3)  # rpm is read only
    (answer,) = exchange(line, Frame(False, 2, 0x80, 0x00), 3)
    assert len(answer.payload) == 0xF1
    assert answer.payload[9:13] != bytes(4)
    exchange(line, Frame(False, 2, 0, 0xFC, b"\x07"), 3)
    (answer,) = exchange(line, Frame(False, 7, 1, 0), 3)
    assert (answer.id, answer.payload) == (7, b"\x81")


@pytest.mark.parametrize("power", [math.nan, math.inf, -math.inf])
def test_powers_that_are_no_numbers_harm_nothing(power):
    line = Line(M5Thrusters, nodes="1")
    exchange(line, Frame(False, 1, 0, 0x04, struct.pack("<f", power)), 20)
    assert abs(line["thrust"][0]) <= 1.0


@pytest.mark.parametrize("nodes", ["", "1 1", "0", "128", "a", "1 2 3 4 5 6 7"])
def test_nodes_that_cannot_be_are_refused(nodes):
    with pytest.raises(InputError, match="nodes"):
        Line(M5Thrusters, nodes=nodes)


def test_restored_state_goes_on_identically():
    line = Line(M5Thrusters)
    keep(line, [0.5, 0.2, -1.0], 1.0)
    state = line.component.get_state()
    other = M5Thrusters("other")
    other.set_state(state)
    for number in range(50):
        for component in (line.component, other):
            component.advance((line.now + number * 10_000_000) / 1e9, STEP)
        for name in ("speed", "temperature", "tx", "voltage"):
            assert line.component.get(name) == other.get(name)


def test_several_share_one_supply_and_tell_their_warmth_in_degrees():
    settings = {"full_current": 12.0, "supply_voltage": 50.0, "line_resistance": 0.4}
    warm = {"thermal_time": 0.5, "thermal_resistance": 0.03, "watchdog": 0.0}
    line = Line(M5Thrusters, nodes="1 2 3", **settings, **warm)
    line.component.set("water_temperature", 280.0)
    powers = [0.9, -0.7, 0.4]
    first = keep(line, powers, 0.1)
    assert first.temperature == pytest.approx(288.15 - 273.15, abs=0.2)
    health = keep(line, powers, 3.0, node=2)
    currents = [12.0 * abs(power) ** 3 for power in powers]
    volts = 50.0 - 0.4 * sum(currents)
    assert line["voltage"] == pytest.approx(volts, rel=1e-4)
    assert line["current"][:3] == pytest.approx(currents, rel=1e-4)
    assert line["speed"][:3] == pytest.approx([2700.0, -2100.0, 1200.0], rel=1e-4)
    assert line["thrust"][:3] == pytest.approx([0.81, -0.49, 0.16], rel=1e-4)
    assert (health.rpm, health.current) == pytest.approx((-2100.0, currents[1]), rel=1e-3)
    keep(line, powers, 2.0)
    rest = [280.0 + 0.03 * volts * current for current in currents]
    assert line["temperature"][:3] == pytest.approx(rest, abs=0.05)
