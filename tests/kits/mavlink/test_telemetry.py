"""Content of telemetry messages, against conversions written out here or made by pymavlink."""

import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymavlink.dialects.v20 import all as mavlink
from pymavlink.quaternion import Quaternion

from seatrial.links.truth import Truth
from seatrial_kits.mavlink.vehicle import Target, Way

from .bench import ORIGIN, Bench

ID = {name: getattr(mavlink, name) for name in dir(mavlink) if name.startswith("MAVLINK_MSG_ID_")}
angles = st.floats(-3.1, 3.1)


def sent(name, *, submerged=False, valid=True, **measured):
    bench = Bench(submerged=submerged, valid=valid)
    bench.measure(**measured)
    return bench.one(ID[f"MAVLINK_MSG_ID_{name}"])


def silent(name, **options):
    submerged = options.pop("submerged", False)
    bench = Bench(submerged=submerged, valid=options.pop("valid", True))
    bench.measure(**options)
    return bench.request(ID[f"MAVLINK_MSG_ID_{name}"]) == (mavlink.MAV_RESULT_DENIED, [])


def test_position():
    m = sent("GLOBAL_POSITION_INT", position_n=(100.0, 50.0, -1.5), velocity_n=(1.234, -0.5, 0.1))
    latitude, longitude, _ = ORIGIN.geodetic((100.0, 50.0, 0.0))
    assert (m.lat, m.lon) == (round(latitude * 1e7), round(longitude * 1e7))
    assert (m.alt, m.relative_alt) == (3500, 1500)  # the origin is at 2 m
    assert (m.vx, m.vy, m.vz) == (123, -50, 10)


def test_coordinates_are_rounded_not_cut():
    m = sent("GLOBAL_POSITION_INT")
    assert (m.lat, m.lon) == (-317800000, -522600000)


def test_depth_is_negative_altitude():
    m = sent("GLOBAL_POSITION_INT", submerged=True, position_n=(0.0, 0.0, 12.0))
    assert (m.alt, m.relative_alt) == (-10000, -12000)
    hud = sent("VFR_HUD", submerged=True, position_n=(0.0, 0.0, 12.0), velocity_n=(3.0, 4.0, 0.5))
    assert (hud.alt, hud.groundspeed, hud.climb) == (-10.0, 5.0, -0.5)
    altitude = sent("ALTITUDE", submerged=True, position_n=(0.0, 0.0, 12.0))
    assert altitude.altitude_relative == -12.0


def test_a_submarine_without_a_position_sends_its_depth():
    m = sent("GLOBAL_POSITION_INT", submerged=True, position_valid=False, position_n=(5, 5, 7))
    assert (m.lat, m.lon, m.relative_alt) == (0, 0, -7000)
    assert silent("GPS_RAW_INT", submerged=True, position_valid=False)


def test_a_boat_without_a_position_sends_none():
    assert silent("GLOBAL_POSITION_INT", position_valid=False)
    assert silent("LOCAL_POSITION_NED", position_valid=False)
    assert sent("GPS_RAW_INT", position_valid=False).fix_type == mavlink.GPS_FIX_TYPE_NO_FIX


def test_satellites():
    m = sent("GPS_RAW_INT", position_n=(0.0, 0.0, 0.0), velocity_n=(-3.0, 4.0, 9.0))
    assert m.fix_type == mavlink.GPS_FIX_TYPE_3D_FIX
    assert (m.lat, m.lon, m.alt) == (-317800000, -522600000, 2000)
    assert m.vel == 500
    assert m.cog == round(math.degrees(math.atan2(4.0, -3.0)) * 100)


@pytest.mark.parametrize(
    ("psi", "heading"), [(0.0, 0), (-1e-9, 0), (math.pi, 180), (-math.pi / 2, 270), (7.0, 41)]
)
def test_headings_go_round_once(psi, heading):
    assert sent("VFR_HUD", attitude=(0, 0, psi)).heading == heading
    m = sent("GLOBAL_POSITION_INT", attitude=(0, 0, psi))
    assert 0 <= m.hdg < 36000
    assert math.cos(math.radians(m.hdg / 100) - psi) == pytest.approx(1.0, abs=1e-7)
    yaw = sent("ATTITUDE", attitude=(0, 0, psi)).yaw
    assert -math.pi <= yaw <= math.pi
    assert math.cos(yaw - psi) == pytest.approx(1.0)


def test_a_heading_that_is_not_valid_is_unknown():
    assert sent("GLOBAL_POSITION_INT", heading_valid=False).hdg == 65535


@given(angles, st.floats(-1.5, 1.5), angles)
def test_quaternions(phi, theta, psi):
    m = sent("ATTITUDE_QUATERNION", attitude=(phi, theta, psi), rates=(0.1, 0.2, 0.3))
    ours, theirs = (m.q1, m.q2, m.q3, m.q4), Quaternion([phi, theta, psi]).q
    # q and -q are the same attitude.
    assert abs(sum(a * b for a, b in zip(ours, theirs, strict=True))) == pytest.approx(1.0)
    assert (m.rollspeed, m.pitchspeed, m.yawspeed) == (0.1, 0.2, 0.3)


