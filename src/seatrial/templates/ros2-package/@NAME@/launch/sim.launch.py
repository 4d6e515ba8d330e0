"""A trial of seatrial, and the node that sails it: vehicle:=otter trial:=otter-course-square"""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, EmitEvent, ExecuteProcess, RegisterEventHandler
from launch.event_handlers import OnProcessExit
from launch.events import Shutdown
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node


def generate_launch_description():
    vehicle, trial = LaunchConfiguration("vehicle"), LaunchConfiguration("trial")
    simulation = ExecuteProcess(
        cmd=[
            *("seatrial", "run", trial, "--vehicle", vehicle, "--autopilot", "ros2"),
            *("--set", "autopilot.ros2.lockstep=stamped"),
            *("--set", "autopilot.ros2.period=100 ms"),
            *("--set", "autopilot.ros2.truth_period=100 ms"),
        ],
        output="screen",
    )
    helm = Node(
        package="@NAME@", executable="helm", parameters=[{"vehicle": vehicle, "use_sim_time": True}]
    )
    over = OnProcessExit(target_action=simulation, on_exit=[EmitEvent(event=Shutdown())])
    return LaunchDescription(
        [
            DeclareLaunchArgument("vehicle", default_value="otter"),
            DeclareLaunchArgument("trial", default_value="otter-course-square"),
            simulation,
            helm,
            RegisterEventHandler(over),
        ]
    )
