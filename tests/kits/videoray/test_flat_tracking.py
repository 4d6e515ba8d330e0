"""Flat outputs and the law that tracks with them: identities, (8.1), poles, table 8.1."""

import csv
from types import SimpleNamespace

import casadi as ca
import numpy as np
import pytest

from seatrial.errors import InputError
from seatrial_kits.videoray.tracking.flat_outputs import (
    controllability_matrix,
    flat_output,
    kronecker_indices,
    tracking_gain,
)
from seatrial_kits.videoray.tracking.flat_tracking import (
    FlatTracking,
    vessel_flat_output,
    vessel_jacobians,
)
from seatrial_kits.videoray.vessel.surface_vessel import SurfaceVessel
from tests.kits.videoray.vessel_loop import (
    CASES,
    GAINS,
    REFERENCE,
    STEPS,
    assert_columns,
    build,
    follow,
    profile,
    started,
    table,
)


def still(matrix):
    """Return d/dt of a constant matrix."""
    return ca.DM.zeros(matrix.shape)


def jacobians(variant, nu, **changes):
    values = SimpleNamespace(**{k: ca.DM(v) for k, v in {**profile(variant), **changes}.items()})
    x = ca.SX.sym("x", 3)
    matrices = ca.Function("AB", [x], list(vessel_jacobians(x, values)))
    return [np.array(matrix) for matrix in matrices(nu)], values


# ---------------------------------------------------------------------- general systems


def test_kronecker_indices():
    chain = np.diag([1.0, 1.0], 1)  # x1' = x2, x2' = x3
    assert kronecker_indices(chain, np.eye(3)[:, [2]]) == (3,)
    assert kronecker_indices(chain, np.eye(3)[:, [2, 0]]) == (3, 0)
    assert kronecker_indices(chain, np.eye(3)[:, [1, 2]]) == (2, 1)
    assert kronecker_indices(chain, np.eye(3)[:, [0]]) == (1,)  # not controllable
    # Columns of very different length are as independent as their directions.
    assert kronecker_indices(chain, np.array([[0, 0], [1e-12, 0], [0, 1.0]])) == (2, 1)


@pytest.mark.parametrize("indices", [(1, 2), (2, 1)])
def test_flat_outputs_depend_on_inputs_in_their_last_derivative_only(indices):
    generator = np.random.default_rng(3)
    A, B = generator.normal(size=(3, 3)), generator.normal(size=(3, 2))
    C_K = controllability_matrix(ca.DM(A), ca.DM(B), indices, still)
    F = np.array(flat_output(C_K, indices, [1.0, 1.0]))
    for i, order in enumerate(indices):
        for j in range(order):
            effect = F[i] @ np.linalg.matrix_power(A, j) @ B
            wanted = np.eye(2)[i] if j == order - 1 else np.zeros(2)
            # The input of another group may act through a shorter chain.
            own = [k for k in range(2) if indices[k] > j]
            np.testing.assert_allclose(effect[own], wanted[own], atol=1e-12)


@pytest.mark.parametrize("indices", [(1, 2), (2, 1)])
def test_gain_places_the_poles(indices):
    generator = np.random.default_rng(4)
    A, B = generator.normal(size=(3, 3)), generator.normal(size=(3, 2))
    C_K = controllability_matrix(ca.DM(A), ca.DM(B), indices, still)
    F = flat_output(C_K, indices, [3.0, -0.5])
    gains = {1: [(2.0,), (12.0, 7.0)], 2: [(12.0, 7.0), (2.0,)]}[indices[0]]
    G = np.array(tracking_gain(ca.DM(A), ca.DM(B), F, indices, gains, still))
    poles = np.sort(np.linalg.eigvals(A + B @ G).real)
    np.testing.assert_allclose(poles, [-4.0, -3.0, -2.0], rtol=1e-9)


# ---------------------------------------------------------------------- the vessel's


@pytest.mark.parametrize("variant", STEPS)
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_laws_jacobians_are_the_vessels(variant, sign):
    nu = [0.3, -0.2, 0.5]
    (A, B), _ = jacobians(variant, nu, yaw_coupling_sign=sign)
    craft = build(SurfaceVessel, variant, yaw_coupling_sign=sign)
    linear = craft.linearise(np.array([0, 0, 0, *nu]))
    np.testing.assert_allclose(A, linear.A[3:, 3:], rtol=1e-15, atol=1e-18)
    commands = [linear.u_names.index(f"command.{axis}") for axis in ("t1", "t2")]
    np.testing.assert_allclose(B, linear.B[3:, commands], rtol=1e-15)


