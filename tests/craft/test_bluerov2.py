"""The BlueROV2 Heavy: reference trajectories, eigenvalues, closed forms, its thrusters."""

import math

import numpy as np
import pytest
from scipy.signal import StateSpace, lsim

from seatrial.errors import InputError
from tests.devices.running import run

from .references import STATES, assert_met, columns, row, shipped

RUNS = ("surge", "turn", "dive", "excitation", "current")
V = tuple(f"V{n}" for n in range(1, 9))
T = tuple(f"T{n}" for n in range(1, 9))
WRENCH = ("X", "Y", "Z", "K", "M", "N")
A0, A1, A2, B1 = 108700.0, 9258.0, 89.0, 6136.0
SINES = [
    *((15, 0.10, 0.0), (15, 0.13, 0.5), (12, 0.17, 1.0)),
    *((0.4, 0.23, 1.5), (0.4, 0.19, 2.0), (0.8, 0.11, 2.5)),
]


def rov(variant="benchmark", **values):
    start = {"eta_start": (0, 0, 5, 0, 0, 0)}
    return shipped("rov", "bluerov2.rov", variant, **{**start, **values})


def thruster(**values):
    component = shipped("polynomial-thruster", "bluerov2.thruster", **values)
    component.initialise()
    component.begin()
    return component


def curve(command):
    """Return von Benzon's eq. 18, N."""
    x = np.clip(command, -1, 1)
    return -140.3 * x**9 + 389.9 * x**7 - 404.1 * x**5 + 176.0 * x**3 + 8.9 * x


class Lagging:
    """Thrusts of held commands, by the eigenvectors of the lag."""

    _A = np.array([[0.0, 1, 0], [0, 0, 1], [-A0, -A1, -A2]])
    _poles, _vectors = np.linalg.eig(_A)

    def __init__(self, data):
        self._t, self._wanted = data["t"], curve(np.array([data[v] for v in V]))
        z, rows = np.zeros((3, 8), complex), []
        for k in range(len(self._t)):
            rows.append(z)
            z = self._after(z, self._wanted[:, k], 0.1)
        self._rows = rows

    def _after(self, z, wanted, duration):
        steady = np.outer([1, 0, 0], wanted / A0)
        kept = self._vectors @ np.diag(np.exp(self._poles * duration))
        return steady + kept @ np.linalg.solve(self._vectors, z - steady)

    def __call__(self, t):
        k = row(self._t, t)
        z = self._after(self._rows[k], self._wanted[:, k], t - self._t[k])
        return (A0 * z[0] + B1 * z[1]).real


def inputs(name, data):
    if "V1" in data:
        lagging = Lagging(data)
        return lambda t, _: {"thrust": lagging(t)}
    held = np.array([data[axis] for axis in WRENCH])

    def wrench(t, _):
        if name == "excitation":
            load = [A * math.sin(math.tau * f * t + p) for A, f, p in SINES]
        else:
            load = held[:, row(data["t"], t)]
        return {"force_1": load[:3], "moment_1": load[3:]}

    return wrench


def jumps(name, data):
    if name == "excitation":
        return []
    held = np.array([data[axis] for axis in (V if "V1" in data else WRENCH)])
    return data["t"][1:][np.abs(np.diff(held)).max(axis=0) > 0]


@pytest.mark.parametrize("name", RUNS)
def test_reference_trajectories_are_met(name):
    data = columns(f"bluerov2_{name}")
    start = [data[s][0] for s in STATES]
    current = (0.4, -0.25, 0.05) if name == "current" else (0, 0, 0)
    vehicle = rov(eta_start=start[:6], nu_start=start[6:], current=current)
    given = inputs(name, data)
    found = vehicle.reference(data["t"], given, jumps(name, data), rtol=1e-12, atol=1e-13)
    assert_met(found.x, data, STATES)


