"""Line-of-sight helmsman of a boat."""

import math

import rclpy
from geometry_msgs.msg import TwistStamped
from nav_msgs.msg import Odometry, Path
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile

LOOKAHEAD, SPEED, GAIN = 8.0, 1.5, 0.8


class Helm(Node):
    def __init__(self):
        super().__init__("helm")
        vehicle = self.declare_parameter("vehicle", "otter").value
        late = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.leg = None
        self.create_subscription(Path, f"/{vehicle}/leg", self.on_leg, late)
        odometry = f"/{vehicle}/odometry/ground_truth"
        self.create_subscription(Odometry, odometry, self.on_odometry, 10)
        self.velocity = self.create_publisher(TwistStamped, f"/{vehicle}/cmd_vel_stamped", 10)

    def on_leg(self, leg):
        self.leg = [pose.pose.position for pose in leg.poses]

    def on_odometry(self, odometry):
        command = TwistStamped()
        command.header.stamp = odometry.header.stamp
        if self.leg is not None:
            error, distance = self.to_go(odometry.pose.pose)
            command.twist.linear.x = min(SPEED, GAIN * distance) * max(0.0, math.cos(error))
            command.twist.angular.z = GAIN * error * min(1.0, distance)
        self.velocity.publish(command)

    def to_go(self, pose):
        """Return the heading error to a point ahead on the leg, and the distance to its end."""
        begin, end = self.leg
        along = math.atan2(end.y - begin.y, end.x - begin.x)
        east, north = pose.position.x - begin.x, pose.position.y - begin.y
        done = east * math.cos(along) + north * math.sin(along)
        ahead = min(done + LOOKAHEAD, math.dist((begin.x, begin.y), (end.x, end.y)))
        east, north = ahead * math.cos(along) - east, ahead * math.sin(along) - north
        turn = pose.orientation
        yaw = math.atan2(
            2.0 * (turn.w * turn.z + turn.x * turn.y), 1.0 - 2.0 * (turn.y**2 + turn.z**2)
        )
        distance = math.dist((pose.position.x, pose.position.y), (end.x, end.y))
        return math.remainder(math.atan2(north, east) - yaw, math.tau), distance


def main():
    rclpy.init()
    rclpy.spin(Helm())


if __name__ == "__main__":
    main()
