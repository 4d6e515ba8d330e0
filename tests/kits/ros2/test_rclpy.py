"""A real rclpy, where there is one: the node of the tutorial sails the Otter, twice alike.

SEATRIAL_ROS2 names the folder of a built workspace (`build_rclpy.sh`): its ``v`` is the environment
of its Python, its ``install`` what was built. The link is on DDS, with nodes of rmw_cyclonedds, or a
node of that rclpy: with nodes of rmw_fastrtps, whose services DDS alone cannot answer, if it is there.
"""

import json
import math
import os
import re
import subprocess
import sys
import time
from pathlib import Path

import pytest

from seatrial import Simulation
from seatrial.trial.records.run_folder import load_run
from tests.command import SEATRIAL

from .peer import LOOPBACK
from .test_confinement import SHOW

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
from simulation_interfaces.srv import GetSimulationState, SetSimulationState, SpawnEntity, StepSimulation

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
assert "seatrial" in node.get_node_names(), node.get_node_names()
state = call(GetSimulationState, "/seatrial/get_simulation_state", GetSimulationState.Request())
assert state.state.state == 1, state
pause = SetSimulationState.Request()
pause.state.state = 2
assert call(SetSimulationState, "/seatrial/set_simulation_state", pause).result.result == 1
spawned = call(SpawnEntity, "/seatrial/spawn_entity", SpawnEntity.Request(name="second"))
assert spawned.result.result == 0 and spawned.result.error_message, spawned
steps = StepSimulation.Request(steps=10)
assert call(StepSimulation, "/seatrial/step_simulation", steps).result.result == 1
pause.state.state = 1
assert call(SetSimulationState, "/seatrial/set_simulation_state", pause).result.result == 1
value = ParameterValue(type=4, string_value="off")
fault = SetParameters.Request(parameters=[Value(name="gps", value=value)])
assert call(SetParameters, "/otter/inject_fault", fault).results[0].successful
print("done", len(seen))
"""

# A node as those that are written for VRX: its topics, no word of this project. It turns towards
# the goal and goes there.
KEEPER = """
import math, rclpy
from geometry_msgs.msg import PoseStamped
from rclpy.node import Node
from sensor_msgs.msg import Imu, NavSatFix
from std_msgs.msg import Float64

class Keeper(Node):
    def __init__(self):
        super().__init__("keeper")
        self.goal = self.yaw = None
        self.rate = 0.0
        self.create_subscription(PoseStamped, "/vrx/stationkeeping/goal", self.on_goal, 10)
        self.create_subscription(Imu, "/wamv/sensors/imu/imu/data", self.on_imu, 10)
        self.create_subscription(NavSatFix, "/wamv/sensors/gps/gps/fix", self.on_fix, 10)
        self.sides = [
            self.create_publisher(Float64, f"/wamv/thrusters/{side}/thrust", 10)
            for side in ("left", "right")
        ]

    def on_goal(self, goal):
        self.goal = goal.pose.position.x, goal.pose.position.y

    def on_imu(self, imu):
        turn = imu.orientation
        self.yaw = math.atan2(
            2.0 * (turn.w * turn.z + turn.x * turn.y), 1.0 - 2.0 * (turn.y**2 + turn.z**2)
        )
        self.rate = imu.angular_velocity.z

    def on_fix(self, fix):
        if self.goal is None or self.yaw is None:
            return
        north = 111_000.0 * (self.goal[0] - fix.latitude)
        east = 111_000.0 * math.cos(math.radians(fix.latitude)) * (self.goal[1] - fix.longitude)
        error = math.remainder(math.atan2(north, east) - self.yaw, math.tau)
        away = math.hypot(north, east)
        turn = -150.0 * self.rate + (200.0 * error if away > 0.3 else 0.0)
        ahead = 0.0
        if away > 0.3 and abs(error) < math.pi / 4.0:  # else it would circle round the goal
            ahead = (22.0 + 6.0 * min(away, 2.0)) * math.cos(2.0 * error)  # 16 N are a dead band
        for publisher, share in zip(self.sides, (-1.0, 1.0)):
            publisher.publish(Float64(data=ahead + share * turn))

