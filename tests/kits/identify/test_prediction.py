"""Predicted readings against SciPy's integrator and against differences."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.identification import CASES, PERIOD, synthetic
from seatrial_kits.identify.axis_motion import AxisMotion, AxisRotation
from seatrial_kits.identify.prediction import PARAMETERS, UNKNOWNS, delayed, predict

QUIET = {case.name[:3]: replace(case, noise=0.0, resolution=1e-15) for case in CASES}


def unknowns(**values):
    return np.array([values.get(name, 0.0) for name in UNKNOWNS])


@pytest.mark.parametrize(("name", "tolerance"), [("sur", 2e-5), ("yaw", 2e-4)])
def test_reading_of_a_whole_run(name, tolerance):
    """Tolerances: what RK4 leaves in sub-steps of 25 ms, 1/500 and 1/9 of a sensor's quantum."""
    case = QUIET[name]
    run = synthetic(case, 3)
    B, C, E = case.truth
    motion = (AxisRotation if case.rotation else AxisMotion)("axis")
    found = predict(
        motion,
        run.log.reading,
        unknowns(linear=B, quadratic=C, thrust=E, time_constant=0.1),
        delayed(run.log.command, case.delay),
        PERIOD,
    )
    np.testing.assert_allclose(found.reading, run.log.measured, atol=tolerance)


@pytest.mark.parametrize("cls", [AxisMotion, AxisRotation])
@pytest.mark.parametrize("law", ["linear", "quadratic"])
@pytest.mark.parametrize("lag", ["none", "thruster"])
@pytest.mark.parametrize("reading", ["acceleration", "place"])
def test_sensitivities_are_those_of_differences(cls, law, lag, reading):
    motion = cls("axis")
    motion.set("thrust_law", law)
    motion.set("lag", lag)
    command = 0.5 * np.sin(np.arange(60.0))
    at = unknowns(
        linear=-0.2, quadratic=-1.1, offset=0.05, thrust=6.0, time_constant=0.2,
        place_start=0.3, velocity_start=0.1, share_start=0.2, bias=0.07,
    )  # fmt: skip

    def run(change):
        return predict(motion, reading, at + change, command, 0.1)

    exact = run(np.zeros(len(at))).sensitivity
    for column, name in enumerate(UNKNOWNS):
        change = np.zeros(len(at))
        change[column] = 1e-5
        apart = (run(change).reading - run(-change).reading) / 2e-5
        np.testing.assert_allclose(exact[:, column], apart, atol=2e-7, err_msg=name)
    used = np.abs(exact).max(axis=0) > 0.0
    assert used[: len(PARAMETERS) - 1].all()
    assert used[UNKNOWNS.index("time_constant")] == (lag == "thruster")


def test_a_late_command():
    np.testing.assert_array_equal(delayed(np.array([1.0, 2.0, 3.0]), 2), [0.0, 0.0, 1.0])
    np.testing.assert_array_equal(delayed(np.array([1.0, 2.0]), 0), [1.0, 2.0])


def test_a_finer_period_changes_nothing():
    """A reading every 0.4 s is every fourth of one every 0.1 s: sub-steps do not grow with it."""
    at = unknowns(linear=-0.2, quadratic=-1.1, thrust=6.0)
    slow = np.array([0.3, -0.5, 0.2, 0.4])
    coarse = predict(AxisMotion(), "place", at, slow, 0.4).reading
    fine = predict(AxisMotion(), "place", at, np.repeat(slow, 4), 0.1).reading
    np.testing.assert_allclose(coarse, fine[::4], atol=1e-14)
