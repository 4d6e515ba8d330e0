"""Defaults as each sensor's page and data sheet state them, angles in degrees."""

import math

import numpy as np
import pytest

from seatrial.devices.ahrs import Ahrs
from seatrial.devices.anemometer import Anemometer
from seatrial.devices.compass import Compass
from seatrial.devices.imu import Imu

from .ideal import ideal
from .running import over

STATED = {
    Anemometer: {"angle_noise": 1, "angle_instability": 1, "angle_resolution": 1},
    Ahrs: {"euler_noise": (0.134, 0.05, 0.195), "euler_resolution": 0.1},
    Compass: {
        "heading_noise": 0.3,
        "heading_instability": 0.5,
        "heading_resolution": 0.1,
        "deviation": (1, 0, 0, 0),
    },
    Imu: {
        "gyro_noise": 0.035,
        "gyro_instability": 0.003,
        "gyro_resolution": 500 / 2**16,
        "gyro_range": 250,
        "roll_pitch_noise": 0.1,
        "roll_pitch_instability": 0.3,
    },
}


@pytest.mark.parametrize(
    ("kind", "name"), [(kind, name) for kind, stated in STATED.items() for name in stated]
)
def test_defaults_are_those_stated(kind, name):
    found = np.degrees(kind("sensor").get(name))
    np.testing.assert_allclose(found, np.broadcast_to(STATED[kind][name], found.shape))


def test_a_unit_that_stands_on_end_pitches_by_89_degrees_at_most():
    still = {"attitude_time": 1e9, "period": 0.1}
    unit = ideal(Imu, **still, attitude=(0.0, 1.3, 0.0), rates=(0.0, 0.5, 0.0))
    found = np.degrees(over(unit, ["roll_pitch"], 0.1, [{}] * 12)[:, 1])
    assert found[4] == pytest.approx(math.degrees(1.3 + 4 * 0.05))
    assert found.max() == pytest.approx(89.0)


def test_a_unit_is_as_its_sheet_says_at_25_degrees():
    drift = {"gyro_temperature_drift": (1e-3, 0, 0), "accelerometer_temperature_drift": 0.0}
    unit = ideal(Imu, **drift, temperature=273.15 + 25.0)
    assert unit.get("gyro")[0] == 0.0
    unit.set("temperature", 273.15 + 45.0)
    assert unit.get("gyro")[0] == pytest.approx(0.02)