@pytest.mark.parametrize("name", ["turn", "dive"])
def test_thrusts_are_met(name):
    data = columns(f"bluerov2_{name}")
    stop_ms = round(1000 * data["t"][-1])
    for v, t in zip(V, T, strict=True):
        rows = run(
            thruster(), ["thrust"], stop_ms, 100, lambda ms, v=v: {"command": data[v][ms // 100]}
        )
        np.testing.assert_allclose(np.ravel(rows), data[t], rtol=1e-9, atol=2e-8)


# ---------------------------------------------------------------------- the thruster


@pytest.mark.parametrize(
    ("command", "newtons"),
    [
        (0.1, 1.0619978),
        (0.5, 16.5939453),
        (0.9, 29.8298577),
        (1, 30.4),
        (2, 30.4),
        (-0.5, -16.5939453),
    ],
)
def test_thrust_in_the_end(command, newtons):
    found = thruster(command=command)
    found.advance(0.0, 10.0)
    assert found.get("thrust") == pytest.approx(newtons, abs=5e-8)


@pytest.mark.parametrize("step_ms", [1, 7, 10, 35])
def test_the_lag_is_that_of_its_transfer_function_whatever_the_step(step_ms):
    """Beside SciPy's response of the same state space, over two jumps of the command."""
    found = thruster()
    commands = {0: 0.3, 70: -0.6}
    rows = run(
        found, ["thrust"], 350, step_ms, lambda ms: {"command": commands[70 if ms >= 70 else 0]}
    )
    t = np.arange(351) / 1000
    u = np.where(np.arange(351) >= 70, curve(-0.6), curve(0.3))
    system = StateSpace(Lagging._A, [[0], [0], [1]], [[A0, B1, 0]], [[0]])
    _, expected, _ = lsim(system, u, t, interp=False)
    np.testing.assert_allclose(np.ravel(rows), expected[::step_ms], rtol=1e-9, atol=1e-9)


def test_failures_of_the_thruster():
    def after(fault, **values):
        found = thruster(command=0.5, fault=fault, **values)
        found.advance(0.0, 0.02)
        return found.get("thrust")

    whole = after("none")
    assert 0.5 < whole / curve(0.5) < 0.7
    assert after("wrong") == pytest.approx(whole / 2)
    assert after("off") == 0.0
    slow = thruster(command=0.5, fault="slow")
    slow.advance(0.0, 0.2)
    assert slow.get("thrust") == pytest.approx(whole)


def test_a_lag_that_is_not_stable_is_refused():
    with pytest.raises(
        InputError, match=r"lag_poles is \[1\.0, 1\.0, 0\.5\], whose lag is not stable"
    ):
        thruster(lag_poles=(1.0, 1.0, 0.5))


# ---------------------------------------------------------------------- the hull


EIGENVALUES = {
    "benchmark": {"phi p": [1.71192594j], "theta q": [-1.09589041 + 1.55053974j], "w": [-1.02548166], "u": [-0.68982880]},
    "wu": {"v phi p": [-0.12599447 + 2.83534492j, -0.2549], "u theta q": [-0.12704872 + 2.84498809j, -0.2343], "w": [-0.1987], "r": [-0.2500]},
}  # fmt: skip


@pytest.mark.parametrize("variant", EIGENVALUES)
def test_eigenvalues_at_rest(variant):
    A = rov(variant).linearise(np.array([0, 0, 5.0, *np.zeros(9)])).A
    for states, expected in EIGENVALUES[variant].items():
        rows = [STATES.index(s) for s in states.split()]
        found = np.linalg.eigvals(A[np.ix_(rows, rows)])
        for known in expected:
            assert np.abs(found - known).min() < (1e-5 if abs(known) > 0.3 else 1e-4), states


@pytest.mark.parametrize(("variant", "speed"), [("benchmark", 0.4751854), ("wu", 0.4657500)])
def test_without_a_pilot_pitch_grows_above_a_speed(variant, speed):
    def growth(u):
        vehicle = rov(variant, center_of_buoyancy=(0, 0, -0.01) if variant == "benchmark" else 0.0)
        x = np.array([0, 0, 5.0, 0, 0, 0, u, *np.zeros(5)])
        rows = [STATES.index(s) for s in ("theta", "w", "q")]
        return np.linalg.eigvals(vehicle.linearise(x).A[np.ix_(rows, rows)]).real.max()

    assert growth(speed - 2e-3) < 0.0 < growth(speed + 2e-3)


@pytest.mark.parametrize(
    ("axis", "speeds"),
    [("u", (0.6055530, 1.7092229)), ("v", (0.5258305, 1.5269559)), ("w", (0.4817799, 1.2055055))],
)
def test_terminal_speed_at_60_newtons(axis, speeds):
    """Drag alone, one axis: linear and quadratic."""
    for variant, speed in zip(("benchmark", "wu"), speeds, strict=True):
        x = np.array([0, 0, 5.0, *np.zeros(9)])
        x[STATES.index(axis)] = speed
        vehicle = rov(variant, terms="damping")
        load = vehicle.mass_matrix() @ vehicle.derivatives(x)[6:]
        assert load[STATES.index(axis) - 6] == pytest.approx(-60.0, abs=2e-5)


@pytest.mark.parametrize(("force", "loops"), [(15.3, False), (15.7, True)])
def test_with_its_verticals_off_it_loops_above_15_5_newtons(force, loops):
    """Surge thrust acts 0.085 m below the origin; weight and buoyancy give 1.31588 N.m at most."""
    thrust = force / (4 * math.sqrt(0.5))
    ahead = [thrust, thrust, -thrust, -thrust, 0, 0, 0, 0]
    vehicle = rov(terms="restoring propellers", thrust=ahead)
    x = np.array([0, 0, 5.0, *np.zeros(9)])
    pushes = []
    for theta in np.radians(np.arange(1.0, 90.0)):
        x[4] = theta
        pushes.append(vehicle.derivatives(x)[10])
    assert (min(pushes) > 0.0) == loops


def test_the_surface_changes_nothing_at_depth():
    states = 0.3 * np.random.default_rng(7).standard_normal((20, 12))
    states[:, 2] += 5.0
    thrust = (5, -4, 3, 2, 1, -2, 3, 4)
    floating, submerged = (rov(restoring=form, thrust=thrust) for form in ("floating", "submerged"))
    for x in states:
        np.testing.assert_allclose(
            floating.derivatives(x), submerged.derivatives(x), rtol=1e-9, atol=1e-12
        )


def test_in_the_air_it_has_no_thrust_and_falls():
    up = rov(thrust=(0, 0, 0, 0, 30, 30, 30, 30))
    x = np.array([0, 0, -1.0, *np.zeros(9)])
    assert up.derivatives(x)[8] == pytest.approx(132.57 / 32.18)


def test_the_pilot_has_the_places_of_the_hull_from_the_cg():
    for variant in ("benchmark", "wu", "calibrated"):
        hull = rov(variant)
        allocation = shipped("thruster-matrix-allocation", "bluerov2.allocation", variant)
        places = np.array(hull.propeller_position) - hull.center_of_gravity
        np.testing.assert_allclose(allocation.position[:8], places, atol=1e-15)
        assert allocation.direction[:8] == hull.propeller_direction
