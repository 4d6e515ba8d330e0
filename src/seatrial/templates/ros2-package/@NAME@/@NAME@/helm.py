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
            error = self.heading_error(odometry.pose.pose)
            command.twist.linear.x = SPEED * max(0.2, math.cos(error))
            command.twist.angular.z = GAIN * error
        self.velocity.publish(command)

    def heading_error(self, pose):
        begin, end = self.leg
        along = math.atan2(end.y - begin.y, end.x - begin.x)
        north, east = pose.position.y - begin.y, pose.position.x - begin.x
        across = north * math.cos(along) - east * math.sin(along)
        turn = pose.orientation
        yaw = math.atan2(
            2.0 * (turn.w * turn.z + turn.x * turn.y), 1.0 - 2.0 * (turn.y**2 + turn.z**2)
        )
        return math.remainder(along - math.atan2(across, LOOKAHEAD) - yaw, math.tau)


def main():
    rclpy.init()
    rclpy.spin(Helm())


if __name__ == "__main__":
    main()
