"""Buoyancy engines, tanks and moving masses: hydrostatics, inertia of points, a steady glide."""

import math

import numpy as np
import pytest

from seatrial.physics.craft.kinematics import rotation
from seatrial.physics.craft.marine_craft import MarineCraft
from seatrial_kits.fitted.fitted_craft import FittedCraft
from tests.kits.fitted.fitting import BODY, DENSITY, craft, padded, state

WEIGHT = 40.0 * 9.81


def test_a_buoyancy_engine_holds_up_what_it_displaces():
    # 0.2 kg too heavy: the engine at x = 0.3 m displaces as much, and the craft pitches until the
    # moments of weight and buoyancy balance: tan(theta) = x V rho / (m z_G).
    excess, x = 0.2, 0.3
    volume = 2 * excess / DENSITY
    part = craft(
        ballasts="buoyancy-engine",
        mass=40.0 + excess,
        ballast_volume_1=volume,
        ballast_position_1=(x, 0, 0),
    )
    part.set("ballast_order", padded(0.5))
    theta = math.atan(excess * x / ((40.0 + excess) * 0.03))
    slope = part.derivatives(state(part, attitude=(0, theta, 0)))
    np.testing.assert_allclose(slope, 0, atol=1e-12)
    found = part.trim(state(part, attitude=(0, 0.5 * theta, 0)), hold=("position", "attitude.psi"))
    assert found[4] == pytest.approx(theta, abs=1e-9)


@pytest.mark.parametrize("order", [1.0, -1.0, 0.25, 3.0])
def test_buoyancy_beyond_the_neutral_lifts_at_its_place(order):
    part = craft(ballasts="buoyancy-engine", ballast_volume_1=1e-3, ballast_position_1=(0.3, 0, 0))
    part.set("ballast_order", padded(order))
    found = part.mass_matrix() @ part.derivatives(state(part))[6:12]
    lift = 9.81 * DENSITY * 1e-3 * max(-1, min(order, 1))
    np.testing.assert_allclose(found, [0, 0, -lift, 0, 0.3 * lift, 0], atol=1e-12)


def points_of(component):
    """Return points of which an inertia tensor is made, about their own centre, and their mass."""
    m, place = component["mass"], np.array(component["center_of_gravity"])
    xx, yy, zz = component["inertia"][:3]
    offsets = np.sqrt(np.array([yy + zz - xx, xx + zz - yy, xx + yy - zz]) / 2 / (m / 3))
    signs = [np.eye(3)[k] * s * offsets[k] for k in range(3) for s in (1, -1)]
    return [(m / 6, place + each) for each in signs]


BALLAST = {
    "ballasts": "tank moving-mass",
    "ballast_mass_1": 3.0,
    "ballast_position_1": (0.4, -0.1, 0.05),
    "ballast_mass_2": 5.0,
    "ballast_position_2": (-0.1, 0.02, 0.04),
    "ballast_axis_2": (0.8, 0.0, 0.6),
    "ballast_travel_2": 0.2,
}
EVEN = {"inertia": (1.8, 2.0, 2.2, 0, 0, 0)}


def test_a_craft_with_ballast_is_the_rigid_body_of_all_its_points():
    # A free craft without water: its accelerations under a load are those of all the points.
    dry = {"added_mass": 0.0, "added_inertia": 0.0, "terms": "", **EVEN}
    part = craft(**dry, **BALLAST)
    part.set("ballast_order", padded(0.6, -0.5))
    load = np.array([3.0, -2.0, 5.0, 0.4, -0.3, 0.6])
    part.set("force_1", load[:3])
    part.set("moment_1", load[3:])
    points = points_of({**BODY, **EVEN})
    shift = -0.5 * 0.2 * np.array([0.8, 0, 0.6])
    place = np.array(BALLAST["ballast_position_2"])
    points += [(1.8, np.array(BALLAST["ballast_position_1"])), (-5, place), (5, place + shift)]
    M = np.zeros((6, 6))
    for m, r in points:
        S = np.array([[0, -r[2], r[1]], [r[2], 0, -r[0]], [-r[1], r[0], 0]])
        J = np.hstack([np.eye(3), -S])
        M += m * J.T @ J
    found = part.derivatives(state(part))[6:12]
    np.testing.assert_allclose(found, np.linalg.solve(M, load), rtol=1e-11, atol=1e-12)


