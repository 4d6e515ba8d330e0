"""The linear system of a chain, and the step in time."""

import os
import subprocess
import sys

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from seatrial_kits.videoray.cable.cable_shape import static_shape
from seatrial_kits.videoray.cable.cable_solver import Chain, implicit_step
from tests.kits.videoray.cables import NEUTRAL, STILL, STREAM, cable

SHEARED = {
    "profile_depth": (0.0, 5.0, 20.0, 40.0),
    "profile_velocity": ((0.1, 0.3, 0.2, 0.0), (0.0, 0.2, 0.1, 0.4)),
}


def crooked(one, seed):
    """Return positions and velocities of a cable with taut and slack segments."""
    random = np.random.default_rng(seed)
    n = one.segments + 1
    x = np.cumsum(one.l0 * (random.normal(size=(3, n)) * 0.4 + [[0.3], [0.5], [0.8]]), axis=1)
    return x, random.normal(size=(3, n))


@pytest.mark.parametrize("free", [7, 8])
@pytest.mark.parametrize("motion", ["positions", "velocities"])
def test_matrices_are_the_derivatives_of_the_forces(free, motion):
    one = cable(8, mass_per_length=0.08, tangential_drag=0.02, **SHEARED)
    current = np.array([[0.5], [0.2], [0.1]])
    x, v = crooked(one, 3)
    s = one.forces(x, v, current)
    assert 0 < np.count_nonzero(s.tension) < 8
    slopes, chain = one.slopes(s, s.axial), Chain(free)
    if motion == "positions":
        common = np.zeros_like(slopes.drag)
        common[:, 2] = -slopes.shear
        chain.load(slopes.pull, slopes.drag, common)
    else:
        chain.load(slopes.damping, np.zeros_like(slopes.drag), slopes.flow)
    columns = []
    for node in range(1, free + 1):
        for axis in range(3):
            ends = []
            for step in (1e-6, -1e-6):
                moved = [x.copy(), v.copy()]
                moved[motion == "velocities"][axis, node] += step
                ends.append(one.node_forces(one.forces(*moved, current))[:, 1 : free + 1])
            columns.append(((ends[1] - ends[0]) / 2e-6).T.ravel())
    expected = np.array(columns).T
    np.testing.assert_allclose(chain.dense(), expected, atol=1e-7 * np.abs(expected).max())


def test_solution_of_the_chain():
    one = cable(12, tangential_drag=0.02)
    x, v = crooked(one, 4)
    s = one.forces(x, v, STREAM)
    slopes, chain = one.slopes(s, s.axial), Chain(11)
    chain.load(slopes.pull, slopes.drag, slopes.flow)
    chain.diagonal += one.masses(s)[..., 1:-1]
    matrix = chain.dense()
    right = np.random.default_rng(5).normal(size=(3, 11))
    found = chain.solve(right).copy()
    np.testing.assert_allclose(found.T.ravel(), np.linalg.solve(matrix, right.T.ravel()), rtol=1e-9)


def test_singular_chain_says_so():
    chain = Chain(4)
    none = np.zeros((3, 3, 5))
    chain.load(none, none, none)
    with pytest.raises(ArithmeticError, match="singular"):
        chain.solve(np.ones((3, 4)))


def test_a_step_loses_no_momentum():
    """What the nodes gain and the ends get is the weight and the drag: here, the weight alone."""
    one = cable(15, mass_per_length=0.09, added_mass=0.0, normal_drag=0.0)
    x, v = crooked(one, 6)
    moved = implicit_step(one, Chain(14), x, v, STILL, 0.01)
    gained = (0.09 * one.l0 * (moved.v - v)[:, 1:-1]).sum(axis=1) / 0.01
    weight = np.array([0.0, 0.0, (0.09 - NEUTRAL) * 9.81 * 40.0])
    scale = np.abs(moved.pull).max()
    np.testing.assert_allclose(gained + moved.pull.sum(axis=1), weight, atol=1e-9 * scale)


def manoeuvre(t):
    """Return where the vehicle's end is at t (s), m, and its velocity, m/s: a sway of 0.4 m."""
    phase, way = 2.0 * t, np.array([0.24, 0.2, -0.25])
    start = np.array([34.0, 0.0, 17.0])
    return start + way * (1.0 - np.cos(phase)), 2.0 * way * np.sin(phase)


