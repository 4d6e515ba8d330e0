"""ROS 2: a simulated vehicle as the nodes of a robot see it.

`component` is what a rig uses. It joins a domain over a `transport`: DDS itself (`dds`, without a
ROS installation), or a node of rclpy (`rcl`). On it are the topics that are `published`, the
`commands` that are received, the services of the `simulator`, and the `lockstep` with other nodes.
Types come from the stores of rosbags (`messages`), the turns between axes from `frames`.
"""