def test_scaled_by_the_determinant_the_flat_outputs_are_the_sources():
    """(8.1) with psi_d read as R_d, and the source's sign of the yaw coupling."""
    U, V, R = 0.05, 0.0217588514953, -0.2
    (A, B), values = jacobians("table75", [U, V, R], yaw_coupling_sign=-1.0)
    (m11, m22, m33), (d11, _, d33), (C1, C2) = (
        profile("table75")[name] for name in ("mass", "damping", "thrust")
    )
    middle = m33 * (C2**2 * (d11 - V * m22) + C2**2 * V * m11) - C2**2 * m11 * (d33 - V * m22)
    # The first row of (8.1) is that of b2's partner: its columns are u, v and r.
    first = [
        -(C2**2) * (R * m33 - U * m11) / (m22 * m33**2),
        middle / (m11**2 * m33**2),
        -(C2**2) * (R * m33 - U * m11) / (m11 * m22 * m33),
    ]
    second = [0.0, 2 * C1 * C2 / (m11 * m33), 0.0]
    F = np.array(vessel_flat_output(ca.DM(A), ca.DM(B), values, "determinant", still))
    np.testing.assert_allclose(np.abs(F[1]), np.abs(second), rtol=1e-13, atol=1e-18)
    np.testing.assert_allclose(F[0], np.array(first), rtol=1e-13)


def test_scaled_by_constants_the_flat_outputs_are_readable():
    U, V, R = 0.05, 0.0217588514953, -0.2
    (A, B), values = jacobians("physical", [U, V, R])
    m11, _, m33 = profile("physical")["mass"]
    F = np.array(vessel_flat_output(ca.DM(A), ca.DM(B), values, "constant", still))
    np.testing.assert_allclose(F[0, [0, 2]], [m11, m33 / 0.1], rtol=1e-12)
    np.testing.assert_allclose(F[1], [0, 1, 0], atol=1e-12)
    # The state follows from F1, F2 and F2': T is regular, and F1, F2 know no input.
    T = np.vstack([F, F[1] @ A])
    dx = np.array([0.3, -0.2, 0.1])
    np.testing.assert_allclose(np.linalg.solve(T, T @ dx), dx, rtol=1e-12)
    # C_K's other columns are annihilated.
    np.testing.assert_allclose([F[0] @ B[:, 1], F[0] @ A @ B[:, 1]], 0, atol=1e-12 * m11)
    np.testing.assert_allclose(F[1] @ B, 0, atol=1e-12)


@pytest.mark.parametrize(
    ("case", "poles", "bound"),
    # A triple pole moves by the cube root of what rounding does to the polynomial.
    [(1, [-2, -2, -2], 2e-4), (2, [-0.5, -0.125 - 0.99215674j, -0.125 + 0.99215674j], 1e-8)],
)
def test_poles_of_the_frozen_loop(case, poles, bound):
    law = started(FlatTracking, "table75", **CASES[case], gain=GAINS[case], design="LTI")
    for k in (0, 1200, 10**7):
        (A, B), _ = jacobians("table75", list(law._row(k).velocity))
        G = np.array(law._gains[min(k, len(law._gains) - 1)])
        np.testing.assert_allclose(
            np.sort_complex(np.linalg.eigvals(A + B @ G)), np.sort_complex(poles), atol=bound
        )


@pytest.mark.parametrize("case", [1, 2])
def test_gains_of_the_reference(case):
    law = started(FlatTracking, "table75", **CASES[case], gain=GAINS[case])
    expected = table(f"vessel_case{case}_nominal")
    found = np.array([law._gains[min(10 * k, len(law._gains) - 1)] for k in range(241)])
    for i in range(2):
        for j in range(3):
            column = expected[f"G{i + 1}{j + 1}"]
            assert np.abs(found[:, i, j] - column).max() < 2e-11 * np.abs(column).max()


