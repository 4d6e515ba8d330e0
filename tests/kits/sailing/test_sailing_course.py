import math

import pytest

from seatrial_kits.sailing.control.course import laid, side, turn, turned

DEG = math.radians(1.0)


def degrees(angle):
    return math.degrees(math.remainder(angle, math.tau))


@pytest.mark.parametrize("wanted", [60, 90, 179, -150, -66])
def test_a_course_off_the_wind_is_laid(wanted):
    found = laid(wanted * DEG, 0.0, side(wanted), 60 * DEG, 5 * DEG)
    assert degrees(found.course) == pytest.approx(wanted)
    assert (found.tack, found.beats) == (math.copysign(1, wanted), False)


@pytest.mark.parametrize("eye", [0, 170, -100])
@pytest.mark.parametrize(
    ("wanted", "tack", "course"),
    [
        *((0, 1, 60), (0, -1, -60), (30, 1, 60), (-30, 1, 60), (59, 1, 60)),
        *((-64, 1, 60), (-66, 1, -66)),  # the other tack from 65 degrees on
    ],
)
def test_upwind_it_stays_on_its_tack(wanted, tack, course, eye):
    found = laid((eye + wanted) * DEG, eye * DEG, tack, 60 * DEG, 5 * DEG)
    assert degrees(found.course - eye * DEG) == pytest.approx(course)
    assert found.beats == (course != wanted)


@pytest.mark.parametrize(
    ("before", "course", "way"),
    [(90, 150, 60), (150, -150, 60), (80, -80, 200), (-80, 80, -200), (170, -100, 90)],
)
def test_no_turn_leads_through_the_eye_of_the_wind(before, course, way):
    assert math.degrees(turn(before * DEG, course * DEG, 0.0)) == pytest.approx(way)


def test_the_heading_wanted_waits_for_the_boat():
    assert turned(0.0, 1.0, 0.1, heading=0.0, lead=0.5) == pytest.approx(0.1)
    assert turned(0.45, 1.0, 0.1, heading=0.0, lead=0.5) == pytest.approx(0.45)
    # It may always come back.
    assert turned(0.6, -1.0, 0.1, heading=0.0, lead=0.3) == pytest.approx(0.5)
