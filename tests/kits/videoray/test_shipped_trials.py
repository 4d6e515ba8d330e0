"""The shipped trials of the VideoRay Pro 4: verdicts, and the figures of its page."""

import math

import numpy as np
import pytest

from seatrial.trial.files.trial import load_trial
from seatrial.trial.records.run_folder import load_run
from seatrial.trial.running.run import run_trial

pytestmark = pytest.mark.interop

OPEN = [f"videoray-open-{name}" for name in ("surge", "heave", "yaw", "ascent")]


def run(name, folder, engine="direct", **settings):
    trial = load_trial(name).changed(settings, "test")
    return load_run(run_trial(trial, folder, engine=engine).folder)


@pytest.mark.parametrize("name", OPEN)
def test_every_criterion_holds(name, tmp_path):
    found = run(name, tmp_path / "run")
    assert found.verdicts
    assert [v["name"] for v in found.verdicts if not v["passed"]] == []


def test_heading_of_the_compass_follows_that_of_the_vehicle(tmp_path):
    found = run("videoray-open-yaw", tmp_path / "run")
    psi, read = found.signals["hull.attitude.psi"], found.signals["ahrs.euler.psi"]
    assert np.unwrap(psi)[-1] > 5 * math.tau
    samples = slice(0, None, 10)
    error = np.degrees((read - psi + math.pi)[samples] % math.tau - math.pi)
    # Noise of 0.195 and a quantum of 0.1 degrees.
    assert error.std() == pytest.approx(math.hypot(0.195, 0.1 / math.sqrt(12)), rel=0.15)
    assert np.abs(error).max() < 1.0
    tenths = np.degrees(read[samples]) * 10
    np.testing.assert_allclose(tenths, np.round(tenths), rtol=0, atol=1e-6)


@pytest.mark.parametrize(("share", "least", "most"), [(0.03, 0, 1), (0.05, 14, 20), (0.1, 45, 55)])
def test_faster_than_the_limit_it_porpoises(share, least, most, tmp_path):
    """Started 1 degree bow up: at 0.61 m/s that dies out, above it grows to a limit cycle."""
    settings = {
        "hull.eta_start": ["0 m", "0 m", "50 m", "0 deg", "1 deg", "0 deg"],
        "hull.volume": "6.5 l",
        "thrusters.port.full_thrust": f"{46.7 * share / 0.02} N",
        "thrusters.starboard.full_thrust": f"{46.7 * share / 0.02} N",
        "thrusters.vertical.full_thrust": "0 N",
        "stop": "120 s",
    }
    found = run("videoray-open-surge", tmp_path / "run", **settings)
    pitch = np.degrees(np.abs(found.signals["hull.attitude.theta"][found.time > 90]))
    assert least <= pitch.max() <= most


@pytest.mark.long
@pytest.mark.parametrize("seed", range(1, 21))
def test_on_its_tether_it_holds_depth_and_heading(seed, tmp_path):
    found = run("videoray-tethered-taut", tmp_path / "run", engine="fmu", seed=seed)
    assert [v["passed"] for v in found.verdicts] == [True, True]
    # It was at work: through 20 m of tether, taut at the end, against a current.
    assert found.signals["tether.greatest_tension"][-1] > 1.5
    place = [found.signals[f"loop.vehicle.hull.position.{axis}"][-1] for axis in "xyz"]
    # Of its 20 m a bow across the current takes up to a metre.
    assert 19.0 < math.dist(place, (0.0, 0.0, 0.0)) < 20.1
