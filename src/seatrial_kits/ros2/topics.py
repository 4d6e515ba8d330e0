"""Topics: their default names below that of the vehicle, and those that a profile gives them."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import NamedTuple

from seatrial.errors import InputError, unknown

OFF = "off"
"""In the place of a topic's name: there is none."""
_NAME = re.compile(r"/?[A-Za-z_]\w*(/[A-Za-z_]\w*)*", re.ASCII)


class Topic(NamedTuple):
    """Default name and type of a topic; an absolute name stays as it is."""

    name: str
    kind: str


PUBLISHED: Mapping[str, Topic] = {
    "clock": Topic("/clock", "rosgraph_msgs/msg/Clock"),
    "tf": Topic("/tf", "tf2_msgs/msg/TFMessage"),
    "tf_static": Topic("/tf_static", "tf2_msgs/msg/TFMessage"),
    "odometry": Topic("odometry/ground_truth", "nav_msgs/msg/Odometry"),
    "imu": Topic("imu/data", "sensor_msgs/msg/Imu"),
    "compass": Topic("imu/mag", "sensor_msgs/msg/MagneticField"),
    "fix": Topic("gnss/fix", "sensor_msgs/msg/NavSatFix"),
    "velocity": Topic("gnss/velocity", "geometry_msgs/msg/TwistStamped"),
    "pressure": Topic("pressure", "sensor_msgs/msg/FluidPressure"),
    "dvl": Topic("dvl/twist", "geometry_msgs/msg/TwistWithCovarianceStamped"),
    "dvl_report": Topic("dvl", "marine_acoustic_msgs/msg/Dvl"),
    "water_speed": Topic("speed_log", "geometry_msgs/msg/TwistStamped"),
    "water_depth": Topic("echo_sounder", "sensor_msgs/msg/Range"),
    "wind": Topic("wind", "geometry_msgs/msg/TwistStamped"),
    "wind_vector": Topic("wind_vector", "geometry_msgs/msg/Vector3"),
    "sonar": Topic("sonar", "sensor_msgs/msg/LaserScan"),
    "leak": Topic("leak", "std_msgs/msg/Bool"),
    "temperature": Topic("temperature", "sensor_msgs/msg/Temperature"),
    "battery": Topic("battery", "sensor_msgs/msg/BatteryState"),
    "joints": Topic("joint_states", "sensor_msgs/msg/JointState"),
    "description": Topic("robot_description", "std_msgs/msg/String"),
    "leg": Topic("leg", "nav_msgs/msg/Path"),
    "nmea": Topic("nmea", "nmea_msgs/msg/Sentence"),
    "ais_targets": Topic("ais_targets", "geometry_msgs/msg/PoseArray"),
    "diagnostics": Topic("/diagnostics", "diagnostic_msgs/msg/DiagnosticArray"),
}
"""Topics that the link writes."""
CLOCK = PUBLISHED["clock"].name
LATCHED = ("tf_static", "description", "leg")
"""Those that late readers get too."""

COMMANDED: Mapping[str, Topic] = {
    "cmd_vel": Topic("cmd_vel", "geometry_msgs/msg/Twist"),
    "cmd_vel_stamped": Topic("cmd_vel_stamped", "geometry_msgs/msg/TwistStamped"),
    "cmd_wrench": Topic("cmd_wrench", "geometry_msgs/msg/WrenchStamped"),
    "goal_pose": Topic("goal_pose", "geometry_msgs/msg/PoseStamped"),
}
"""Topics that the link reads, beside those of the actuators."""
ACTUATORS: Mapping[str, Topic] = {
    way: Topic(f"thrusters/{{}}/{way}", "std_msgs/msg/Float64")
    for way in ("thrust", "command", "pos")
}
"""Topics of an actuator, NAME.thrust and so on, by how it is commanded: N; -1 to 1; rad."""


def read_topics(text: str) -> dict[str, str]:
    """Return topics by key of a text ``KEY TOPIC; KEY TOPIC``; `OFF` is none.

    Raises InputError for an unknown key, and a name that ROS does not allow.
    """
    found: dict[str, str] = {}
    known = [*PUBLISHED, *COMMANDED]
    for entry in filter(None, map(str.strip, text.split(";"))):
        key, _, name = entry.partition(" ")
        name = name.strip()
        if key not in known and key.rpartition(".")[2] not in ACTUATORS:
            raise InputError(unknown("topic", key, [*known, *(f"ACTUATOR.{a}" for a in ACTUATORS)]))
        if not _NAME.fullmatch(name):
            raise InputError(
                f"topic {key} is {name!r}, a name like 'imu/data' or '/wamv/imu' is needed, "
                f"or {OFF!r}"
            )
        found[key] = name
    return found


def check_namespace(text: str) -> None:
    """Raise InputError for what is no name of ROS."""
    if not re.fullmatch(r"[\w/-]*", text, re.ASCII) or re.match(r"[/-]", text):
        raise InputError(f"namespace is {text!r}, a name like 'otter' is needed")


def token(text: str) -> str:
    """Return a name as a token of ROS: of letters, digits and underscores, no digit first."""
    made = re.sub(r"_+", "_", re.sub(r"\W", "_", text, flags=re.ASCII)).strip("_") or "x"
    return f"_{made}" if made[0].isdigit() else made


class Names:
    """Names of topics in full, of a namespace and what ``text`` says in their place."""

    def __init__(self, namespace: str, text: str) -> None:
        parts = [token(part) for part in namespace.split("/") if part]
        self.namespace = "".join(f"/{part}" for part in parts)
        self._given = read_topics(text)

    def full(self, name: str) -> str:
        """Return a name in the namespace, unless it is absolute."""
        return name if name.startswith("/") else f"{self.namespace}/{name}"

    def of(self, key: str, topic: Topic) -> str | None:
        """Return the name of a topic; None if there is none."""
        name = self._given.get(key, topic.name)
        return None if name == OFF else self.full(name)

    def of_actuator(self, name: str, way: str) -> str | None:
        """Return the topic of an actuator, None if there is none."""
        given = self._given.get(f"{name}.{way}", ACTUATORS[way].name.format(token(name)))
        return None if given == OFF else self.full(given)

    @property
    def actuators(self) -> set[str]:
        """Actuators that the profile names."""
        return {key.rpartition(".")[0] for key in self._given if "." in key}
