"""Algebra of panel tables and of the memory, with random numbers: no fit, no file."""

import math
from types import SimpleNamespace

import casadi as ca
import numpy as np
import pytest

from seatrial.errors import InputError
from seatrial_kits.panels.memory import MODES, Memory, _Network, memories
from seatrial_kits.panels.panels import PanelTables, all_round
from seatrial_kits.panels.seakeeping_craft import _coupling, _damping, _parameters, radiation

G = 9.81
PLACE = np.array([0.6, -0.3, 0.2])


ROUND = np.radians(np.arange(0.0, 360.0, 30.0))


def tables(chi=ROUND):
    draw = np.random.default_rng(1)
    omega = np.array([1.0, 2.0, 3.5])
    excitation = draw.normal(size=(6, 3, len(chi))) + 1j * draw.normal(size=(6, 3, len(chi)))
    added, damping = draw.normal(size=(2, 3, 6, 6))
    return PanelTables(omega, added, damping, draw.normal(size=(6, 6)), omega, chi, excitation)


def transfer(place):
    """Return H of nu at the origin of the tables, H nu, of a velocity at a point ``-place`` off."""
    columns = []
    for unit in np.eye(6):
        velocity, rates = unit[:3], unit[3:]
        columns.append([*(velocity + np.cross(rates, place)), *rates])
    return np.array(columns).T


def test_tables_about_another_point_do_the_same_work():
    here = tables()
    there, H = here.moved(PLACE), transfer(PLACE)
    for name in ("added", "damping", "infinite"):
        expected = H.T @ getattr(here, name) @ H
        np.testing.assert_allclose(getattr(there, name), expected, atol=1e-12)
    for j in range(len(here.chi)):
        expected = H.T @ here.excitation[:, :, j]
        np.testing.assert_allclose(there.excitation[:, :, j], expected, atol=1e-12)


def test_an_excitation_is_of_the_phase_ahead_and_fades_out():
    here, chi = tables(), math.radians(60.0)
    w = np.array([0.5, 1.0, 2.0, 3.5, 3.9375, 4.375, 5.0])
    found = here.response(0.7, G)(w, w**2 / G, chi)
    at = here.excitation[:, :, 2] * np.exp(-1j * here.omega**2 / G * 0.7 * math.cos(chi))
    expected = [at[:, 0], at[:, 0], at[:, 1], at[:, 2], 0.5 * at[:, 2], 0 * at[:, 2], 0 * at[:, 2]]
    np.testing.assert_allclose(found, np.array(expected).T, atol=1e-12)


@pytest.mark.parametrize("side", [1, -1])
def test_one_side_is_met_from_the_other_too(side):
    chi = side * np.radians([0.0, 45.0, 90.0, 120.0, 150.0, 180.0])
    forces = tables(chi=chi).excitation
    round_chi, found = all_round(chi, forces)
    assert len(round_chi) == 10
    assert (np.diff(round_chi) > 0).all()
    mirror = np.array([1, -1, 1, -1, 1, -1])[:, None]
    for angle, force in zip(chi, np.moveaxis(forces, 2, 0), strict=True):
        met = {angle: force}
        if abs(math.sin(angle)) > 1e-6:  # ahead and astern are met once, as they are
            met[-angle] = mirror * force
        for turned, expected in met.items():
            place = np.argmin(np.abs(np.remainder(turned, math.tau) - round_chi))
            np.testing.assert_allclose(found[:, :, place], expected)
    with pytest.raises(InputError, match="more than 45 degrees apart: 0, 50, 120, 180, 240, 310"):
        all_round(np.radians([0.0, 50.0, 120.0, 180.0]), forces[:, :, :4])


# ------------------------------------------------------------------ memory


def network(seed=2):
    """Return modes, R, not negative, and B of one group."""
    draw = np.random.default_rng(seed)
    root = np.tril(draw.normal(size=(MODES, MODES)))
    omega = draw.uniform(0.5, 4.0, MODES)
    return Memory(omega, root @ root.T, draw.normal(size=(MODES, 3)), np.zeros(3)), root


