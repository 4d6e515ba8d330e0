"""Buoys and moving obstacles against straight lines and a taut mooring."""

import math

import pytest

from seatrial.errors import InputError
from seatrial_kits.sailing.floating import Buoy, MovingObstacle
from tests.devices.running import started


def after(component, seconds, h=0.1):
    for k in range(round(seconds / h)):
        component.advance(k * h, h)
    return component.get("position")


def test_adrift_it_goes_with_the_water_and_a_share_of_the_wind():
    buoy = started(
        Buoy, swing=-1.0, anchor=[5, 6], current=[0.3, -0.1], wind=[0.0, 5.0], leeway=0.02
    )
    assert after(buoy, 100) == pytest.approx([5 + 30, 6 - 10 + 10, 0])
    assert buoy.get("velocity") == pytest.approx([0.3, 0.0])


@pytest.mark.parametrize("h", [0.1, 2.0])
def test_moored_it_ends_down_the_drift(h):
    buoy = started(Buoy, swing=4.0, offset=[-2, 3], current=[0.3, 0.4])
    assert after(buoy, 400, h) == pytest.approx([4 * 0.6, 4 * 0.8, 0], abs=1e-3)
    buoy.set("current", [-0.3, 0.4])
    for k in range(4000):
        buoy.advance(400 + 0.1 * k, 0.1)
        assert math.hypot(*buoy.get("position")[:2]) <= 4.0 + 1e-9
    assert buoy.get("position") == pytest.approx([-2.4, 3.2, 0], abs=1e-3)


def test_the_sea_of_a_trial_carries_it():
    buoy = started(Buoy, swing=-1.0, current_speed=0.5, current_direction=math.pi / 2)
    assert after(buoy, 10) == pytest.approx([0, 5, 0])


@pytest.mark.parametrize("kind", [Buoy, MovingObstacle])
def test_a_stream_that_turns_is_met_in_the_middle_of_a_step(kind):
    # U sin(w t) over one step: 1 - cos(w h); the middle has that but for (w h)^2 / 24.
    w, h = math.tau / 1000, 50.0
    tide = {"current_tide": 2.0, "current_tide_period": 1000.0, "current_tide_phase": -math.pi / 2}
    drifting = started(kind, **tide, **({"swing": -1.0} if kind is Buoy else {}))
    drifting.advance(0.0, h)
    north = 2.0 / w * (1 - math.cos(w * h))
    assert abs(drifting.get("position")[0]) == pytest.approx(north, rel=(w * h) ** 2 / 20)


def test_held_where_it_is():
    assert after(started(Buoy, anchor=[7, 8], current=[1, 1]), 10) == [7, 8, 0]


def test_a_place_that_the_mooring_does_not_allow():
    with pytest.raises(InputError, match="swing allows 1 m"):
        started(Buoy, swing=1.0, offset=[3, 0])


def test_along_waypoints_round_their_corners():
    path = {"count": 2, "waypoint_1": [10, 0, 0], "waypoint_2": [10, 5, 0], "cruise": 2.0}
    for seconds, place in ((3, [6, 0, 0]), (6, [10, 2, 0]), (20, [10, 5, 0])):
        assert after(started(MovingObstacle, **path), seconds, 0.5) == pytest.approx(place)
        assert after(started(MovingObstacle, **path), seconds, 0.05) == pytest.approx(place)
    obstacle = started(MovingObstacle, **path)
    after(obstacle, 3)
    assert obstacle.get("velocity") == pytest.approx([2, 0])
    assert obstacle.get("kind") == 2


def test_a_mooring_lies_where_its_anchor_does():
    drift = {"current": [0.3, 0.1], "wind": [2.0, -5.0], "leeway": 0.05}
    buoy = started(Buoy, swing=4.0, anchor=[30.0, -20.0], offset=[1.0, 2.0], **drift)
    assert buoy.get("position") == [31.0, -18.0, 0.0]
    buoy.advance(0.0, 2.0)
    assert buoy.get("position") == pytest.approx([31.8, -18.3, 0.0])
    assert buoy.get("velocity") == pytest.approx([0.4, -0.15])
    size = math.hypot(0.4, 0.15)
    after(buoy, 400)
    there = [30 + 4 * 0.4 / size, -20 - 4 * 0.15 / size, 0.0]
    assert buoy.get("position") == pytest.approx(there, abs=1e-3)


def test_an_obstacle_goes_round_corners_from_where_it_begins():
    goals = {"count": 2.0, "waypoint_1": [13.0, -16.0, 5.0], "waypoint_2": [13.0, -4.0, 0.0]}
    obstacle = started(MovingObstacle, begins_at=[10.0, -20.0], cruise=2.0, **goals)
    # 5 m to the first, at 2 m/s, then 12 m east.
    for seconds, place in ((2.0, [12.4, -16.8]), (2.0, [13.0, -13.0]), (9.0, [13.0, -4.0])):
        obstacle.advance(obstacle.now, seconds)
        assert obstacle.get("position") == pytest.approx([*place, 0.0])
    assert obstacle.get("velocity") == pytest.approx([0.0, 1.0])
    assert obstacle.get("kind") == 2
