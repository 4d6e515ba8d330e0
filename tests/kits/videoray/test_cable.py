"""Forces of a cable, and how they change."""

import math

import numpy as np
import pytest

from seatrial_kits.videoray.cable.cable_solver import linearised
from tests.kits.videoray.cables import NEUTRAL, STILL, cable


def straight(one, direction, strain=0.0):
    """Return nodes on a straight line from the origin."""
    shares = one.l0 * (1.0 + strain) * np.arange(one.segments + 1)
    return np.outer(np.array(direction) / np.linalg.norm(direction), shares)


def test_tension_is_ea_times_strain_and_none_when_slack():
    one = cable(8)
    for strain, expected in ((1e-3, 20.0), (0.0, 0.0), (-0.1, 0.0)):
        s = one.forces(straight(one, (1, 2, 2), strain), np.zeros((3, 9)), STILL)
        np.testing.assert_allclose(s.tension, expected, atol=1e-10)
    pushed = one.forces(straight(one, (1, 2, 2), -0.1), np.zeros((3, 9)), STILL, compression=True)
    np.testing.assert_allclose(pushed.tension, -2000.0, rtol=1e-12)


def test_damping_resists_stretching_along_the_cable_alone():
    one = cable(5, normal_drag=0.0, mass_per_length=0.05)
    x = straight(one, (0, 0, 1), -0.01)
    v = np.array([[0.3], [0.0], [0.2]]) * np.arange(6)
    # c = damping_ratio sqrt(EA m), here 0.2 sqrt(2e4 * 0.05), and 0.2 m/s per segment
    s = one.forces(x, v, STILL)
    np.testing.assert_allclose(s.axial, 0.2 * math.sqrt(1e3) * 0.2, rtol=1e-12)


@pytest.mark.parametrize(
    ("direction", "flow", "expected"),
    [
        # 1/2 rho d Cn U^2 = 4.908 U |U| N/m across, with Ct = 0.02 0.0818 along
        ((0, 0, 1), (0.5, 0.0, 0.0), (4.908 * 0.25, 0.0, 0.0)),
        ((0, 0, 1), (0.0, 0.0, -0.5), (0.0, 0.0, -0.0818 * 0.25)),
        ((0, 1, 0), (0.3, 0.5, 0.4), (4.908 * 0.5 * 0.3, 0.0818 * 0.25, 4.908 * 0.5 * 0.4)),
        ((3, 0, 4), (0.5, 0.0, 0.0), (4.908 * 0.16 * 0.8 + 0.0818 * 0.09 * 0.6, 0.0, -4.908 * 0.16 * 0.6 + 0.0818 * 0.09 * 0.8)),
    ],
)  # fmt: skip
def test_drag_across_and_along(direction, flow, expected):
    one = cable(5, tangential_drag=0.02)
    s = one.forces(straight(one, direction), np.zeros((3, 6)), np.array(flow)[:, None])
    np.testing.assert_allclose(s.drag / one.l0, np.outer(expected, np.ones(5)), atol=1e-12)
    # A cable that moves through still water is dragged alike.
    moving = one.forces(straight(one, direction), -np.outer(flow, np.ones(6)), STILL)
    np.testing.assert_allclose(moving.drag, s.drag, atol=1e-12)


def test_forces_between_nodes_cancel_and_loads_remain():
    one = cable(12, mass_per_length=0.08, tangential_drag=0.02)
    random = np.random.default_rng(1)
    x = straight(one, (1, 0, 2)) + 0.3 * random.normal(size=(3, 13))
    s = one.forces(x, random.normal(size=(3, 13)), np.array([[0.4], [0.1], [0.0]]))
    load = s.drag.sum(axis=1)
    load[2] += (0.08 - NEUTRAL) * 9.81 * 40.0
    np.testing.assert_allclose(one.node_forces(s).sum(axis=1), load, rtol=1e-10)


def test_current_profile_is_piecewise_linear_and_constant_outside():
    one = cable(
        5,
        profile_depth=(2.0, 6.0, 10.0),
        profile_velocity=((1.0, 0.2, 0.2), (0.0, 0.4, -0.4)),
    )
    depth = np.array([0.0, 4.0, 6.5, 8.0, 30.0])
    water, shear = one.water(depth, np.array([[0.1], [0.0], [0.05]]))
    np.testing.assert_allclose(water[0], [1.1, 0.7, 0.3, 0.3, 0.3], rtol=1e-14)
    np.testing.assert_allclose(water[1], [0.0, 0.2, 0.3, 0.0, -0.4], atol=1e-15)
    np.testing.assert_allclose(water[2], 0.05)
    np.testing.assert_allclose(shear[0], [0.0, -0.2, 0.0, 0.0, 0.0], atol=1e-15)
    np.testing.assert_allclose(shear[1], [0.0, 0.1, -0.2, -0.2, 0.0], atol=1e-15)


