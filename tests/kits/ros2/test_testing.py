"""The node that tests have beside a simulation."""

import pytest

from seatrial.errors import InputError
from tests.command import seatrial, seatrial_process


@pytest.fixture
def otter(simulation, domain):
    made = simulation(
        "sil",
        choices={"vehicle": "otter", "autopilot": "ros2"},
        set={"autopilot.ros2.domain": domain},
    )
    made.step(3)
    return made


def test_a_test_commands_and_expects(otter):
    node = otter.ros2("autopilot.ros2")
    node.publish("thrusters/port/command", data=0.5)
    otter.step(2)
    assert otter.get("autopilot.ros2.pulse.ch1") == pytest.approx(1.7e-3)
    imu = node.expect("imu/data", within="0.1 s", where=lambda each: each.header.stamp.nanosec > 0)
    assert imu.linear_acceleration.z == pytest.approx(9.8, abs=0.5)
    node.publish("goal_pose", header={"frame_id": "map"}, pose={"position": (5.0, 0.0, 0.0)})
    otter.run(otter.time + 0.7)  # until the thruster's command is too old
    assert otter.get("autopilot.ros2.source") == "goal_pose"
    assert otter.get("autopilot.ros2.target_position") == pytest.approx((0.0, 5.0, 0.0))
    node.publish("goal_pose", header={"frame_id": "mars"})
    otter.step(2)
    assert otter.get("autopilot.ros2.source") == "none"


def test_a_wrench_is_shares_of_the_pilot_s_limits(otter):
    node = otter.ros2("autopilot.ros2")
    node.publish("cmd_wrench", wrench={"force": (115.0, 0.0, 0.0), "torque": (0.0, 0.0, 25.0)})
    otter.step(2)
    assert otter.get("autopilot.ros2.mode") == "manual"
    surge, sway, yaw, heave = otter.get("autopilot.ros2.manual")
    assert (surge, sway, yaw, heave) == pytest.approx((0.5, 0.0, -0.5, 0.0))


def test_topics_that_are_not_there_are_named(otter):
    node = otter.ros2("autopilot.ros2")
    with pytest.raises(InputError, match=r"imu/date.*imu/data"):
        node.publish("imu/date")
    with pytest.raises(AssertionError, match=r"pressure was not received .*nothing"):
        node.expect("pressure", within="0.1 s")


@pytest.mark.slow
def test_a_bag_has_what_a_recorder_would_have(tmp_path, domain):
    """Written by the link as an FMU, read by mcap-ros2-support, which knows nothing of rosbags."""
    from mcap.reader import make_reader
    from mcap_ros2.decoder import DecoderFactory

    done = seatrial_process(
        "run",
        "under-way",
        "--vehicle",
        "otter",
        "--autopilot",
        "ros2",
        "--engine",
        "fmu",
        "--set",
        "stop=0.5 s",
        "--set",
        "autopilot.ros2.bag=on",
        "--out",
        "run",
        "--set",
        f"autopilot.ros2.domain={domain}",
        cwd=tmp_path,
    )
    assert done.returncode in (0, 1), done.stderr
    (file,) = (tmp_path / "run/autopilot.ros2").glob("*.mcap")
    found = {}
    with file.open("rb") as opened:
        reader = make_reader(opened, decoder_factories=[DecoderFactory()])
        for _, channel, _, content in reader.iter_decoded_messages():
            found.setdefault(channel.topic, []).append(content)
    assert len(found["/clock"]) == 50
    assert len(found["/otter/imu/data"]) == 50
    assert len(found["/otter/odometry/ground_truth"]) == 25
    assert found["/otter/leg"][0].poses[1].pose.position.x == 5000.0
    assert found["/otter/imu/data"][7].header.stamp.nanosec == 70_000_000


def test_a_run_forked_from_a_process_that_speaks_dds_says_so(tmp_path, domain, otter):
    """The tests' command runs in this process, and the run in a fork of it: it would hang."""
    otter.ros2("autopilot.ros2")
    settings = ("--set", f"autopilot.ros2.domain={domain}", "--set", "stop=1 s")
    done = seatrial(
        "run",
        "under-way",
        "--vehicle",
        "otter",
        "--autopilot",
        "ros2",
        "--engine",
        "direct",
        *settings,
        cwd=tmp_path,
    )
    assert done.returncode == 2
    assert "forked from one that speaks DDS" in done.stderr
