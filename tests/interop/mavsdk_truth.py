"""True motion of the boat, to compare with what MAVSDK received of it."""

from __future__ import annotations

import datetime
import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from seatrial.trial.records.run_folder import Run
from tests.kits.mavlink.ground import north_of

Values = dict[str, Any]
Array = NDArray[np.float64]

LAG_S, LEAD_S = 0.45, 0.2
"""Of a sample's time before and after the truth: 0.3 s of the GNSS, a row, the clock's 0.1 s."""
GRAVITY = 9.81
ANTENNA = (0.0, 0.0, -0.3)
MIDNIGHT_US = datetime.datetime(2026, 2, 5, tzinfo=datetime.UTC).timestamp() * 1e6

# Five standard deviations of the sensors in hil_profiles/hydrone.toml, noise and varying bias
# together, the compass's constant deviation of 1 deg, and the resolutions of the messages; of
# rates also what they may change by between two rows of the record.
PLACE, HEIGHT, SPEED = 5 * 0.0112 + 0.011, 5 * 0.0224 + 0.001, 5 * 0.02 + 0.01
HEADING, ROLL = math.radians(1.0 + 5 * 0.583 + 0.1), math.radians(5 * 0.316)
RATE, FORCE = math.radians(5 * 0.0351 + 0.0076) + 3e-3, 5 * 0.00702 + 0.0012 + 0.01
DEGREE = math.radians(1.0)


class Truth:
    """The record of the run as arrays over time: SI, rad, {n}, of the antenna where it says so."""

    def __init__(self, run: Run) -> None:
        self.run, self.time = run, run.time
        self.arrays: dict[str, Array] = {}
        phi, theta, psi = (
            run.signals[f"vehicle.hull.attitude.{a}"] for a in ("phi", "theta", "psi")
        )
        turn = Rotation.from_euler("ZYX", np.column_stack([psi, theta, phi]))
        position, velocity, rates, acceleration = (
            np.column_stack([run.signals[f"vehicle.hull.{port}.{a}"] for a in axes])
            for port, axes in (
                ("position", "xyz"),
                ("velocity", "uvw"),
                ("rates", "pqr"),
                ("acceleration", "xyz"),
            )
        )
        antenna = position + turn.apply(ANTENNA)
        moving = turn.apply(velocity + np.cross(rates, ANTENNA))
        felt = acceleration - turn.inv().apply([0.0, 0.0, GRAVITY])
        along = turn.inv().apply(moving)
        for names, values in (
            (("north", "east", "down"), antenna),
            (("vn", "ve", "vd"), moving),
            (("ahead", "starboard", "below"), along),
            (("p", "q", "r"), rates),
            (("fx", "fy", "fz"), felt),
            (("x", "y", "z"), position),
            (("u", "v", "w"), velocity),
        ):
            self.arrays |= dict(zip(names, values.T, strict=True))
        self.arrays |= {"phi": phi, "theta": theta, "psi": np.unwrap(psi), "time": self.time}
        self.arrays["speed"] = np.hypot(moving[:, 0], moving[:, 1])

    def __getitem__(self, name: str) -> Array:
        return self.arrays[name]

    def window(self, began: float, ended: float) -> slice:
        """Return the rows from one to another time, with those next to them."""
        first = np.searchsorted(self.time, began, "right") - 1
        last = np.searchsorted(self.time, ended, "left") + 1
        return slice(max(int(first), 0), int(last))

    def off(self, name: str, value: float, time: float, *, angle: bool = False) -> float:
        """Return how far a value is from all that was true about then."""
        rows = self.arrays[name][self.window(time - LAG_S, time + LEAD_S)]
        if angle:
            value = rows[-1] + math.remainder(value - rows[-1], math.tau)
        return float(max(rows.min() - value, value - rows.max(), 0.0))


def place(values: Values) -> tuple[float, float]:
    """Return north and east, m, of a sample with latitude and longitude."""
    (lat_0, lon_0), (lat_1, lon_1) = north_of(0.0), north_of(1.0, 1.0)
    north = (values["latitude_deg"] - lat_0) / (lat_1 - lat_0)
    return north, (values["longitude_deg"] - lon_0) / (lon_1 - lon_0)


def euler(values: Values, prefix: str = "") -> tuple[float, float, float]:
    """Return roll, pitch, yaw, rad, of a sample with a quaternion."""
    x, y, z, w = (values[f"{prefix}{a}"] for a in "xyzw")
    yaw, pitch, roll = Rotation.from_quat([x, y, z, w]).as_euler("ZYX")
    return roll, pitch, yaw


Compared = tuple[str, Callable[[Values], float], float]
"""Name of the truth, the value out of a sample, how far it may be off."""


