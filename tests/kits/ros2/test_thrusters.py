"""Thrusts in newtons as commands of thrusters, against their published curves."""

import time

import pytest

from seatrial import Simulation
from seatrial_kits.ros2.joining import join
from seatrial_kits.ros2.messages.packing import packed

FLOAT = "std_msgs/msg/Float64"


def t200(command):
    """von Benzon et al. 2022, eq. 18, N."""
    v = abs(command)
    thrust = -140.3 * v**9 + 389.9 * v**7 - 404.1 * v**5 + 176.0 * v**3 + 8.9 * v
    return thrust if command > 0.0 else -thrust


@pytest.mark.parametrize("command", [0.1, 0.5, 0.9, -0.3, -0.7])
def test_a_thrust_of_the_bluerov2_is_the_command_of_its_published_curve(domain, command):
    participant = join(domain, "/test", "dds")
    writer = participant.writer("/bluerov2/thrusters/t3/thrust", FLOAT)
    with Simulation(
        "sil",
        choices={"vehicle": "bluerov2", "autopilot": "ros2"},
        set={"autopilot.ros2.domain": domain},
    ) as simulation:
        simulation.step(2)
        until = time.monotonic() + 10.0
        while not writer.readers and time.monotonic() < until:
            time.sleep(0.01)
        writer.write(packed(FLOAT, {"data": t200(command)}))
        time.sleep(0.05)
        simulation.step(3)
        pulse = simulation.get("autopilot.ros2.pulse.ch3")
        others = simulation.get("autopilot.ros2.pulse.ch1")
    participant.close()
    assert pulse == pytest.approx(1.5e-3 + 0.4e-3 * command, abs=1e-8)
    assert others == pytest.approx(1.5e-3)
