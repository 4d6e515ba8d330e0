"""Courses round marks, against geometry."""

import itertools
import math

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from seatrial.control.course import Course
from seatrial.control.rounding import rounded
from seatrial.errors import InputError
from tests.devices.running import started

DEG = math.radians(1)
places = st.tuples(st.floats(-200, 200), st.floats(-200, 200), st.just(0.0))


def cross(a, b, c):
    """Return twice the area of a triangle, positive if c lies to starboard of a to b."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


@given(places, places, places, st.sampled_from([1, -1]))
def test_a_mark_stays_on_its_side(start, mark, end, side):
    assume(min(math.dist(start, mark), math.dist(mark, end)) > 40)
    assume(abs(math.remainder(_bearing(start, mark) - _bearing(end, mark), math.tau)) > 5 * DEG)
    points = [point for point, _ in rounded(start, [mark, end], [side, 0], 10.0)]
    track = [start, *points]
    for point in points[:-1]:
        assert math.dist(point, mark) == pytest.approx(10.0)
    for a, b in itertools.pairwise(track):
        closest = _distance(a, b, mark)
        assert closest > 10.0 * math.cos(31 * DEG) - 1e-6
    winding = sum(
        math.remainder(_bearing(mark, b) - _bearing(mark, a), math.tau)
        for a, b in itertools.pairwise(track)
    )
    # Left to port, bearings from the mark turn anticlockwise, which is negative.
    assert winding * side <= 1e-9


def _bearing(a, b):
    return math.atan2(b[1] - a[1], b[0] - a[0])


def _distance(a, b, point):
    length = math.dist(a, b)
    along = sum((b[i] - a[i]) * (point[i] - a[i]) for i in (0, 1)) / length**2
    along = min(max(along, 0.0), 1.0)
    return math.hypot(*(a[i] + along * (b[i] - a[i]) - point[i] for i in (0, 1)))


def test_half_round_a_mark_to_port():
    """There and back north, the mark to port: past its east side first, then north, then west."""
    points = rounded((0, 0, 0), [(100, 0, 0), (0, 0, 0)], [1, 0], 10.0)
    assert [[round(x, 6) for x in point[:2]] for point, _ in points[:-1]] == [
        [100, 10],
        [round(100 + 10 * math.sin(60 * DEG), 6), 5],
        [round(100 + 10 * math.sin(60 * DEG), 6), -5],
        [100, -10],
    ]
    assert [number for _, number in points] == [0, 0, 0, 1, 2]


def test_a_course_counts_marks_and_legs():
    marks = {"count": 2, "waypoint_1": [100, 0, 0], "waypoint_2": [0, 0, 0]}
    course = started(Course, **marks, sides="port", clearance=10.0)
    counted = []
    for k in range(60):
        course.set("reached", course.get("leg"))
        course.advance(0.1 * k, 0.1)
        counted.append((course.get("passed"), course.get("rounded")))
    assert counted[-1] == (5, 2)
    assert (4, 1) in counted
    plain = started(Course, **marks)
    assert plain.get("leg_to") == [100, 0, 0]


@pytest.mark.parametrize(
    ("sides", "named"), [("left", "left"), ("port any starboard", "3 words, there are 1")]
)
def test_sides_that_cannot_be(sides, named):
    with pytest.raises(InputError, match=named):
        started(Course, sides=sides)
