"""Craft off every symmetry, at random poses and rates: momentum, momentum of the water, the wind."""

import itertools
import math
from types import SimpleNamespace

import casadi as ca
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from seatrial.physics.craft.marine_craft import MarineCraft
from seatrial.physics.craft.rov import Rov, propellers
from seatrial.physics.craft.six_dof import six_dof_motion
from seatrial.physics.craft.terms.context import Context
from seatrial.physics.craft.through_water import flow_outputs
from seatrial.physics.craft.wave_hull import WaveHull
from seatrial_kits.fitted.parts.flow import through_water
from tests.craft.numerically import numbers, pose
from tests.sea.references import content, table

G = 9.81
SEEDS = range(4)


def motion(attitude, nu, depth=50.0, **values):
    """Return acceleration of the origin, angular acceleration, {b}, and rates of change."""
    both = numbers(Rov, **values)
    place = ca.DM([3.0, -4.0, depth])
    changes, outputs = six_dof_motion(place, ca.DM(attitude), ca.DM(nu), both, both)
    found = (outputs["acceleration"], changes.rates, changes.position, changes.attitude)
    return [np.array(each).ravel() for each in found]


def masses(draw):
    """Return places and masses of points, and what a craft made of them is by its parameters."""
    places, each = draw.normal(size=(5, 3)) * 0.3, draw.uniform(1, 5, 5)
    middle = each @ places / each.sum()
    x, y, z = (places - middle).T
    products = [x * y, x * z, y * z]
    tensor = [each @ part for part in (y * y + z * z, x * x + z * z, x * x + y * y, *products)]
    body = {"mass": each.sum(), "center_of_gravity": middle, "inertia": tensor}
    return places, each, body


@pytest.mark.parametrize("seed", SEEDS)
def test_momentum_of_points_changes_by_the_forces_on_them(seed):
    # Newton's law in {n}, of mass points. Without added mass and drag, water matters by its
    # pressure gradient alone: neither its speed nor its shear shows.
    draw = np.random.default_rng(seed)
    attitude, R, nu = pose(draw)
    places, each, body = masses(draw)
    force, moment, pull, at, buoyant = draw.normal(size=(5, 3)) * 20
    volume, rises = draw.uniform(0.005, 0.02), draw.normal(size=3)
    surging = draw.normal(size=3)
    acceleration, turning, moved, turned = motion(
        attitude,
        nu,
        **body,
        force_1=0.3 * force,
        force_2=0.7 * force,
        moment_3=moment,
        attachment_force=pull,
        attachment_place=at,
        center_of_buoyancy=buoyant,
        volume=volume,
        buoyancy=1000 * G * volume,
        terms="restoring coriolis",
        water_velocity=rises,
        water_acceleration=surging,
        water_shear=rises[:2],
    )
    omega = nu[3:]
    inwards = np.cross(omega, np.cross(omega, places))
    points = (acceleration + np.cross(turning, places) + inwards) @ R.T
    upwards = 1000 * volume * (surging - [0, 0, G])
    loads = [R @ force, pull, upwards, *(m * np.array([0, 0, G]) for m in each)]
    levers = [np.zeros(3), at, buoyant, *places]
    np.testing.assert_allclose(each @ points, sum(loads), rtol=1e-9, atol=1e-9)
    moments = [R @ moment, *(np.cross(R @ r, f) for r, f in zip(levers, loads, strict=True))]
    spins = [m * np.cross(R @ r, a) for m, r, a in zip(each, places, points, strict=True)]
    np.testing.assert_allclose(sum(spins), sum(moments), rtol=1e-9, atol=1e-8)
    np.testing.assert_allclose(moved, R @ nu[:3], rtol=1e-12)
    later = Rotation.from_euler("ZYX", (attitude + 1e-6 * turned)[::-1])
    spun = (later * Rotation.from_matrix(R).inv()).as_rotvec() / 1e-6
    np.testing.assert_allclose(spun, R @ omega, atol=1e-5)