@pytest.mark.parametrize("psi", [-3.0, -0.1, 0.1, 3.0])
@pytest.mark.parametrize("turns", [-1, 1])
def test_a_quaternion_does_not_change_its_sign_with_a_whole_turn(psi, turns):
    q = []
    for angle in (psi, psi + turns * math.tau):
        m = sent("ATTITUDE_QUATERNION", attitude=(0.1, 0.2, angle))
        q.append((m.q1, m.q2, m.q3, m.q4))
    assert q[0] == pytest.approx(q[1], abs=1e-6)
    assert q[0][0] > 0.0


def test_inertia():
    measured = {"specific_force": (0.0, 9.80665, -19.6133), "rates": (0.5, -1.0, 0.0015)}
    m = sent("SCALED_IMU", **measured)
    assert (m.xacc, m.yacc, m.zacc) == (0, 1000, -2000)
    assert (m.xgyro, m.ygyro, m.zgyro) == (500, -1000, 2)
    m = sent("HIGHRES_IMU", **measured, submerged=True, depth=10.0)
    assert (m.yacc, m.ygyro, m.abs_pressure) == (9.80665, -1.0, pytest.approx(1993.915))


def test_pressure_of_the_water_is_that_of_its_depth():
    # An atmosphere, and a technical one (98 066.5 Pa) for each 10 m of fresh water.
    for depth, pressure in ((0.0, 1013.25), (10.0, 1993.915), (100.0, 10_819.9)):
        m = sent("SCALED_PRESSURE2", submerged=True, depth=depth)
        assert m.press_abs == pytest.approx(pressure, rel=1e-12)
    assert silent("SCALED_PRESSURE2", submerged=True)
    assert sent("HIGHRES_IMU").fields_updated & 0x200 == 0


def test_distance_to_the_ground():
    m = sent("DISTANCE_SENSOR", ground_distance=12.344)
    assert (m.current_distance, m.orientation) == (1234, mavlink.MAV_SENSOR_ROTATION_PITCH_270)
    assert silent("DISTANCE_SENSOR")


WAY = Way(heading=math.radians(200.0), speed=0.8, depth=3.0, cross_track=-1.5, distance=70.4)


def test_where_it_heads_for():
    m = sent("NAV_CONTROLLER_OUTPUT", way=WAY, velocity_n=(0.5, 0.0, 0.0))
    assert (m.nav_bearing, m.target_bearing, m.wp_dist) == (-160, -160, 70)
    assert (m.xtrack_error, m.alt_error) == (-1.5, 0.0)
    assert m.aspd_error == pytest.approx(0.3)
    deep = sent("NAV_CONTROLLER_OUTPUT", submerged=True, way=WAY, position_n=(0.0, 0.0, 12.0))
    assert deep.alt_error == 9.0  # 3 m deep is wanted: higher
    sails = sent("NAV_CONTROLLER_OUTPUT", way=replace(WAY, speed=None), velocity_n=(0.5, 0.0, 0.0))
    assert sails.aspd_error == 0.0
    assert silent("NAV_CONTROLLER_OUTPUT")


def test_the_bearing_of_where_it_goes():
    bench = Bench()
    bench.enter("guided")
    bench.measure(way=WAY, position_n=(100.0, 50.0, 0.0))
    bench.vehicle.target = Target("position", (100.0, 150.0, 0.0))
    assert bench.one(ID["MAVLINK_MSG_ID_NAV_CONTROLLER_OUTPUT"]).target_bearing == 90
    bench.enter("return")
    bench.tick()
    bearing = bench.one(ID["MAVLINK_MSG_ID_NAV_CONTROLLER_OUTPUT"]).target_bearing
    assert bearing == round(math.degrees(math.atan2(-50.0, -100.0)))


def test_true_wind_from_the_apparent_one():
    # A west wind of 6 m/s on a boat that goes north at 2 m/s: the air comes at it with
    # (-2, 6) along its axes.
    apparent = (math.hypot(2, 6), math.atan2(6, -2))
    m = sent("WIND", apparent_wind=apparent, velocity_n=(2, 0, 0), attitude=(0, 0, 0))
    assert (m.speed, m.direction) == (pytest.approx(6.0), pytest.approx(270.0))
    # The same air and boat, that points east now and is set north by a current.
    turned = (math.hypot(2, 6), math.atan2(2, 6))
    m = sent("WIND_COV", apparent_wind=turned, velocity_n=(2, 0, 0), attitude=(0, 0, math.pi / 2))
    assert (m.wind_x, m.wind_y) == (pytest.approx(0.0, abs=1e-12), pytest.approx(6.0))
    assert silent("WIND")
    assert silent("WIND_COV")