def test_the_response_is_that_of_its_states():
    memory, _ = network()
    W, n = np.diag(memory.omega), MODES
    A = np.block([[-memory.damping, -W], [W, np.zeros((n, n))]])
    B = np.vstack([memory.coupling, np.zeros((n, 3))])
    found = memory.response(np.array([0.4, 2.0, 7.0]))
    for w, K in zip((0.4, 2.0, 7.0), found, strict=True):
        np.testing.assert_allclose(K, B.T @ np.linalg.solve(1j * w * np.eye(2 * n) - A, B))


def wanted_of(half):
    return half + half.transpose(0, 2, 1)


def test_the_errors_of_a_fit_have_their_derivatives():
    draw, omega = np.random.default_rng(3), np.array([0.5, 1.2, 2.5, 4.0])
    half = draw.normal(size=(4, 3, 3)) + 1j * draw.normal(size=(4, 3, 3))
    fit = _Network(omega, wanted_of(half))
    parameters = 0.4 * draw.normal(size=4 * MODES + MODES * (MODES + 1) // 2)
    memory = fit.memory(parameters)
    off = memory.response(omega) - wanted_of(half)
    rows, columns = np.tril_indices(3)
    wanted = off[:, rows, columns].ravel()
    # Errors are of K in units of its own middle frequency: the same numbers.
    np.testing.assert_allclose(fit.error(parameters), [*wanted.real, *wanted.imag], atol=1e-9)
    h = 1e-6
    slopes = [
        (fit.error(parameters + h * e) - fit.error(parameters - h * e)) / (2 * h)
        for e in np.eye(len(parameters))
    ]
    np.testing.assert_allclose(fit.jacobian(parameters), np.array(slopes).T, atol=1e-6)


def test_a_hull_without_a_centre_plane_is_refused():
    omega = np.array([1.0, 2.0, 3.0])
    damping = np.tile(np.diag([2.0, 3, 5, 1, 4, 6]), (3, 1, 1))
    added, infinite = 0 * damping, np.zeros((6, 6))
    damping[:, 0, 1] = damping[:, 1, 0] = 0.03 * math.sqrt(2 * 3)
    with pytest.raises(InputError, match="push the hull sideways"):
        memories(omega, added, damping, infinite)


def test_the_parameters_of_a_craft_are_those_of_its_memories():
    both = [network(5)[0], network(6)[0]]
    both = [
        Memory(m.omega, m.damping, m.coupling, np.array(missed))
        for m, missed in zip(both, ([0.1, 0.2, 0.3], [0.4, 0.5, 0.6]), strict=True)
    ]
    found = _parameters(both)
    assert found["memory_missed"] == [0.1, 0.4, 0.2, 0.5, 0.3, 0.6]
    p = SimpleNamespace(**{name: ca.DM(values) for name, values in found.items()})
    B, R = (np.array(ca.DM(each(p))) for each in (_coupling, _damping))
    W = found["memory_omega"]
    for n, (memory, group) in enumerate(zip(both, ((0, 2, 4), (1, 3, 5)), strict=True)):
        part = slice(n * MODES, (n + 1) * MODES)
        np.testing.assert_array_equal(W[part], memory.omega)
        np.testing.assert_allclose(B[part][:, group], memory.coupling)
        np.testing.assert_allclose(R[part, part], memory.damping)
    assert np.count_nonzero(B) == 2 * 3 * MODES
    assert np.count_nonzero(R) == 2 * MODES**2
    state = np.random.default_rng(7).normal(size=4 * MODES)
    held = radiation(SimpleNamespace(parameters=p, inputs=SimpleNamespace(memory=ca.DM(state))))
    np.testing.assert_allclose(np.array(ca.DM(held)).ravel(), -B.T @ state[: 2 * MODES])
