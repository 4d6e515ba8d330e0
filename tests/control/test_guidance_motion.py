"""Guidance laws one by one, at random places, beside the same plane in complex numbers."""

import cmath
import math

import numpy as np
import pytest

from seatrial.control.guidance_motion import FOLLOW, STAY, STEER, Goal, Law, Past, command

LAW = Law(6.0, 0.3, 4.0, 1.5, 0.4, 0.7)
FROM, TO = (20.0, -30.0, 2.0), (110.0, 35.0, 9.0)
PAST = Past(0.6, integral=2.5)


def plane(point):
    """Return north + i east: an argument is then a bearing."""
    return complex(*point[:2])


def places(count=6):
    """Return places beside the leg from `FROM` to `TO`, m, and how far along and across they are."""
    draw = np.random.default_rng(3)
    length, course = cmath.polar(plane(TO) - plane(FROM))
    for along, across, depth in draw.uniform((0.1, -25, 0), (0.8, 25, 12), (count, 3)):
        at = plane(FROM) + cmath.rect(1.0, course) * complex(along * length, across)
        yield (at.real, at.imag, depth), along, across, course


def turned(found, expected):
    assert math.remainder(found - expected, math.tau) == pytest.approx(0.0, abs=1e-12)


def test_a_leg_is_led_onto_by_line_of_sight_with_its_integral():
    goal = Goal(FOLLOW, TO, FROM, speed=1.7, radius=3.0)
    for here, along, across, course in places():
        found = command(goal, LAW, here, PAST)
        assert (found.motion, found.speed, found.arrived, found.away) == (FOLLOW, 1.7, False, False)
        reaching = across + 0.3 * 2.5
        turned(found.heading, course - math.atan(reaching / 6.0))
        assert found.integral_rate == pytest.approx(6 * across / (reaching**2 + 36))
        assert found.across == pytest.approx(across)
        assert found.depth == pytest.approx(2.0 + along * 7.0)
        assert found.distance == pytest.approx(abs(plane(TO) - plane(here)))


def test_before_its_begin_a_leg_has_the_depth_of_its_begin_and_past_its_end_heads_for_it():
    goal = Goal(FOLLOW, TO, FROM, speed=1.7, radius=3.0)
    leg = plane(TO) - plane(FROM)
    before, past = plane(FROM) - 0.1 * leg + 2j, plane(TO) + 0.2 * leg + 3
    assert command(goal, LAW, (before.real, before.imag, 5.0), PAST).depth == 2.0
    found = command(goal, LAW, (past.real, past.imag, 5.0), PAST)
    turned(found.heading, cmath.phase(plane(TO) - past))
    across = ((past - plane(TO)) / (leg / abs(leg))).imag
    assert (found.depth, found.speed, found.integral_rate) == (9.0, 1.7, 0.0)
    assert found.across == pytest.approx(across)


def test_a_leg_without_a_length_is_a_place_to_go_to():
    found = command(Goal(FOLLOW, TO, TO, speed=1.7), LAW, (90.0, 50.0, 1.0), PAST)
    turned(found.heading, cmath.phase(20 - 15j))
    assert (found.motion, found.depth, found.speed) == (FOLLOW, 9.0, 1.7)
    assert found.distance == pytest.approx(25.0)


@pytest.mark.parametrize(
    ("depth", "arrived"), [(8.4, True), (9.6, True), (8.2, False), (9.8, False)]
)
def test_the_end_is_reached_within_radius_and_depth(depth, arrived):
    goal = Goal(FOLLOW, TO, FROM, speed=1.7, radius=3.0)
    inside, outside = (TO[0] - 1.7, TO[1] + 2.4, depth), (TO[0] - 1.9, TO[1] + 2.4, depth)
    found = command(goal, LAW, inside, PAST)
    assert (found.motion, found.arrived) == (STAY, arrived)
    assert command(goal, LAW, outside, PAST).motion == FOLLOW
    kept = command(goal, LAW, outside, PAST._replace(arrived=True))
    assert (kept.motion, kept.arrived, kept.heading) == (STAY, True, 0.6)


@pytest.mark.parametrize("radius", [8.0, -5.0])
def test_circles_are_sailed_by_line_of_sight(radius):
    goal = Goal(STAY, TO, speed=1.2, circle=radius)
    for off in (3 + 4j, -9 + 2j, -1 - 12j):
        at = plane(TO) + off
        found = command(goal, LAW, (at.real, at.imag, 1.0), PAST)
        way = math.copysign(1, radius)
        across = way * (abs(radius) - abs(off))
        tangent = cmath.phase(off) + way * math.pi / 2
        turned(found.heading, tangent - math.atan((across + 0.75) / 6))
        assert found.across == pytest.approx(across)
        assert (found.motion, found.speed, found.depth) == (STAY, 1.2, 9.0)
        assert found.distance == pytest.approx(abs(off))
        assert found.integral_rate == pytest.approx(6 * across / ((across + 0.75) ** 2 + 36))


@pytest.mark.parametrize(
    ("off", "away", "speed"),
    # Rest to the drift limit, 4 m; then at 0.4 / s of the distance, to 1.5 m.
    [
        *((3.9, False, 0.0), (4.1, False, 1.64), (9.0, False, 2.0)),
        *((3.9, True, 1.56), (1.6, True, 0.64), (1.4, True, 0.0)),
    ],
)
def test_staying_at_rest_goes_back_from_the_drift_limit(off, away, speed):
    way = cmath.rect(off, 2.2)
    at = plane(TO) + way
    past = PAST._replace(away=away)
    found = command(Goal(STAY, TO, speed=2.0), LAW, (at.real, at.imag, 1.0), past)
    assert found.speed == pytest.approx(speed)
    assert found.away == (speed > 0)
    turned(found.heading, 2.2 + math.pi if speed else 0.6)
    assert (found.motion, found.depth) == (STAY, 9.0)
    assert found.distance == pytest.approx(off)


@pytest.mark.parametrize(("off", "speed"), [(3.5, 0.0), (5.5, 0.6), (12.0, 2.0)])
def test_a_weather_vane_stays_at_the_drift_limit(off, speed):
    at = plane(TO) + cmath.rect(off, -0.9)
    law = LAW._replace(vanes=True)
    found = command(Goal(STAY, TO, speed=2.0), law, (at.real, at.imag, 1.0), PAST)
    assert found.speed == pytest.approx(speed)
    turned(found.heading, math.pi - 0.9 if speed else 0.6)
    assert (found.motion, found.depth) == (STAY, 9.0)
    assert found.distance == pytest.approx(off)


@pytest.mark.parametrize(("heading", "steered"), [(None, 0.6), (-1.3, -1.3)])
def test_a_heading_is_steered_at_its_speed_and_depth(heading, steered):
    found = command(Goal(STEER, TO, speed=0.9, heading=heading), LAW, FROM, PAST)
    assert (found.motion, found.heading, found.speed, found.depth) == (STEER, steered, 0.9, 9.0)
