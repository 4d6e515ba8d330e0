"""A node of somebody else: cyclonedds alone, with types typed by hand and its own serialiser.

python peer.py DOMAIN square|delayed|thrust|silent: helmsmen of the vehicle ``otter``. It ends when its
standard input does.
"""

import math
import random
import select
import sys
import time
from dataclasses import dataclass

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import array, float64, int32, sequence, uint32
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic

RELIABLE = Qos(Policy.Reliability.Reliable(1_000_000_000), Policy.History.KeepLast(10))
LATCHED = Qos(
    Policy.Reliability.Reliable(1_000_000_000),
    Policy.Durability.TransientLocal,
    Policy.History.KeepLast(1),
)
LOOPBACK = (
    '<General><Interfaces><NetworkInterface address="127.0.0.1"/></Interfaces>'
    "<AllowMulticast>false</AllowMulticast></General><Discovery>"
    "<ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>60</MaxAutoParticipantIndex>"
    '<Peers><Peer address="127.0.0.1"/></Peers></Discovery>'
)


@dataclass
class Time(IdlStruct, typename="builtin_interfaces::msg::dds_::Time_"):
    sec: int32
    nanosec: uint32


@dataclass
class Clock(IdlStruct, typename="rosgraph_msgs::msg::dds_::Clock_"):
    clock: Time


@dataclass
class Header(IdlStruct, typename="std_msgs::msg::dds_::Header_"):
    stamp: Time
    frame_id: str


@dataclass
class Vector3(IdlStruct, typename="geometry_msgs::msg::dds_::Vector3_"):
    x: float64 = 0.0
    y: float64 = 0.0
    z: float64 = 0.0


@dataclass
class Point(IdlStruct, typename="geometry_msgs::msg::dds_::Point_"):
    x: float64
    y: float64
    z: float64


@dataclass
class Quaternion(IdlStruct, typename="geometry_msgs::msg::dds_::Quaternion_"):
    x: float64
    y: float64
    z: float64
    w: float64


@dataclass
class Pose(IdlStruct, typename="geometry_msgs::msg::dds_::Pose_"):
    position: Point
    orientation: Quaternion


@dataclass
class PoseWithCovariance(IdlStruct, typename="geometry_msgs::msg::dds_::PoseWithCovariance_"):
    pose: Pose
    covariance: array[float64, 36]


@dataclass
class Twist(IdlStruct, typename="geometry_msgs::msg::dds_::Twist_"):
    linear: Vector3
    angular: Vector3


@dataclass
class TwistStamped(IdlStruct, typename="geometry_msgs::msg::dds_::TwistStamped_"):
    header: Header
    twist: Twist


@dataclass
class TwistWithCovariance(IdlStruct, typename="geometry_msgs::msg::dds_::TwistWithCovariance_"):
    twist: Twist
    covariance: array[float64, 36]


@dataclass
class Odometry(IdlStruct, typename="nav_msgs::msg::dds_::Odometry_"):
    header: Header
    child_frame_id: str
    pose: PoseWithCovariance
    twist: TwistWithCovariance


@dataclass
class PoseStamped(IdlStruct, typename="geometry_msgs::msg::dds_::PoseStamped_"):
    header: Header
    pose: Pose


@dataclass
class Path(IdlStruct, typename="nav_msgs::msg::dds_::Path_"):
    header: Header
    poses: sequence[PoseStamped]


@dataclass
class Float64(IdlStruct, typename="std_msgs::msg::dds_::Float64_"):
    data: float64


class Node:
    """Topics of one participant."""

    def __init__(self, domain):
        self.participant = DomainParticipant(domain)

    def writer(self, name, kind, qos=RELIABLE, prefix="rt"):
        return DataWriter(self.participant, Topic(self.participant, prefix + name, kind), qos=qos)

    def reader(self, name, kind, qos=RELIABLE, prefix="rt"):
        return DataReader(self.participant, Topic(self.participant, prefix + name, kind), qos=qos)


def taken(reader):
    return [each for each in reader.take(10) if each.sample_info.valid_data]


def yaw(turn):
    return math.atan2(
        2.0 * (turn.w * turn.z + turn.x * turn.y), 1.0 - 2.0 * (turn.y**2 + turn.z**2)
    )


def towards(odometry, path):
    """Bearing error to a point 8 m ahead on the leg, east-north-up, rad."""
    (begin, end), at = [p.pose.position for p in path.poses], odometry.pose.pose.position
    along = math.atan2(end.y - begin.y, end.x - begin.x)
    across = -(at.x - begin.x) * math.sin(along) + (at.y - begin.y) * math.cos(along)
    wanted = along - math.atan2(across, 8.0)
    return math.remainder(wanted - yaw(odometry.pose.pose.orientation), math.tau)


def sail(node, act):
    """Answer each odometry by ``act``, until the standard input ends."""
    odometry = node.reader("/otter/odometry/ground_truth", Odometry)
    leg = node.reader("/otter/leg", Path, LATCHED)
    path, answered = None, None
    while not select.select([sys.stdin], [], [], 0.0)[0]:
        moved = taken(odometry)
        for found in taken(leg):  # written before the odometry of the same instant
            path = found
        for found in moved:
            stamp = (found.header.stamp.sec, found.header.stamp.nanosec)
            if stamp != answered:
                answered = stamp
                act(found, path)
        time.sleep(0.0002)


def square(node, longest=0.0):
    """Sail the legs by stamped velocities; answers come up to ``longest``, s, later, at random."""
    writer = node.writer("/otter/cmd_vel_stamped", TwistStamped)

    def act(odometry, path):
        time.sleep(longest * random.random())
        error = towards(odometry, path) if path else 0.0
        speed = 1.5 * max(0.2, math.cos(error))
        twist = Twist(Vector3(x=speed), Vector3(z=0.8 * error))
        writer.write(TwistStamped(Header(odometry.header.stamp, "base_link"), twist))

    sail(node, act)


def thrust(node):
    """Sail the first leg by the thrusts of both propellers, N."""
    port = node.writer("/otter/thrusters/port/thrust", Float64)
    starboard = node.writer("/otter/thrusters/starboard/thrust", Float64)

    def act(odometry, path):
        error = towards(odometry, path) if path else 0.0  # the leg may come after an odometry
        turn = 60.0 * error - 60.0 * odometry.twist.twist.angular.z
        port.write(Float64(60.0 - turn))
        starboard.write(Float64(60.0 + turn))

    sail(node, act)


def delayed(node):
    square(node, 0.05)


def silent(node):
    sail(node, lambda odometry, path: None)


if __name__ == "__main__":
    helmsmen = {each.__name__: each for each in (square, delayed, thrust, silent)}
    helmsmen[sys.argv[2]](Node(int(sys.argv[1])))
