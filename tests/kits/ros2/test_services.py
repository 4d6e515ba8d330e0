"""Services called by a program that knows DDS and the bytes of rmw_cyclonedds alone."""

import threading
import time
from dataclasses import dataclass

import pytest
from cyclonedds.idl import IdlStruct, make_idl_struct
from cyclonedds.idl.types import array, float64, int8, int64, sequence, uint8, uint16, uint64

from seatrial import Simulation

from .peer import (
    LATCHED,
    LOOPBACK,
    Header,
    Node,
    Point,
    Pose,
    PoseStamped,
    Quaternion,
    Time,
    Twist,
    Vector3,
)

PACKAGE = "simulation_interfaces"


@dataclass
class Result(IdlStruct, typename=f"{PACKAGE}::msg::dds_::Result_"):
    result: uint8
    error_message: str


@dataclass
class State(IdlStruct, typename=f"{PACKAGE}::msg::dds_::SimulationState_"):
    state: uint8


@dataclass
class Features(IdlStruct, typename=f"{PACKAGE}::msg::dds_::SimulatorFeatures_"):
    features: sequence[uint16]
    spawn_formats: sequence[str]
    custom_info: str


@dataclass
class Accel(IdlStruct, typename="geometry_msgs::msg::dds_::Accel_"):
    linear: Vector3
    angular: Vector3


@dataclass
class EntityState(IdlStruct, typename=f"{PACKAGE}::msg::dds_::EntityState_"):
    header: Header
    pose: Pose
    twist: Twist
    acceleration: Accel


@dataclass
class ParameterValue(IdlStruct, typename="rcl_interfaces::msg::dds_::ParameterValue_"):
    type: uint8 = 0
    bool_value: bool = False
    integer_value: int64 = 0
    double_value: float64 = 0.0
    string_value: str = ""
    byte_array_value: sequence[uint8] = ()
    bool_array_value: sequence[bool] = ()
    integer_array_value: sequence[int64] = ()
    double_array_value: sequence[float64] = ()
    string_array_value: sequence[str] = ()


@dataclass
class Parameter(IdlStruct, typename="rcl_interfaces::msg::dds_::Parameter_"):
    name: str
    value: ParameterValue


@dataclass
class Outcome(IdlStruct, typename="rcl_interfaces::msg::dds_::SetParametersResult_"):
    successful: bool
    reason: str


@dataclass
class Uuid(IdlStruct, typename="unique_identifier_msgs::msg::dds_::UUID_"):
    uuid: array[uint8, 16]


@dataclass
class GoalInfo(IdlStruct, typename="action_msgs::msg::dds_::GoalInfo_"):
    goal_id: Uuid
    stamp: Time


@dataclass
class GoalStatus(IdlStruct, typename="action_msgs::msg::dds_::GoalStatus_"):
    goal_info: GoalInfo
    status: int8


@dataclass
class GoalStatuses(IdlStruct, typename="action_msgs::msg::dds_::GoalStatusArray_"):
    status_list: sequence[GoalStatus]


@dataclass
class Goal(IdlStruct, typename=f"{PACKAGE}::action::dds_::SimulateSteps_Goal_"):
    steps: uint64


@dataclass
class Outcomes(IdlStruct, typename=f"{PACKAGE}::action::dds_::SimulateSteps_Result_"):
    result: Result


@dataclass
class Progress(IdlStruct, typename=f"{PACKAGE}::action::dds_::SimulateSteps_Feedback_"):
    completed_steps: uint64
    remaining_steps: uint64


@dataclass
class Feedback(IdlStruct, typename=f"{PACKAGE}::action::dds_::SimulateSteps_FeedbackMessage_"):
    goal_id: Uuid
    feedback: Progress


def _service(kind, request, response):
    """Classes of a service's two messages, with the header of rmw_cyclonedds."""
    package, name, group = (*kind, "srv")[:3]
    header = {"client_guid": uint64, "sequence_number": int64}
    return [
        make_idl_struct(suffix, f"{package}::{group}::dds_::{name}_{suffix}_", {**header, **fields})
        for suffix, fields in (("Request", request), ("Response", response))
    ]


NONE = {"structure_needs_at_least_one_member": uint8}
"""Fields of a request that has none."""