def test_mass_matrices_and_accelerations_belong_together():
    one = cable(6, mass_per_length=0.08, added_mass=1.3)
    random = np.random.default_rng(2)
    x = np.cumsum(random.normal(size=(3, 7)), axis=1)
    x[:, 4] = x[:, 2]  # folded: no mean tangent at node 3
    s = one.forces(x, random.normal(size=(3, 7)), STILL)
    masses, accelerations = one.masses(s), one.accelerations(s)
    carried = np.einsum("ijk,jk->ik", masses, accelerations)
    np.testing.assert_allclose(carried, one.node_forces(s), rtol=1e-10, atol=1e-9)
    # Along a straight cable there is no added mass, across it there is.
    s = one.forces(straight(one, (0, 0, 1)), np.zeros((3, 7)), STILL)
    added = 1.3 * NEUTRAL * one.lumps
    np.testing.assert_allclose(one.masses(s)[2, 2], 0.08 * one.lumps, rtol=1e-12)
    np.testing.assert_allclose(one.masses(s)[0, 0], 0.08 * one.lumps + added, rtol=1e-12)


@pytest.mark.parametrize("segments", [5, 10, 50])
def test_axial_modes(segments):
    """omega_k = (2 / l0) sqrt(EA / m) sin((2 k - 1) pi / 4 N), fixed at the top, free below."""
    one = cable(segments, damping_ratio=0.0)
    direction = np.array([0.48, 0.6, 0.64])
    x = straight(one, direction, 1e-6)  # none is slack by round-off
    matrix = linearised(one, x, np.zeros_like(x), STILL, free_end=True)
    n = 3 * segments
    found = np.sqrt(np.abs(np.linalg.eigvals(matrix[n:, :n]).real))
    axial = np.sort(found)[-segments:]  # hardly loaded, it has hardly any stiffness across
    k = np.arange(1, segments + 1)
    exact = 2 / one.l0 * math.sqrt(2e4 / NEUTRAL) * np.sin((2 * k - 1) * math.pi / (4 * segments))
    np.testing.assert_allclose(axial, exact, rtol=1e-8)
    assert axial[0] / math.tau == pytest.approx(
        {5: 3.8398, 10: 3.8517, 50: 3.8555}[segments], abs=5e-5
    )


def test_shortest_axial_wave_has_the_damping_ratio():
    # Between two fixed ends N lumps swing against each other at (2 / l0) sqrt(EA / m) sin(..).
    one = cable(40, damping_ratio=0.2)
    x = straight(one, (0, 0, 1), 1e-6)
    eigenvalues = np.linalg.eigvals(linearised(one, x, np.zeros_like(x), STILL))
    fastest = eigenvalues[np.argmax(np.abs(eigenvalues))]
    ratio = -fastest.real / abs(fastest)
    assert ratio == pytest.approx(0.2 * math.sin(39 * math.pi / 80), rel=1e-8)


def test_transverse_modes_of_a_taut_cable_carry_added_mass():
    """A beaded string: omega_k = 2 sqrt(T / (Ls (m + rho A Ca) l0)) sin(k pi / 2 N)."""
    one = cable(12, damping_ratio=0.0, added_mass=0.8)
    x = straight(one, (1, 0, 0), 5e-3)  # T = 100 N
    matrix = linearised(one, x, np.zeros_like(x), STILL)
    found = np.sort(np.sqrt(np.abs(np.linalg.eigvals(matrix[33:, :33]).real)))[:22]
    k = np.arange(1, 12)
    lump = 1.8 * NEUTRAL * one.l0
    exact = 2 * math.sqrt(100.0 / (one.l0 * 1.005 * lump)) * np.sin(k * math.pi / 24)
    np.testing.assert_allclose(found, np.repeat(exact, 2), rtol=1e-8)


def test_neutral_means_neutral():
    assert cable(7).weight == pytest.approx(np.zeros(8), abs=1e-15)
