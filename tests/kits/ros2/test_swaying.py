"""Velocities abeam: followed by pilots that have sway, named by others."""

import logging
import math

import pytest


def sailed(simulation, domain, vehicle, seconds, twist):
    made = simulation(
        "sil",
        choices={"vehicle": vehicle, "autopilot": "ros2"},
        set={"autopilot.ros2.domain": domain, "autopilot.ros2.timeout": "1000 s"},
    )
    made.step(2)
    made.ros2("autopilot.ros2").publish("cmd_vel", **twist)
    begun = made.get("vehicle.motion.position")
    made.run(seconds)
    return made, [b - a for a, b in zip(begun, made.get("vehicle.motion.position"), strict=True)]


@pytest.mark.slow
def test_an_underwater_vehicle_goes_to_port_and_keeps_its_heading(simulation, domain):
    made, (north, east, _) = sailed(simulation, domain, "bluerov2", 20.0, {"linear": {"y": 0.3}})
    assert made.get("autopilot.ros2.target_kind") == "body"
    assert -0.3 * 20.0 < east < -0.3 * 17.0  # 3 s to speed up, at 0.1 m/s2
    assert abs(north) < 0.1
    assert abs(made.get("vehicle.motion.attitude")[2]) < math.radians(1.0)


@pytest.mark.slow
def test_a_ship_with_tunnel_thrusters_goes_to_starboard(simulation, domain):
    twist = {"linear": {"y": -0.5}}
    made, (_, east, _) = sailed(simulation, domain, "supply-ship", 60.0, twist)
    assert 0.5 * 40.0 < east < 0.5 * 60.0
    assert abs(made.get("vehicle.motion.attitude")[2]) < math.radians(2.0)


@pytest.mark.slow
def test_parts_that_a_pilot_has_no_control_of_are_named_once(simulation, domain, caplog):
    twist = {"linear": (0.5, 0.3, 0.2), "angular": (0.1, 0.1, 0.1)}
    with caplog.at_level(logging.WARNING, "seatrial.ros2"):
        made, _ = sailed(simulation, domain, "otter", 1.0, twist)
    assert made.get("autopilot.ros2.target_kind") == "heading"
    said = [each.message for each in caplog.records if "is not followed" in each.message]
    assert [each.partition("cmd_vel: ")[2] for each in said] == [
        "linear.y is not followed: this pilot has no sway",
        "linear.z is not followed: this pilot has no depth",
        "angular.x is not followed: this pilot has no roll to turn",
        "angular.y is not followed: this pilot has no pitch to turn",
    ]
