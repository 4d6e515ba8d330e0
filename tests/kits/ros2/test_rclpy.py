"""A real rclpy, where there is one: the node of the tutorial sails the Otter, twice alike.

SEATRIAL_ROS2 names the folder of a built workspace: its ``v`` is the environment of its Python,
its ``install`` what was built.
"""

import os
import re
import subprocess
import time
from pathlib import Path

import pytest

from tests.command import seatrial, seatrial_process

from .peer import LOOPBACK

ROOT = Path(__file__).parents[3]
ROS = Path(os.environ.get("SEATRIAL_ROS2", "/opt/seatrial-ros2"))
pytestmark = [
    pytest.mark.long,
    pytest.mark.skipif(not (ROS / "install/setup.bash").is_file(), reason="no ROS 2 is here"),
]
WATCH = """
import sys, rclpy
from rclpy.node import Node
from rclpy.parameter import Parameter
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Imu
from std_srvs.srv import SetBool
from rcl_interfaces.srv import SetParameters
from rcl_interfaces.msg import Parameter as Value, ParameterValue
from simulation_interfaces.srv import GetSimulationState, StepSimulation, SetSimulationState

rclpy.init()
node = Node("watch", parameter_overrides=[Parameter("use_sim_time", value=True)])
seen = []
node.create_subscription(Imu, "/otter/imu/data", seen.append, 10)

def call(kind, name, request):
    client = node.create_client(kind, name)
    assert client.wait_for_service(20.0), name
    future = client.call_async(request)
    rclpy.spin_until_future_complete(node, future, timeout_sec=20.0)
    return future.result()

while len(seen) < 50:
    rclpy.spin_once(node)
assert node.get_clock().now().nanoseconds > 0
state = call(GetSimulationState, "/seatrial/get_simulation_state", GetSimulationState.Request())
assert state.state.state == 1, state
pause = SetSimulationState.Request()
pause.state.state = 2
assert call(SetSimulationState, "/seatrial/set_simulation_state", pause).result.result == 1
steps = StepSimulation.Request(steps=10)
assert call(StepSimulation, "/seatrial/step_simulation", steps).result.result == 1
pause.state.state = 1
assert call(SetSimulationState, "/seatrial/set_simulation_state", pause).result.result == 1
value = ParameterValue(type=4, string_value="off")
fault = SetParameters.Request(parameters=[Value(name="gps", value=value)])
assert call(SetParameters, "/otter/inject_fault", fault).results[0].successful
print("done", len(seen))
"""


@pytest.fixture
def node(domain, tmp_path):
    """A function that starts a program under ROS; what runs at the end of the test is ended."""
    started = []

    def start(name, text):
        (tmp_path / name).write_text(text)
        shell = f". {ROS}/v/bin/activate && . {ROS}/install/setup.bash && exec python3 {name}"
        environment = {
            **{k: v for k, v in os.environ.items() if not k.startswith("PYTHON")},
            "RMW_IMPLEMENTATION": "rmw_cyclonedds_cpp",
            "RCL_LOGGING_IMPLEMENTATION": "rcl_logging_noop",
            "CYCLONEDDS_URI": LOOPBACK,
            "ROS_DOMAIN_ID": str(domain),
        }
        started.append(
            subprocess.Popen(
                ["bash", "-c", shell], cwd=tmp_path, env=environment, text=True,
                stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
            )
        )  # fmt: skip
        return started[-1]

    yield start
    for process in started:
        process.kill()
        process.wait()


def run(tmp_path, domain, out, *settings):
    given = (f"autopilot.ros2.domain={domain}", *settings)
    done = seatrial_process(
        "run",
        "otter-course-square",
        "--autopilot",
        "ros2",
        "--engine",
        "direct",
        "--out",
        out,
        *(each for setting in given for each in ("--set", setting)),
        cwd=tmp_path,
    )
    assert done.returncode in (0, 1), done.stderr
    return tmp_path / out / "signals.csv"


def helm():
    page = (ROOT / "docs/kits/ros2/ros2-controller.md").read_text()
    return re.search(r"```python\n(.*?)```", page, re.S)[1]


def test_the_tutorial_s_node_sails_the_square_twice_alike(node, domain, tmp_path):
    node("helm.py", helm())
    lockstep = (
        "autopilot.ros2.lockstep=stamped",
        *(f"autopilot.ros2.{key}=100 ms" for key in ("period", "truth_period")),
    )
    first, second = (run(tmp_path, domain, out, *lockstep) for out in ("first", "second"))
    assert first.read_bytes() == second.read_bytes()
    report = seatrial("report", "first", cwd=tmp_path)
    assert "PASS  all waypoints are passed" in report.stdout


def test_clock_imu_services_and_faults(node, domain, tmp_path):
    from seatrial import Simulation

    process = node("watch.py", WATCH)
    with Simulation(
        "sil",
        choices={"vehicle": "otter", "autopilot": "ros2"},
        set={"autopilot.ros2.domain": domain},
    ) as simulation:
        until = time.monotonic() + 90.0
        while process.poll() is None and time.monotonic() < until:
            simulation.step(1)
            time.sleep(0.005)
        assert process.poll() == 0, process.stdout.read()
        assert simulation.get("autopilot.ros2.failure.gps") == "off"
