"""The Otter sailed by a node of somebody else, in a process of its own."""

import pytest

from seatrial import Simulation
from tests.command import seatrial_process

LEGS = {
    "autopilot.course.count": 2,
    "autopilot.course.waypoint_1": ["15 m", "0 m", "0 m"],
    "autopilot.course.waypoint_2": ["15 m", "40 m", "0 m"],
}
SLOW = {"autopilot.ros2.period": "250 ms", "autopilot.ros2.truth_period": "250 ms"}


def otter(domain, **settings):
    named = {f"autopilot.ros2.{key}": value for key, value in settings.items()}
    return Simulation(
        "sil",
        choices={"vehicle": "otter", "autopilot": "ros2"},
        set={"autopilot.ros2.domain": domain, **LEGS, **SLOW, **named},
    )


@pytest.mark.slow
def test_a_helmsman_in_lockstep_leaves_the_same_bytes_however_late_it_answers(
    domain, peer, tmp_path
):
    settings = {"autopilot.ros2.domain": domain, **SLOW, "autopilot.ros2.lockstep": "stamped"}
    written = [f"{key}={value}" for key, value in settings.items()]
    for name in ("square", "delayed"):
        helmsman = peer(name)
        done = seatrial_process(
            "run",
            "under-way",
            "--vehicle",
            "otter",
            "--autopilot",
            "ros2",
            "--engine",
            "direct",
            "--set",
            "stop=8 s",
            "--set",
            'autopilot.course.waypoint_1=["4 m", "0 m", "0 m"]',
            "--out",
            name,
            *(each for setting in written for each in ("--set", setting)),
            cwd=tmp_path,
        )
        assert done.returncode in (0, 1), done.stderr
        helmsman.kill()
        helmsman.wait()
    first, second = (tmp_path / name / "signals.csv" for name in ("square", "delayed"))
    assert first.read_bytes() == second.read_bytes()
    assert len(first.read_text().splitlines()) > 15


@pytest.mark.slow
def test_a_helmsman_sails_by_thrusts_and_the_pilot_takes_no_part(domain, peer):
    peer("thrust")
    with otter(domain, lockstep="counted", awaited="port.thrust starboard.thrust") as simulation:
        simulation.run("10 s")
        assert simulation.get("autopilot.ros2.source") == "thrusters"
        assert not simulation.get("autopilot.ros2.armed")
        north, east, _ = (simulation.get(f"vehicle.motion.position.{axis}") for axis in "xyz")
    assert north > 6.0
    assert abs(east) < 2.0
