"""A body of mass m with the component contact, against closed forms of the laws."""

import itertools
import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from seatrial.physics.contact import friction as coulomb
from seatrial.physics.contact import hunt_crossley, restitution
from seatrial_kits.underwater.contact import Contact
from tests.devices.running import started

G = 9.81
DEPTH, HALF_HEIGHT = 10.0, 0.25  # m
CORNERS = 4  # that stand on a level bottom


def fall(mass, h, duration, *, height=0.0, w=0.0, u=0.0, gravity=G, tilt=0.0, **values):
    """Return t, z, w, u of a body that only translates, in the axes of the bottom, and contact.

    With the bottom at ``tilt``, the body's axes and gravity are turned instead of it.
    """
    contact = Contact("contact")
    settings = {"box_size": [1.0, 1.0, 2 * HALF_HEIGHT], "seabed_depth": DEPTH}
    for name, value in {**settings, **values}.items():
        contact.set(name, value)
    x, z = 0.0, DEPTH - HALF_HEIGHT - height
    contact.set("position", [x, 0.0, z])
    contact.initialise()
    contact.begin()
    rows = []
    for k in range(round(duration / h)):
        contact.set("position", [x, 0.0, z])
        contact.set("velocity", [u, 0.0, w])
        force = contact.get("force")
        rows.append((k * h, z, w, u))
        contact.advance(contact.now, h)
        down = gravity * math.cos(tilt) + force[2] / mass
        ahead = gravity * math.sin(tilt) + force[0] / mass
        z, w = z + w * h + 0.5 * down * h * h, w + down * h
        x, u = x + u * h + 0.5 * ahead * h * h, u + ahead * h
    return rows, contact


@pytest.mark.slow
@pytest.mark.sampled(3)
@pytest.mark.parametrize("h", [0.001, 0.005, 0.01, 0.02])
def test_a_body_at_rest_stands_as_deep_as_weight_over_stiffness(h):
    _, contact = fall(20.0, h, 6.0, height=0.01, stiffness=5000.0)
    assert contact.get("penetration") == pytest.approx(20 * G / (CORNERS * 5000), rel=1e-6)
    assert contact.get("normal_force") == pytest.approx(20 * G, rel=1e-6)


@pytest.mark.parametrize(("h", "tolerance"), [(0.001, 1e-3), (0.005, 4e-3), (0.01, 1e-2)])
def test_restitution_is_that_of_the_law(h, tolerance):
    rows, contact = fall(20.0, h, 1.0, height=0.1, w=1.0, gravity=0.0, stiffness=5e3, damping=0.5)
    assert -rows[-1][2] == pytest.approx(restitution(0.5, 1.0), abs=tolerance)
    assert contact.get("touches") == 1
    assert contact.get("impact_speed") == 1.0


@pytest.mark.slow
@pytest.mark.sampled(3)
@pytest.mark.parametrize("h", [0.001, 0.005, 0.01])
def test_a_bounce_loses_energy_wherever_in_a_step_it_begins(h):
    for phase in range(7):
        height = 0.1 + phase * h / 7
        rows, _ = fall(20.0, h, 1.0, height=height, w=1.0, gravity=0.0, stiffness=5e3, damping=0.05)
        assert 0.9 < -rows[-1][2] < 1.0
        rows, _ = fall(20.0, h, 1.0, height=height, w=1.0, gravity=0.0, stiffness=5e3, damping=0.0)
        assert -rows[-1][2] == pytest.approx(1.0, abs=0.006)


def test_a_body_that_bounces_loses_height_each_time():
    rows, _ = fall(20.0, 0.005, 3.0, height=0.5, stiffness=2e4, damping=0.2)
    tops = [b[1] for a, b in pairwise(rows) if a[2] < 0.0 <= b[2]]
    assert len(tops) > 2
    assert all(later > earlier for earlier, later in pairwise(tops))


def test_a_body_that_slides_is_slowed_by_mu_g():
    sunk = 20 * G / (CORNERS * 5000)
    rows, _ = fall(20.0, 0.005, 0.5, height=-sunk, u=3.0, stiffness=5000.0, friction=0.4)
    # less by (v_s / v)^2 / 2 of the regularisation
    assert (rows[0][3] - rows[-1][3]) / rows[-1][0] == pytest.approx(0.4 * G, rel=1e-4)


@pytest.mark.parametrize("friction", [0.30, 0.35])
def test_on_a_slope_that_is_steeper_than_its_friction_it_slides(friction):
    a = math.radians(20.0)  # tan 0.364
    sunk = 20 * G * math.cos(a) / (CORNERS * 5000)
    rows, _ = fall(20.0, 0.005, 4.0, height=-sunk, tilt=a, stiffness=5e3, friction=friction)
    late = [row for row in rows if row[0] >= 2.0]
    slope = (late[-1][3] - late[0][3]) / (late[-1][0] - late[0][0])
    assert slope == pytest.approx(G * (math.sin(a) - friction * math.cos(a)), abs=2e-3)


