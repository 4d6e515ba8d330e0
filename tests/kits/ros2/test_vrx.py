"""Tasks of VRX: scores by hand, topics as nodes of VRX read them, trials by the vehicle's pilot."""

import math
import time
from dataclasses import dataclass

import pytest
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import float32, float64, int64, sequence, uint8

from seatrial import Simulation
from seatrial.errors import InputError
from seatrial.trial.files.trial import load_trial
from seatrial_kits.ros2.vrx import VrxTask
from seatrial_kits.ros2.vrx_scores import Gates, StationKeeping, Wayfinding, pose_error

from . import peer

TASKS = ("vrx-stationkeeping", "vrx-wayfinding", "vrx-follow-path")
# One gate of 20 m, whose red mark is the eastern one: it is crossed northward.
GATE = [(0.0, 10.0), (0.0, -10.0)]


def test_the_heading_weighs_less_the_farther_the_goal_is():
    """By hand: on the spot the angle alone; at 4 m 4 + 0.31640625 angle; beyond half a turn it is
    the shorter way round."""
    assert pose_error((3.0, 4.0), 0.2, (3.0, 4.0), -0.3) == pytest.approx(0.5)
    assert pose_error((0.0, 0.0), 1.0, (4.0, 0.0), 0.0) == pytest.approx(4.0 + 0.31640625)
    near_south = math.pi - 0.1
    assert pose_error((0, 0), near_south, (0, 0), -near_south) == pytest.approx(0.2)


def test_station_keeping_is_the_mean_of_all_and_wayfinding_of_the_least():
    keeping = StationKeeping([(0.0, 0.0)], [0.0])
    finding = Wayfinding([(0.0, 0.0), (0.0, 10.0)], [0.0, 0.0])
    for east in (0.0, 3.0, 6.0):
        keeping.add((0.0, east), 0.0)
        finding.add((0.0, east), 0.0)
    assert keeping.value == pytest.approx(3.0)
    assert finding.errors == pytest.approx([0.0, 4.0])
    assert finding.value == pytest.approx(2.0)


def three_gates():
    return Gates([(north + n, e) for north in (0.0, 30.0, 60.0) for n, e in GATE])


def sail(gates, *track):
    for north, east in track:
        gates.add((north, east), 0.0)
    return gates


def test_gates_give_ten_and_one_for_each_that_follows_and_one_at_the_end():
    gates = sail(three_gates(), *((0.5 + n, 1.0) for n in range(-5, 70)))
    assert (gates.value, gates.crossed, gates.done) == (33.0, 3, True)


@pytest.mark.parametrize(
    ("track", "value", "states"),
    [
        ([(-5, 0), (5, 12), (25, 12), (35, 0)], 0, [2, 0, 0]),  # past the first: nothing counts
        ([(-5, 0), (5, 0), (25, 15), (35, 15), (55, 0), (65, 0)], 21, [3, 2, 3]),  # 10, 10 and 1
        ([(-5, 0), (5, 0), (25, 15), (35, 0), (25, 0), (55, 0), (65, 0)], 21, [3, 4, 3]),
        ([(5, 0), (-5, 0), (5, 0)], 10, [3, 0, 0]),  # the first may be passed the other way first
    ],
)
def test_gates_that_are_left_out_or_passed_the_other_way(track, value, states):
    gates = sail(three_gates(), *track)
    assert gates.value == value
    assert gates.errors == states


@pytest.mark.slow
def test_a_pilot_keeps_the_states_and_the_score_of_its_track():
    """The score is the mean of pose errors computed here of the track, from 1 s to 3 s."""
    goal = {"task.waypoint_1": ["4 m", "3 m", "0 m"], "task.heading.goal1": "90 deg"}
    times = {"task.initial": "0.4 s", "task.ready": "0.6 s", "task.running": "2 s"}
    choices = {"vehicle": "wam-v", "autopilot": "guidance"}
    errors, states = [], []
    with Simulation("vrx", choices=choices, set={"task.topics": "off", **goal, **times}) as otter:
        while otter.time < 3.5:
            position, psi = (
                [otter.get(f"vehicle.hull.position.{axis}") for axis in "xy"],
                otter.get("vehicle.hull.attitude.psi"),
            )
            distance = math.hypot(position[0] - 4.0, position[1] - 3.0)
            turn = abs(math.remainder(psi - math.pi / 2, math.tau))
            if 1.0 - 1e-9 <= otter.time < 3.0 - 1e-9 and round(otter.time * 100) % 2 == 0:
                errors.append(distance + 0.75**distance * turn)
            states.append(otter.get("task.state"))
            otter.step(1)
        assert otter.get("task.score") == pytest.approx(sum(errors) / len(errors), rel=1e-9)
    assert list(dict.fromkeys(states)) == ["initial", "ready", "running", "finished"]


