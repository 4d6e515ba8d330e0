"""ROS 2: a simulated vehicle as the nodes of a robot see it, without a ROS installation.

`component` is what a rig uses. Below it `node` joins the parts: `participant` (DDS, by the package
cyclonedds), the topics that are `published`, the `commands` that are received, `services`, and the
`lockstep` with other nodes. Message types come from the stores of rosbags (`definitions`), and the
turns between axes here and there from `frames`.
"""
