"""Messages that the link writes: one function per topic, from inputs to fields of messages.

Each returns the message, None while the measurement is not valid. World axes are east-north-up,
body axes ahead-left-up (`frames`).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, NamedTuple

from seatrial.links.geodesy import Origin
from seatrial.links.truth import Truth
from seatrial.links.unconnected import is_connected
from seatrial.model.unit_table import STANDARD_GRAVITY
from seatrial.physics.craft.kinematics import to_body

from .frames import enu, flu, quaternion
from .instruments import Instruments
from .ports import JOINTS, MOTORS, Ros2Ports

Fields = Mapping[str, Any]
MAP, ODOM, BASE = "map", "odom", "base_link"
_ATMOSPHERE = 101_325.0
_FRESH_WATER = 1000.0
"""Pressure of the air, Pa, and the density, kg/m3, that depth sensors assume."""
_CELSIUS = 273.15
_SONAR, _FAR = 0, 100.0
_NO_FIX, _FIX, _GPS = -1, 0, 1
_DIAGONAL = 2
_DISCHARGING, _POWER_UNKNOWN = 2, 0
_BOTTOM = 1
_UNKNOWN = [-1.0, *(0.0,) * 8]
"""Covariance that says: there is no such estimate."""


@dataclass(frozen=True)
class Here:
    """What messages need beside the inputs."""

    now_ns: int
    prefix: str
    origin: Origin
    field: tuple[float, float, float]
    """The earth's, in {n}, T."""
    instruments: Instruments

    def header(self, frame: str) -> Fields:
        """Return a header of now."""
        named = frame if frame == MAP else self.prefix + frame
        return {"stamp": self.now_ns, "frame_id": named}


Maker = Callable[[Ros2Ports, Here], Fields | None]


def pose(truth: Truth) -> Fields:
    """Return the true pose as geometry_msgs/Pose."""
    return {"position": enu(truth.position_n), "orientation": quaternion(truth.attitude)}


def odometry(link: Ros2Ports, here: Here) -> Fields:
    """nav_msgs/Odometry: the truth; its twist in base_link, as REP 105 has it."""
    truth = link.true_motion()
    twist = {"linear": flu(link.true_velocity), "angular": flu(truth.rates)}
    return {
        "header": here.header(ODOM),
        "child_frame_id": here.prefix + BASE,
        "pose": {"pose": pose(truth)},
        "twist": {"twist": twist},
    }


def transforms(link: Ros2Ports, here: Here) -> Fields:
    """tf2_msgs/TFMessage: map to odom, which are one here, and odom to base_link."""
    truth = link.true_motion()
    moved = {"translation": enu(truth.position_n), "rotation": quaternion(truth.attitude)}
    return {
        "transforms": [
            _transform(here, MAP, ODOM, {"rotation": _UP}),
            _transform(here, ODOM, BASE, moved),
        ]
    }


def places(link: Ros2Ports, here: Here) -> Fields:
    """tf2_msgs/TFMessage: base_link to each sensor, whose axes are its own, but for a DVL's."""
    found = [
        (frame, here.instruments.place(key), _DOWN if key == "dvl_report" else _UP)
        for key, frame in FRAMES.items()
    ]
    return {
        "transforms": [
            _transform(here, BASE, frame, {"translation": flu(at), "rotation": turn})
            for frame, at, turn in found
        ]
    }


_UP, _DOWN = (0.0, 0.0, 0.0, 1.0), (1.0, 0.0, 0.0, 0.0)
"""Turns of axes ahead-left-up, and ahead-right-down: half a turn about the x axis."""


def _transform(here: Here, parent: str, child: str, transform: Fields) -> Fields:
    named = here.prefix + child
    return {"header": here.header(parent), "child_frame_id": named, "transform": transform}