@pytest.mark.parametrize(
    "case", [1, *(pytest.param(case, marks=pytest.mark.interop) for case in CASES if case != 1)]
)
@pytest.mark.parametrize("scaling", ["constant", "determinant"])
def test_flat_outputs_decay_as_prescribed_along_the_trajectory(case, scaling):
    """The linear closed loop is integrated; F and its scaling are computed by hand here."""
    h, stop = 0.005, 20.0  # two samples of the law per step of the integrator
    trajectory = {**CASES[case], "duration": 15.0}
    law = started(
        FlatTracking, "table75", **trajectory, gain=[0.5, 1.0, 0.25], scaling=scaling, period=h / 2
    )
    last = len(law._gains) - 1
    (m11, m22, m33), (_, d22, _), (E1, E2) = (
        profile("table75")[name] for name in ("mass", "damping", "thrust")
    )
    B = np.array([[E1 / m11, E2 / m11], [0, 0], [E1 / m33, -E2 / m33]])

    def A(k):
        U, V, R = law._row(k).velocity
        c = m11 - m22
        return np.array(
            [
                [0, m22 * R / m11, m22 * V / m11],
                [-m11 * R / m22, -d22 / m22, -m11 * U / m22],
                [c * V / m33, c * U / m33, 0],
            ]
        )

    def flat(k, dx):
        b = A(k) @ B[:, 1]
        c1 = -(m11 * b[0] + m33 * b[2]) / b[1]
        F = np.array([m11 * dx[0] + c1 * dx[1] + m33 * dx[2], dx[1]])
        det = np.linalg.det(np.column_stack([B, b]))
        return F * ([1, 1] if scaling == "constant" else [det / (2 * E1), det / b[1]])

    def slope(k, dx):
        return A(k) @ dx + B @ (np.array(law._gains[min(k, last)]) @ dx)

    dx, F = np.array([0.01, -0.02, 0.03]), []
    for n in range(round(stop / h)):
        k = 2 * n
        F.append(flat(k, dx))
        k1 = slope(k, dx)
        k2 = slope(k + 1, dx + h / 2 * k1)
        k3 = slope(k + 1, dx + h / 2 * k2)
        k4 = slope(k + 2, dx + h * k3)
        dx = dx + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    F, t = np.array(F), h * np.arange(round(stop / h))
    scale = np.abs(F).max(axis=0)
    assert np.abs(F[:, 0] - F[0, 0] * np.exp(-0.5 * t)).max() < 1e-10 * scale[0]
    # F2 has two free constants, value and slope, which a fit finds; what is left is the error.
    w = np.sqrt(1 - 0.125**2)
    modes = np.exp(-0.125 * t)[:, None] * np.column_stack([np.cos(w * t), np.sin(w * t)])
    constants, *_ = np.linalg.lstsq(modes, F[:, 1])
    assert np.abs(F[:, 1] - modes @ constants).max() < 1e-10 * scale[1]


def test_without_the_derivatives_the_decay_is_another_one():
    designs = [
        started(FlatTracking, "table75", **CASES[2], gain=GAINS[2], design=design)._gains
        for design in ("LTV", "LTI")
    ]
    assert np.abs(np.subtract(designs[0], designs[1])[1200]).max() > 1e-4
    constant = [started(FlatTracking, "table75", design=design)._gains for design in ("LTV", "LTI")]
    np.testing.assert_allclose(constant[0], constant[1], rtol=1e-14)


# ---------------------------------------------------------------------- nonlinear loops


@pytest.mark.parametrize("case", [1, 2])
def test_saturated_trajectories_of_the_reference(case):
    law = started(FlatTracking, "table75", **CASES[case], gain=GAINS[case], period=0.02)
    rows = follow(law, 240.0, "table75", (0.01, 0.01, -0.01))
    expected = table(f"vessel_case{case}_tab75_sat")
    assert_columns(rows[::50], ("u", "v", "r", "tau1", "tau2"), expected, 1e-8)


def biased(axis, size, period=0.02, stop=200.0):
    law = started(FlatTracking, "table81_fit", yaw_rate=-0.2, command_limit=1e9, period=period)

    def step(t):
        bias = [0.0, 0.0, 0.0]
        bias["uvr".index(axis)] = size if 112.0 <= t < 187.0 else 0.0
        return {"nu_bias": bias}

    return follow(law, stop, "table81_fit", inputs=step)


@pytest.mark.interop
@pytest.mark.parametrize(("which", "axis"), [("surge", "u"), ("sway", "v")])
def test_transients_of_table_81(which, axis):
    rows = biased(axis, 1.0)
    assert_columns(rows[::25], ("u", "v", "r"), table(f"table81_transient_{which}"), 1e-7)


def published():
    with (REFERENCE / "videoray_table81_repro.csv").open() as file:
        next(file)
        return {row["disturbance"]: row for row in csv.DictReader(file)}


@pytest.mark.parametrize(
    ("which", "axis", "size"), [("surge", "u", 1.0), ("sway", "v", 1.0), ("yaw", "r", 0.1)]
)
def test_table_81(which, axis, size):
    found = biased(axis, size, period=0.1, stop=186.5)[-1, 1:4]
    row = published()[which]
    # Half a unit of the last printed digit: 5 decimals for u, 4 for v and r.
    for value, name, half in zip(found, "uvr", (5e-6, 5e-5, 5e-5), strict=True):
        assert abs(value - float(row[f"{name}_published"])) < half, name
        assert abs(value - float(row[f"{name}_model"])) < 1e-9, name


def test_the_law_is_local():
    """Case 2 with table 7.5: errors of 1e-4 vanish, of 1e-2 grow without end."""
    for size, grows in ((1e-4, False), (1e-2, True)):
        law = started(FlatTracking, "table75", **CASES[2], gain=GAINS[2])
        rows = follow(law, 60.0, "table75", (size, size, -size))
        assert (np.abs(rows[-1, 1:4] - rows[-1, 6:9]).max() > 1.0) == grows


def test_a_trajectory_that_loses_control_of_sway_is_refused():
    with pytest.raises(InputError, match="must be on one side of 0"):
        started(FlatTracking, "physical", **CASES[2])
