"""Mistakes of other nodes: refused or counted, reported once, and never fatal."""

import logging
import math
import os
import subprocess
import sys
import time

import pytest
from cyclonedds.core import Policy, Qos

from seatrial import Simulation
from seatrial.errors import InputError, SimulationError

from .peer import (
    LATCHED,
    LOOPBACK,
    Float64,
    Header,
    Node,
    Odometry,
    Time,
    Twist,
    TwistStamped,
    Vector3,
)

_ARRIVES = 0.5 if "SEATRIAL_TEST_TRANSPORT" in os.environ else 0.02
"""Wall time in which a message arrives, s."""
PORT, LINK = "/otter/thrusters/port/thrust", "autopilot.ros2."


@pytest.fixture
def node(domain, monkeypatch):
    monkeypatch.setenv("CYCLONEDDS_URI", LOOPBACK)
    node = Node(domain)
    yield node
    node.participant.__del__()


@pytest.fixture
def otter(domain):
    made = []

    def make(**settings):
        named = {f"{LINK}{key}": value for key, value in settings.items()}
        made.append(
            Simulation(
                "sil",
                choices={"vehicle": "otter", "autopilot": "ros2"},
                set={f"{LINK}domain": domain, **named},
            )
        )
        made[-1].step(3)
        return made[-1]

    yield make
    for each in made:
        each.close()


def sent(simulation, writer, *messages):
    """Send, once the link is there, and let it take in what has come."""
    until = time.monotonic() + 10.0
    while not writer.get_matched_subscriptions() and time.monotonic() < until:
        time.sleep(0.01)
    for each in messages:
        writer.write(each)
        time.sleep(_ARRIVES)
    simulation.step(3)


def pulse(simulation):
    return simulation.get("autopilot.ros2.pulse.ch1")


def test_thrust_is_a_pulse_until_it_is_too_old(otter, node):
    simulation, writer = otter(), node.writer(PORT, Float64)
    sent(
        simulation, writer, Float64(0.25 * 0.01108 * 103.93086427398**2)
    )  # a quarter: half of speed
    assert pulse(simulation) == pytest.approx(1.7e-3)
    assert simulation.get(f"{LINK}pulse.ch3") == pytest.approx(1.5e-3)  # without a command: neutral
    simulation.run(simulation.time + 0.45)
    assert pulse(simulation) == pytest.approx(1.7e-3)
    simulation.run(simulation.time + 0.2)
    assert simulation.get(f"{LINK}source") == "none"
    assert pulse(simulation) == pytest.approx(1.5e-3)


def test_numbers_that_are_not_finite_and_beyond_the_limits(otter, node, caplog):
    simulation, writer = otter(), node.writer(PORT, Float64)
    with caplog.at_level(logging.WARNING):
        sent(simulation, writer, *map(Float64, (math.nan, math.inf, -math.inf)))
    assert simulation.get(f"{LINK}refused") == 3
    assert simulation.get(f"{LINK}source") == "none"
    reported = [each.message for each in caplog.records if "not finite" in each.message]
    assert len(reported) == 1
    assert PORT in reported[0]
    sent(simulation, writer, Float64(1e9))
    assert pulse(simulation) == pytest.approx(1.9e-3)
    sent(simulation, writer, Float64(-1e300))
    assert pulse(simulation) == pytest.approx(1.1e-3)


def test_a_second_publisher_is_refused_while_the_first_commands(otter, node, domain, caplog):
    simulation, first, second = otter(), node.writer(PORT, Float64), node.writer(PORT, Float64)
    sent(simulation, first, Float64(30.0))
    before = pulse(simulation)
    sent(simulation, second, Float64(-60.0))
    assert pulse(simulation) == before
    assert simulation.get(f"{LINK}refused") == 1
    assert "two command the same" in caplog.text
    simulation.run(simulation.time + 0.6)
    sent(simulation, second, Float64(-60.0))
    assert pulse(simulation) < 1.5e-3


def test_a_flood_and_a_huge_message_cost_no_more_than_a_step(otter, node):
    simulation = otter()
    writer = node.writer("/otter/cmd_vel_stamped", TwistStamped)
    twist = Twist(Vector3(x=1.0), Vector3())
    now = Time(0, round(simulation.time * 1e9))
    sent(simulation, writer, TwistStamped(Header(now, "x" * 10_000_000), twist))
    assert simulation.get(f"{LINK}source") == "cmd_vel"
    for _ in range(1000):
        writer.write(TwistStamped(Header(now, "base_link"), twist))
    begun = time.process_time()
    simulation.step(10)
    assert time.process_time() - begun < 1.0
    assert simulation.get(f"{LINK}target_speed") == 1.0