def test_a_moving_mass_in_the_middle_changes_nothing_and_a_tank_is_never_less_than_empty():
    part, plain = craft(**BALLAST), craft(ballasts="")
    part.set("ballast_order", padded(-0.7, 0))
    nu = (1.0, 0.2, -0.1, 0.3, 0.2, 0.1)
    found = part.derivatives(state(part, nu))
    np.testing.assert_allclose(found, plain.derivatives(state(plain, nu)), rtol=1e-11, atol=1e-12)


def test_a_mass_that_moves_forward_puts_the_bow_down():
    part = craft(**BALLAST)
    theta = -math.atan(5.0 * 0.2 * 0.8 / (40 * 0.03 + 5.0 * 0.2 * 0.6))
    part.set("ballast_order", padded(0, 1))
    slope = part.derivatives(state(part, attitude=(0, theta, 0)))
    np.testing.assert_allclose(slope, 0, atol=1e-12)


def test_a_tank_sinks_a_surface_craft_by_its_waterplane():
    surface = {
        "restoring": "surface-conservative",
        "waterplane_area": 0.6,
        "GM_T": 0.8,
        "GM_L": 3.0,
    }
    part = craft(
        **surface,
        ballasts="tank",
        ballast_mass_1=6.0,
        ballast_position_1=(0, 0, 0.1),
        density=1000.0,
    )
    part.set("ballast_order", padded(0.5))
    at = state(part)
    at[2] = 3.0 / (1000.0 * 0.6)
    np.testing.assert_allclose(part.derivatives(at), 0, atol=1e-12)
    # Off the centre line it heels: m g y cos(phi) = W GM sin(phi) cos(phi).
    part.set("ballast_position_1", (0, 0.05, 0))
    heeled = part.trim(at, hold=("position.x", "position.y", "attitude.psi"))
    assert math.sin(heeled[3]) == pytest.approx(3.0 * 0.05 / (40.0 * 0.8), rel=1e-9)


def test_a_steady_glide_goes_down_at_the_angle_of_drag_over_lift():
    wing = {"body_lift_area": 0.3, "body_lift_span": 0.5, "body_lift_drag": 0.02}
    part = craft(
        **wing,
        terms="restoring coriolis damping body-lift",
        coriolis="without-munk",
        quadratic_damping_force=0.0,
        linear_damping_force=0.0,
        center_of_gravity=(0.01, 0.0, 0.05),
        ballasts="buoyancy-engine",
        ballast_volume_1=4e-4,
    )
    run = part.reference([0.0, 600.0], lambda t, x: {"ballast_order": padded(-1)})
    x = run.x[-1]
    part.set("ballast_order", padded(-1))
    assert np.abs(part.derivatives(x)[6:12]).max() < 1e-9
    u, w = x[6], x[8]
    alpha, aspect = math.atan2(w, u), 0.25 / 0.3
    lift = math.pi * aspect * alpha / (1 + math.sqrt(1 + aspect**2 / 4))
    drag = 0.02 + lift**2 / (math.pi * 0.7 * aspect)
    north, _, down = np.array(rotation(*x[3:6])) @ x[6:9]
    assert north > 0.3
    assert math.atan2(down, north) == pytest.approx(math.atan2(drag, lift), abs=1e-9)
    # Lift and drag carry the weight that is left.
    U2 = u * u + w * w
    total = DENSITY / 2 * U2 * 0.3 * math.hypot(lift, drag)
    assert total == pytest.approx(4e-4 * DENSITY * 9.81, rel=1e-9)


def test_without_ballast_it_is_the_marine_craft():
    plain = MarineCraft("plain")
    for name, value in BODY.items():
        plain.set(name, value)
    rng = np.random.default_rng(5)
    for _ in range(5):
        x = rng.normal(size=12) * 0.4
        part = craft()
        found = part.derivatives(np.concatenate([x, np.zeros(32)]))
        np.testing.assert_allclose(found[:12], plain.derivatives(x), rtol=1e-13, atol=1e-13)
        assert not found[12:].any()
    assert issubclass(FittedCraft, MarineCraft)
