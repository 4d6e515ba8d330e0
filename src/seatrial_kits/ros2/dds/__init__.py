"""DDS as ROS 2 has it: participant, readers and writers, services, announcements."""
