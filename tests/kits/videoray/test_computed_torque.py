"""Computed torque against an independent computation and the error dynamics it promises."""

import csv

import numpy as np
import pytest

from seatrial_kits.videoray.tracking.computed_torque import ComputedTorque
from seatrial_kits.videoray.tracking.flat_tracking import FlatTracking
from tests.kits.videoray.vessel_loop import CASES, REFERENCE, assert_columns, follow, started, table

ERROR = (0.01, 0.01, -0.01)
COLUMNS = ("u", "v", "r", "tau1", "tau2")


@pytest.mark.parametrize("variant", ["physical", "table75"])
@pytest.mark.parametrize("case", [1, 2])
def test_trajectories_of_the_reference(case, variant):
    law = started(ComputedTorque, variant, **CASES[case])
    rows = follow(law, 240.0, variant, ERROR)
    expected = table(f"pi_case{case}_{variant.replace('table75', 'tab7.5')}")
    assert_columns(rows[::10], COLUMNS, expected, 1e-7)


@pytest.mark.parametrize("variant", ["physical", "table75"])
@pytest.mark.parametrize("case", CASES)
def test_it_converges_where_the_flatness_law_diverges(case, variant):
    rows = follow(started(ComputedTorque, variant, **CASES[case]), 20.0, variant, ERROR)
    off = np.abs(rows[-1, [1, 3]] - rows[-1, [6, 8]]).max()
    assert off < 1e-7


def test_errors_decay_with_the_poles_of_the_gains():
    """Continuous limit: e'' + kp e' + ki e = 0 with e'(0) = -kp e(0) (the integral is empty)."""
    law = started(ComputedTorque, "physical", period=1e-3, kp=3.0, ki=2.0)
    rows = follow(law, 3.0, "physical", (0.02, 0.0, -0.03))
    t = rows[:, 0]
    share = -np.exp(-t) + 2 * np.exp(-2 * t)  # poles -1 and -2
    for column, nominal, start in ((1, 6, 0.02), (3, 8, -0.03)):
        off = rows[:, column] - rows[:, nominal]
        # The command is held for 1 ms: half a millisecond late.
        np.testing.assert_allclose(off, start * share, atol=3e-3 * abs(start))


def rejections():
    with (REFERENCE / "videoray_disturbance_rejection.csv").open() as file:
        return list(csv.DictReader(file))


LAWS = {"flat": (FlatTracking, {}), "P": (ComputedTorque, {"ki": 0.0}), "PI": (ComputedTorque, {})}
VARIANTS = {"tab7.5": "table75", "physical": "physical", "t8.1fit": "table81_fit"}


def rows_of_the_table():
    """Return the table's rows as parameters: one plant's at once, the others in their time."""
    return [
        pytest.param(
            row,
            id="-".join(row[key] for key in ("plant", "law", "kind", "comp")),
            marks=() if row["plant"] == "physical" and row["law"] != "P" else pytest.mark.interop,
        )
        for row in rejections()
    ]


@pytest.mark.parametrize("row", rows_of_the_table())
def test_rejection_of_steps(row):
    cls, values = LAWS[row["law"]]
    variant, axis = VARIANTS[row["plant"]], "uvr".index(row["comp"])
    if variant == "table81_fit":  # no limits, and the sign that is right
        values = {**values, "command_limit": 1e9, "yaw_coupling_sign": 1.0}
    law = started(cls, variant, surge=float(row["U"]), yaw_rate=float(row["R"]), **values)

    def step(t):
        size = [0.0, 0.0, 0.0]
        size[axis] = float(row["amp"]) if 112.0 <= t < 187.0 else 0.0
        if row["kind"] == "meas":
            return {"nu_bias": size}
        return {"force_1": size[:2], "moment_1": size[2]}

    rows = follow(law, 186.5, variant, inputs=step, yaw_coupling_sign=1.0)
    expected = np.array([float(row[name]) for name in ("du", "dv", "dr")])
    found = rows[-1, 1:4] - rows[-1, 6:9]
    # 1e-7 is what one law and another leave at rest.
    assert np.abs(found - expected).max() < 1e-6 * np.abs(expected).max() + 1e-9


def test_a_force_abeam_moves_sway_alone():
    rows = follow(
        started(ComputedTorque, "physical", **CASES[1]),
        60.0,
        "physical",
        inputs=lambda _t: {"force_1": [0.0, 5.0]},
    )
    off = rows[-1, 1:4] - rows[-1, 6:9]
    assert off == pytest.approx([0.0, 5.0 / 5.87, 0.0], abs=1e-9)


def test_no_integral_grows_while_a_thruster_is_at_its_limit():
    law = started(ComputedTorque, "physical", command_limit=0.01, nu=[1.0, 0.0, 0.2])
    law.begin()
    law.advance(0.0, 60.0)
    assert max(map(abs, law.get("command"))) == 0.01
    law.set("nu", law.get("nominal"))
    assert law.get("command") == pytest.approx(law.get("nominal_command"), rel=1e-12)
