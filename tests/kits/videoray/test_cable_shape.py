"""Shapes at rest against closed forms and reference data."""

import itertools
import math
from pathlib import Path

import numpy as np
import pytest

from seatrial_kits.videoray.cable.cable_shape import hanging_shape, static_shape
from tests.kits.videoray.cables import (
    END_FORCE,
    NEUTRAL,
    STILL,
    STREAM,
    arc_in_current,
    cable,
    catenary,
)

REFERENCE = Path(__file__).parents[2] / "reference"
TOP = np.zeros(3)


def error(found, exact):
    """Return the greatest distance of a node from its place."""
    return float(np.linalg.norm(found - exact, axis=0).max())


def unbalanced(one, x, current, v=None):
    s = one.forces(x, np.zeros_like(x) if v is None else v, current, compression=True)
    return float(np.abs(one.node_forces(s)[:, 1:-1]).max())


@pytest.mark.parametrize("segments", [5, 10, 20])
def test_reference_in_a_current(segments):
    found = hanging_shape(cable(segments), TOP, END_FORCE, STREAM)
    file = REFERENCE / f"videoray_tether_static_current_N{segments}.csv"
    expected = np.genfromtxt(file, delimiter=",", names=True)
    for axis, row in zip("xyz", found, strict=True):
        column = expected[f"{axis}_num"]
        np.testing.assert_allclose(row, column, rtol=0, atol=1e-6 * np.abs(column).max())
    exact = arc_in_current(segments)
    np.testing.assert_allclose(exact[0], expected["x_exact"], atol=1e-9)
    np.testing.assert_allclose(exact[2], expected["z_exact"], atol=1e-9)


def test_second_order_in_a_current():
    errors = [
        error(hanging_shape(cable(n), TOP, END_FORCE, STREAM), arc_in_current(n))
        for n in (10, 20, 40, 80)
    ]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    np.testing.assert_allclose(orders, 2.0, atol=0.1)
    # at worst in one direction, m
    for n, expected in ((10, 0.0751), (20, 0.0182), (40, 0.00453)):
        apart = np.abs(hanging_shape(cable(n), TOP, END_FORCE, STREAM) - arc_in_current(n))
        assert apart.max() == pytest.approx(expected, rel=5e-3)


def test_second_order_of_the_elastic_catenary():
    """0.25 N/m of weight in water between two ends; 2 N horizontally, 3 N up at the top."""
    errors = []
    for n in (10, 20, 40, 80):
        one, exact = cable(n, mass_per_length=NEUTRAL + 0.25 / 9.81), catenary(n, 0.25, 2.0, 3.0)
        found = static_shape(one, TOP, exact[:, -1], np.zeros_like(exact), STILL)
        errors.append(float(np.abs(found - exact).max()))
        hanging = hanging_shape(one, TOP, np.array([2.0, 0.0, -7.0]), STILL)
        assert error(hanging, exact) < 8.0 / n**2
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    np.testing.assert_allclose(orders, 2.0, atol=0.1)
    np.testing.assert_allclose(errors[:3], [0.090, 0.0220, 0.00549], rtol=5e-3)


@pytest.mark.slow
def test_tension_of_a_neutral_cable_without_friction_is_constant():
    """Loads across the cable turn its tension and leave the size: in the limit of many segments."""
    exact, errors = math.hypot(3.0, 10.0), []
    for n in (40, 80, 160):
        one = cable(n)
        x = hanging_shape(one, TOP, END_FORCE, STREAM)
        tension = one.forces(x, np.zeros_like(x), STREAM).tension
        errors.append(float(np.abs(tension - exact).max()))
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    np.testing.assert_allclose(orders, 2.0, atol=0.1)
    assert errors[0] < 2e-3 * exact


@pytest.mark.parametrize("friction", [0.0, 0.02])
def test_reactions_are_the_loads(friction):
    one = cable(30, tangential_drag=friction, mass_per_length=0.07)
    x = static_shape(one, TOP, np.array([25.0, 3.0, 20.0]), np.zeros((3, 31)), STREAM)
    s = one.forces(x, np.zeros_like(x), STREAM)
    force = one.node_forces(s)
    load = s.drag.sum(axis=1)
    load[2] += (0.07 - NEUTRAL) * 9.81 * 40.0
    np.testing.assert_allclose(force[:, 0] + force[:, -1], load, rtol=1e-9, atol=1e-9)
    assert (s.tension > 0.0).all()


