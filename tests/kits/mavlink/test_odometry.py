"""ODOMETRY and HIL_STATE_QUATERNION: on request alone, estimates and truth."""

import math

import pytest
from pymavlink.dialects.v20 import all as mavlink

from seatrial.links.truth import Truth

from .bench import ORIGIN, Bench

ODOMETRY = mavlink.MAVLINK_MSG_ID_ODOMETRY
TRUTH = mavlink.MAVLINK_MSG_ID_HIL_STATE_QUATERNION
EAST = math.pi / 2
DENIED = mavlink.MAV_RESULT_DENIED


def test_they_are_sent_on_request_only():
    bench = Bench()
    bench.wait(5.0)
    assert not bench.transport.take("ODOMETRY")
    assert not bench.transport.take("HIL_STATE_QUATERNION")


def test_odometry_has_its_velocity_along_the_body():
    bench = Bench()
    bench.measure(
        position_n=(3.0, 4.0, 0.5), velocity_n=(-0.2, 1.0, 0.1), attitude=(0.0, 0.0, EAST)
    )
    m = bench.one(ODOMETRY)
    assert (m.frame_id, m.child_frame_id) == (1, 12)
    assert (m.x, m.y, m.z) == pytest.approx((3.0, 4.0, 0.5))
    assert (m.vx, m.vy, m.vz) == pytest.approx((1.0, 0.2, 0.1))
    assert m.q == pytest.approx([math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5)])
    assert math.isnan(m.pose_covariance[0])
    assert math.isnan(m.velocity_covariance[0])


def test_no_odometry_without_a_position():
    assert Bench(valid=False).request(ODOMETRY) == (DENIED, [])


def test_the_truth():
    bench = Bench()
    assert bench.request(TRUTH) == (DENIED, [])
    bench.vehicle.truth = Truth(
        (30.0, 40.0, 0.25), (1.0, -0.5, 0.0), (0.0, 0.0, -EAST), (0.1, 0.2, 0.3), (0.0, 0.0, -9.80665)
    )  # fmt: skip
    m = bench.one(TRUTH)
    latitude, longitude, altitude = ORIGIN.geodetic((30.0, 40.0, 0.25))
    assert (m.lat, m.lon) == (round(latitude * 1e7), round(longitude * 1e7))
    assert m.alt == round(altitude * 1e3)
    assert (m.vx, m.vy, m.vz) == (100, -50, 0)
    assert (m.rollspeed, m.pitchspeed, m.yawspeed) == pytest.approx((0.1, 0.2, 0.3))
    assert m.zacc == -1000
    assert m.attitude_quaternion == pytest.approx([math.sqrt(0.5), 0.0, 0.0, -math.sqrt(0.5)])
