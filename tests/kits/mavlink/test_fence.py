import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from pymavlink.dialects.v20 import all as mavlink
from scipy.spatial import ConvexHull, Delaunay, QhullError

from seatrial.errors import InputError
from seatrial_kits.mavlink.missions.fence_zones import Zone, is_allowed

from .bench import Bench
from .ground import FENCE, RALLY, listed, north_of, one, upload

NONE, FLOOR, BOUNDARY = 0, 1, 3
OK, DENIED = mavlink.MAV_RESULT_ACCEPTED, mavlink.MAV_RESULT_DENIED
ENABLE = mavlink.MAV_CMD_DO_FENCE_ENABLE
STATUS, HEALTH = mavlink.MAVLINK_MSG_ID_FENCE_STATUS, mavlink.MAVLINK_MSG_ID_SYS_STATUS
FENCED = mavlink.MAV_SYS_STATUS_GEOFENCE

metres = st.floats(-100.0, 100.0)
points = st.tuples(metres, metres)


def polygon(corners, inclusion=True, group=0):
    return Zone(inclusion, group, tuple((n, e, 0.0) for n, e in corners), 0.0)


def circle(centre, radius, inclusion=True, group=0):
    return Zone(inclusion, group, ((*centre, 0.0),), radius)


def place(point):
    return (*point, 3.0)


# ---------------------------------------------------------------------- geometry


@pytest.mark.slow
@given(st.lists(points, min_size=3, max_size=9), st.lists(points, min_size=1, max_size=20))
def test_convex_polygons_contain_what_a_triangulation_does(corners, tried):
    try:
        hull = ConvexHull(np.array(corners))
    except QhullError:
        assume(False)
    assume(hull.volume > 1.0)
    ring = [tuple(hull.points[k]) for k in hull.vertices]
    triangles = Delaunay(np.array(ring))
    for point in tried:
        distances = hull.equations @ np.array([*point, 1.0])
        if np.abs(distances).min() > 1e-6:  # on the edge either is right
            inside = bool(triangles.find_simplex(np.array(point)) >= 0)
            for corners in (ring, ring[::-1]):  # both ways round
                assert polygon(corners).contains(place(point)) == inside


@given(st.integers(3, 12), points, st.randoms(use_true_random=False))
def test_stars_contain_what_is_nearer_than_their_edge(count, point, random):
    # Seen from its centre, a star's edge is at one distance in each direction.
    radii = [random.uniform(10.0, 90.0) for _ in range(2 * count)]
    angles = [math.pi * k / count for k in range(2 * count)]
    corners = [(r * math.cos(a), r * math.sin(a)) for r, a in zip(radii, angles, strict=True)]
    rho, angle = math.hypot(*point), math.atan2(point[1], point[0]) % math.tau
    k = min(int(angle / (math.pi / count)), 2 * count - 1)
    (n1, e1), (n2, e2) = corners[k], corners[(k + 1) % len(corners)]
    c, s = math.cos(angle), math.sin(angle)
    edge = (n1 * e2 - n2 * e1) / (c * (e2 - e1) - s * (n2 - n1))
    assume(abs(rho - edge) > 1e-6)
    assert polygon(corners).contains(place(point)) == (rho < edge)


@given(points, st.floats(0.1, 80.0), points)
def test_circles(centre, radius, point):
    away = math.dist(centre, point)
    assume(abs(away - radius) > 1e-9)
    assert circle(centre, radius).contains(place(point)) == (away < radius)


@pytest.mark.parametrize(
    ("zones", "allowed"),
    [
        ([], True),
        ([circle((0, 0), 5)], True),
        ([circle((0, 0), 5), circle((20, 0), 5)], False),  # in all of a group
        ([circle((0, 0), 5), circle((20, 0), 5, group=1)], True),  # in one of the groups
        ([circle((20, 0), 5, group=1), circle((30, 0), 5, group=2)], False),
        ([circle((0, 0), 5, inclusion=False)], False),
        ([circle((20, 0), 5, inclusion=False)], True),
        ([circle((0, 0), 9), circle((0, 0), 5, inclusion=False)], False),
    ],
)
def test_zones_together(zones, allowed):
    assert is_allowed(zones, (0.0, 0.0, 0.0)) == allowed


# ---------------------------------------------------------------------- service

SQUARE = [north_of(*at) for at in ((-50, -50), (50, -50), (50, 50), (-50, 50))]
ZONES = listed(
    *(one(5001, 4.0, at=at) for at in SQUARE), one(5004, 10.0, at=north_of(30)), kind=FENCE
)


class Fenced(Bench):
    """A bench inside a square of 100 m with a forbidden circle of 10 m in the north of it."""

    def __init__(self, items=ZONES, **bench):
        super().__init__(**bench)
        assert upload(self, items, FENCE) == 0
        self.tick()
        self.transport.take()

    def be(self, north, east=0.0, down=0.0):
        self.measure(position_n=(north, east, down))
        self.tick()

    def status(self):
        m = self.one(STATUS)
        return m.breach_status, m.breach_type, m.breach_count

    def is_healthy(self):
        m = self.one(HEALTH)
        assert m.onboard_control_sensors_present & FENCED
        assert m.onboard_control_sensors_enabled & FENCED
        return bool(m.onboard_control_sensors_health & FENCED)