@pytest.mark.parametrize("seed", SEEDS)
def test_momentum_of_body_and_water_is_conserved(seed):
    # Kirchhoff: (M nu)' in turning axes, with any symmetric added mass.
    draw = np.random.default_rng(seed)
    attitude, _, nu = pose(draw)
    places, each, body = masses(draw)
    root = draw.normal(size=(6, 6))
    added = root @ root.T
    upper = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]
    acceleration, turning, _, _ = motion(
        attitude,
        nu,
        **body,
        added_mass=[added[i, j] for i, j in upper],
        added_inertia=[added[3 + i, 3 + j] for i, j in upper],
        added_coupling=added[:3, 3:].ravel(),
        terms="coriolis",
        buoyancy=body["mass"] * G,
    )
    jacobians = [np.hstack([np.eye(3), np.cross(np.eye(3), r).T]) for r in places]
    M = added + sum(m * J.T @ J for m, J in zip(each, jacobians, strict=True))
    v, omega, (p, L) = nu[:3], nu[3:], np.split(M @ nu, 2)
    gyroscopic = np.concatenate([np.cross(omega, p), np.cross(omega, L) + np.cross(v, p)])
    slope = np.concatenate([acceleration - np.cross(omega, v), turning])
    np.testing.assert_allclose(M @ slope, -gyroscopic, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("seed", SEEDS)
def test_parts_meet_the_water_at_their_own_depth(seed):
    draw = np.random.default_rng(seed)
    attitude, R, nu = pose(draw)
    place, rises, shear = draw.normal(size=3), draw.normal(size=3), draw.normal(size=2)
    both = numbers(Rov, water_shear=shear, flow_place=place)
    velocity = ca.DM(nu)
    context = Context(ca.DM(3, 1), attitude, ca.DM(R), velocity, velocity, None, both, both)
    water = np.add(rises, [*(shear * (R @ place)[2]), 0.0])
    expected = nu[:3] + np.cross(nu[3:], place) - R.T @ water
    slot = SimpleNamespace(position=ca.DM(np.add(place, [0.4, 0, 0])), waves=ca.DM(rises))
    met = through_water(context, slot, 0.4)
    flow = flow_outputs(ca.DM(R), velocity, both, both)["flow"]
    np.testing.assert_allclose(np.array(met).ravel(), expected, rtol=1e-9)
    np.testing.assert_allclose(np.array(flow).ravel(), expected + R.T @ rises, rtol=1e-9)


def smooth(x):
    return np.polyval([-2, 3, 0, 0], np.clip(x, 0, 1))


@pytest.mark.parametrize("seed", SEEDS)
def test_propellers_push_by_the_speed_and_depth_at_their_place(seed):
    draw = np.random.default_rng(seed)
    attitude, R, nu = pose(draw)
    place, size = draw.normal(size=3), draw.uniform(2, 9)
    direction = Rotation.random(random_state=seed).apply([1, 0, 0])
    full, kappa, ring, radius = 10.0, 0.4, 3.0, 0.07
    depth = draw.uniform(-0.4, 1.0) * radius
    origin = ca.DM([2.0, 5.0, depth - (R @ place)[2]])
    wet = {"submerged": (1.0, 1.0)}
    wet["floating"] = smooth((depth / radius + 0.5) / 1.8), smooth(0.5 + depth / radius / 2.2)
    for sign, faster, kind in itertools.product((-1, 1), (0.3, 30.0), wet):
        both = numbers(
            Rov,
            propeller_position_1=place,
            propeller_direction_1=direction,
            bollard_thrust=8 * [full],
            advance_loss=8 * [kappa],
            propeller_radius=8 * [radius],
            ring_drag=[ring] + 7 * [0],
            restoring=kind,
            thrust=[sign * size] + 7 * [0],
        )
        flow = nu * faster
        v = flow[:3] + np.cross(flow[3:], place)
        context = Context(origin, attitude, ca.DM(R), flow, ca.DM(flow), None, both, both)
        advance = np.clip(sign * direction @ v, -1.0, 1 / kappa)  # no thrust is left beyond
        pushed = sign * (size - kappa * math.sqrt(size * full) * advance) * wet[kind][0]
        dragged = ring * max(flow[0], 0.0) * np.array([0, v[1], v[2]]) * wet[kind][1]
        force = pushed * direction - dragged
        expected = [*force, *np.cross(place, force)]
        found = np.array(propellers(context)).ravel()
        np.testing.assert_allclose(found, expected, rtol=1e-6, atol=1e-9)


# ------------------------------------------------------------------ waves


@pytest.mark.parametrize("chi", [0.4, 2.0, 3.9, 5.5])
def test_drift_in_oblique_waves(chi):
    hull, omega = WaveHull("hull"), np.linspace(0.6, 2.0, 8)
    head, beam = -3.0 * omega, 7.0 * omega
    for name, value in (("frequency", omega), ("head", head), ("beam", beam)):
        hull.set(f"drift_{name}", value)
    cos, sin = math.cos(chi), math.sin(chi)
    found = hull.drift()(np.array([0.9, 1.5]), chi)
    expected = [
        np.multiply(-3 * cos * abs(cos), [0.9, 1.5]),
        np.multiply(7 * sin * abs(sin), [0.9, 1.5]),
    ]
    np.testing.assert_allclose(found, [*expected, [0.0, 0.0]], rtol=1e-12, atol=1e-15)


# ------------------------------------------------------------------ wind

SHIP = content("wind_loads")
OUTLINE = {
    "windage_frontal": SHIP["A_front"],
    "windage_lateral": SHIP["A_lateral"],
    "windage_length": SHIP["Loa"],
    "windage_height": SHIP["sH"],
    "windage_type": SHIP["type"],
    "windage_beam": SHIP["B"],
    "windage_perimeter": SHIP["S"],
    "windage_masts": SHIP["M"],
    "windage_superstructure": SHIP["A_superstructure"],
}


def blown(relative, draw, **values):
    """Return X, Y, K, N of a craft that the air meets with ``relative``, m/s in {b}."""
    heading, u, v = draw.uniform(-3, 3, 3)
    air = np.exp(1j * heading) * (complex(*relative) + complex(u, v))
    craft = MarineCraft("boat")
    for name, value in {**OUTLINE, "terms": "wind-loads", **values}.items():
        craft.set(name, value)
    craft.set("wind_speed", abs(air))
    craft.set("wind_direction", np.angle(air))
    state = np.zeros(12)
    state[[0, 1, 5, 6, 7]] = 30.0, -20.0, heading, u, v
    load = craft.met()(0.0, state)[-6:]
    assert load[2] == load[4] == 0.0
    return load[[0, 1, 3, 5]]


@pytest.mark.parametrize("kind", ["isherwood", "blendermann"])
def test_ships_meet_the_wind_of_the_reference_at_any_heading_and_speed(kind):
    draw = np.random.default_rng(1)
    ahead = {"isherwood": 0.5 * SHIP["Loa"] - SHIP["C"], "blendermann": SHIP["sL"]}[kind]
    area, length = SHIP["A_lateral"], SHIP["Loa"]
    scale = np.array([SHIP["A_front"], area, area**2 / length, area * length])
    for row in table("wind_loads"):
        gamma, side = math.radians(row["gamma_deg"]), draw.choice([-1, 1])
        speed = draw.uniform(3, 20)
        relative = speed * np.array([-math.cos(gamma), side * math.sin(gamma)])
        found = blown(relative, draw, windage_model=kind, windage_ahead=ahead)
        axes = [
            row[f"{kind}_C{axis}"] if f"{kind}_C{axis}" in row.dtype.names else 0.0
            for axis in "XYKN"
        ]
        expected = 0.5 * 1.225 * speed**2 * scale * axes * [1, side, side, side]
        np.testing.assert_allclose(found, expected, rtol=1e-7, atol=1e-6 * speed**2 * scale[0])


@pytest.mark.parametrize("seed", SEEDS)
def test_a_small_craft_meets_the_wind_over_it(seed):
    draw = np.random.default_rng(seed)
    x, y = draw.normal(size=2) * 6
    found = blown((x, y), draw, windage_ahead=2.0, windage_along=0.6, windage_across=0.9)
    pressure = 0.5 * 1.225 * math.hypot(x, y)
    side = pressure * 0.9 * SHIP["A_lateral"] * y
    expected = [pressure * 0.6 * SHIP["A_front"] * x, side, SHIP["sH"] * side, 2.0 * side]
    np.testing.assert_allclose(found, expected, rtol=1e-9)
