"""The shipped trials of the two ships: verdicts, and the record against reference data.

Figures are those of tests/reference, which an independent implementation computed.
"""

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from seatrial.trial.files.trial import load_trial
from seatrial.trial.records.run_folder import load_run
from seatrial.trial.reports.report import write_report
from seatrial.trial.running.run import run_trial
from seatrial_kits.campaigns.campaign import load_campaign
from seatrial_kits.campaigns.in_folders import run_campaign
from tests.trials.conftest import figures_of
from tests.trials.test_shipped_trials import TRIALS

pytestmark = pytest.mark.interop

REFERENCE = Path(__file__).parents[2] / "reference"
SHIPS = [name for name in TRIALS if name.startswith(("mariner", "thruster-ship"))]


def run(name, folder, **settings):
    return load_run(run_trial(load_trial(name).changed(settings, "test"), folder).folder)


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=pytest.mark.long if name == "mariner-chart-plotter" else ())
        for name in SHIPS
    ],
)
def test_every_criterion_holds(name, tmp_path):
    found = run(name, tmp_path / "run")
    assert found.verdicts
    assert [v["name"] for v in found.verdicts if not v["passed"]] == []


@cache
def table(name):
    return np.genfromtxt(REFERENCE / name, delimiter=",", names=True)


@pytest.mark.parametrize(("step_ms", "bound"), [(100, 2e-4), (50, 5e-5)])
@pytest.mark.parametrize(("variant", "file"), [("linear", "linS"), ("cubic", "nl")])
def test_coupled_fmus_give_the_step_of_one_integrator(variant, file, step_ms, bound, tmp_path):
    """Between ship and machine the angle crosses a connection, which costs the square of the step."""
    found = run("mariner-step-5", tmp_path / "run", variant=variant, step=f"{step_ms} ms")
    expected = table(f"mariner_dim_step5deg_{file}.csv")
    rows = slice(None, None, 2000 // step_ms)
    np.testing.assert_allclose(found.time[rows], expected["t_s"], atol=1e-9)
    for signal, column in (
        ("ship.attitude.psi", "psi"),
        ("ship.velocity.v", "v"),
        ("ship.rates.r", "r"),
        ("machine.angle", "delta"),
        ("autopilot.rudder", "delta_cmd"),
    ):
        error = np.abs(found.signals[signal][rows] - expected[column]).max()
        assert error < bound * np.abs(expected[column]).max(), signal


def test_the_published_cases_side_by_side(tmp_path):
    run_campaign(load_campaign("thruster-ship-cases"), tmp_path / "cases")
    final = np.genfromtxt(
        REFERENCE / "ship_final_values.csv", delimiter=",", names=True, dtype=None, encoding="utf-8"
    )
    cases = {row["case"]: row for row in final if row["T_s"] == 10}
    folders = sorted(path.parent for path in (tmp_path / "cases").glob("*/signals.csv"))
    assert len(folders) == 6
    for folder in folders:
        found = load_run(folder)
        force, moment = (found.signals[f"thrusters.{s}"][-1] for s in ("force.x", "moment"))
        sway = found.signals["thrusters.force.y"][-1]
        (row,) = (
            row
            for row in cases.values()
            if (row["Fx_N"], row["Fy_N"], row["Mz_Nm"]) == (force, sway, moment)
        )
        for model, short in (("nonlinear", "nl"), ("linear", "lin")):
            for signal, column in (
                ("position.x", "x"),
                ("position.y", "y"),
                ("attitude.psi", "psi"),
            ):
                value = found.signals[f"{model}.{signal}"][-1]
                assert value == pytest.approx(row[f"{short}_{column}"], rel=1e-9, abs=1e-13)


def test_both_models_share_the_panels_of_the_report(tmp_path):
    folder = run("thruster-ship-combined", tmp_path / "run").folder
    page = write_report(folder).read_text("utf-8")
    assert "<h2>Motion of nonlinear and linear</h2>" in page
    assert "<h2>Velocities of nonlinear and linear</h2>" in page
    motion = page[page.index("Motion of nonlinear and linear") : page.index("Velocities of nonl")]
    (figure,) = figures_of(motion)
    # x, y and psi: in the plane there is nothing else.
    assert [trace["name"] for trace in figure["data"]] == ["nonlinear", "linear"] * 3


def test_figures_of_positioning(tmp_path):
    """What docs/kits/ships/thruster-ship.md says of it."""
    for name, place, heading in (
        ("thruster-ship-load", 0.115, 0.157),
        ("thruster-ship-load-lag", 0.115, 0.160),
        ("thruster-ship-load-fivefold", 0.570, 0.787),
    ):
        signals = run(name, tmp_path / name).signals
        largest = max(np.abs(signals[f"ship.position.{axis}"]).max() for axis in "xy")
        assert largest == pytest.approx(place, abs=1e-3)
        turned = np.degrees(np.abs(signals["ship.attitude.psi"]).max())
        assert turned == pytest.approx(heading, abs=1e-3)