@pytest.mark.parametrize("friction", [0.38, 0.60])
def test_on_a_slope_that_is_not_it_creeps_as_its_regularisation_says(friction):
    a = math.radians(20.0)
    sunk = 20 * G * math.cos(a) / (CORNERS * 5000)
    rows, _ = fall(20.0, 0.005, 4.0, height=-sunk, tilt=a, stiffness=5e3, friction=friction)
    r = math.tan(a) / friction
    assert rows[-1][3] == pytest.approx(0.01 * r / math.sqrt(1 - r * r), rel=1e-6)


def test_it_does_not_pull_a_body_that_leaves():
    contact = Contact("contact")
    for name, value in {"seabed_depth": 1.0, "damping": 5.0, "position": [0.0, 0.0, 0.51]}.items():
        contact.set(name, value)
    contact.set("velocity", [0.0, 0.0, -1.0])
    contact.initialise()
    contact.begin()
    assert contact.get("penetration") == pytest.approx(0.01)
    assert contact.get("normal_force") == 0.0
    assert contact.get("force") == [0.0, 0.0, 0.0]


def test_a_corner_pushes_along_the_normal_of_a_wall_and_turns_the_body():
    contact = Contact("contact")
    values = {"obstacles": "box 2 0 0 1 20 20 0", "attitude": [0.0, 0.0, math.pi / 8]}
    for name, value in {**values, "stiffness": 1e3, "box_size": [2.0, 1.0, 1.0]}.items():
        contact.set(name, value)
    c, s = math.cos(math.pi / 8), math.sin(math.pi / 8)
    reach = c + 0.5 * s  # of the corner to starboard... the one to port is nearer by s
    contact.set("position", [1.5 - reach + 0.01, 0.0, 0.0])
    contact.initialise()
    contact.begin()
    # two corners, above one another, 1 cm deep; a wall at x = 1.5 pushes to the south
    assert contact.get("normal_force") == pytest.approx(20.0)
    fx, fy, fz = contact.get("force")
    assert (fx, fy) == pytest.approx((-20.0 * c, 20.0 * s))
    assert fz == pytest.approx(0.0, abs=1e-12)
    x, y = 1.0, -0.5
    assert contact.get("moment")[2] == pytest.approx(x * fy - y * fx)


@pytest.mark.parametrize("seed", range(4))
def test_corners_press_and_rub_where_they_touch(seed):
    # A box that tumbles into a level bottom: of each corner, in {n}, by its lowest point.
    draw = np.random.default_rng(seed)
    attitude, center = draw.uniform(-0.5, 0.5, 3), draw.uniform(-0.1, 0.1, 3)
    size, radius, v, rates = draw.uniform(0.5, 1.0, 3), 0.08, *draw.normal(size=(2, 3))
    R = Rotation.from_euler("ZYX", attitude[::-1])
    corners = [center + 0.5 * size * s for s in itertools.product((-1, 1), repeat=3)]
    down = np.array([0.0, 0.0, 1.0])
    lowest = sorted(R.apply(arm)[2] + radius for arm in corners)
    depth = 7.0 + 0.5 * (lowest[-2] + lowest[-3])  # two corners are in the bottom
    law = {"stiffness": 3e3, "damping": 0.4, "friction": 0.5, "slip_speed": 0.02}
    contact = started(
        Contact,
        position=[2.0, -3.0, 7.0],
        attitude=attitude,
        velocity=v,
        rates=rates,
        **{"box_size": size, "box_center": center, "radius": radius, "seabed_depth": depth, **law},
    )
    force, moment = np.zeros((2, 3))
    for arm in corners:
        foot = R.apply(arm) + radius * down
        moves = R.apply(v) + np.cross(R.apply(rates), foot)
        press = hunt_crossley(7.0 + foot[2] - depth, moves[2], 3e3, 0.4)
        own = np.array([*coulomb(press, moves[:2], 0.5, 0.02), -press])
        force, moment = force + own, moment + np.cross(foot, own)
    assert np.abs(force).max() > 1.0
    np.testing.assert_allclose(contact.get("force"), R.inv().apply(force), rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(contact.get("moment"), R.inv().apply(moment), rtol=1e-9, atol=1e-9)


def test_far_from_everything_nothing_is_touched():
    contact = started(Contact, seabed_depth=500.0)
    contact.advance(0.0, 0.1)
    assert (contact.get("touches"), contact.get("impact_speed")) == (0, 0.0)


def test_over_a_step_the_force_is_that_of_its_middle():
    law = {"stiffness": 700.0, "damping": 0.3, "seabed_depth": 5.0, "friction": 0.0}
    box = {"box_size": [0.0, 0.0, 0.0], "radius": 0.5}  # eight corners in one place
    ball = started(Contact, **law, **box, position=[1.0, 2.0, 4.6], velocity=[0.3, 0.2, 1.5])
    assert ball.get("penetration") == pytest.approx(0.1)
    assert ball.get("normal_force") == pytest.approx(8 * 700 * 0.1 * 1.45)
    ball.advance(0.0, 0.04)
    assert ball.get("normal_force") == pytest.approx(8 * 700 * (0.1 + 0.02 * 1.5) * 1.45)
    assert (ball.get("touches"), ball.get("impact_speed")) == (1, pytest.approx(1.5))