@dataclass
class Value(IdlStruct, typename="rcl_interfaces::msg::dds_::ParameterValue_"):
    type: uint8
    bool_value: bool
    integer_value: int64
    double_value: float64
    string_value: str
    byte_array_value: sequence[uint8]
    bool_array_value: sequence[bool]
    integer_array_value: sequence[int64]
    double_array_value: sequence[float64]
    string_array_value: sequence[str]


@dataclass
class Parameter(IdlStruct, typename="rcl_interfaces::msg::dds_::Parameter_"):
    name: str
    value: Value


@dataclass
class ParamVec(IdlStruct, typename="ros_gz_interfaces::msg::dds_::ParamVec_"):
    header: peer.Header
    params: sequence[Parameter]


@dataclass
class Float32(IdlStruct, typename="std_msgs::msg::dds_::Float32_"):
    data: float32


def test_a_node_of_vrx_gets_goal_error_and_state(domain, monkeypatch):
    """The goal is north and east of the home of the profile, in degrees; its yaw from east."""
    monkeypatch.setenv("CYCLONEDDS_URI", peer.LOOPBACK)
    node = peer.Node(domain)
    kinds = {"task/info": ParamVec, "stationkeeping/goal": peer.PoseStamped}
    readers = {name: node.reader(f"/vrx/{name}", kind) for name, kind in kinds.items()}
    errors = node.reader("/vrx/stationkeeping/pose_error", Float32)
    task = VrxTask("task")
    settings = {"domain": domain, "initial": 0.0, "ready": 0.0, "waypoint_1": [100.0, 50.0, 0.0]}
    settings |= {"latitude": math.radians(-33.7), "longitude": math.radians(150.0)}
    for name, value in settings.items():
        task.set(name, value)
    task.set("heading", [math.pi / 2, *[0.0] * 7])
    task.initialise()
    task.begin()
    task.set("position", [97.0, 46.0, 0.0])
    until = time.monotonic() + 10.0
    writers = task._writers.values()
    while not all(each.dds.get_matched_subscriptions() for each in [*writers][:3]):
        assert time.monotonic() < until
        time.sleep(0.01)
    for k in range(51):
        task.advance(0.02 * k, 0.02)
    time.sleep(0.2)
    info = {each.name: each.value for each in peer.taken(readers["task/info"])[-1].params}
    pose = peer.taken(readers["stationkeeping/goal"])[-1].pose
    error = peer.taken(errors)[-1].data
    task.close()
    node.participant.__del__()
    assert info["name"].string_value == "stationkeeping"
    assert info["state"].string_value == "running"
    assert info["score"].double_value == pytest.approx(error)
    assert error == pytest.approx(5.0 + 0.75**5 * math.pi / 2, rel=1e-6)
    per_degree = math.pi / 180 * 6_371_000.0  # of a sphere: 1 % is enough to tell the axes apart
    assert (pose.position.x + 33.7) * per_degree == pytest.approx(100.0, rel=0.01)
    east = per_degree * math.cos(math.radians(33.7))
    assert (pose.position.y - 150.0) * east == pytest.approx(50.0, rel=0.01)
    assert peer.yaw(pose.orientation) == pytest.approx(0.0, abs=1e-12)


def test_half_a_gate_is_refused():
    task = VrxTask("task")
    for name, value in {"task": "follow_path", "count": 3.0, "topics": "off"}.items():
        task.set(name, value)
    with pytest.raises(InputError, match=r"task.count is 3, an even number is needed"):
        task.initialise()


@pytest.mark.parametrize("name", TASKS)
def test_the_trials_are_whole(name):
    trial = load_trial(name)
    assert [each.name for each in trial.file.criteria][1] == "the task is run to its end"
