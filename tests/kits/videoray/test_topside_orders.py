"""Orders of a pilot as the command block has them, with settings off their defaults."""

import math
import struct

import pytest

from seatrial_kits.videoray.station import Commands, manipulator_request
from seatrial_kits.videoray.topside import Pro4Topside
from tests.devices.running import started

SETTINGS = {
    "manual": (0.6, -0.35, 0.5), "manual_limit": 0.8, "density": 1030.0, "gravity": 9.78,
    "surface_pressure": 99000.0, "depth_wanted": 12.5, "heading_wanted": 4.4, "lights": 0.37,
    "camera_tilt": -0.5, "camera_focus": 0.45, "camera_select": 1, "camera_buttons": 5,
    "hold_depth": True, "hold_heading": True,
}  # fmt: skip


@pytest.mark.parametrize(("vertical_ahead", "way"), [("up", -1), ("down", 1)])
def test_orders_of_an_armed_vehicle(vertical_ahead, way):
    topside = started(Pro4Topside, **SETTINGS, vertical_ahead=vertical_ahead, armed=True)
    found = topside._commands()
    expected = (0.8 * 0.25, 0.8 * 0.95, way * 0.8 * 0.5)
    assert found.thrust == pytest.approx(expected)
    assert found.auto_depth == pytest.approx((99000.0 + 1030 * 9.78 * 12.5) / 100)
    assert found.auto_heading == pytest.approx(math.degrees(4.4))
    assert (found.lights, found.camera_focus) == (0.37, 0.45)
    assert (found.camera_control, found.camera_buttons) == (2, 5)
    assert found.camera_tilt == pytest.approx(math.degrees(-0.5))
    block = struct.unpack("<hhhBbbBBHH", found.block())
    pressure = round((99000.0 + 1030 * 9.78 * 12.5) / 100)
    assert block == (20, 76, way * 40, 37, -29, 45, 2, 5, pressure, round(math.degrees(4.4)))


def test_a_vehicle_that_is_not_armed_is_given_light_alone():
    found = started(Pro4Topside, **SETTINGS)._commands()
    assert found.thrust == (0.0, 0.0, 0.0)
    assert (found.auto_depth, found.auto_heading, found.lights) == (None, None, 0.37)


def test_depth_is_what_the_pressure_says_below_the_surface():
    topside = started(Pro4Topside, **SETTINGS)
    assert topside._depth_of(990.0 + 1030 * 9.78 * 7.3 / 100) == pytest.approx(7.3)


def test_a_block_stays_within_what_its_bytes_can_say():
    wild = Commands((3.0, -3.0, 0.004), 2.0, 200.0, -7.0, 300, 511, 99999.0, -10.4)
    found = struct.unpack("<hhhBbbBBHH", wild.block())
    assert found == (100, -100, 0, 100, 90, -100, 44, 255, 65534, 350)


@pytest.mark.parametrize(("direction", "command"), [(1, 3), (-1, 2), (0, 0)])
def test_a_gripper_is_told_by_a_number(direction, command):
    frame = manipulator_request(direction)
    assert (frame.is_response, frame.id, frame.flags) == (False, 0x42, 0)
    assert frame.payload == bytes([0x35, 0x49, 0, 0, 0, 0, command, 0])
