"""Nodes: what they refuse, what their state holds, both carriers, and the shipped trials."""

import math
from itertools import pairwise

import pytest
from dronecan import uavcan
from dronecan.transport import Transfer
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from seatrial.errors import InputError
from seatrial.links.text import Outbox, decode
from seatrial.trial.files.trial import load_trial
from seatrial.trial.running.run import run_trial
from seatrial_kits.can.dronecan.autopilot import DroneCanAutopilot
from seatrial_kits.can.dronecan.channels import channels_of
from seatrial_kits.can.dronecan.navigation import euler, quaternion
from seatrial_kits.can.dronecan.peripheral import DroneCanPeripheral
from seatrial_kits.can.frame import Frame
from seatrial_kits.can.operations import Transmit, encode
from seatrial_kits.can.operations import decode as operations
from tests.kits.can.dronecan.bench import made

STEP = 0.01


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"channels": "esc0 fin1"}, "'fin1' is no channel, such as 'esc0'"),
        ({"channels": "esc20"}, "'esc20': the number is at most 19"),
        ({"channels": "actuator256"}, "at most 255"),
        ({"channels": "esc0:pwm"}, "only actuators have a type"),
        ({"channels": "actuator1:angle"}, "the type is one of unitless, position"),
        ({"channels": "esc0 rpm0"}, "'esc0' has a number that another one has too"),
        ({"channels": " ".join(f"esc{n}" for n in range(9))}, "9 channels, 8 at most"),
        ({"node_name": "My ESC"}, "name is 'My ESC', 1 to 80 small letters"),
        ({"unique_id": "12"}, "unique_id is '12', 32 hexadecimal digits"),
        ({"software_version": "1.2.3"}, "version is '1.2.3', something like '1.0'"),
        ({"hardware_version": "1.256"}, "version is '1.256'"),
        ({"measured": "voltag"}, "did you mean 'voltage'"),
        ({"date": "5.2.2026"}, "a day like '2026-02-05' is needed"),
        ({"node_id": 1.5}, "node_id is 1.5, a whole number is needed"),
        ({"node_id": 128.0}, "allowed 0.0 to 127"),
        ({"pulse_neutral": 2e-3}, "must rise"),
    ],
)
def test_what_cannot_be_is_refused_with_what_can(values, message):
    with pytest.raises(InputError) as raised:
        made(DroneCanPeripheral, "esc", **values).initialise()
    assert message in str(raised.value)


def test_channels_are_read_in_their_order():
    found = channels_of("actuator3 esc0 actuator0:pwm rpm7")
    assert [tuple(each) for each in found] == [("unitless", 3), ("esc", 0), ("pwm", 0), ("rpm", 7)]
    assert channels_of("") == []


ANGLE = st.floats(-math.pi, math.pi)


@given(ANGLE, st.floats(-1.57, 1.57), ANGLE)
def test_quaternions_are_scipys(phi, theta, psi):
    found = quaternion((phi, theta, psi))
    wanted = Rotation.from_euler("ZYX", [psi, theta, phi])
    assert (wanted.inv() * Rotation.from_quat(found)).magnitude() < 1e-7
    again = Rotation.from_euler("ZYX", euler(*found)[::-1])
    assert (wanted.inv() * again).magnitude() < 1e-6


def sent_text(outbox: dict, time_ns: int, payload, **fields) -> str:
    """Return what a bus sends when another node has sent a message."""
    fields = {"source_node_id": 99, **fields}
    box = Outbox(outbox)
    for each in Transfer(payload=payload, **fields).to_frames():
        frame = Frame(each.message_id, bytes(each.bytes), True)
        box.put(time_ns, encode(Transmit(frame)))
    return box.flush()


def sent(node, k: int) -> str:
    node.advance(k * STEP, STEP)
    return node.get("tx")


def started(node):
    node.setup(0.0)
    node.initialise()
    node.begin()
    return node


