"""The topside, alone and with the vehicle: what it sends, and what it understands."""

import math

import pynmeagps
import pytest

from seatrial.links.text import Inbox
from seatrial_kits.videoray.frame import encode
from seatrial_kits.videoray.half_duplex import byte_time
from seatrial_kits.videoray.replies import read_memory
from seatrial_kits.videoray.rov import Pro4Rov
from seatrial_kits.videoray.station import NEUTRAL
from seatrial_kits.videoray.topside import Pro4Topside

from .bench import PACKETS, STEP, Line, frames


def driven(**parameters):
    """Return a topside that has found a vehicle, whose answers are the captured ones."""
    line = Line(Pro4Topside, **parameters)
    for number in (0, 2, 4):
        assert [data for _, data in line.step(1)] == [PACKETS[number]]
        line.send(PACKETS[number + 1])
        line.step(9)
    assert line["connected"] is True
    return line


def block(line):
    """Return the command block of the next cycle, by register."""
    ((_, data),) = line.step(1)
    line.send(PACKETS[7])
    line.step(9)
    (frame,) = frames(data)
    assert (frame.id, frame.flags, frame.address, len(frame.payload)) == (1, 5, 0, 15)
    return read_memory(0, frame.payload).values


def test_it_finds_a_vehicle_as_captured():
    line = driven()
    assert line["serial_number"] == "J14461"
    assert line["cycles"] == 3
    assert line["missed"] == 0
    ((_, data),) = line.step(1)
    assert data == encode(frames(PACKETS[6])[0].__class__(False, 1, 5, 0, NEUTRAL.payload))


def test_readings_of_the_captured_reply():
    line = driven()
    block(line)
    assert [math.degrees(a) for a in line["attitude"]] == pytest.approx([-3.0, 3.7, 49.3])
    assert line["specific_force"] == pytest.approx([0.615, 0.510, -9.035])
    assert line["water_temperature"] == pytest.approx(273.15 + 11.1)
    assert line["humidity"] == pytest.approx(0.48)
    assert line["power"] == 1.0
    assert line["depth"] == pytest.approx(-101_325 / 9806.65)  # a vehicle without pressure sensor


def test_headings_in_halves_are_those_of_the_full_circle():
    line = Line(Pro4Topside)
    for number in (1, 3, 9):
        line.step(1)
        line.send(PACKETS[number])
        line.step(9)
    assert math.degrees(line["attitude"][2]) == pytest.approx(346.8)


def test_disarmed_it_commands_nothing_but_lights_and_camera():
    line = driven()
    line.component.set("manual", [1.0, 0.5, -1.0])
    line.component.set("hold_depth", True)
    line.component.set("hold_heading", True)
    line.component.set("lights", 0.5)
    line.component.set("camera_tilt", math.radians(-30.0))
    values = block(line)
    assert [values[f"{name}_target"] for name in ("port", "starboard", "vertical")] == [0, 0, 0]
    assert values["auto_depth_target"] == values["auto_heading_target"] == 0xFFFF
    assert values["lights"] == pytest.approx(0.5)
    assert values["camera_tilt"] == -30


@pytest.mark.parametrize(
    ("manual", "thrust"),
    [
        ([0.5, 0.0, 0.0], (0.5, 0.5, 0.0)),
        ([0.0, 0.3, 0.0], (0.3, -0.3, 0.0)),
        ([0.0, 0.0, 0.4], (0.0, 0.0, -0.4)),
        ([1.0, 1.0, -9.0], (1.0, 0.0, 1.0)),
    ],
)
def test_manual_control(manual, thrust):
    line = driven()
    line.component.set("armed", True)
    line.component.set("manual", manual)
    values = block(line)
    found = [values[f"{name}_target"] for name in ("port", "starboard", "vertical")]
    assert found == pytest.approx(thrust)


def test_manual_control_has_a_limit():
    line = driven(manual_limit=0.2, vertical_ahead="down")
    line.component.set("armed", True)
    line.component.set("manual", [1.0, 0.0, 1.0])
    values = block(line)
    assert values["port_target"] == values["vertical_target"] == pytest.approx(0.2)


def test_holds_in_the_vehicles_units():
    line = driven()
    line.component.set("armed", True)
    line.component.set("hold_depth", True)
    line.component.set("depth_wanted", 10.0)
    line.component.set("hold_heading", True)
    line.component.set("heading_wanted", math.radians(359.7))
    values = block(line)
    assert values["auto_depth_target"] == round(1013.25 + 980.665)
    assert values["auto_heading_target"] == 0


def test_the_gripper():
    line = driven()
    line.component.set("manipulator", 1)
    (_, first), (second_at, second) = line.step(1)
    assert frames(first)[0].id == 1
    assert second.hex() == "faaf4200f008ef35490000000003007f"
    assert second_at % 100_000_000 == len(first) * byte_time(115_200)
    line.send(PACKETS[7])
    line.step(9)
    assert len(line.step(1)) == 1  # once


def test_a_lost_vehicle_is_looked_for_and_not_commanded():
    line = driven(timeout=0.5)
    line.component.set("armed", True)
    line.component.set("manual", [1.0, 0.0, 0.0])
    sent = [frames(data)[0] for _, data in line.step(100)]
    assert line["connected"] is False
    assert line["missed"] == 9
    assert [f.flags for f in sent] == [5] * 5 + [1] * 5 or [f.flags for f in sent] == [5] * 6 + [
        1
    ] * 4
    assert all(not f.payload for f in sent if f.flags == 1)


def test_nmea_sentences_are_read_by_somebody_elses_parser():
    line = driven(nmea="on")
    for _ in range(8):
        block(line)
    chunks = Inbox({}).take(line["nmea_tx"])
    lines = chunks[0][1].split(b"\r\n")
    depth, heading, temperature = (pynmeagps.NMEAReader.parse(each + b"\r\n") for each in lines[:3])
    assert (depth.talker, depth.msgID, depth.depth) == ("VR", "DPT", -10.3)
    assert (heading.msgID, heading.headingM) == ("HDG", 49.3)
    assert (temperature.msgID, temperature.temp) == ("MTW", 11.1)
    assert lines[3].startswith(b"$PVRND,000001.00,-10.3,49.3,3.7,-3.0*")


def test_both_ends_in_simulated_time_miss_nothing():
    rov, topside = Line(Pro4Rov).component, Line(Pro4Topside).component
    rov.set("depth", 7.0)
    topside.set("armed", True)
    for number in range(300):
        sent, received = topside.get("tx"), rov.get("tx")
        rov.set("rx", sent)
        topside.set("rx", received)
        for component in (rov, topside):
            component.advance(number * STEP, STEP)
    assert topside.get("cycles") == 30
    assert topside.get("missed") == 0
    assert topside.get("depth") == pytest.approx(7.0, abs=0.01)
    assert topside.get("round_trip") == pytest.approx(65 * 10 / 115_200, rel=1e-4)


def test_restored_state_goes_on_identically():
    line = driven()
    state = line.component.get_state()
    first = [line.component.get("tx")]
    other = Pro4Topside("other")
    other.set_state(state)
    for component in (line.component, other):
        component.set("armed", True)
        component.set("manual", [0.2, 0.1, 0.0])
    first, second = [], []
    for number in range(30):
        for component, found in ((line.component, first), (other, second)):
            component.advance((line.now + number * 10_000_000) / 1e9, STEP)
            found.append([component.get(n) for n in ("tx", "phase", "attitude", "missed")])
    assert first == second