def test_between_two_ends_it_takes_the_shape_that_hung_there():
    one = cable(40, tangential_drag=0.02, mass_per_length=0.06)
    force, current = np.array([2.0, -1.0, 6.0]), np.array([[0.4], [0.2], [0.0]])
    hanging = hanging_shape(one, TOP, force, current)
    found = static_shape(one, TOP, hanging[:, -1], np.zeros((3, 41)), current)
    np.testing.assert_allclose(found, hanging, atol=1e-7)
    s = one.forces(found, np.zeros_like(found), current)
    # 1e-7 m of one segment is 2e-3 N
    np.testing.assert_allclose(one.node_forces(s)[:, -1], -force, atol=2e-3)


@pytest.mark.parametrize("segments", [5, 20, 200])
@pytest.mark.parametrize(
    ("bottom", "current", "changes"),
    [
        ((30.0, 0.0, 30.0), (0.5, 0.2, 0.0), {}),  # stretched by 2.4 m
        ((39.9, 0.0, 0.0), (0.0, 0.5, 0.0), {"axial_stiffness": 1e6}),
        ((5.0, 0.0, 20.0), (0.5, 0.0, 0.0), {}),  # loose
        ((-20.0, 0.0, 20.0), (0.5, 0.0, 0.0), {"tangential_drag": 0.02}),
        ((20.0, 0.0, 5.0), (0.0, 0.0, 0.0), {"mass_per_length": 0.2}),
        ((20.0, 0.0, 5.0), (0.0, 0.0, 0.0), {"mass_per_length": 0.03}),  # buoyant
        ((0.0, 0.0, 20.0), (0.0, 0.0, 0.0), {"mass_per_length": 0.2}),  # under its other end
        ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), {"mass_per_length": 0.2}),  # both ends in one place
        (
            (10.0, 0.0, 30.0),
            (0.0, 0.0, 0.0),
            {
                "tangential_drag": 0.02,
                "profile_depth": (0.0, 10.0, 15.0, 40.0),
                "profile_velocity": ((0.5, 0.5, -0.5, -0.5), (0.0, 0.0, 0.2, 0.4)),
            },
        ),
    ],
)
def test_forces_balance_at_every_node(segments, bottom, current, changes):
    one, water = cable(segments, **changes), np.array(current)[:, None]
    x = static_shape(one, TOP, np.array(bottom), np.zeros((3, segments + 1)), water)
    np.testing.assert_allclose(x[:, [0, -1]].T, [TOP, bottom], atol=1e-12)
    # A node is placed to 1e-14 m, and EA / l0 is up to 5e6 N/m.
    assert unbalanced(one, x, water) < 2e-7


def test_towed_at_one_speed_it_rests_in_its_own_frame():
    one, bottom = cable(20), np.array([30.0, 0.0, 17.0])
    towed = np.array([[-0.5], [0.0], [0.0]]) * np.ones(21)
    in_current = static_shape(one, TOP, bottom, np.zeros((3, 21)), STREAM)
    np.testing.assert_allclose(static_shape(one, TOP, bottom, towed, STILL), in_current, atol=1e-9)


@pytest.mark.parametrize("bottom", [(20.0, 0.0, 5.0), (0.0, 0.0, 10.0), (0.0, 0.0, 0.0)])
def test_loose_cable_without_load_is_an_unstretched_arc(bottom):
    one = cable(24)
    x = static_shape(one, TOP, np.array(bottom), np.zeros((3, 25)), STILL)
    lengths = np.linalg.norm(np.diff(x, axis=1), axis=0)
    np.testing.assert_allclose(lengths, one.l0, rtol=1e-11)
    middle = x[:, 12] - (TOP + bottom) / 2.0
    assert np.dot(middle, bottom) == pytest.approx(0.0, abs=1e-9)
    assert np.linalg.norm(middle) > 10.0
    turns = [np.linalg.norm(np.cross(a, b)) for a, b in itertools.pairwise(np.diff(x).T)]
    np.testing.assert_allclose(turns, turns[0], rtol=1e-9)  # alike at every node


def test_a_free_end_without_force_hangs_nowhere():
    with pytest.raises(ArithmeticError, match="anywhere"):
        hanging_shape(cable(5), TOP, np.zeros(3), STREAM)