def test_battery():
    measured = {"voltage": 15.9, "current": 3.21, "charge": 0.604}
    m = sent("BATTERY_STATUS", **measured)
    assert (m.voltages[0], m.current_battery, m.battery_remaining) == (15900, 321, 60)
    m = sent("SYS_STATUS", **measured)
    assert (m.voltage_battery, m.current_battery, m.battery_remaining) == (15900, 321, 60)
    assert m.onboard_control_sensors_health & mavlink.MAV_SYS_STATUS_SENSOR_BATTERY
    assert silent("BATTERY_STATUS")
    m = sent("SYS_STATUS")
    assert (m.voltage_battery, m.current_battery, m.battery_remaining) == (65535, -1, -1)
    assert not m.onboard_control_sensors_present & mavlink.MAV_SYS_STATUS_SENSOR_BATTERY


@pytest.mark.parametrize(
    ("lost", "bits"),
    [
        ("position_valid", mavlink.MAV_SYS_STATUS_SENSOR_GPS),
        ("heading_valid", mavlink.MAV_SYS_STATUS_SENSOR_3D_MAG | mavlink.MAV_SYS_STATUS_AHRS),
    ],
)
def test_health_follows_validity(lost, bits):
    m = sent("SYS_STATUS")
    healthy = m.onboard_control_sensors_health
    assert m.onboard_control_sensors_enabled == m.onboard_control_sensors_present
    # What a ground station takes for healthy: gyro, accelerometer, compass, satellites, attitude.
    assert healthy & 0x200027 == 0x200027
    assert sent("SYS_STATUS", **{lost: False}).onboard_control_sensors_health == healthy & ~bits


def test_filter_status():
    horizontal = mavlink.EKF_POS_HORIZ_ABS
    assert sent("EKF_STATUS_REPORT").flags & horizontal
    flags = sent("EKF_STATUS_REPORT", position_valid=False).flags
    assert not flags & horizontal
    assert flags & mavlink.EKF_CONST_POS_MODE


def test_servo_outputs():
    pulses = (1.1e-3, 0.0, 1.9e-3, *[0.0] * 12, 1.5004e-3)
    m = sent("SERVO_OUTPUT_RAW", pulses=pulses)
    assert (m.servo1_raw, m.servo2_raw, m.servo3_raw, m.servo16_raw) == (1100, 0, 1900, 1500)


def test_named_values():
    bench = Bench()
    bench.measure(named=(("rudder", 0.25), ("sail", -1.5)))
    _, messages = bench.request(mavlink.MAVLINK_MSG_ID_NAMED_VALUE_FLOAT)
    assert [(m.name, m.value) for m in messages] == [("rudder", 0.25), ("sail", -1.5)]


def test_it_has_always_landed():
    assert sent("EXTENDED_SYS_STATE").landed_state == mavlink.MAV_LANDED_STATE_ON_GROUND


def test_truth_stands_beside_the_estimates():
    bench = Bench()
    number = mavlink.MAVLINK_MSG_ID_SIM_STATE
    assert bench.request(number)[0] == mavlink.MAV_RESULT_DENIED
    bench.measure(position_n=(99.0, 99.0, 99.0))
    bench.vehicle.truth = Truth(
        (100.0, 50.0, 3.0), (1.0, 2.0, 3.0), (0.1, 0.2, 4.0), (0.01, 0.02, 0.03), (0.0, 0.0, -9.8)
    )
    m = bench.one(number)
    latitude, longitude, _ = ORIGIN.geodetic((100.0, 50.0, 0.0))
    assert (m.lat_int, m.lon_int) == (round(latitude * 1e7), round(longitude * 1e7))
    assert m.alt == -1.0
    assert (m.roll, m.pitch, m.yaw) == (0.1, 0.2, pytest.approx(4.0 - math.tau))
    assert (m.vn, m.ve, m.vd, m.zacc, m.xgyro) == (1.0, 2.0, 3.0, -9.8, 0.01)


LARGE = st.floats(-1e9, 1e9)


@given(st.lists(LARGE, min_size=12, max_size=12), st.booleans())
def test_values_of_any_size_can_be_sent(x, submerged):
    bench = Bench(submerged=submerged)
    bench.measure(
        position_n=tuple(x[:3]),
        velocity_n=tuple(x[3:6]),
        attitude=tuple(x[6:9]),
        rates=tuple(x[9:]),
        specific_force=tuple(x[:3]),
        depth=x[0] if submerged else None,
        apparent_wind=(x[1], x[2]),
        voltage=x[3],
        current=x[4],
        charge=x[5],
        pulses=tuple(x) + tuple(x[:4]),
        named=(("x", x[0]),),
        ground_distance=x[0],
        way=Way(*x[:5]),
    )
    bench.wait(1.0)  # the transport of the bench packs every message
    assert len(bench.transport.sent) > 20