def imu(link: Ros2Ports, here: Here) -> Fields | None:
    """sensor_msgs/Imu: rates and force; attitude where roll, pitch and heading are measured."""
    if not link.gyro_valid:
        return None
    values: dict[str, Any] = {
        "header": here.header(FRAMES["imu"]),
        "angular_velocity": flu(link.gyro),
        "angular_velocity_covariance": here.instruments.covariance("imu", "gyro"),
        "linear_acceleration_covariance": _UNKNOWN,
        "orientation_covariance": _UNKNOWN,
    }
    if is_connected(*link.accelerometer) and link.imu_valid:
        values["linear_acceleration"] = flu(link.accelerometer)
        values["linear_acceleration_covariance"] = here.instruments.covariance(
            "imu", "accelerometer"
        )
    known = is_connected(*link.roll_pitch, link.heading)
    if known and link.imu_valid and link.heading_valid:
        values["orientation"] = quaternion((*link.roll_pitch, link.heading))
        tilt = here.instruments.deviations("imu", "roll_pitch", 2)
        turn = here.instruments.deviations("compass", "heading", 1)
        diagonal = [v * v for v in (*tilt, *turn)]
        values["orientation_covariance"] = [
            diagonal[i // 4] if i % 4 == 0 else 0.0 for i in range(9)
        ]
    return values


def compass(link: Ros2Ports, here: Here) -> Fields | None:
    """sensor_msgs/MagneticField, T: the earth's, turned by the measured heading and tilt."""
    if not link.heading_valid:
        return None
    tilt = link.roll_pitch if is_connected(*link.roll_pitch) else (0.0, 0.0)
    field = to_body((*tilt, link.heading), here.field)
    return {"header": here.header(FRAMES["compass"]), "magnetic_field": flu(field)}


def fix(link: Ros2Ports, here: Here) -> Fields:
    """sensor_msgs/NavSatFix: WGS 84, degrees; without a fix its status says so."""
    header = here.header(FRAMES["fix"])
    if not link.position_valid:
        lost = (math.nan,) * 3
        status = {"status": _NO_FIX, "service": _GPS}
        return {"header": header, "status": status, **dict(zip(_PLACE, lost, strict=True))}
    place = _geodetic(here.origin, link.position_n)
    covariance = here.instruments.covariance("fix", "position_n", world=True)
    return {
        "header": header,
        "status": {"status": _FIX, "service": _GPS},
        **dict(zip(_PLACE, place, strict=True)),
        "position_covariance": covariance,
        "position_covariance_type": _DIAGONAL if any(covariance) else 0,
    }


_PLACE = ("latitude", "longitude", "altitude")


@lru_cache(maxsize=8)
def _geodetic(origin: Origin, position: tuple[float, float, float]) -> tuple[float, float, float]:
    """Return a place; a receiver gives each several times, and other vehicles theirs between."""
    return origin.geodetic(position)


def velocity(link: Ros2Ports, here: Here) -> Fields | None:
    """geometry_msgs/TwistStamped of GNSS: over ground, east-north-up, m/s."""
    if not link.position_valid:
        return None
    return {"header": here.header(MAP), "twist": {"linear": enu(link.velocity_n)}}


def pressure(link: Ros2Ports, here: Here) -> Fields | None:
    """sensor_msgs/FluidPressure, Pa, absolute: of fresh water under standard air."""
    if not link.depth_valid:
        return None
    per_metre = _FRESH_WATER * STANDARD_GRAVITY
    (deviation,) = here.instruments.deviations("pressure", "depth", 1)
    return {
        "header": here.header(FRAMES["pressure"]),
        "fluid_pressure": _ATMOSPHERE + per_metre * link.depth,
        "variance": (per_metre * deviation) ** 2,
    }


def dvl(link: Ros2Ports, here: Here) -> Fields | None:
    """geometry_msgs/TwistWithCovarianceStamped: over the bottom, in base_link; none without it."""
    if not link.velocity_b_valid:
        return None
    covariance = [0.0] * 36
    known = here.instruments.dvl_covariance()
    for row in range(3):
        covariance[6 * row : 6 * row + 3] = known[3 * row : 3 * row + 3]
    twist = {"twist": {"linear": flu(link.velocity_b)}, "covariance": covariance}
    return {"header": here.header(BASE), "twist": twist}


def dvl_report(link: Ros2Ports, here: Here) -> Fields | None:
    """marine_acoustic_msgs/Dvl: x ahead, z down, the way it points; none without the bottom.

    The course is that of its x axis to its y axis. Of single beams it has nothing.
    """
    if not link.velocity_b_valid:
        return None
    u, v, _ = link.velocity_b
    echo = is_connected(link.water_depth) and link.water_depth_valid
    known = here.instruments.dvl_covariance()
    return {
        "header": here.header(FRAMES["dvl_report"]),
        "velocity_mode": _BOTTOM,
        "velocity": link.velocity_b,
        "velocity_covar": known if any(known) else [-1.0] * 9,
        "altitude": link.water_depth if echo else math.nan,
        "course_gnd": math.atan2(v, u),
        "speed_gnd": math.hypot(u, v),
        "num_good_beams": 4,
        "sound_speed": math.nan,
    }


def water_speed(link: Ros2Ports, here: Here) -> Fields | None:
    """geometry_msgs/TwistStamped: ahead through the water, in base_link, m/s."""
    if not link.water_speed_valid:
        return None
    return {"header": here.header(BASE), "twist": {"linear": (link.water_speed, 0.0, 0.0)}}


def water_depth(link: Ros2Ports, here: Here) -> Fields:
    """sensor_msgs/Range below the transducer; without an echo inf, as REP 117 has it."""
    return {
        "header": here.header(FRAMES["water_depth"]),
        "radiation_type": _SONAR,
        "max_range": _FAR,
        "range": link.water_depth if link.water_depth_valid else math.inf,
    }


def wind(link: Ros2Ports, here: Here) -> Fields | None:
    """geometry_msgs/TwistStamped: velocity of the apparent wind in base_link, m/s."""
    if not link.wind_valid:
        return None
    return {"header": here.header(BASE), "twist": {"linear": _wind(link)}}


def wind_vector(link: Ros2Ports, here: Here) -> Fields | None:
    """geometry_msgs/Vector3: the same velocity of the apparent wind, in base_link, m/s."""
    if not link.wind_valid:
        return None
    return dict(zip("xyz", _wind(link), strict=True))


def _wind(link: Ros2Ports) -> tuple[float, float, float]:
    speed, angle = link.wind_speed, link.wind_angle
    return flu((speed * math.cos(angle), speed * math.sin(angle), 0.0))


def sonar(link: Ros2Ports, here: Here) -> Fields:
    """sensor_msgs/LaserScan of one ping of a scanning sonar; without an echo inf (REP 117).

    The angle is about the z axis up, so that one to starboard is negative, in [-pi, pi].
    """
    angle = math.remainder(-link.sonar_angle, math.tau)
    return {
        "header": here.header(FRAMES["sonar"]),
        "angle_min": angle,
        "angle_max": angle,
        "range_max": _FAR,
        "ranges": [link.sonar_distance if link.sonar_distance_valid else math.inf],
    }


def leak(link: Ros2Ports, here: Here) -> Fields:
    """std_msgs/Bool."""
    return {"data": link.leaking > 0.5}


def temperature(link: Ros2Ports, here: Here) -> Fields:
    """sensor_msgs/Temperature of the water, degrees Celsius."""
    return {
        "header": here.header(FRAMES["temperature"]),
        "temperature": link.water_temperature - _CELSIUS,
    }


def battery(link: Ros2Ports, here: Here) -> Fields:
    """sensor_msgs/BatteryState; a current that discharges is negative there."""
    unknown = math.nan
    return {
        "header": here.header(BASE),
        "voltage": link.voltage,
        "current": -link.current if is_connected(link.current) else unknown,
        "percentage": link.charge if is_connected(link.charge) else unknown,
        **dict.fromkeys(("temperature", "charge", "capacity", "design_capacity"), unknown),
        "power_supply_status": _DISCHARGING,
        "power_supply_technology": _POWER_UNKNOWN,
        "present": True,
    }


def joints(link: Ros2Ports, here: Here) -> Fields:
    """sensor_msgs/JointState: angles of servos, rad, and speeds of motors, rad/s."""
    angles = {n: v for n, v in zip(JOINTS, link.joint, strict=True) if is_connected(v)}
    speeds = {
        f"motor{n}": v
        for n, v in zip(range(1, len(MOTORS) + 1), link.motor_speed, strict=True)
        if is_connected(v)
    }
    return {
        "header": here.header(BASE),
        "name": [*angles, *speeds],
        "position": [*angles.values(), *(math.nan for _ in speeds)],
        "velocity": [*(math.nan for _ in angles), *speeds.values()],
    }


def leg(link: Ros2Ports, here: Here) -> Fields | None:
    """nav_msgs/Path: both ends of the course's leg; a node that sails it is given it so."""
    if not link.leg:
        return None
    header = here.header(MAP)
    ends = [{"header": header, "pose": {"position": enu(e)}} for e in (link.leg_from, link.leg_to)]
    return {"header": header, "poses": ends}


FRAMES = {
    "imu": "imu_link",
    "compass": "compass_link",
    "fix": "gnss_link",
    "pressure": "pressure_link",
    "dvl_report": "dvl_link",
    "water_depth": "echo_sounder_link",
    "temperature": "ctd_link",
    "sonar": "sonar_link",
}
"""Frames of sensors, by key of their topics."""


class Measurement(NamedTuple):
    """A topic of measurements: the inputs that say whether the vehicle has it, and its messages."""

    ports: tuple[str, ...]
    make: Maker
    beside: tuple[str, ...] = ()
    """All other inputs that its messages are made of."""


_TILT = (
    *("gyro_valid", "accelerometer", "imu_valid"),
    *("roll_pitch", "heading", "heading_valid"),
)
MEASURED: Mapping[str, Measurement] = {
    "imu": Measurement(("gyro",), imu, _TILT),
    "compass": Measurement(("heading",), compass, ("heading_valid", "roll_pitch")),
    "fix": Measurement(("position_n",), fix, ("position_valid",)),
    "velocity": Measurement(("velocity_n",), velocity, ("position_valid",)),
    "pressure": Measurement(("depth",), pressure, ("depth_valid",)),
    "dvl": Measurement(("velocity_b",), dvl, ("velocity_b_valid",)),
    "dvl_report": Measurement(
        ("velocity_b",), dvl_report, ("velocity_b_valid", "water_depth", "water_depth_valid")
    ),
    "water_speed": Measurement(("water_speed",), water_speed, ("water_speed_valid",)),
    "water_depth": Measurement(("water_depth",), water_depth, ("water_depth_valid",)),
    "wind": Measurement(("wind_speed",), wind, ("wind_angle", "wind_valid")),
    "wind_vector": Measurement(("wind_speed",), wind_vector, ("wind_angle", "wind_valid")),
    "sonar": Measurement(("sonar_distance",), sonar, ("sonar_distance_valid", "sonar_angle")),
    "leak": Measurement(("leaking",), leak),
    "temperature": Measurement(("water_temperature",), temperature),
    "battery": Measurement(("voltage",), battery, ("current", "charge")),
    "joints": Measurement(("joint", "motor_speed"), joints),
}
"""Topics of measurements by key: written as they change, and at the period of their sensor."""


def measured(link: Ros2Ports) -> list[str]:
    """Return the keys of what the vehicle measures, now or later."""

    def is_there(port: str) -> bool:
        value = getattr(link, port)
        return any(map(is_connected, value if isinstance(value, tuple) else (value,)))

    return [key for key, each in MEASURED.items() if any(map(is_there, each.ports))]