SERVICES = {
    "get_simulator_features": ((PACKAGE, "GetSimulatorFeatures"), NONE, {"features": Features}),
    "get_simulation_state": (
        (PACKAGE, "GetSimulationState"), NONE, {"state": State, "result": Result}),
    "set_simulation_state": (
        (PACKAGE, "SetSimulationState"), {"state": State}, {"result": Result}),
    "step_simulation": ((PACKAGE, "StepSimulation"), {"steps": uint64}, {"result": Result}),
    "reset_simulation": ((PACKAGE, "ResetSimulation"), {"scope": uint8}, {"result": Result}),
    "spawn_entity": (
        (PACKAGE, "SpawnEntity"),
        {"name": str, "allow_renaming": bool, "uri": str, "resource_string": str,
         "entity_namespace": str, "initial_pose": PoseStamped},
        {"result": Result, "entity_name": str}),
    "delete_entity": ((PACKAGE, "DeleteEntity"), {"entity": str}, {"result": Result}),
    "get_entity_state": (
        (PACKAGE, "GetEntityState"), {"entity": str}, {"result": Result, "state": EntityState}),
    "simulate_steps/_action/send_goal": (
        (PACKAGE, "SimulateSteps_SendGoal", "action"),
        {"goal_id": Uuid, "goal": Goal}, {"accepted": bool, "stamp": Time}),
    "simulate_steps/_action/get_result": (
        (PACKAGE, "SimulateSteps_GetResult", "action"),
        {"goal_id": Uuid}, {"status": int8, "result": Outcomes}),
    "simulate_steps/_action/cancel_goal": (
        ("action_msgs", "CancelGoal"),
        {"goal_info": GoalInfo}, {"return_code": int8, "goals_canceling": sequence[GoalInfo]}),
    "inject_fault": (
        ("rcl_interfaces", "SetParameters"),
        {"parameters": sequence[Parameter]}, {"results": sequence[Outcome]}),
}  # fmt: skip


class Client:
    """Calls services of a simulation that steps meanwhile, in real time or faster."""

    def __init__(self, domain):
        self.node, self.made, self.count = Node(domain), {}, 0

    def call(self, name, *values, within=10.0):
        if name not in self.made:
            asked, answered = _service(*SERVICES[name])
            base = f"/otter/{name}" if name == "inject_fault" else f"/seatrial/{name}"
            writer = self.node.writer(f"{base}Request", asked, prefix="rq")
            reader = self.node.reader(f"{base}Reply", answered, prefix="rr")
            self.made[name] = asked, writer, reader
        asked, writer, reader = self.made[name]
        until = time.monotonic() + within
        while not (writer.get_matched_subscriptions() and reader.get_matched_publications()):
            assert time.monotonic() < until, f"no service {name}"
            time.sleep(0.01)
        self.count += 1
        writer.write(asked(0xABCDEF, self.count, *values))
        while time.monotonic() < until:
            for each in reader.take(10):
                if each.sample_info.valid_data and each.sequence_number == self.count:
                    assert each.client_guid == 0xABCDEF
                    return each
            time.sleep(0.005)
        raise AssertionError(f"no answer of {name}")


@pytest.fixture
def running(domain, monkeypatch):
    """A simulation of the Otter that steps in a thread, and a client beside it."""
    monkeypatch.setenv("CYCLONEDDS_URI", LOOPBACK)
    simulation = Simulation(
        "sil",
        choices={"vehicle": "otter", "autopilot": "ros2"},
        set={"autopilot.ros2.domain": domain},
    )
    stop = threading.Event()

    def run():
        while not stop.is_set():
            simulation.step(1)
            time.sleep(0.001)

    thread = threading.Thread(target=run)
    thread.start()
    client = Client(domain)
    yield simulation, client
    stop.set()
    thread.join(0.2)
    if thread.is_alive():  # it is paused
        client.call("set_simulation_state", State(1))
        thread.join()
    client.node.participant.__del__()
    simulation.close()


