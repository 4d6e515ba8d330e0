"""Missions and guidance together, with a point that goes where guidance wants."""

import math

import pytest

from seatrial.control.guidance import Guidance
from seatrial_kits.mavlink.component import Mavlink
from tests.control.guided_craft import drive, guidance

from .bench import Bench
from .ground import (
    DELAY,
    LOITER_TIME,
    MISSION_FRAME,
    RETURN,
    SPEED,
    TURNS,
    listed,
    north_of,
    one,
    upload,
)

START = 300
LEGS = ("leg", "leg_from", "leg_to", "leg_speed", "leg_radius", "leg_wait", "leg_circle")


def sail(bench, seconds, **settings):
    """Let guidance follow the mission for so long; return when each item was reached, s."""
    guided = guidance(mode="auto", **settings)
    reached = []

    def each(t):
        leg = bench.node.missions.leg
        values = (leg.number, leg.start, leg.end, leg.speed, leg.radius, leg.wait, leg.circle)
        for name, value in zip(LEGS, values, strict=True):
            guided.set(name, value)
        bench.measure(position_n=tuple(guided.position_n))
        bench.node.missions.reached = guided.get("reached")
        bench.wait(guided.period)
        reached.extend((m.seq, t) for m in bench.transport.take("MISSION_ITEM_REACHED"))

    drive(guided, seconds, each=each)
    return dict(reached), guided


def mission(*items, **settings):
    bench = Bench(cruise_speed=1.0, waypoint_radius=1.0, **settings)
    assert upload(bench, listed(*items)) == 0
    bench.arm()
    bench.tick()
    assert bench.command(START) == 0
    return bench


@pytest.mark.parametrize("name", LEGS)
def test_the_component_gives_what_guidance_takes(name):
    given, taken = Mavlink.ports[name], Guidance.ports[name]
    assert (given.unit, given.type, given.axes) == (taken.unit, taken.type, taken.axes)
    assert Mavlink.ports["leg_reached"].type is Guidance.ports["reached"].type


@pytest.mark.interop
def test_times_are_those_of_the_way():
    bench = mission(
        one(at=north_of(20)),
        one(SPEED, 1.0, 2.0, frame=MISSION_FRAME, at=(0, 0)),
        one(16, 10.0, at=north_of(50)),
        one(DELAY, 5.0, frame=MISSION_FRAME, at=(0, 0)),
        one(RETURN, frame=MISSION_FRAME, at=(0, 0)),
    )
    reached, guided = sail(bench, 85.0)
    # Distances less the radius of acceptance; 0.5 s for the instants that everything takes.
    assert reached[1] == pytest.approx(19.0, abs=0.5)
    assert reached[3] == pytest.approx(reached[1] + 30.0 / 2.0 + 10.0, abs=0.5)
    assert reached[4] == pytest.approx(reached[3] + 5.0, abs=0.5)
    # Back at 2 m/s, after a turn by 180 degrees: from 1 m before the waypoint to 1 m before home.
    assert reached[5] == pytest.approx(reached[4] + 48.0 / 2.0, abs=1.5)
    assert bench.node.missions.leg.number == guided.get("reached")


@pytest.mark.interop
@pytest.mark.parametrize(
    ("radius", "turns", "seconds"),
    [(-6.0, 1.0, 80.0), pytest.param(6.0, 2.0, 120.0, marks=pytest.mark.interop)],
)
def test_turns_take_the_time_of_their_length(radius, turns, seconds):
    bench = mission(one(at=north_of(10)), one(TURNS, turns, p3=radius, at=north_of(40)))
    reached, _ = sail(bench, seconds, lookahead=3.0)
    # From the acceptance (1 m outside the circle); the way onto the circle turns it too.
    way = math.tau * abs(radius) * turns
    assert reached[2] - reached[1] == pytest.approx(20.0 + way, rel=0.08)


@pytest.mark.interop
def test_a_circle_for_a_time():
    bench = mission(one(LOITER_TIME, 30.0, p3=6.0, at=north_of(20)))
    reached, guided = sail(bench, 60.0)
    assert reached[1] == pytest.approx(13.0 + 30.0, abs=0.5)
    assert guided.get("state") == 2  # stays where it was when the time was over
