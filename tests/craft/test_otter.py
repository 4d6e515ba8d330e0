"""The Otter USV: its data from the source's constants, reference trajectories, steady motion."""

import math

import numpy as np
import pytest

from tests.devices.running import run

from .references import STATES, assert_met, columns, row, shipped

G, RHO, LENGTH, PONTOON, ARM = 9.81, 1025.0, 2.0, 0.25, 0.395
AHEAD, ASTERN = math.sqrt(24.4 * G / 0.02216), math.sqrt(13.6 * G / 0.01289)
RUNS = ("acceleration", "turn", "zigzag_current", "release", "excitation")
EMPTY = {"excitation"}


def otter(variant="loaded", **values):
    return shipped("marine-craft", "otter.marine-craft", variant, **values)


def propeller(**values):
    component = shipped("shaft-propeller", "otter.propeller", **values)
    component.initialise()
    component.begin()
    return component


def derived(payload):
    """Return what the source's formulas give of its constants, for a payload in kg."""
    hull, r_hull, r_load = 55.0, np.array([0.2, 0, -0.2]), np.array([0.05, 0, -0.35])
    mass = hull + payload
    cg = (hull * r_hull + payload * r_load) / mass

    def parallel(m, d):
        return m * (d @ d * np.eye(3) - np.outer(d, d))

    inertia = hull * np.diag(np.square([0.432, 0.5, 0.5]))
    inertia = inertia + parallel(hull, r_hull - cg) + parallel(payload, r_load - cg)
    volume, area = mass / RHO, 0.75 * LENGTH * PONTOON
    draught = volume / (2 * 0.4 * PONTOON * LENGTH)
    shape = 6 * 0.75**3 / (1.75 * 2.5)
    I_T = LENGTH * PONTOON**3 / 6 * shape + 2 * area * ARM**2
    I_L = 0.8 * PONTOON * LENGTH**3 / 6
    KB = (2.5 * draught - volume / (2 * LENGTH * PONTOON)) / 3
    GM_T, GM_L = (KB + second / volume - draught + cg[2] for second in (I_T, I_L))
    surge = 2.7 * RHO * (hull / RHO) ** (5 / 3) / LENGTH**2
    added = [surge, 82.5, 55.0, *(np.diag(inertia) * (0.2, 0.8, 1.7))]
    about_origin = np.diag(inertia + parallel(mass, cg))
    M = np.array([mass, mass, mass, *about_origin]) + added
    k = RHO * G * np.array([2 * area, volume * GM_T, volume * GM_L])
    w = np.sqrt(k / M[2:5])
    return {
        "mass": mass,
        "center_of_gravity": cg,
        "inertia": [*np.diag(inertia), 0, -inertia[0, 2], 0],
        "added_mass": [*added[:3], 0, 0, 0],
        "added_inertia": [*added[3:], 0, 0, 0],
        "crossflow_draught": draught,
        "GM_T": GM_T,
        "GM_L": GM_L,
        "waterplane_area": 2 * area,
        "linear_damping_force": [24.4 * G / (6 * 0.5144), M[1], 0.6 * w[0] * M[2]],
        "linear_damping_moment": [0.4 * w[1] * M[3], 0.8 * w[2] * M[4], M[5]],
        "quadratic_damping_moment": [0, 0, 10 * M[5]],
    }


@pytest.mark.parametrize(("variant", "payload"), [("loaded", 25.0), ("empty", 0.0)])
def test_the_data_follow_from_the_constants_of_the_source(variant, payload):
    hull = otter(variant)
    for name, value in derived(payload).items():
        np.testing.assert_allclose(hull.get(name), value, rtol=1e-11, atol=1e-12, err_msg=name)


def test_the_propellers_turn_as_fast_as_their_bollard_pull_says():
    found = propeller()
    assert found.get("speed_ahead") == pytest.approx(AHEAD, rel=1e-12)
    assert found.get("speed_astern") == pytest.approx(ASTERN, rel=1e-12)


def driven(data, k, t):
    """Return port and starboard shaft speed at ``t``, in the interval from row k on."""
    speeds = []
    for n in ("n1", "n2"):
        wanted = np.clip(data[f"{n}_command"][k], -ASTERN, AHEAD)
        speeds.append(wanted + (data[n][k] - wanted) * math.exp(-(t - data["t"][k]) / 0.1))
    return speeds


def lagging(t, amplitude, frequency, phase):
    """Return the answer of a lag of 0.1 s, at rest at 0, to a sine."""
    w = math.tau * frequency
    gain, late = 1 / math.hypot(1, 0.1 * w), math.atan(0.1 * w)
    steady = gain * np.sin(w * t + phase - late)
    return amplitude * (steady - gain * math.sin(phase - late) * np.exp(-t / 0.1))


SINES = [(70, 0.05, 0.3), (80, 0.08, 1.1)]
WRENCH = [(20, 0.07), (40, 0.11), (60, 0.3), (40, 0.35), (60, 0.25), (15, 0.09)]


def load(speeds):
    """Return force and moment of the propellers, at (0, -+0.395, 0)."""
    port, starboard = ((0.01108 if n > 0 else 0.006445) * n * abs(n) for n in speeds)
    return np.array([port + starboard, 0, 0, 0, 0, ARM * (port - starboard)])