def test_a_state_holds_half_a_transfer_commands_and_counters():
    node = started(
        made(DroneCanPeripheral, "esc", node_id=9.0, gnss_period=0.05, measured="voltage")
    )
    bus: dict = {}
    node.set("rx", sent_text(bus, 0, uavcan.equipment.esc.RawCommand(cmd=[1000])))
    for k in range(10):
        sent(node, k)
    state = node.get_state()
    first = [sent(node, k) for k in range(10, 130)], node.get("command"), node.get("failsafe")
    node.set_state(state)
    again = [sent(node, k) for k in range(10, 130)], node.get("command"), node.get("failsafe")
    assert first == again
    other = started(made(DroneCanPeripheral, "esc", node_id=9.0, gnss_period=0.05))
    other.set_state(state)
    assert [sent(other, k) for k in range(10, 130)] == first[0]
    assert len(set(first[0])) > 24  # a fix every 50 ms
    assert first[2] is True


def test_an_autopilots_state():
    node = started(made(DroneCanAutopilot, "autopilot", node_id=1.0))
    status = uavcan.equipment.esc.Status(voltage=15.0, esc_index=1)
    bus: dict = {}
    node.set("rx", sent_text(bus, 0, status, source_node_id=7))
    sent(node, 0)
    assert node.get("voltage")[:2] == [0.0, 15.0]
    state = node.get_state()
    later = uavcan.equipment.esc.Status(voltage=9.0, esc_index=1)
    text = sent_text(bus, 10_000_000, later, transfer_id=1, source_node_id=7)
    node.set("rx", text)
    first = sent(node, 1), node.get("voltage")
    assert first[1][1] == 9.0
    node.set_state(state)
    assert node.get("voltage")[:2] == [0.0, 15.0]
    node.set("rx", text)
    assert (sent(node, 1), node.get("voltage")) == first


def test_what_is_due_is_requested_at_its_very_time():
    node = started(
        made(DroneCanPeripheral, "esc", node_id=9.0, status_period=0.0137, gnss_period=0.2)
    )
    times: dict[int, list[int]] = {}
    before = ""
    for k in range(300):
        text = sent(node, k)
        for when, data in decode(text)[1] if text != before else []:
            frame = operations(data)[0].frame
            if frame.data[-1] & 0x80:  # the first of a transfer
                times.setdefault(frame.identifier >> 8 & 0xFFFF, []).append(when)
        before = text
    for kind, period_ns in ((341, 10**9), (1034, 13_700_000), (1063, 200_000_000)):
        gaps = {late - early for early, late in pairwise(times[kind])}
        assert gaps == {period_ns}
    assert times[1063][0] == 0 < times[1034][0] < 13_700_000


RIG = """
step = "5 ms"

[components]
can       = { fmu = "canbus", set = { nodes = "autopilot esc", bit_rate = "1 MHz" } }
autopilot = { fmu = "dronecan-autopilot", set = { node_id = 1, "command.c1" = 0.25 } }
esc       = { fmu = "dronecan-peripheral", set = { node_id = 2, gnss_period = "100 ms", channels = "esc0 esc1" } }

[connections]
"autopilot.tx" = "can.tx.n1"
"esc.tx"       = "can.tx.n2"
"can.rx.n1"    = "autopilot.rx"
"can.rx.n2"    = "esc.rx"
"""
TRIAL = """
rig  = "rig.toml"
stop = "1.5 s"

[[criteria]]
name  = "the command arrives"
check = "finally esc.command.c1 > 0.2499"
"""


def test_both_carriers_leave_the_same_bytes(write):
    write("rig.toml", RIG)
    trial = write("trial.toml", TRIAL)
    logs = []
    for engine in ("direct", "fmu"):
        result = run_trial(load_trial(str(trial)), trial.parent / engine, engine=engine)
        assert (result.status, result.passed) == ("complete", True), result.error
        logs.append([(result.folder / name).read_bytes() for name in ("signals.csv", "can.log")])
    assert logs[0] == logs[1]
    assert logs[0][1].count(b"\n") > 200


def passes(name: str, folder) -> None:
    result = run_trial(load_trial(name), folder / name, engine="direct")
    failed = [name for name, _, verdict in result.verdicts if not verdict.passed]
    assert (result.status, failed) == ("complete", []), result.error


@pytest.mark.long
@pytest.mark.parametrize("name", ["hydrone-dronecan-square", "hydrone-dronecan-load"])
def test_the_hydrone_is_guided_over_the_bus(name, tmp_path):
    passes(name, tmp_path)
