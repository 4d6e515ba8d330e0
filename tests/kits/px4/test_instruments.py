"""The instruments of PX4's simulator: what HIL messages have of a motion."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
from pymavlink.dialects.v20 import common as mavlink

from seatrial.errors import InputError, SimulationError
from seatrial.links.atmosphere import standard_pressure
from seatrial.links.earth_field import earth_field
from seatrial_kits.px4.firmware import environment
from tests.kits.mavlink.ground_station.vehicle import HOME, placed

from .made import QUIET, component, firmware

PLACE = {"latitude": math.radians(HOME[0]), "longitude": math.radians(HOME[1])}
NOON_5_FEBRUARY_2026 = 1_770_292_800
MASKS = {"accelerometer": 0x7, "gyro": 0x38, "field": 0x1C0, "pressure": 0x1A00}
"""Bits of fields_updated as the MAVLink standard has them: x, y, z; and 9, 11, 12."""


def flown(steps=1, h=0.01, moves=lambda made, t: None, **values):
    """Return the messages of each step, while ``moves`` sets the true motion."""
    got = []

    def take(peer):
        got.extend(peer.sense() for _ in range(steps))

    with component(**{**QUIET, **PLACE, **values}) as made, firmware(made, take):
        for k in range(steps):
            moves(made, k * h)
            made.advance(k * h, h)
    return got


def of(messages, name):
    return [each for step in messages for each in step if each.get_type() == name]


def still(**inputs):
    def moves(made, t):
        for name, value in inputs.items():
            made.set(name, value)

    return moves


def test_at_rest_and_level():
    (sensor,) = of(flown(), "HIL_SENSOR")
    assert (sensor.xacc, sensor.yacc, sensor.zacc) == pytest.approx((0.0, 0.0, -9.81))
    assert (sensor.xgyro, sensor.ygyro, sensor.zgyro) == (0.0, 0.0, 0.0)
    assert sensor.abs_pressure == pytest.approx(1013.25)
    assert sensor.id == 0
    assert sensor.fields_updated == sum(MASKS.values())


@pytest.mark.parametrize("heading", [0.0, math.pi / 2, -2.0])
def test_the_field_is_the_earths_in_body_axes_in_gauss(heading):
    (sensor,) = of(flown(moves=still(true_attitude=(0.0, 0.0, heading))), "HIL_SENSOR")
    north, east, down = earth_field(*PLACE.values(), 0.0, NOON_5_FEBRUARY_2026)
    shown = math.atan2(-sensor.ymag, sensor.xmag) + math.atan2(east, north)  # + declination
    assert math.remainder(shown - heading, math.tau) == pytest.approx(0.0, abs=1e-6)
    assert math.hypot(sensor.xmag, sensor.ymag) == pytest.approx(1e4 * math.hypot(north, east))
    assert sensor.zmag == pytest.approx(1e4 * down)
    assert 0.2 < math.hypot(sensor.xmag, sensor.ymag, sensor.zmag) < 0.7  # anywhere on earth


def test_pressure_of_the_standard_atmosphere():
    """ISO 2533: 89,874.6 Pa at 1000 m, 54,019.9 Pa at 5000 m (geopotential)."""
    assert standard_pressure(1000.0) == pytest.approx(89_874.6, abs=1.0)
    assert standard_pressure(5000.0) == pytest.approx(54_019.9, abs=1.0)
    (deep,) = of(flown(moves=still(true_position=(0, 0, 20.0)), altitude=10.0), "HIL_SENSOR")
    assert 100.0 * deep.abs_pressure == pytest.approx(101_325.0 + 10.0 * 1.225 * 9.80665, abs=0.2)


def test_an_inertial_unit_off_the_origin_feels_the_turn():
    """A turn that grows by 0.5 rad/s2, 2 m ahead of the origin: w^2 r inwards, dw/dt r abeam."""

    def turns(made, t):
        made.set("true_rates", (0.0, 0.0, 0.5 * t))

    last = of(flown(steps=101, moves=turns, imu=(2.0, 0.0, 0.0)), "HIL_SENSOR")[-1]
    assert last.zgyro == pytest.approx(0.5)
    assert (last.xacc, last.yacc, last.zacc) == pytest.approx((-0.5, 1.0, -9.81), abs=1e-5)


def test_a_fix_has_place_velocity_and_time_of_day_of_the_antenna():
    moves = still(
        true_position=(30.0, -40.0, 0.0),
        true_velocity=(1.5, 0.0, 0.0),
        true_attitude=(0.0, 0.0, math.pi / 2),
        true_rates=(0.0, 0.0, 0.1),
    )
    fixes = of(flown(21, moves=moves, antenna=(2.0, 0.0, -0.5), satellites=17.0), "HIL_GPS")
    noon = 1_000_000 * NOON_5_FEBRUARY_2026
    assert [fix.time_usec - noon for fix in fixes] == [0, 200_000]
    fix = fixes[0]
    item = mavlink.MAVLink_mission_item_int_message(
        0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, fix.lat, fix.lon, 0
    )
    assert placed(item) == pytest.approx((30.0, -38.0), abs=0.02)  # 1e-7 degrees are 1 cm
    assert (fix.alt, fix.fix_type, fix.satellites_visible) == (500, 3, 17)
    # Heading east, turning to starboard: the antenna ahead moves south too.
    assert (fix.vn, fix.ve, fix.vd) == (-20, 150, 0)
    assert fix.vel == round(100 * math.hypot(1.5, 0.2))
    assert fix.cog / 100 == pytest.approx(90.0 + math.degrees(math.atan(0.2 / 1.5)), abs=0.01)


def test_the_truth_goes_with_it():
    moves = still(true_attitude=(0.1, -0.2, 0.3), true_rates=(0.4, 0.5, 0.6))
    (truth,) = of(flown(moves=moves), "HIL_STATE_QUATERNION")
    w, x, y, z = truth.attitude_quaternion
    assert math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)) == pytest.approx(0.1, abs=1e-6)
    assert math.asin(2 * (w * y - z * x)) == pytest.approx(-0.2, abs=1e-6)
    assert math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)) == pytest.approx(0.3, abs=1e-6)
    assert (truth.rollspeed, truth.pitchspeed, truth.yawspeed) == pytest.approx((0.4, 0.5, 0.6))


def test_each_instrument_has_its_rate_and_the_clock_rises():
    messages = flown(50, h=0.004, field_period=0.01, pressure_period=0.02, gnss_period=0.1)
    sensors = of(messages, "HIL_SENSOR")
    assert [each.time_usec for each in sensors] == [max(1, 4000 * k) for k in range(50)]
    new = [each.fields_updated for each in sensors]
    assert all(each & 0x3F == 0x3F for each in new)
    assert sum(each & MASKS["field"] == MASKS["field"] for each in new) == 20
    assert sum(each & MASKS["pressure"] == MASKS["pressure"] for each in new) == 10
    assert len(of(messages, "HIL_GPS")) == 2
    # HIL_SENSOR is the last of a step: it sets the clock that the others are taken in by.
    assert all(step[-1].get_type() == "HIL_SENSOR" for step in messages)


@pytest.mark.parametrize(
    ("depth", "reception", "fixes"),
    [(0.2, "air", 1), (0.4, "air", 0), (5.0, "everywhere", 1)],
)
def test_under_water_there_are_no_fixes(depth, reception, fixes):
    moves = still(true_position=(0.0, 0.0, depth))
    assert len(of(flown(moves=moves, reception=reception), "HIL_GPS")) == fixes


def test_instruments_that_are_taken_away_send_nothing():
    moves = still(without=(True, True, True))
    messages = flown(30, moves=moves)
    assert not of(messages, "HIL_GPS")
    assert {each.fields_updated for each in of(messages, "HIL_SENSOR")} == {0x3F}


@pytest.mark.slow
def test_noise_is_as_large_as_it_says_and_keyed_by_the_seed():
    noise = {"gyro_noise": 0.01, "accelerometer_noise": 0.1, "field_noise": 1e-6}

    def sample(seed):
        found = of(flown(400, seed=seed, pressure_noise=5.0, **noise), "HIL_SENSOR")
        names = ("xgyro", "ygyro", "zgyro", "xacc", "yacc", "zacc", "xmag", "ymag", "abs_pressure")
        return np.array([[getattr(each, name) for name in names] for each in found])

    first = sample(7.0)
    np.testing.assert_allclose(
        np.std(first, axis=0), [0.01] * 3 + [0.1] * 3 + [0.01] * 2 + [0.05], rtol=0.15
    )
    correlation = np.corrcoef(first.T) - np.eye(9)
    assert np.abs(correlation).max() < 0.2
    np.testing.assert_array_equal(first, sample(7.0))
    assert np.abs(first - sample(8.0)).max() > 0.01


def test_a_motion_that_cannot_be_is_not_sent():
    with (
        pytest.raises(SimulationError, match=r"autopilot: the rates is 1000\.0 rad/s, .* to PX4"),
        component() as made,
        firmware(made, lambda peer: None),
    ):
        made.set("true_rates", (0.0, 1e3, 0.0))
        made.advance(0.0, 0.01)


MEASURED = {
    "gyro": [0.1, -0.2, 0.3],
    "accelerometer": [0.5, 0.6, -9.7],
    "imu_valid": True,
    "position_n": [3.0, -4.0, -0.3],
    "velocity_n": [0.3, -0.4, 0.1],
    "position_valid": True,
    "heading": math.pi / 2,
    "heading_valid": True,
}


def test_what_the_vehicles_own_sensors_measure_is_sent():
    messages = flown(
        moves=still(**MEASURED, true_position=[100.0, 0.0, 0.0]), measured="imu gnss compass"
    )
    (sensor,), (fix,) = of(messages, "HIL_SENSOR"), of(messages, "HIL_GPS")
    assert (sensor.xacc, sensor.yacc, sensor.zacc) == pytest.approx((0.5, 0.6, -9.7))
    assert (sensor.xgyro, sensor.ygyro, sensor.zgyro) == pytest.approx((0.1, -0.2, 0.3))
    north, east, down = earth_field(*PLACE.values(), 0.0, NOON_5_FEBRUARY_2026)
    gauss = [1e4 * each for each in (east, -north, down)]  # with the bow to the east
    assert (sensor.xmag, sensor.ymag, sensor.zmag) == pytest.approx(gauss, rel=1e-3)
    assert sensor.fields_updated == sum(MASKS.values())
    item = mavlink.MAVLink_mission_item_int_message(*(0,) * 11, fix.lat, fix.lon, 0)
    assert placed(item) == pytest.approx((3.0, -4.0), abs=0.02)
    assert (fix.vn, fix.ve, fix.vd, fix.vel) == (30, -40, 10, 50)


@pytest.mark.parametrize(
    ("flag", "gone"),
    [
        ("imu_valid", MASKS["accelerometer"] + MASKS["gyro"]),
        ("heading_valid", MASKS["field"]),
        ("position_valid", 0),
    ],
)
def test_an_outage_of_a_vehicles_sensor_reaches_the_firmware(flag, gone):
    moves = still(**{**MEASURED, flag: False})
    messages = flown(moves=moves, measured="imu gnss compass")
    (sensor,) = of(messages, "HIL_SENSOR")
    assert sensor.fields_updated == sum(MASKS.values()) - gone
    assert len(of(messages, "HIL_GPS")) == (flag != "position_valid")


def test_the_firmware_knows_the_vehicles_receiver():
    gnss = {"kind": "gnss", "antenna": [0.1, 0.0, -0.5], "delay": [0.12]}
    values = {"instruments": json.dumps({"rtk": gnss}), "antenna": [9.0, 9.0, 9.0]}
    for measured, place, delay in (("gnss", "0.1", "120"), ("imu", "9", "0")):
        with component(**values, measured=measured) as made:
            variables = environment(made, {})
        assert variables["PX4_PARAM_EKF2_GPS_POS_X"] == place
        assert variables["PX4_PARAM_EKF2_GPS_DELAY"] == delay


def test_an_instrument_of_another_name_is_refused():
    with pytest.raises(InputError, match="unknown instrument 'gps'"), component(measured="gps"):
        pass