def inputs(name, data):
    def given(t, _):
        if name == "excitation":
            speeds = [lagging(t, *sine) for sine in SINES]
            w = [A * math.sin(math.tau * f * t + 0.5 * i) for i, (A, f) in enumerate(WRENCH)]
        else:
            k = row(data["t"], t)
            speeds, w = driven(data, k, t), np.zeros(6)
        total = load(speeds) + w
        return {"force_1": total[:3], "moment_1": total[3:]}

    return given


@pytest.mark.parametrize("name", RUNS)
def test_reference_trajectories_are_met(name):
    data = columns(f"otter_{name}")
    start = [data[s][0] for s in STATES]
    current = (0.3 * math.cos(math.pi / 6), 0.15, 0) if name == "zigzag_current" else (0, 0, 0)
    hull = otter(
        "empty" if name in EMPTY else "loaded",
        position_start=start[:3],
        attitude_start=start[3:6],
        velocity_start=start[6:9],
        rates_start=start[9:],
        current=current,
    )
    moved = np.diff(data["n1_command"]) + np.diff(data["n2_command"])
    jumps = [] if name == "excitation" else data["t"][1:][moved != 0]
    found = hull.reference(data["t"], inputs(name, data), jumps, rtol=1e-11, atol=1e-12)
    # Straight ahead it is unstable: what breaks the symmetry is round-off.
    kept = [
        s for s in STATES if name != "acceleration" or s not in ("y", "phi", "psi", "v", "p", "r")
    ]
    states = [found.x[:, STATES.index(s)] for s in kept]
    assert_met(np.transpose(states), data, kept)


@pytest.mark.parametrize("name", [run for run in RUNS if run != "excitation"])
def test_shaft_speeds_and_thrusts_are_met(name):
    data = columns(f"otter_{name}")
    for n in ("n1", "n2"):
        wanted = data[f"{n}_command"]

        def share(t_ms, wanted=wanted):
            speed = wanted[t_ms // 100]
            return {"command": speed / (AHEAD if speed > 0 else ASTERN)}

        stop_ms = round(1000 * data["t"][-1])
        rows = run(propeller(), ["speed", "thrust"], stop_ms, 100, share)
        found = np.array(rows)
        np.testing.assert_allclose(found[:, 0], data[n], rtol=0, atol=1e-7)
        k = np.where(data[n] > 0, 0.01108, 0.006445)
        np.testing.assert_allclose(found[:, 1], k * data[n] * np.abs(data[n]), rtol=0, atol=1e-6)


@pytest.mark.parametrize("step_ms", [1, 7, 20, 100])
def test_the_shaft_is_exact_whatever_the_step(step_ms):
    shaft = propeller(speed_start=-50.0, command=0.5)
    for k in range(700 // step_ms):
        shaft.advance(k * step_ms / 1000, step_ms / 1000)
    wanted = 0.5 * AHEAD
    expected = wanted + (-50.0 - wanted) * math.exp(-7.0)
    assert shaft.get("speed") == pytest.approx(expected, rel=1e-12)


def test_a_damaged_propeller_has_half_of_its_thrust_and_a_slow_shaft_a_long_lag():
    def after(fault):
        shaft = propeller(command=1.0, fault=fault)
        shaft.advance(0.0, 0.1)
        return shaft

    whole = after("none")
    assert after("wrong").get("thrust") == pytest.approx(whole.get("thrust") / 2)
    assert after("slow").get("speed") == pytest.approx(-AHEAD * math.expm1(-0.1))
    assert after("off").get("speed") == 0.0


# Shaft speeds; u, v, heel in deg, heading rate in deg/s; computed independently of this project.
TURNS = {
    ("loaded", 80, 60): (1.398308, -0.099474, -0.27262, 9.554728),
    ("loaded", 80, 120): (2.321656, 0.245167, 0.78712, -16.642067),
    ("loaded", 80, -80): (0.371614, -0.039587, -0.11788, 15.550509),
    ("empty", 60, 40): (0.738155, -0.032946, -0.04823, 6.400446),
    ("empty", 100, 80): (2.248469, -0.213955, -0.36524, 15.939881),
}


@pytest.mark.parametrize("case", TURNS, ids=str)
def test_steady_turns(case):
    variant, *speeds = case
    total = load(np.clip(speeds, -ASTERN, AHEAD))
    hull = otter(variant, force_1=total[:3], moment_1=total[3:], **{"rates_start.r": 0.01})
    x = hull.reference([0.0, 60.0]).x[-1]
    phi, theta, r = x[3], x[4], x[11]
    turning = (x[10] * math.sin(phi) + r * math.cos(phi)) / math.cos(theta)
    found = x[6], x[7], math.degrees(phi), math.degrees(turning)
    assert found == pytest.approx(TURNS[case], abs=6e-6)


@pytest.mark.parametrize(("variant", "speed"), [("loaded", 1.1566315), ("empty", 1.2524347)])
def test_straight_ahead_it_turns_by_itself_above_a_speed(variant, speed):
    """The growth of sway, roll and yaw, linearised, changes its sign there."""

    def growth(u):
        x = np.zeros(12)
        x[6] = u
        states = (3, 7, 9, 11)
        return np.linalg.eigvals(otter(variant).linearise(x).A[np.ix_(states, states)]).real.max()

    assert growth(speed - 1e-5) < 0.0 < growth(speed + 1e-5)
