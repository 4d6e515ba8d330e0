"""Courses round marks, and headings clear of obstacles, against geometry."""

import itertools
import math

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from seatrial.control.course import Course
from seatrial.control.lookout import Sighting, clear_heading, placed, watched
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


@pytest.mark.parametrize("bearing", [0.0, 1.0, -2.0])
def test_where_a_sphere_is(bearing):
    there = (30.0 * math.cos(0.4 + bearing), 30.0 * math.sin(0.4 + bearing))
    seen = placed(bearing, 2 * math.asin(0.5 / 30.0), 1.0, (0, 0, 0), 0.4)
    assert seen[:2] == pytest.approx(there)
    assert seen.distance == pytest.approx(30.0)


def test_tracks_of_what_was_seen():
    tracks = watched([], [Sighting(30, -8, 31), Sighting(0, 50, 50)], 0.0, 5.0)
    tracks = watched(tracks, [Sighting(31, -5, 31)], 1.0, 5.0)
    assert [track[3] for track in tracks] == [2, 1]
    assert 30 < tracks[0][0] < 31
    assert tracks[0][1] + 8 == pytest.approx(3 * (tracks[0][0] - 30))
    assert len(watched(tracks, [], 5.5, 5.0)) == 1
    assert watched(tracks, [], 7.0, 5.0) == []


@given(
    st.floats(-3, 3),
    st.lists(st.tuples(st.floats(-50, 50), st.floats(-50, 50)), max_size=4),
    st.floats(-3, 3),
)
def test_a_clear_heading_is_clear(wanted, obstacles, eye):
    clearance = 8.0
    assume(all(math.hypot(*each) > clearance for each in obstacles))
    heading = clear_heading(wanted, obstacles, (0, 0, 0), clearance, eye, 60 * DEG, 0.0)
    if heading == wanted:
        return
    for north, east in obstacles:
        off = math.remainder(heading - math.atan2(east, north), math.tau)
        if abs(off) < math.pi / 2:
            assert math.hypot(north, east) * abs(math.sin(off)) >= clearance - 1e-6
    assert abs(math.remainder(heading - eye, math.tau)) >= 60 * DEG


def test_the_nearer_side_and_then_the_same():
    place, eye = [(40.0, 1.0)], math.pi
    args = (place, (0, 0, 0), 8.0, eye, 1.0)
    port = clear_heading(0.0, *args, 0.0)
    half, off = math.asin(8.0 / math.hypot(40, 1)), math.atan2(1, 40)
    assert port == pytest.approx(off - half)
    assert clear_heading(0.0, *args, 0.3) == pytest.approx(off + half)
    assert clear_heading(2.0, *args, 0.0) == 2.0
    # Not into the wind.
    assert clear_heading(0.0, place, (0, 0, 0), 8.0, off - half, 1.2, 0.0) == pytest.approx(0.0)
