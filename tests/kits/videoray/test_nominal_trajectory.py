"""The nominal trajectory against published figures and an independent computation."""

import numpy as np
import pytest

from seatrial.errors import InputError
from seatrial_kits.videoray.tracking.nominal_trajectory import NominalTrajectory
from seatrial_kits.videoray.tracking.vessel_nominal import Profile
from seatrial_kits.videoray.vessel.surface_vessel import SurfaceVessel
from tests.kits.videoray.vessel_loop import CASES, STEPS, build, profile, started, table


def over_time(component, stop, every=1.0):
    component.begin()
    rows = []
    for k in range(round(stop / every) + 1):
        rows.append([k * every, *component.get("nominal"), *component.get("nominal_command")])
        component.advance(k * every, every)
    return np.array(rows)


@pytest.mark.parametrize(
    ("sign", "rate", "sway", "command"),
    [
        (1, 0.2, -0.0217589, (-0.625778, 0.00494223)),
        (1, -0.2, 0.0217589, (-0.483343, 0.00639864)),
        (-1, 0.2, -0.0217589, (-0.483343, 0.00639864)),
        (-1, -0.2, 0.0217589, (-0.625778, 0.00494223)),
    ],
)
def test_nominal_values_of_table_75(sign, rate, sway, command):
    """By hand: X = -m22 V R = 0.560661 N, N = -s (m11 - m22) U V = +-0.072001 N m."""
    found = started(NominalTrajectory, "table75", yaw_rate=rate, yaw_coupling_sign=sign)
    assert found.get("nominal") == pytest.approx([0.05, sway, rate], rel=3e-6)
    assert found.get("nominal_command") == pytest.approx(command, rel=2e-6)


@pytest.mark.parametrize("case", [1, 2])
def test_nominal_motion_of_the_reference(case):
    expected = table(f"vessel_case{case}_nominal")
    rows = over_time(started(NominalTrajectory, "table75", **CASES[case]), 240)
    for column, name in enumerate(("Ud", "Vd", "Rd", "tau1d", "tau2d"), start=1):
        error = np.abs(rows[:, column] - expected[name]).max()
        assert error < 2e-11 * np.abs(expected[name]).max(), name


@pytest.mark.parametrize("variant", STEPS)
@pytest.mark.parametrize("case", CASES)
def test_nominal_commands_give_the_nominal_motion(case, variant):
    """With the acceleration of sway that the trajectory has, the vessel's equations balance."""
    found = started(NominalTrajectory, variant, **CASES[case])
    craft = build(SurfaceVessel, variant)
    for k in (0, 200, 1000, 2399, 2400, 10**7):
        row = found._row(k)
        craft.set("command", row.command)
        slope = craft.derivatives(np.array([0, 0, 0, *row.velocity]))
        np.testing.assert_allclose(slope[3:], row.acceleration, atol=2e-17)


def test_polynomial_is_the_sources():
    """Printed: 1.5070e-13 t^5 - 9.0422e-11 t^4 + 1.4468e-8 t^3, and figures at 240 s."""
    rise = Profile(0.02, 240.0)
    t = np.linspace(1, 239, 50)
    printed = np.polyval([1.507041e-13, -9.042245e-11, 1.446759e-8, 0, 0, 0], t)
    np.testing.assert_allclose([rise.at(x)[0] for x in t], printed, atol=2e-7 * 0.02 * 10)
    for x in t.tolist():  # derivatives, by central differences
        h = 1e-3
        (_, first, second), (a, a1, _), (b, b1, _) = rise.at(x), rise.at(x - h), rise.at(x + h)
        assert first == pytest.approx((b - a) / (2 * h), rel=1e-6, abs=1e-12)
        assert second == pytest.approx((b1 - a1) / (2 * h), rel=1e-6, abs=1e-13)


def test_polynomial_starts_and_ends_at_rest_and_is_held():
    rise = Profile(0.02, 240.0)
    assert rise.at(0.0) == (0.0, 0.0, 0.0)
    assert rise.at(240.0) == rise.at(1e9) == (0.02, 0.0, 0.0)
    almost = rise.at(240.0 * (1 - 1e-9))
    assert almost == pytest.approx((0.02, 0.0, 0.0), abs=1e-12)


def test_sway_comes_to_rest_where_the_steady_equation_says():
    (m11, _, _), (_, d22, _) = (profile("table81_fit")[k] for k in ("mass", "damping"))
    found = started(NominalTrajectory, "table81_fit", **CASES[2])
    assert found._row(10**9).velocity[1] == pytest.approx(-m11 * 0.02 * 0.04 / d22, rel=1e-13)


def test_state_moves_to_another_instance():
    first = started(NominalTrajectory, "table75", **CASES[2])
    first.begin()
    first.advance(0.0, 100.0)
    other = NominalTrajectory("other")
    other.set_state(first.get_state())
    for component in (first, other):
        component.advance(100.0, 50.0)
    assert first.get("nominal") == other.get("nominal")
    assert first.get("nominal")[0] > 0.01


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"damping": [0.0, 0.0, 0.0]}, r"damping\.v is 0\.0 N\.s/m"),
        ({"thrust": [0.0, 46.7]}, r"thrust is \[0\.0, 46\.7\] N"),
        ({"yaw_coupling_sign": 0.0}, r"yaw_coupling_sign is 0\.0, allowed -1\.0 or 1\.0"),
        ({"surge_profile": "polynomial", "duration": 1e6}, r"at most 500000 are allowed"),
    ],
)
def test_what_has_no_trajectory_is_refused(values, message):
    with pytest.raises(InputError, match=message):
        started(NominalTrajectory, "physical", **values)
