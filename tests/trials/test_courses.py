"""The shipped courses: verdicts, and the true track beside the legs."""

import itertools
import math

import numpy as np
import pytest

from seatrial.shipped import available
from seatrial.trial.files.trial import load_trial
from seatrial.trial.records.run_folder import load_run
from seatrial.trial.running.run import run_trial
from tests.kit import needs_kits

pytestmark = pytest.mark.interop

TRIALS = sorted(name for name in available("harness/trials") if "-course-" in name)
TRIALS = [name for name in TRIALS if name.startswith(("hydrone", "videoray"))]
pytestmark = needs_kits("videoray")
TRACKED = {"hydrone-course-square", "videoray-course-box", "hydrone-course-current"}
"""Those whose tracks are looked at here, and their criteria with them."""


def run(name, folder, **settings):
    trial = load_trial(name).changed(settings, "test")
    return load_run(run_trial(trial, folder, engine="direct").folder)


def marked(name):
    """Return a trial for the tests; one takes half a minute, in the long run only."""
    slow = name == "hydrone-course-modes"
    return pytest.param(name, marks=pytest.mark.long if slow else ())


def passes(found):
    assert found.verdicts
    assert [v["name"] for v in found.verdicts if not v["passed"]] == []


def test_all_that_are_tracked_are_there():
    assert set(TRIALS) > TRACKED


@pytest.mark.parametrize("name", [marked(name) for name in TRIALS if name not in TRACKED])
def test_every_criterion_holds(name, tmp_path):
    passes(run(name, tmp_path / "run"))


def beside(found, craft):
    """Return per leg the waypoint and the true positions, and the distances from its line."""
    parameters = found.manifest["components"]["autopilot.course"]["parameters"]

    def place(name):
        return np.array([parameters[f"{name}.{axis}"]["value"] for axis in ("north", "east")])

    count = int(parameters["count"]["value"])
    places = [place(name) for name in ("start_point", *(f"waypoint_{n + 1}" for n in range(count)))]
    track = np.column_stack([found.signals[f"{craft}.position.{axis}"] for axis in "xy"])
    legs, follows = (
        found.signals["autopilot.course.leg"],
        found.signals["autopilot.pilot.guidance.state"] == 3,
    )
    for n, (start, end) in enumerate(itertools.pairwise(places), 1):
        at = track[legs == n]
        length = math.dist(start, end)
        if length:
            way = (end - start) / length
            off = (track[(legs == n) & follows] - start) @ np.array([-way[1], way[0]])
            yield end, at, off
        else:
            yield end, at, np.zeros(0)


@pytest.mark.parametrize(
    ("name", "craft", "radius"),
    [
        ("hydrone-course-square", "vehicle.hull", 3.0),
        pytest.param("videoray-course-box", "vehicle.hull", 1.0, marks=pytest.mark.long),
    ],
)
def test_the_true_track_passes_the_waypoints_and_keeps_to_the_legs(name, craft, radius, tmp_path):
    found = run(name, tmp_path / "run")
    passes(found)
    legs = list(beside(found, craft))
    for waypoint, track, _ in legs:
        # 0.1 m for what it does between two fixes, and for their errors and age.
        assert np.hypot(*(track - waypoint).T).min() <= radius + 0.1
    off = np.concatenate([off for *_, off in legs])
    rms = math.sqrt(np.mean(off**2))
    assert rms <= 2.0
    # The component's own figure, from the fixes.
    assert found.signals["autopilot.pilot.guidance.cross_track_rms"][-1] == pytest.approx(
        rms, rel=0.1
    )


def test_across_a_current_it_heads_up_by_the_crab_angle(tmp_path):
    found = run("hydrone-course-current", tmp_path / "run")
    passes(found)
    late = (found.time > 150) & (found.time < 190)
    u, v, psi = (
        found.signals[f"vehicle.hull.{name}"][late]
        for name in ("velocity.u", "velocity.v", "attitude.psi")
    )
    # A third of a metre per second abeam, with the speed held over ground along the bow.
    assert (u * np.sin(psi) + v * np.cos(psi)).mean() == pytest.approx(0.0, abs=0.01)
    through = u - 0.33 * np.sin(psi)
    assert np.degrees(psi.mean()) == pytest.approx(
        -math.degrees(math.asin(0.33 / through.mean())), abs=2.0
    )


@pytest.mark.long
def test_without_the_integral_the_current_leaves_its_error(tmp_path):
    found = run(
        "hydrone-course-current",
        tmp_path / "run",
        **{"autopilot.pilot.guidance.integral_gain": 0.0},
    )
    late = (found.time > 150) & (found.time < 190)
    psi, error = (
        found.signals["vehicle.hull.attitude.psi"],
        found.signals["autopilot.pilot.guidance.cross_track"],
    )
    # tan(heading) = -e / lookahead.
    assert error[late].mean() == pytest.approx(-5.0 * math.tan(psi[late].mean()), abs=0.1)
    assert error[late].mean() > 1.0