def with_ends(one, start, inner_x, inner_v, t):
    """Return all nodes of a manoeuvre from those between the ends, (3, N - 1)."""
    x, v = start.copy(), np.zeros_like(start)
    x[:, 1:-1], v[:, 1:-1] = inner_x, inner_v
    x[:, -1], v[:, -1] = manoeuvre(t)
    return x, v


def reference(one, start, times):
    """Return nodes over time by Radau's method, from the same right-hand side."""
    n = one.segments - 1

    def slope(t, y):
        inner_x, inner_v = y.reshape(2, 3, n)
        x, v = with_ends(one, start, inner_x, inner_v, t)
        return np.concatenate(
            (y[3 * n :], one.accelerations(one.forces(x, v, STREAM))[:, 1:-1].ravel())
        )

    begin = np.concatenate((start[:, 1:-1].ravel(), np.zeros(3 * n)))
    solved = solve_ivp(slope, (0.0, times[-1]), begin, "Radau", t_eval=times, rtol=1e-8, atol=1e-9)
    return [
        with_ends(one, start, *y.reshape(2, 3, n), t)[0]
        for t, y in zip(times, solved.y.T, strict=True)
    ]


def stepped(one, start, times, h):
    """Return nodes over time by implicit steps of ``h``, the end moving linearly in each."""
    chain, x, v, found = Chain(one.segments - 1), start.copy(), np.zeros_like(start), []
    for k in range(round(times[-1] / h)):
        goal = manoeuvre((k + 1) * h)[0]
        v[:, -1] = (goal - x[:, -1]) / h
        x, v, _ = implicit_step(one, chain, x, v, STREAM, h)
        if (k + 1) % round(0.1 / h) == 0:
            found.append(x)
    return found


@pytest.mark.slow
def test_the_step_converges_with_first_order():
    one = cable(10, tangential_drag=0.02)
    times = 0.1 * np.arange(1, 16)
    start = static_shape(one, np.zeros(3), manoeuvre(0.0)[0], np.zeros((3, 11)), STREAM)
    exact = np.array(reference(one, start, times))
    errors = [
        np.abs(np.array(stepped(one, start, times, h)) - exact).max() for h in (0.02, 0.01, 0.005)
    ]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    np.testing.assert_allclose(orders, 1.0, atol=0.2)
    assert errors[1] < 4e-3  # m, of 0.8 m of motion


@pytest.mark.slow
@pytest.mark.parametrize(
    "stiffness", [1e7, *(pytest.param(x, marks=pytest.mark.interop) for x in (2e4, 1e5))]
)
def test_any_stiffness_is_stable_at_10_ms(stiffness):
    """Explicit methods need less than 2 ms for 50 segments at 1e5 N."""
    one = cable(50, axial_stiffness=stiffness, tangential_drag=0.02)
    top, bottom = np.zeros(3), np.array([34.0, 0.0, 17.0])
    rest = static_shape(one, top, bottom, np.zeros((3, 51)), STREAM)
    random = np.random.default_rng(7)
    x, v, chain = rest.copy(), np.zeros_like(rest), Chain(49)
    v[:, 1:-1] = 0.05 * random.normal(size=(3, 49))
    for _ in range(2000):
        x, v, _ = implicit_step(one, chain, x, v, STREAM, 0.01)
    assert np.abs(x - rest).max() < 1e-3
    assert np.abs(v).max() < 1e-4


RUN = """
import hashlib, itertools, sys
from pathlib import Path
from seatrial.trial.running.run import Hooks, run_trial
from seatrial.trial.files.trial import load_trial
polls = itertools.count()
hooks = Hooks(stop_requested=lambda: next(polls) > 1000)
folder = run_trial(load_trial(sys.argv[2]), Path(sys.argv[1]), engine="direct", hooks=hooks).folder
print(hashlib.sha256((folder / "signals.csv").read_bytes()).hexdigest())
"""


@pytest.mark.interop
@pytest.mark.parametrize("trial", ["videoray-tethered-taut", "videoray-tethered-station"])
def test_a_run_is_the_same_on_another_processor(trial, tmp_path):
    """The processor decides which kernels OpenBLAS takes; those of AVX-512 round differently."""
    own = {name: value for name, value in os.environ.items() if name != "OPENBLAS_CORETYPE"}
    found = [
        subprocess.run(
            [sys.executable, "-c", RUN, str(tmp_path / f"run{len(kernels)}"), trial],
            env={**own, **kernels}, check=True, capture_output=True,
        ).stdout
        for kernels in ({}, {"OPENBLAS_CORETYPE": "Prescott"})
    ]  # fmt: skip
    assert found[0] == found[1] != b""
