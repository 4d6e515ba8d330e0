"""Plans of motion against SciPy: integration of the track and the sway, peaks found by search."""

import csv

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import minimize_scalar

from seatrial.errors import InputError
from seatrial.trial.files.trial import load_trial
from seatrial.trial.records.run_folder import load_run
from seatrial.trial.running.run import run_trial
from seatrial_kits.videoray.plan.motion import plan_motion
from seatrial_kits.videoray.plan.page import _commands, _track, settings, write_plan

M11, M22, M33, D11, D22, D33, E, ARM = 8.44, 12.55, 0.133, 0.95, 5.87, 0.023, 46.7, 0.1
"""The variant physical of videoray-surface."""


def rise(t, value, duration):
    x = np.clip(t / duration, 0.0, 1.0)
    slope = 30.0 * x**2 * (1.0 - x) ** 2 / duration
    return value * (10.0 * x**3 - 15.0 * x**4 + 6.0 * x**5), value * slope


def test_the_plan_is_what_the_equations_integrate_to():
    U_end, R_end, duration = 0.6, 0.3, 20.0
    plan = plan_motion("videoray-surface", U_end, R_end, duration=duration, stop=60.0)

    def slope(t, state):
        v, _x, _y, psi = state
        u, r = rise(t, U_end, duration)[0], rise(t, R_end, duration)[0]
        turned = np.array([[np.cos(psi), -np.sin(psi)], [np.sin(psi), np.cos(psi)]]) @ [u, v]
        return -(D22 * v + M11 * u * r) / M22, *turned, r

    t = plan.time
    assert len(t) == 601
    v, *track = solve_ivp(
        slope, (0, 60), [0.0] * 4, t_eval=t, rtol=1e-10, atol=1e-12, max_step=0.1
    ).y
    (u, u1), (r, r1) = rise(t, U_end, duration), rise(t, R_end, duration)
    np.testing.assert_allclose(plan.velocity, np.column_stack((u, v, r)), atol=1e-9)
    # Simpson's rule over 0.1 s
    np.testing.assert_allclose(plan.track, np.column_stack(track), atol=2e-6)
    X = M11 * u1 + D11 * u - M22 * v * r
    N = M33 * r1 + D33 * r - (M11 - M22) * u * v
    wanted = np.column_stack((X + N / ARM, X - N / ARM)) / (2 * E)
    np.testing.assert_allclose(plan.command, wanted, atol=1e-11)
    assert plan.peak == pytest.approx(np.abs(wanted).max())
    assert plan.feasible
    np.testing.assert_allclose(plan.flat, ARM * u * M11 - r * M33, atol=1e-12)


@pytest.mark.parametrize(("surge", "limit"), [(2.0, 0.1), (5.0, 0.2)])
def test_the_shortest_duration_just_fits_the_limit(surge, limit):
    """Ahead alone both thrusters give (m11 U' + d11 U) / (2 E)."""
    plan = plan_motion("videoray-surface", surge, 0.0, limit=limit)

    def peak(duration):
        def less(t):
            u, u1 = rise(t, surge, duration)
            return -(M11 * u1 + D11 * u) / (2 * E)

        return -minimize_scalar(less, bounds=(0.0, duration), method="bounded").fun

    assert plan.duration_was_found
    assert plan.feasible
    assert peak(plan.duration) <= limit * (1 + 1e-3)
    assert peak(plan.duration * 0.995) > limit


@pytest.mark.parametrize(
    ("surge", "yaw_rate", "constant", "until"),
    [
        (0.05, 0.2, ("surge", "yaw"), None),
        (0.02, 0.04, ("yaw",), "crossed"),  # l m11 U passes R m33
        (0.5, 0.2, (), 0.0),  # at rest
    ],
)
def test_where_commands_do_not_reach_sway_is_named(surge, yaw_rate, constant, until):
    duration = None if len(constant) == 2 else 100.0
    plan = plan_motion(
        "videoray-surface", surge, yaw_rate, constant=constant, duration=duration, stop=200.0
    )
    if until == "crossed":
        t = np.arange(2001) / 10
        sign = ARM * M11 * rise(t, surge, 100.0)[0] - M33 * yaw_rate
        until = t[np.flatnonzero(sign >= 0)[0]]
    assert plan.flat_until == (until if until is None else pytest.approx(until))


def test_a_law_in_a_trial_has_the_motion_that_was_planned(tmp_path):
    plan = plan_motion("videoray-surface", 0.6, 0.3, limit=0.5, stop=20.0)
    folder = write_plan(plan, tmp_path / "plan")
    with (folder / "plan.csv").open() as file:
        rows = list(csv.DictReader(file))
    changes = dict(line.replace('"', "").split(" = ") for line in settings(plan))
    trial = load_trial("videoray-surface-case-1").changed(
        changes | {"stop": "20 s", "vessel.nu_start": [0.0, 0.0, 0.0]}, "test"
    )
    found = load_run(run_trial(trial, tmp_path / "run", engine="direct").folder)
    for column, signal in {
        "U": "law.nominal.u", "V": "law.nominal.v", "R": "law.nominal.r",
        "t1": "law.nominal_command.t1", "t2": "law.nominal_command.t2",
    }.items():  # fmt: skip
        planned = np.array([float(row[column]) for row in rows])
        np.testing.assert_array_equal(found.signals[signal][: len(planned)], planned)
    for row, axis in (("x", "x"), ("y", "y")):
        track = np.array([float(each[row]) for each in rows])
        # The law acts ten times a second.
        off = found.signals[f"vessel.position.{axis}"][: len(track)] - track
        assert np.abs(off).max() < 0.05 * np.abs(track).max()


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        ({"surge": 200.0}, "no duration is long enough"),
        ({"surge": 1.0, "duration": -1.0}, "duration is -1 s, allowed is more than 0"),
        ({"surge": 1.0, "stop": 1e9}, "stop is 1e\\+09 s, allowed"),
        ({"surge": 1.0, "limit": 0.0}, "limit is 0, allowed is more than 0 up to 1"),
        ({"surge": 1.0, "constant": ["sway"]}, "constant is 'sway', allowed are surge, yaw"),
        ({"surge": 1.0, "constant": ["surge", "yaw"], "duration": 1.0}, "have no duration"),
    ],
)
def test_mistakes_are_named(arguments, named):
    with pytest.raises(InputError, match=named):
        plan_motion("videoray-surface", **({"yaw_rate": 0.0} | arguments))


@pytest.mark.parametrize(("limit", "shown"), [(0.2, [0.2, -0.2]), (1.0, [])])
def test_limits_are_drawn_where_they_do_not_flatten_the_commands(limit, shown):
    plan = plan_motion("videoray-surface", 0.6, 0.1, duration=10.0, stop=12.0, limit=limit)
    assert 0.02 < plan.peak < 0.1
    commands, track = _commands(plan), _track(plan)
    assert [shape["y0"] for shape in commands.layout.get("shapes", [])] == shown
    for k, trace in enumerate(commands.data):
        np.testing.assert_array_equal(trace["y"], plan.command[:, k])
    np.testing.assert_array_equal(track.data[0]["x"], plan.track[:, 1])  # east to the right
    np.testing.assert_array_equal(track.data[0]["y"], plan.track[:, 0])
