import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from seatrial.devices.anemometer import Anemometer

from .running import started

IDEAL = {
    **dict.fromkeys(("speed_noise", "speed_resolution"), 0.0),
    **dict.fromkeys(("angle_noise", "angle_instability", "angle_resolution"), 0.0),
}


def measured(**values):
    anemometer = started(Anemometer, **{**IDEAL, **values})
    return anemometer.get("speed"), anemometer.get("angle")


@pytest.mark.parametrize(
    ("psi", "speed", "angle"),
    [
        (0.0, 3.0, 0.0),  # running before 5 m/s at 2 m/s
        (math.pi, 7.0, math.pi),  # straight against it
        (math.pi / 2, math.hypot(5.0, 2.0), math.atan2(-5.0, -2.0)),  # on a beam reach eastwards
    ],
)
def test_apparent_wind_of_a_boat_under_way(psi, speed, angle):
    found = measured(wind=[5.0, 0.0], attitude=[0.0, 0.0, psi], velocity=[2.0, 0.0, 0.0])
    assert found == pytest.approx((speed, angle), rel=1e-12)


def test_against_the_flow_by_rotation_matrices():
    attitude, velocity, rates = [0.4, -0.1, 2.1], [1.5, -0.2, 0.1], [0.3, 0.1, -0.2]
    place, wind = [0.2, 0.1, -0.9], [4.0, -3.0]
    to_ned = Rotation.from_euler("ZYX", attitude[::-1])
    flow = to_ned.inv().apply([*wind, 0.0]) - velocity - np.cross(rates, place)
    found = measured(attitude=attitude, velocity=velocity, rates=rates, place=place, wind=wind)
    expected = (np.hypot(flow[0], flow[1]), np.arctan2(flow[1], flow[0]))
    assert found == pytest.approx(expected, rel=1e-12)


def test_speed_with_errors_is_not_negative_and_the_angle_is_wrapped():
    low = started(Anemometer, **{**IDEAL, "speed_bias": -1.0}, wind=[0.5, 0.0])
    assert low.get("speed") == 0.0
    round_about = measured(wind=[-5.0, 0.0], angle_bias=0.1)
    assert round_about == pytest.approx((5.0, 0.1 - math.pi), rel=1e-12)
    assert measured(wind=[-5.0, 0.0])[1] == math.pi


def test_resolution():
    found = measured(wind=[3.14, 1.0], speed_resolution=0.1, angle_resolution=0.1)
    assert found == pytest.approx((3.3, 0.3), rel=1e-12)
