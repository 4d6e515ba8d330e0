"""Two bodies with the component collision: momentum, energy, and places by brute force."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from seatrial.errors import InputError
from seatrial.physics.contact import hunt_crossley, restitution
from seatrial_kits.underwater.collision import Collision, nearest_points

M1, M2, I1, I2 = 55.0, 22.0, 20.0, 5.0  # kg, kg.m2


def run(offset, h=0.002, duration=2.0, **values):
    """Return a list of momentum north, east, about the origin, and energy, over the time.

    Two bodies that move in the horizontal plane; the first runs at 1.5 m/s into the second.
    """
    collision = Collision("collision")
    for name, value in values.items():
        collision.set(name, value)
    collision.initialise()
    collision.begin()
    bodies = [[0.0, 0.0, 0.0, 1.5, 0.0, 0.0], [1.2, offset, 0.3, 0.0, 0.0, 0.0]]
    rows = []
    for _ in range(round(duration / h)):
        for name, (x, y, psi, vx, vy, r) in zip(("first", "second"), bodies, strict=True):
            c, s = math.cos(psi), math.sin(psi)
            collision.set(f"{name}_position", [x, y, 0.0])
            collision.set(f"{name}_attitude", [0.0, 0.0, psi])
            collision.set(f"{name}_velocity", [c * vx + s * vy, c * vy - s * vx, 0.0])
            collision.set(f"{name}_rates", [0.0, 0.0, r])
        loads = [
            (collision.get(f"{name}_force"), collision.get(f"{name}_moment")[2])
            for name in ("first", "second")
        ]
        collision.advance(collision.now, h)
        row = np.zeros(4)
        for body, m, inertia, (force, moment) in zip(
            bodies, (M1, M2), (I1, I2), loads, strict=True
        ):
            x, y, psi, vx, vy, r = body
            row += [
                m * vx,
                m * vy,
                m * (x * vy - y * vx) + inertia * r,
                0.5 * m * (vx * vx + vy * vy) + 0.5 * inertia * r * r,
            ]
            c, s = math.cos(psi), math.sin(psi)
            ax, ay = (c * force[0] - s * force[1]) / m, (s * force[0] + c * force[1]) / m
            body[0] += vx * h + 0.5 * ax * h * h
            body[1] += vy * h + 0.5 * ay * h * h
            body[2] += r * h
            body[3] += ax * h
            body[4] += ay * h
            body[5] += moment / inertia * h
        rows.append(row)
    return np.array(rows), bodies, collision


@pytest.mark.parametrize("offset", [0.0, 0.2, -0.35])
def test_momentum_is_conserved_and_energy_lost(offset):
    rows, bodies, collision = run(offset)
    assert collision.get("touches") >= 1
    assert bodies[1][3] > 0.5  # it was struck
    assert rows[:, 0] == pytest.approx(M1 * 1.5, rel=1e-12)
    assert rows[:, 1] == pytest.approx(0.0, abs=1e-10)
    # The place of the force is that of the beginning of a step: h v off
    assert rows[:, 2] == pytest.approx(rows[0, 2], abs=0.05)
    assert rows[-1, 3] < rows[0, 3]
    assert rows[:, 3].max() <= rows[0, 3] * (1 + 1e-9)


@pytest.mark.parametrize("seed", range(3))
def test_neither_of_the_two_is_the_first(seed):
    draw, found = np.random.default_rng(seed), {}
    poses = {
        "position": [[0.0, 0.0, 0.0], [0.4, 0.5, 0.2]],
        "attitude": draw.uniform(-0.4, 0.4, (2, 3)),
        "velocity": draw.normal(size=(2, 3)),
        "rates": draw.normal(size=(2, 3)),
        "length": [1.4, 0.9],
        "radius": [0.4, 0.3],
        "center": draw.uniform(-0.1, 0.1, (2, 3)),
    }
    for order in (("first", "second"), ("second", "first")):
        collision = Collision("collision")
        for name, values in poses.items():
            for craft, value in zip(order, values, strict=True):
                collision.set(f"{craft}_{name}", value)
        collision.initialise()
        collision.begin()
        loads = [
            collision.get(f"{craft}_{load}") for craft in order for load in ("force", "moment")
        ]
        found[order] = np.ravel(loads)
    one, other = found.values()
    assert np.abs(one).max() > 1.0
    # Both go on by 1 us: the normal force knows how fast their hulls come together.
    before, press = -collision.get("distance"), collision.get("normal_force")
    for craft, place, euler, v, rates in zip(order, *list(poses.values())[:4], strict=True):
        turned = Rotation.from_euler("ZYX", euler[::-1])
        later = turned * Rotation.from_rotvec(1e-6 * rates)
        collision.set(f"{craft}_position", place + 1e-6 * turned.apply(v))
        collision.set(f"{craft}_attitude", later.as_euler("ZYX")[::-1])
    closing = (-collision.get("distance") - before) / 1e-6
    law = hunt_crossley(before, closing, collision.stiffness, collision.damping)
    assert press == pytest.approx(law, rel=1e-4)
    np.testing.assert_allclose(one, other, rtol=1e-9, atol=1e-9)


@pytest.mark.slow
def test_a_central_impact_separates_them_by_the_restitution_of_the_law():
    _, bodies, _ = run(0.0, h=5e-4, second_length=0.5, damping=0.4)
    # the second is a sphere: its heading does not matter
    e = restitution(0.4, 1.5)
    assert bodies[1][3] - bodies[0][3] == pytest.approx(1.5 * e, rel=2e-3)
    assert bodies[1][3] == pytest.approx(M1 * 1.5 * (1 + e) / (M1 + M2), rel=2e-3)


def test_places_nearest_to_each_other_are_those_of_a_fine_search():
    random = np.random.default_rng(5)
    shares = np.linspace(0.0, 1.0, 401)
    for _ in range(40):
        a, b, c, d = random.normal(size=(4, 3))
        one, other = nearest_points(a, b, c, d)
        first = a + shares[:, None] * (b - a)
        second = c + shares[:, None] * (d - c)
        searched = np.linalg.norm(first[:, None] - second[None], axis=2).min()
        assert math.dist(one, other) <= searched + 1e-12
        assert math.dist(one, other) == pytest.approx(searched, abs=0.02)


def test_parallel_and_degenerate_segments_have_a_distance():
    one, other = nearest_points((0, 0, 0), (2, 0, 0), (1, 3, 0), (4, 3, 0))
    assert math.dist(one, other) == 3.0
    one, other = nearest_points((0, 0, 0), (0, 0, 0), (1, 0, 0), (1, 0, 0))
    assert math.dist(one, other) == 1.0


def test_a_capsule_shorter_than_it_is_thick_is_refused():
    collision = Collision("boats")
    collision.set("second_length", 0.3)
    with pytest.raises(InputError, match=r"boats: second_length is 0\.3 m: a capsule with"):
        collision.initialise()
        collision.begin()


def test_over_a_step_the_force_is_that_of_its_middle_and_touches_are_counted():
    law = {"stiffness": 700.0, "damping": 0.3, "friction": 0.0}
    boats = Collision("boats")
    hulls = {"first_length": 1.0, "first_radius": 0.5, "second_length": 1.4, "second_radius": 0.7}
    for name, value in {**law, **hulls}.items():
        boats.set(name, value)
    # Two spheres, 3, 4 and 5 apart: 0.2 m of them overlap, or a gap of 0.3 m.
    for name, value in (("position", [0.6, 0.8, 0.0]), ("velocity", [-0.9, -1.2, 0.4])):
        boats.set(f"first_{name}", value)
    boats.initialise()
    boats.begin()
    speed, overlap = 1.5, 0.2
    assert boats.get("distance") == pytest.approx(-overlap)
    assert boats.get("normal_force") == pytest.approx(700 * overlap * (1 + 0.3 * speed))
    assert boats.get("first_force") == pytest.approx(
        [0.6 * boats.get("normal_force"), 0.8 * boats.get("normal_force"), 0.0]
    )
    boats.advance(0.0, 0.04)
    middle = 700 * (overlap + 0.02 * speed) * (1 + 0.3 * speed)
    assert boats.get("normal_force") == pytest.approx(middle)
    assert (boats.get("touches"), boats.get("impact_speed")) == (1, pytest.approx(1.5))
    boats.set("first_velocity", [-0.3, -0.4, 0.0])
    boats.advance(0.04, 0.04)
    boats.set("first_position", [0.9, 1.2, 0.0])  # apart
    boats.advance(0.08, 0.04)
    assert boats.get("distance") == pytest.approx(0.3)
    assert (boats.get("normal_force"), boats.get("touching")) == (0.0, False)
    boats.set("first_position", [0.6, 0.8, 0.0])
    boats.set("first_velocity", [-0.06, -0.08, 0.0])
    boats.advance(0.12, 0.04)
    # As fast as they came together before the force began.
    assert (boats.get("touches"), boats.get("impact_speed")) == (2, pytest.approx(0.5))