rclpy.init()
rclpy.spin(Keeper())
"""


# A simulation in a process of its own: it steps until a line comes, and says what became of the GNSS.
STEPPED = """
import select, sys, time
from seatrial import Simulation

set = {"autopilot.ros2.domain": int(sys.argv[1]), "autopilot.ros2.transport": sys.argv[2]}
with Simulation("sil", choices={"vehicle": "otter", "autopilot": "ros2"}, set=set) as simulation:
    while not select.select([sys.stdin], [], [], 0.0)[0]:
        simulation.step(1)
        time.sleep(0.005)
    print(simulation.get("autopilot.ros2.failure.gps"))
"""


@pytest.fixture(params=["dds", "rclpy"])
def transport(request):
    return request.param


@pytest.fixture
def environment(domain, transport):
    """A function: the environment of a program, in the workspace or not."""
    other = (ROS / "install/lib/librmw_fastrtps_cpp.so").is_file() and transport == "rclpy"
    middleware = "rmw_fastrtps_cpp" if other else "rmw_cyclonedds_cpp"
    of_ros = {
        "ROS_DISTRO": (ROS / "distribution").read_text().strip(),
        "RMW_IMPLEMENTATION": middleware,
        "RCL_LOGGING_IMPLEMENTATION": "rcl_logging_noop",
        "CYCLONEDDS_URI": LOOPBACK,
        "ROS_LOCALHOST_ONLY": str(int(other)),
        "ROS_DOMAIN_ID": str(domain),
    }
    plain = {k: v for k, v in os.environ.items() if not k.startswith("PYTHON")} | of_ros
    shell = f". {ROS}/v/bin/activate && . {ROS}/install/setup.bash && env -0"
    listed = subprocess.run(["bash", "-c", shell], env=plain, capture_output=True, check=True)
    sourced = dict(line.split("=", 1) for line in listed.stdout.decode().split("\0") if line)
    return lambda inside: sourced if inside else plain


@pytest.fixture
def node(environment, tmp_path):
    """A function that starts a program under ROS; what runs at the end of the test is ended."""
    started = []

    def start(name, text):
        (tmp_path / name).write_text(text)
        started.append(
            subprocess.Popen(
                [ROS / "v/bin/python3", name], cwd=tmp_path, env=environment(inside=True), text=True,
                stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
            )
        )  # fmt: skip
        return started[-1]

    yield start
    for process in started:
        process.kill()
        process.wait()


def run(tmp_path, environment, out, *settings):
    command = [SEATRIAL, "run", "otter-course-square", "--autopilot", "ros2", "--engine", "direct"]
    command += ["--out", out, *(each for setting in settings for each in ("--set", setting))]
    done = subprocess.run(
        command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode in (0, 1), done.stderr
    return tmp_path / out / "signals.csv"


def helm():
    page = (ROOT / "docs/kits/ros2/ros2-controller.md").read_text()
    return re.search(r"```python\n(.*?)```", page, re.S)[1]


def test_the_tutorial_s_node_sails_the_square_twice_alike(node, environment, transport, tmp_path):
    node("helm.py", helm())
    lockstep = (
        f"autopilot.ros2.transport={transport}",
        "autopilot.ros2.lockstep=stamped",
        *(f"autopilot.ros2.{key}=100 ms" for key in ("period", "truth_period")),
    )
    own = environment(inside=transport == "rclpy")
    first, second = (run(tmp_path, own, out, *lockstep) for out in ("first", "second"))
    assert first.read_bytes() == second.read_bytes()
    verdicts = {each["name"]: each["passed"] for each in load_run(tmp_path / "first").verdicts}
    assert len(verdicts) == 3
    assert all(verdicts.values()), verdicts


@pytest.mark.parametrize("transport", ["dds"], indirect=True)
def test_a_node_for_vrx_runs_as_it_is(node, domain, tmp_path):
    """It reaches the goal, in a circle of 1 m, and its death is neutral."""
    process = node("keeper.py", KEEPER)
    with Simulation(
        "vrx",
        choices={"vehicle": "wam-v", "autopilot": "ros2", "link": "vrx"},
        set={
            "autopilot.ros2.domain": domain, "task.domain": domain,
            "task.waypoint_1": ["4.92 m", "3.24 m", "0 m"], "task.heading.goal1": "90 deg",
            "task.initial": "1 s", "task.ready": "1 s",
        },
    ) as simulation:  # fmt: skip
        begun, nearest = time.monotonic(), math.inf
        while simulation.time < 60.0 and nearest > 1.0:
            assert time.monotonic() - begun < 240.0
            simulation.step(5)
            time.sleep(max(0.0, begun + simulation.time - time.monotonic()))
            north, east = (simulation.get(f"vehicle.hull.position.{axis}") for axis in "xy")
            nearest = min(nearest, math.hypot(north - 4.92, east - 3.24))
        assert nearest < 1.0
        assert simulation.get("autopilot.ros2.source") == "thrusters"
        assert simulation.get("task.state") == "running"
        process.kill()
        process.wait()
        simulation.run(simulation.time + 1.2)
        assert simulation.get("autopilot.ros2.source") == "none"
        assert simulation.get("autopilot.ros2.pulse.ch1") == pytest.approx(1.5e-3)


def test_clock_imu_services_and_faults(node, environment, transport, domain):
    process = node("watch.py", WATCH)
    command = [sys.executable, "-c", STEPPED, str(domain), transport]
    with subprocess.Popen(
        command, env=environment(inside=transport == "rclpy"), text=True,
        stdin=subprocess.PIPE, stdout=subprocess.PIPE,
    ) as simulation:  # fmt: skip
        try:
            said, _ = process.communicate(timeout=120.0)
        finally:
            found, _ = simulation.communicate("end\n")
    assert process.returncode == 0, said
    assert found.strip() == "off"


@pytest.mark.skipif(sys.platform != "linux", reason="Linux binds sockets to a device")
def test_sockets_of_rclpy_are_bound_to_the_loopback_device(environment, domain):
    """Over both middlewares: the parameter is that of the nodes' middleware too."""
    done = subprocess.run(
        [sys.executable, "-c", SHOW, str(domain), "rclpy"], cwd=ROOT,
        env=environment(inside=True), capture_output=True, text=True, check=True,
    )  # fmt: skip
    opened, _ = json.loads(done.stdout.splitlines()[-1])
    assert len(opened) > 1
    for address, device in opened:
        assert address == "127.0.0.1" or device == "lo"


