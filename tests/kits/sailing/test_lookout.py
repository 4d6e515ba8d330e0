"""Headings clear of obstacles, against geometry."""

import math

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from seatrial_kits.sailing.control.lookout import Sighting, clear_heading, placed, watched

DEG = math.radians(1)


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


def test_everything_is_seen_from_where_the_boat_is():
    seen = placed(0.7, 2 * math.asin(0.25 / 20.0), 0.5, (5.0, -9.0, 0.0), -2.0)
    there = complex(5.0, -9.0) + 20.0 * complex(math.cos(-1.3), math.sin(-1.3))
    assert (seen.north, seen.east) == pytest.approx((there.real, there.imag))
    assert placed(0.7, 9.0, 0.5, (5.0, -9.0, 0.0), -2.0).distance == 0.25  # fills the sight
    assert placed(0.7, 0.0, 0.5, (5.0, -9.0, 0.0), -2.0) is None
    marks = [(40.0, 3.0), (25.0, -14.0)]
    moved = [(north + 5.0, east - 9.0) for north, east in marks]
    for wanted in (0.0, 0.1, -0.5):
        at_home = clear_heading(wanted, marks, (0, 0, 0), 8.0, math.pi, 0.8, 0.2)
        away = clear_heading(wanted, moved, (5.0, -9.0, 0.0), 8.0, math.pi, 0.8, 0.2)
        assert away == pytest.approx(at_home)
        assert away != wanted


def test_within_the_clearance_it_turns_a_quarter_away():
    found = clear_heading(0.1, [(3.0, 0.0)], (0, 0, 0), 8.0, math.pi, 0.5, 0.0)
    assert found == pytest.approx(math.pi / 2)


def test_a_sighting_belongs_to_the_nearest_track_within_its_gate():
    tracks = [[0.0, 30.0, 0.0, 4.0], [0.0, 12.0, 0.0, 2.0]]
    # Of 30 m the gate is 5 m + 10 m: 14.9 m off the one, 3.1 m off the other.
    near = watched(tracks, [Sighting(0.0, 15.1, 30.0)], 1.0, 5.0)
    assert [track[3] for track in near] == [4.0, 3.0]
    assert near[1][1] == pytest.approx(12.0 + 0.4 * 3.1)
    for off, count in ((14.9, 2), (15.1, 3)):
        assert len(watched(tracks, [Sighting(0.0, 30.0 + off, 30.0)], 1.0, 5.0)) == count


@pytest.mark.parametrize(("off", "turned"), [(14.5, 1), (15.5, -1)])
def test_the_side_that_was_taken_is_left_for_a_turn_that_is_30_degrees_less(off, turned):
    half = math.asin(0.8)
    found = clear_heading(-off * DEG, [(10.0, 0.0)], (0, 0, 0), 8.0, math.pi, 0.5, 0.1)
    assert found == pytest.approx(turned * half)