def test_stamps_of_another_clock_are_reported_and_old_ones_dropped(otter, node, caplog):
    simulation = otter()
    writer = node.writer("/otter/cmd_vel_stamped", TwistStamped)
    twist = Twist(Vector3(x=1.0), Vector3())
    sent(simulation, writer, TwistStamped(Header(Time(1_700_000_000, 0), ""), twist))
    assert simulation.get(f"{LINK}source") == "cmd_vel"
    assert "use_sim_time" in caplog.text
    simulation.run("3 s")
    sent(simulation, writer, TwistStamped(Header(Time(1, 0), ""), twist))
    assert simulation.get(f"{LINK}source") == "none"
    assert simulation.get(f"{LINK}late") == 1


def test_other_types_and_qualities_are_named(otter, node, caplog):
    simulation = otter()
    best_effort = Qos(Policy.Reliability.BestEffort, Policy.History.KeepLast(5))
    kept = [
        node.writer("/otter/cmd_vel", TwistStamped),
        node.writer("/otter/cmd_vel", Twist, best_effort),
        node.reader("/otter/odometry/ground_truth", Odometry, LATCHED),
    ]
    until = time.monotonic() + 10.0
    while len(caplog.records) < 3 and time.monotonic() < until:
        simulation.step(1)
        time.sleep(0.05)
    assert "/otter/cmd_vel: a publisher has the type geometry_msgs/msg/TwistStamped" in caplog.text
    assert "geometry_msgs/msg/Twist is needed" in caplog.text
    assert "/otter/cmd_vel: a publisher is best effort" in caplog.text
    assert "/otter/odometry/ground_truth: a subscriber asks for transient local" in caplog.text
    assert len(kept) == 3


def test_a_clock_from_elsewhere_is_named_and_simulated_time_goes_on(
    otter, domain, tmp_path, caplog
):
    simulation = otter()
    code = (
        "import sys; from tests.kits.ros2.peer import Node, Clock, Time\n"
        f"writer = Node({domain}).writer('/clock', Clock)\n"
        "writer.write(Clock(Time(1_700_000_000, 0))); sys.stdin.read()"
    )
    environment = {**os.environ, "CYCLONEDDS_URI": LOOPBACK}
    command = [sys.executable, "-c", code]
    other = subprocess.Popen(command, stdin=subprocess.PIPE, env=environment)
    until, before = time.monotonic() + 20.0, simulation.time
    while "two clocks" not in caplog.text and time.monotonic() < until:
        simulation.step(1)
        time.sleep(0.05)
    other.communicate()
    assert caplog.text.count("/clock: another program publishes it too") == 1
    assert before < simulation.time < 30.0


@pytest.mark.slow
def test_a_node_that_is_killed_leaves_the_vehicle_neutral_and_the_run_goes_on(otter, peer, caplog):
    simulation, process = otter(period="100 ms", truth_period="100 ms"), peer("thrust")
    until = time.monotonic() + 20.0
    while simulation.get(f"{LINK}source") != "thrusters" and time.monotonic() < until:
        simulation.step(10)
        time.sleep(0.05)
    assert simulation.get(f"{LINK}source") == "thrusters"
    process.kill()
    process.wait()
    simulation.run(simulation.time + 0.9)
    assert simulation.get(f"{LINK}source") == "none"
    assert pulse(simulation) == pytest.approx(1.5e-3)
    assert "neutral" in caplog.text


def test_lockstep_names_who_is_awaited(otter, domain):
    with pytest.raises(SimulationError, match=r"/otter/cmd_vel_stamped \(it has no publisher\)"):
        otter(lockstep="stamped", wait_limit="0.3 s")


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        ({"lockstep": "stamped", "awaited": "cmd_vel"}, "geometry_msgs/msg/Twist, which has no"),
        ({"lockstep": "counted", "awaited": "cmd_vle"}, r"cmd_vle.*did you mean.*cmd_vel"),
        ({"topics": "imv imu"}, r"imv.*imu"),
        ({"topics": "imu imu data"}, "'imu data'"),
        ({"namespace": "/otter"}, "namespace is '/otter'"),
        ({"domain": 233}, "233"),
    ],
)
def test_settings_that_cannot_be(otter, settings, said):
    with pytest.raises((InputError, SimulationError), match=f"(?i){said}"):
        otter(**settings)


@pytest.mark.parametrize(
    ("name", "value", "said"),
    [
        ("ROS_DOMAIN_ID", "seven", "ROS_DOMAIN_ID is 'seven', allowed 0 to 232"),
        ("RMW_IMPLEMENTATION", "rmw_zenoh_cpp", "RMW_IMPLEMENTATION"),
    ],
)
def test_variables_of_ros_that_cannot_be(otter, monkeypatch, name, value, said):
    monkeypatch.setenv(name, value)
    with pytest.raises((InputError, SimulationError), match=said):
        otter(domain=-1)