@pytest.mark.parametrize("where", [(51.0, 0.0), (0.0, -51.0), (30.0, 5.0)])
def test_a_breach_holds_and_is_reported(where):
    boat = Fenced()
    boat.arm()
    boat.enter("manual")
    boat.tick()
    assert boat.status() == (0, NONE, 0)
    assert boat.is_healthy()
    boat.wait(0.5)
    boat.transport.take()
    boat.be(*where)
    (reported,) = boat.transport.take("FENCE_STATUS", None)
    assert (reported.breach_status, reported.breach_type, reported.breach_count) == (1, BOUNDARY, 1)
    assert reported.breach_time == round(boat.now * 1e3)
    assert boat.vehicle.mode.name == "hold"
    assert boat.vehicle.failsafe
    assert "Failsafe: outside the fence, hold" in [
        m.text for m in boat.transport.take("STATUSTEXT")
    ]
    assert not boat.is_healthy()


def test_return_leads_to_the_nearest_place():
    boat = Fenced(fence_action="return")
    upload(boat, listed(one(5100, at=north_of(40, 40)), kind=RALLY), RALLY)
    boat.arm()
    boat.enter("manual")
    boat.be(48.0, 48.0)
    boat.be(51.0, 51.0)
    assert boat.vehicle.mode.name == "return"
    assert boat.node.rally.refuge[:2] == pytest.approx((40.0, 40.0), abs=0.01)


def test_a_breach_is_over_when_it_has_been_inside_for_a_second():
    boat = Fenced()
    boat.be(51.0)
    boat.be(49.0)
    boat.wait(0.98)
    boat.be(51.0)  # a position that scatters
    boat.be(49.0)
    boat.wait(0.98)
    assert boat.status() == (1, BOUNDARY, 1)
    boat.wait(0.03)
    assert boat.status() == (0, NONE, 1)
    assert boat.is_healthy()
    assert not boat.vehicle.failsafe
    boat.be(51.0)
    assert boat.status() == (1, BOUNDARY, 2)


def test_it_acts_once_per_breach():
    boat = Fenced()
    boat.arm()
    boat.be(51.0)
    boat.enter("manual")  # a pilot brings it back
    boat.wait(5.0)
    assert boat.vehicle.mode.name == "manual"


def test_a_position_that_is_lost_ends_no_breach():
    boat = Fenced()
    boat.be(51.0)
    boat.measure(position_valid=False, position_n=(0.0, 0.0, 0.0))
    boat.wait(5.0)
    assert boat.status() == (1, BOUNDARY, 1)
    boat = Fenced()
    boat.measure(position_valid=False)
    boat.be(51.0)
    assert boat.status() == (0, NONE, 0)


def test_without_action_it_is_reported():
    boat = Fenced(fence_action="none")
    boat.arm()
    boat.enter("manual")
    boat.be(51.0)
    assert boat.vehicle.mode.name == "manual"
    assert "outside the fence" in boat.texts()


def test_it_does_not_arm_outside():
    boat = Fenced()
    boat.be(51.0)
    assert boat.command(400, 1) == mavlink.MAV_RESULT_FAILED
    assert "PreArm: outside the fence" in boat.texts()
    boat.be(0.0)
    assert boat.command(400, 1) == OK


def test_a_fence_that_is_off():
    boat = Fenced()
    assert boat.command(ENABLE, 0) == OK
    boat.be(51.0)
    assert boat.status() == (0, NONE, 0)
    assert boat.command(ENABLE, 1) == OK
    boat.tick()
    assert boat.status() == (1, BOUNDARY, 1)
    assert boat.command(ENABLE, 0) == OK
    boat.wait(1.1)
    assert boat.status() == (0, NONE, 1)
    assert boat.command(ENABLE, 2) == DENIED


def test_other_zones_count_at_once():
    boat = Fenced()
    boat.be(51.0)
    assert upload(boat, listed(one(5003, 60.0), kind=FENCE), FENCE) == 0
    boat.wait(1.1)
    assert boat.status() == (0, NONE, 1)
    assert upload(boat, listed(one(5003, 40.0), kind=FENCE), FENCE) == 0
    boat.tick()
    assert boat.status() == (1, BOUNDARY, 2)


def test_a_return_point_fences_nothing():
    boat = Fenced(listed(one(5000, at=north_of(500)), kind=FENCE))
    boat.be(1e5)
    assert boat.vehicle.mode.name == "hold"
    assert not boat.vehicle.failsafe


def test_without_a_fence_nothing_is_reported():
    boat = Bench()
    boat.wait(3.0)
    assert boat.transport.take("FENCE_STATUS") == []


def test_the_floor_of_a_submarine():
    submarine = Bench(submerged=True, fence_depth=20.0, valid=False)
    submarine.measure(heading_valid=True)
    submarine.arm()
    submarine.enter("stabilize")
    submarine.measure(position_n=(0.0, 0.0, 19.9))
    submarine.tick()
    assert submarine.one(STATUS).breach_status == 0
    submarine.measure(position_n=(0.0, 0.0, 20.1))
    submarine.tick()
    m = submarine.one(STATUS)
    assert (m.breach_status, m.breach_type) == (1, FLOOR)
    boat = Bench(fence_depth=20.0)
    boat.measure(position_n=(0.0, 0.0, 30.0))
    boat.tick()
    assert not boat.vehicle.failsafe


def test_an_action_that_the_vehicle_has_not():
    with pytest.raises(InputError, match="surface"):
        Bench(fence_action="surface")
