import itertools
import math

import pytest

from seatrial.control.sailing_guidance import SailingGuidance
from seatrial.errors import InputError
from tests.devices.running import started

DEG = math.radians(1.0)
NORTHERLY = [-5.0, 0.0]  # it blows to the south: the eye of the wind is north
UNDER_WAY = {"wind": NORTHERLY, "speed": 2.0, "turn_rate": 1e3, "lead": math.pi}


def guidance(mark=(0.0, 0.0), position=(0.0, 0.0), heading=90.0, **changes):
    values = {**UNDER_WAY, "mark_1": list(mark), "position_n": [*position, 0.0]}
    return started(SailingGuidance, **{**values, "heading": heading * DEG, **changes})


def at(bearing, distance=100.0):
    return distance * math.cos(bearing * DEG), distance * math.sin(bearing * DEG)


def wrapped(angle):
    return math.degrees(math.remainder(angle, math.tau))


@pytest.mark.parametrize("bearing", [60, 90, 179, -150, -66])
def test_heads_for_a_mark_off_the_wind(bearing):
    found = guidance(at(bearing), heading=bearing)
    assert wrapped(found.get("course")) == pytest.approx(bearing)
    assert wrapped(found.get("heading_wanted")) == pytest.approx(bearing)
    assert found.get("distance") == pytest.approx(100.0)


@pytest.mark.parametrize(
    ("bearing", "heading", "course"),
    [
        *((0, 90, 60), (0, -90, -60), (30, 90, 60), (-30, 90, 60), (59, 90, 60)),
        *((-64, 90, 60), (-66, 90, -66)),  # the other tack from 65 degrees on
    ],
)
def test_an_upwind_mark_is_left_to_the_tack_that_it_is_on(bearing, heading, course):
    assert wrapped(guidance(at(bearing), heading=heading).get("course")) == pytest.approx(course)


def turns(heading, course, count=400):
    """Return the headings wanted, deg, of a boat that follows them at once."""
    found = guidance(at(course, 1e5), heading=heading, turn_rate=6 * DEG)
    headings, wearing = [heading], []
    for k in range(count):
        wanted = found.get("heading_wanted")
        headings.append(headings[-1] + wrapped(wanted - headings[-1] * DEG))
        wearing.append(found.get("wearing"))
        found.advance(0.1 * k, 0.1)
        found.set("heading", wanted)
    return headings, wearing


@pytest.mark.parametrize(
    ("heading", "course", "turned"),
    [(90, 150, 60), (150, -150, 60), (80, -80, 200), (-80, 80, -200), (170, -100, 90)],
)
def test_turns_at_the_rate_and_never_through_the_eye_of_the_wind(heading, course, turned):
    headings, wearing = turns(heading, course)
    assert headings[-1] - heading == pytest.approx(turned, abs=1e-6)
    steps = [b - a for a, b in itertools.pairwise(headings)]
    assert max(map(abs, steps)) <= 0.6 + 1e-9
    assert all(abs(wrapped(h * DEG)) > 60 for h in headings)
    assert any(wearing) == (abs(turned) > 180)


def test_the_heading_wanted_waits_for_the_boat():
    found = guidance(at(180, 1e5), heading=90, turn_rate=6 * DEG, lead=20 * DEG)
    for k in range(200):
        found.advance(0.1 * k, 0.1)
    assert wrapped(found.get("heading_wanted")) == pytest.approx(110.0, abs=0.6)


def test_marks_are_passed_one_after_the_other():
    marks = {"count": 2.0, "mark_1": [0.0, 50.0], "mark_2": [0.0, 100.0], "radius": 8.0}
    found, rows = started(SailingGuidance, **UNDER_WAY, **marks, heading=math.pi / 2), []
    for k in range(60):
        found.set("position_n", [0.0, 2.0 * k, 0.0])
        rows.append((found.get("passed"), found.get("distance")))
        found.advance(0.1 * k, 0.1)
    # At 42 m the first is at 8 m, which is not within; 44 m is. The course is kept afterwards.
    assert [passed for passed, _ in rows] == [0] * 22 + [1] * 25 + [2] * 13
    assert rows[30][1] == pytest.approx(40.0)
    assert wrapped(found.get("course")) == pytest.approx(90.0)


def test_without_way_it_bears_away_until_it_has_way_again():
    found, courses = guidance(at(70, 1e5), heading=70, steerage=0.5, recovered=2.0), []
    for k, speed in enumerate([0.6, 0.4, 0.6, 0.9, 1.1, 0.6]):
        found.set("speed", speed)
        courses.append(wrapped(found.get("course")))
        found.advance(0.1 * k, 0.1)
    assert courses == pytest.approx([70, 110, 110, 110, 70, 70], abs=1e-6)


def test_without_a_position_nothing_changes():
    found = guidance(at(90), heading=50, position_valid=False)
    assert wrapped(found.get("heading_wanted")) == pytest.approx(50)
    found.set("position_valid", True)
    assert wrapped(found.get("heading_wanted")) == pytest.approx(90)
    found.advance(0.0, 0.1)
    found.set("position_valid", False)
    found.set("heading", 0.0)
    assert wrapped(found.get("heading_wanted")) == pytest.approx(90)


@pytest.mark.parametrize("mark", [(300.0, 0.0), (250.0, 120.0)])
def test_beats_to_a_mark_upwind(mark):
    """A boat of 2 m/s that turns as it is told, without leeway."""
    found = guidance(mark, heading=100, turn_rate=6 * DEG, radius=12.0)
    north = east = 0.0
    tacks = set()
    for k in range(10_000):
        heading = found.get("heading_wanted")
        assert abs(wrapped(heading)) > 59.9
        tacks.add(math.copysign(1.0, wrapped(heading)))
        if found.get("passed"):
            break
        found.advance(0.1 * k, 0.1)
        north += 0.2 * math.cos(heading)
        east += 0.2 * math.sin(heading)
        found.set("heading", heading)
        found.set("position_n", [north, east, 0.0])
    assert found.get("passed") == 1
    assert tacks == {1.0, -1.0}


def test_refuses_a_broken_number_of_marks():
    with pytest.raises(InputError, match=r"count is 1\.5, a whole number is needed"):
        started(SailingGuidance, count=1.5)
