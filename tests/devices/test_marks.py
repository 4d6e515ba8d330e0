"""Marks: passed in their order, by the true track alone."""

import pytest

from seatrial.devices.marks import Marks
from seatrial.errors import InputError

PLACES = ((10.0, 0.0, 0.0), (10.0, 10.0, 4.0))


def made(**values):
    marks = Marks("marks")
    places = {f"waypoint_{number}": place for number, place in enumerate(PLACES, 1)}
    for name, value in {"count": 2.0, "radius": 2.0, **places, **values}.items():
        marks.set(name, value)
    marks.setup(0.0)
    marks.initialise()
    marks.begin()
    return marks


def sailed(marks, *track):
    """Move along a track, 0.1 s from place to place; return what is passed after each."""
    passed = []
    for number, position in enumerate(track):
        marks.set("position", position)
        marks.advance(0.1 * number, 0.1)
        passed.append((marks.get("passed"), marks.get("left")))
    return passed


def test_they_are_passed_in_their_order_within_the_margin():
    marks = made()
    track = [
        (10.0, 10.0, 4.0),
        (6.9, 0.0, 0.0),
        (7.1, 0.0, 0.0),
        (10.0, 10.0, 0.9),
        (10.0, 10.0, 1.1),
    ]
    # Within 1.5 times 2 m: neither the second before the first, nor 3.1 m off, also in depth.
    assert sailed(marks, *track) == [(0, 2), (0, 2), (1, 1), (1, 1), (2, 0)]
    marks.set("position", (10.0, 13.0, 8.0))
    marks.advance(0.5, 0.1)
    assert marks.get("distance") == pytest.approx(5.0)  # 3, 4, 5: to the last one


def test_the_distance_is_that_of_now():
    marks = made()
    marks.set("position", (7.0, 4.0, 0.0))
    marks.initialise()
    assert marks.get("distance") == pytest.approx(5.0)


def test_a_failsafe_is_remembered():
    marks = made()
    sailed(marks, (0.0, 0.0, 0.0))
    assert not marks.get("failsafe")
    marks.set("reported", True)
    marks.advance(0.1, 0.1)
    marks.set("reported", False)
    marks.advance(0.2, 0.1)
    assert marks.get("failsafe")


@pytest.mark.parametrize(
    ("values", "said"),
    [({"count": 1.5}, r"marks.count is 1.5, a whole"), ({"radius": 0.0}, "marks.radius is 0")],
)
def test_what_is_no_list_of_marks_is_refused(values, said):
    with pytest.raises(InputError, match=said):
        made(**values)


def test_an_estimate_is_compared_with_the_truth_of_its_time():
    marks = made()
    for number in range(20):  # at 1 m/s to the north, the estimate half a second late
        marks.set("position", (0.1 * number, 2.0, 0.0))
        marks.set("estimated", number > 6)
        marks.set("estimate", (0.1 * number - 0.5 + 0.3, 2.4, 0.0))
        marks.set("estimate_time", 0.1 * number - 0.5)
        marks.set("home", (3.0, -4.0, 0.0))
        marks.advance(0.1 * number, 0.1)
        if number < 6:
            assert (marks.get("error"), marks.get("home_error")) == (0.0, 0.0)
    assert marks.get("error") == pytest.approx(0.5)  # 0.3 north, 0.4 east
    assert marks.get("home_error") == pytest.approx(5.0)
