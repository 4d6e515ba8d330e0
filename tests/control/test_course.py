import pytest

from seatrial.control.course import Course
from seatrial.errors import InputError
from tests.devices.running import started

PLACES = {
    "count": 3.0,
    "start_point": [0.0, 0.0, 1.0],
    "waypoint_1": [10.0, 0.0, 2.0],
    "waypoint_2": [10.0, 20.0, 3.0],
    "waypoint_3": [0.0, 20.0, 4.0],
}


def test_one_leg_after_the_other():
    found = started(Course, **PLACES, speed=0.7, radius=2.5, wait=4.0)
    rows = []
    for k, reached in enumerate([0, 0, 1, 1, 0, 2, 3, 3, 0]):
        found.set("reached", reached)
        rows.append((found.get("leg"), found.get("passed")))
        found.advance(0.1 * k, 0.1)
    # What is reached counts from the next instant; a leg that is behind is not reached again.
    assert rows == [*[(1, 0)] * 3, *[(2, 1)] * 3, (3, 2), (3, 3), (3, 3)]
    assert found.get("leg_from") == PLACES["waypoint_2"]
    assert found.get("leg_to") == PLACES["waypoint_3"]
    assert [found.get(f"leg_{name}") for name in ("speed", "radius", "wait")] == [0.7, 2.5, 4.0]


def test_the_first_leg_begins_at_the_start_point():
    found = started(Course, **PLACES)
    assert found.get("leg") == 1
    assert found.get("leg_from") == [0.0, 0.0, 1.0]
    assert found.get("leg_to") == [10.0, 0.0, 2.0]


def test_refuses_a_broken_number_of_waypoints():
    with pytest.raises(InputError, match=r"count is 2\.5, a whole number is needed"):
        started(Course, count=2.5)
    with pytest.raises(InputError, match=r"count is 9\.0 1, allowed 1\.0 to 8\.0"):
        started(Course, count=9.0)