# What rclpy does not tell, types that the workspace has not, and messages that are counted behind
# a link that runs faster than a network: both ends of those tests are one library in DDS.
_APART = (
    "test_bad_input.py::test_a_second_publisher_is_refused_while_the_first_commands",
    "test_surroundings.py::test_ships_that_ais_reports_are_targets_in_map_and_sentences",
    "test_vrx.py::test_a_node_of_vrx_gets_goal_error_and_state",
    "test_published.py",
    "test_services.py::test_steps_are_an_action_too",
)


@pytest.mark.parametrize("transport", ["dds"], indirect=True)
def test_the_tests_of_the_link_pass_over_rclpy_too(environment):
    """Their peers are cyclonedds alone."""
    own = environment(inside=True)
    del own["RMW_IMPLEMENTATION"], own["ROS_DOMAIN_ID"], own["ROS_LOCALHOST_ONLY"]
    command = [sys.executable, "-m", "pytest", "tests/kits/ros2", "-m", "not long", "-n", "2"]
    command += ["--timeout", "200"]
    command += [f"--deselect=tests/kits/ros2/{each}" for each in _APART]
    done = subprocess.run(
        command, cwd=ROOT, env={**own, "SEATRIAL_TEST_TRANSPORT": "rclpy"},
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout[-4000:]