def _field(name: str, scale: float = 1.0) -> Callable[[Values], float]:
    return lambda values: float(values[name]) * scale


def _fields(
    truths: str, fields: str, tolerances: tuple[float, ...], scale: float = 1.0
) -> list[Compared]:
    pairs = zip(truths.split(), fields.split(), strict=True)
    return [(t, _field(f, scale), tol) for (t, f), tol in zip(pairs, tolerances, strict=True)]


_NORTH_EAST: list[Compared] = [
    ("north", lambda v: place(v)[0], PLACE),
    ("east", lambda v: place(v)[1], PLACE),
]
_PLACE_3 = (PLACE, PLACE, HEIGHT)
_TURN = math.radians(1.0)
_IMU = _fields(
    "fx fy fz p q r",
    "acceleration_frd.forward_m_s2 acceleration_frd.right_m_s2 acceleration_frd.down_m_s2 "
    "angular_velocity_frd.forward_rad_s angular_velocity_frd.right_rad_s "
    "angular_velocity_frd.down_rad_s",
    (FORCE,) * 3 + (RATE,) * 3,
)

STREAMS: dict[str, list[Compared]] = {
    "position": [*_NORTH_EAST, ("down", _field("absolute_altitude_m", -1.0), HEIGHT)],
    "velocity_ned": _fields("vn ve vd", "north_m_s east_m_s down_m_s", (SPEED,) * 3),
    "heading": [("psi", _field("heading_deg", _TURN), HEADING)],
    "position_velocity_ned": [
        *_fields("north east down", "position.north_m position.east_m position.down_m", _PLACE_3),
        *_fields(
            "vn ve vd",
            "velocity.north_m_s velocity.east_m_s velocity.down_m_s",
            (SPEED,) * 3,
        ),
    ],
    "raw_gps": [
        *_NORTH_EAST,
        ("down", _field("absolute_altitude_m", -1.0), HEIGHT),
        ("speed", _field("velocity_m_s"), SPEED * math.sqrt(2.0)),
    ],
    "attitude_euler": _fields(
        "phi theta psi", "roll_deg pitch_deg yaw_deg", (ROLL, ROLL, HEADING), _TURN
    ),
    "attitude_quaternion": [
        ("phi", lambda v: euler(v)[0], ROLL),
        ("theta", lambda v: euler(v)[1], ROLL),
        ("psi", lambda v: euler(v)[2], HEADING),
    ],
    "attitude_angular_velocity_body": _fields(
        "p q r", "roll_rad_s pitch_rad_s yaw_rad_s", (RATE,) * 3
    ),
    "imu": _IMU,
    "scaled_imu": _IMU,
    "fixedwing_metrics": [
        ("speed", _field("groundspeed_m_s"), SPEED * math.sqrt(2.0)),
        ("psi", _field("heading_deg", _TURN), HEADING + 0.5 * DEGREE),
        ("down", _field("absolute_altitude_m", -1.0), HEIGHT),
        ("vd", _field("climb_rate_m_s", -1.0), SPEED),
    ],
    "altitude": [("down", _field("altitude_amsl_m", -1.0), HEIGHT)],
    "odometry": [
        *_fields(
            "north east down", "position_body.x_m position_body.y_m position_body.z_m", _PLACE_3
        ),
        *_fields(
            "ahead starboard below",
            "velocity_body.x_m_s velocity_body.y_m_s velocity_body.z_m_s",
            (0.4,) * 3,  # turned by a heading that is younger, and has an error
        ),
        ("psi", lambda v: euler(v, "q.")[2], HEADING),
    ],
    "ground_truth": [
        ("x", lambda v: place(v)[0], 0.012),
        ("y", lambda v: place(v)[1], 0.012),
        ("z", _field("absolute_altitude_m", -1.0), 0.001),
    ],
    "unix_epoch_time": [("time", lambda v: (v["value"] - MIDNIGHT_US) * 1e-6, 1e-3)],
}
"""What each stream is compared with. Its own errors and its resolution are the tolerance."""
ANGLES = ("phi", "theta", "psi")

ALWAYS: dict[str, Values] = {
    "in_air": {"value": False},
    "landed_state": {"value": 1},
    "vtol_state": {"value": 0},
    "gps_info": {"fix_type": 6, "num_satellites": 20},
    "battery": {"voltage_v": 16.0},  # nothing measures its current, nor its charge
    "rc_status": {"is_available": False},
}
"""Fields that are the same all the time."""
SILENT = (
    *(
        "actuator_control_target",
        "actuator_output_status",
        "distance_sensor",
    ),
    *("scaled_pressure", "wind"),
)
"""Streams of what this boat does not have."""
