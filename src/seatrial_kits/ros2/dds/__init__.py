"""DDS as ROS 2 has it: participant, types and their definitions, services, actions."""
