"""A node of rclpy, where a workspace of ROS 2 is sourced: over any middleware."""