def test_the_standard_s_calls(running):
    simulation, client = running
    assert client.call("get_simulator_features", 0).features.features == [
        10,
        24,
        25,
        26,
        31,
        32,
        33,
    ]
    answer = client.call("get_simulation_state", 0)
    assert (answer.state.state, answer.result.result) == (1, 1)
    refused = client.call("step_simulation", 3)
    assert refused.result.result == 3
    assert client.call("set_simulation_state", State(1)).result.result == 101
    assert client.call("set_simulation_state", State(2)).result.result == 1
    assert client.call("get_simulation_state", 0).state.state == 2
    time.sleep(0.05)
    before = client.call("get_entity_state", "otter").state.header.stamp
    time.sleep(0.1)
    assert client.call("step_simulation", 5).result.result == 1
    after = client.call("get_entity_state", "otter").state.header.stamp
    assert (after.sec - before.sec) * 10**9 + after.nanosec - before.nanosec == 5 * 10**7
    assert client.call("set_simulation_state", State(0)).result.result == 0
    reset = client.call("reset_simulation", 0)
    assert reset.result.result == 0
    assert "seatrial run" in reset.result.error_message
    pose = Pose(Point(0.0, 0.0, 0.0), Quaternion(0.0, 0.0, 0.0, 1.0))
    at = PoseStamped(Header(Time(0, 0), "map"), pose)
    spawned = client.call("spawn_entity", "second", True, "otter", "", "second", at)
    assert (spawned.result.result, spawned.entity_name) == (0, "")
    assert spawned.result.error_message == "vehicles and world are those of the rig"
    assert client.call("delete_entity", "otter").result.result == 0
    lost = client.call("get_entity_state", "oter")
    assert lost.result.result == 2
    assert "'otter'" in lost.result.error_message
    assert client.call("step_simulation", 0).result.result == 4
    assert client.call("set_simulation_state", State(1)).result.result == 1
    time.sleep(0.05)
    assert simulation.get("autopilot.ros2.paused") > 0.1


def test_steps_are_an_action_too(running):
    """With feedback, a result that is waited for, a goal that is refused, and one that is cancelled."""
    _, client = running
    base = "simulate_steps/_action"
    feedback = client.node.reader(f"/seatrial/{base}/feedback", Feedback)
    status = client.node.reader(f"/seatrial/{base}/status", GoalStatuses, LATCHED)
    goals = [Uuid(bytes([n] * 16)) for n in (1, 2, 3)]

    def result_of(goal):
        answer = client.call(f"{base}/get_result", goal)
        return answer.status, answer.result.result.result

    assert client.call(f"{base}/send_goal", goals[0], Goal(5)).accepted
    assert result_of(goals[0]) == (6, 4)  # not paused: aborted
    assert client.call("set_simulation_state", State(2)).result.result == 1
    before = client.call("get_entity_state", "otter").state.header.stamp
    assert client.call(f"{base}/send_goal", goals[1], Goal(5)).accepted
    assert not client.call(f"{base}/send_goal", goals[1], Goal(5)).accepted
    assert result_of(goals[1]) == (4, 1)
    after = client.call("get_entity_state", "otter").state.header.stamp
    assert (after.sec - before.sec) * 10**9 + after.nanosec - before.nanosec == 5 * 10**7
    told = [each for each in feedback.take(10) if each.sample_info.valid_data]
    assert [bytes(each.goal_id.uuid) for each in told] == [b"\2" * 16] * len(told)
    counts = [(each.feedback.completed_steps, each.feedback.remaining_steps) for each in told]
    assert counts == [(1, 4), (2, 3), (3, 2), (4, 1), (5, 0)]
    assert client.call(f"{base}/send_goal", goals[2], Goal(1_000_000)).accepted
    for number in range(11, 21):  # ten results are kept beside the goal that acts
        other = Uuid(bytes([number] * 16))
        assert client.call(f"{base}/send_goal", other, Goal(1)).accepted
        assert result_of(other) == (6, 4)
    cancelled = client.call(f"{base}/cancel_goal", GoalInfo(Uuid(bytes(16)), Time(0, 0)))
    assert cancelled.return_code == 0
    assert [bytes(each.goal_id.uuid) for each in cancelled.goals_canceling] == [b"\3" * 16]
    assert result_of(goals[2]) == (5, 4)
    assert client.call(f"{base}/cancel_goal", GoalInfo(goals[2], Time(0, 0))).return_code == 3
    assert result_of(Uuid(bytes([9] * 16))) == (0, 0)
    last = status.take(10)[-1].status_list
    assert [each.status for each in last] == [6] * 9 + [5]
    assert result_of(goals[1]) == (0, 0)


def test_a_fault_is_injected_and_what_is_none_refused(running):
    simulation, client = running

    def text(name, value):
        return Parameter(name, ParameterValue(type=4, string_value=value))

    asked = [
        text("gps", "off"),
        text("gsp", "off"),
        text("mag", "of"),
        Parameter("gyro", ParameterValue(type=2, integer_value=1)),
    ]
    found = client.call("inject_fault", asked).results
    assert [each.successful for each in found] == [True, False, False, False]
    assert "gps" in found[1].reason
    assert "off" in found[2].reason
    until = time.monotonic() + 10.0
    while simulation.get("autopilot.ros2.failure.gps") != "off" and time.monotonic() < until:
        time.sleep(0.05)
    assert simulation.get("autopilot.ros2.failure.gps") == "off"
    assert simulation.get("vehicle.gnss.fault") == "off"
