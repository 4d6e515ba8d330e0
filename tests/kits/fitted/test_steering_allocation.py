"""Angles of propulsors that turn: directions, ranges, ahead or astern."""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from seatrial_kits.fitted.allocation.steering import (
    Shares,
    Turning,
    angle_for,
    as_one,
    fitting,
    with_directions,
)

DEG = math.pi / 180.0
angles = st.floats(-10.0, 10.0)


def part(least=-1e9, most=1e9, astern=0.5):
    return Turning(np.zeros(3), np.zeros(3), least, most, astern, 1.0)


def force(size, angle):
    return size * np.array([math.cos(angle), math.sin(angle)])


@given(angles, angles, angles, st.floats(0.0, 1.0))
def test_a_fitting_angle_is_the_nearest_of_all_turns(direction, one, other, share):
    least, most = min(one, other), max(one, other)
    now = least + share * (most - least)
    every = [direction + math.tau * turns for turns in range(-8, 9)]
    inside = [angle for angle in every if least <= angle <= most]
    assume(all(min(abs(a - least), abs(a - most)) > 1e-9 for a in every))
    found = fitting(direction, least, most, now)
    if not inside:
        assert found is None
    else:
        nearest = min(abs(angle - now) for angle in inside)
        assert abs(found - now) == pytest.approx(nearest, abs=1e-9)


@given(st.floats(-170.0, 170.0), st.integers(-3, 3))
def test_an_endless_one_turns_the_nearest_way(direction, turns):
    now = 150.0 * DEG + math.tau * turns
    found = angle_for(part(astern=0.0), force(1.0, direction * DEG), now)
    assert math.remainder(found - direction * DEG, math.tau) == pytest.approx(0.0, abs=1e-9)
    assert abs(found - now) <= math.pi + 1e-9


@pytest.mark.parametrize(
    ("size", "direction", "expected"),
    [
        (0.3, 170.0, -10.0),  # astern, the nearer, has enough
        (0.6, 170.0, 170.0),  # more than it has astern
        (0.3, 80.0, 80.0),
        (0.3, -100.0, 80.0),
    ],
)
def test_the_nearer_of_ahead_and_astern_is_taken_if_astern_is_enough(size, direction, expected):
    assert angle_for(part(), force(size, direction * DEG), 0.0) == pytest.approx(expected * DEG)


@pytest.mark.parametrize(
    ("direction", "astern", "expected"),
    [
        (20.0, 0.5, 20.0),
        (160.0, 0.5, -20.0),  # the sector astern
        (60.0, 0.5, 30.0),
        (110.0, 0.5, -30.0),
        (110.0, 0.0, 30.0),  # nothing astern
        (-170.0, 0.0, -30.0),
    ],
)
def test_in_a_sector_the_end_that_gives_the_most_is_taken(direction, astern, expected):
    sector = part(-30.0 * DEG, 30.0 * DEG, astern)
    found = angle_for(sector, force(0.4, direction * DEG), 0.0)
    assert found == pytest.approx(expected * DEG)


def test_abeam_an_end_is_not_left_for_a_little_more():
    sector = part(-30.0 * DEG, 30.0 * DEG)
    for now in (-30.0, 30.0):
        for direction in (89.0, 91.0):
            assert angle_for(sector, force(0.4, direction * DEG), now * DEG) == now * DEG


def test_two_on_one_steering_angle_give_their_sum_and_what_the_weaker_can():
    one = Turning([1.0, 2.0, 3.0], [4.0, 5.0, 6.0], -0.4, 0.7, 0.5, 0.8)
    other = Turning([10.0, 30.0, 20.0], [50.0, 40.0, 70.0], -9.0, 9.0, 0.3, 0.9)
    third = Turning([0.1, 0.2, 0.4], [0.5, 0.6, 0.8], -9.0, 9.0, 0.6, 0.7)
    found = as_one([one, other, third])
    np.testing.assert_allclose(found.along, [11.1, 32.2, 23.4])
    np.testing.assert_allclose(found.abeam, [54.5, 45.6, 76.8])
    assert found[2:] == (-0.4, 0.7, 0.3, 0.7)


def test_parts_that_turn_stand_beside_the_others_with_what_they_can():
    turning = Turning([1.0, 2.0], [-3.0, 5.0], -4.0, 4.0, 0.3, 0.8)
    found = with_directions(Shares([[7.0, 8.0]], [-0.1], [0.2]), [turning], [0.6])
    along, abeam = np.array([1.0, 2.0]), np.array([-3.0, 5.0])
    expected = math.cos(0.6) * along + math.sin(0.6) * abeam
    np.testing.assert_allclose(found.columns, [[7.0, 8.0], expected])
    assert (list(found.low), list(found.high)) == ([-0.1, -0.3], [0.2, 0.8])
