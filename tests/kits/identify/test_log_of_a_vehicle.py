"""A telemetry log in the place of a CSV file: rates of its own, times that are not even."""

import struct

import numpy as np
import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from seatrial_kits.identify.studies.experiment import load_experiment
from seatrial_kits.identify.studies.log_file import read_log
from tests.kit import needs_kits

EXPERIMENT = """
title = "Yaw"
axis = "yaw"
log = "boat.tlog"

[columns]
command = { name = "servo.throttle" }
heading = { name = "ATTITUDE.yaw" }

[known]
mass = "0.122 kg.m2"
thrust = "9 N.m"
source = "bollard pull"
"""
PARAMETERS = {"SERVO1_FUNCTION": 70, "SERVO1_MIN": 1000, "SERVO1_TRIM": 1500, "SERVO1_MAX": 2000}


@needs_kits("mavlink")
def test_a_telemetry_log(tmp_path):
    """Orders that are held, a heading with jitter of 8 ms: both at even times, by closed forms."""
    boat, jitter = mavlink.MAVLink(None, 1, 1), np.random.default_rng(7).integers(-8, 9, 600)

    def stamped(ms, message):
        return struct.pack(">Q", 10**15 + 1000 * int(ms)) + message.pack(boat)

    messages = [stamped(0, mavlink.MAVLink_param_value_message(n.encode(), v, 9, 4, 0))
                for n, v in PARAMETERS.items()]  # fmt: skip
    for k, ms in enumerate(1000 + 100 * np.arange(600) + jitter):
        if k % 10 == 0:  # an order each second, 50 ms before a heading
            pulse = 1500 + 500 * order(k // 10)
            messages.append(
                stamped(
                    950 + 100 * k,
                    mavlink.MAVLink_servo_output_raw_message(0, 0, round(pulse), *[0] * 7),
                )
            )
        messages.append(
            stamped(ms, mavlink.MAVLink_attitude_message(int(ms), 0, 0, yaw(ms / 1e3), 0, 0, 0))
        )
    messages.append(stamped(61_000, mavlink.MAVLink_servo_output_raw_message(0, 0, 1500, *[0] * 7)))
    (tmp_path / "boat.tlog").write_bytes(b"".join(messages))
    (tmp_path / "pool.toml").write_text(EXPERIMENT, "utf-8")
    experiment = load_experiment(str(tmp_path / "pool.toml"))
    found = read_log(experiment, experiment.log_path(None))
    assert found.period == pytest.approx(0.1, abs=0.002)
    grid = (1000 + jitter[0]) / 1e3 + found.period * np.arange(len(found.measured))
    # Between rows h apart a cubic is off by h^3/24 times the third derivative and less, at extrema h^2/8 times the second.
    np.testing.assert_allclose(found.measured, yaw(grid), atol=0.12**2 / 8.0 * 0.5 * 0.8**2)
    whole = np.floor(grid - 0.95 + 1e-9).astype(int)
    np.testing.assert_allclose(found.command, [order(k) for k in whole], atol=1e-12)


def yaw(t):
    return 0.5 * np.sin(0.8 * t)


def order(k):
    """Return the order of a second, a multiple of 1/500."""
    return (37 * k % 101 - 50) / 250.0
