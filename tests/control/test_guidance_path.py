import math

import pytest

from seatrial.control.guidance_path import (
    bearing,
    distance,
    from_circle,
    from_leg,
    integral_rate,
    line_of_sight,
)

DEG = math.radians(1.0)


def at(bearing_deg, far, centre=(0.0, 0.0, 0.0)):
    angle = bearing_deg * DEG
    return centre[0] + far * math.cos(angle), centre[1] + far * math.sin(angle), centre[2]


@pytest.mark.parametrize("course", [0, 30, 90, 179, -179, -90, 180])
@pytest.mark.parametrize(("along", "across"), [(3.0, 4.0), (-2.0, 1.0), (60.0, -5.0)])
def test_offset_from_a_leg_in_any_direction(course, along, across):
    start = (7.0, -11.0, 2.0)
    end = at(course, 50.0, start)
    abreast = at(course, along, start)
    found = from_leg(start, end, at(course + 90, across, abreast))
    assert math.remainder(found.course - course * DEG, math.tau) == pytest.approx(0.0, abs=1e-12)
    assert (found.along, found.across) == pytest.approx((along, across))


def test_a_leg_without_a_length_leads_north():
    found = from_leg((1.0, 2.0, 0.0), (1.0, 2.0, 5.0), (4.0, 6.0, 0.0))
    assert found == pytest.approx((0.0, 3.0, 4.0))


@pytest.mark.parametrize(
    ("radius", "place", "course", "across"),
    [
        (10.0, at(0, 12.0), 90, -2.0),  # outside, to port of a clockwise circle
        (10.0, at(90, 7.0), 180, 3.0),
        (-10.0, at(0, 12.0), -90, 2.0),
        (-10.0, at(-45, 7.0), -135, -3.0),
    ],
)
def test_offset_from_a_circle(radius, place, course, across):
    found = from_circle((0.0, 0.0, 0.0), radius, place)
    assert math.remainder(found.course - course * DEG, math.tau) == pytest.approx(0.0, abs=1e-12)
    assert found.across == pytest.approx(across)


@pytest.mark.parametrize(("across", "turn"), [(0.0, 0.0), (5.0, -45.0), (-5.0, 45.0), (1e9, -90.0)])
def test_line_of_sight_aims_a_lookahead_ahead_on_the_path(across, turn):
    offset = from_leg((0.0, 0.0, 0.0), (100.0, 0.0, 0.0), (20.0, across, 0.0))
    heading = line_of_sight(offset, 0.0, 5.0, 0.1)
    assert heading == pytest.approx(turn * DEG, abs=1e-6)
    aimed = (25.0, 0.0, 0.0)
    assert heading == pytest.approx(bearing((20.0, across, 0.0), aimed), abs=1e-6)


def test_integral_counts_as_a_cross_track_error_and_grows_slowly_far_off():
    offset = from_leg((0.0, 0.0, 0.0), (100.0, 0.0, 0.0), (20.0, 1.0, 0.0))
    further = from_leg((0.0, 0.0, 0.0), (100.0, 0.0, 0.0), (20.0, 3.0, 0.0))
    assert line_of_sight(offset, 20.0, 5.0, 0.1) == pytest.approx(
        line_of_sight(further, 0.0, 5.0, 0.1)
    )
    rates = [integral_rate(e, 0.0, 5.0, 0.1) for e in (0.1, 5.0, 500.0)]
    assert rates == pytest.approx([0.1 / 5.0, 0.5, 5.0 / 500.0], rel=1e-3)


def test_distance_and_bearing_are_horizontal():
    assert distance((1.0, 2.0, 9.0), (4.0, -2.0, -9.0)) == 5.0
    assert bearing((1.0, 2.0, 9.0), (1.0, 0.0, 3.0)) == pytest.approx(-math.pi / 2)
