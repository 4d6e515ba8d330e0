"""Landings on the Hydrone's own hull while something fails: the drone lands, or stays in the air."""

import pytest

import seatrial
from tests.kit import needs_kits

STERN_WIND = {
    "wind.mean_speed": "8 m/s",
    "wind.direction": "0 deg",
    "vehicle.hull.wind_speed": "8 m/s",
    "vehicle.hull.wind_direction": "0 deg",
}
DRIFTING = {"keeper.keeper.enabled": False, "vehicle.hull.current_speed": "0.5 m/s"}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("fault", "seed", "go_arounds"),
    [
        pytest.param({"faults.0.at": "5.4 s"}, 1, 1.0, id="mark lost at 1 m"),
        pytest.param(STERN_WIND, 3, 0.0, id="wind from the stern"),
        pytest.param(DRIFTING, 1, 0.0, id="boat drifts"),
        # At steps of 2 ms friction at rest swung up in this one.
        pytest.param({"faults.1.at": "4 s"}, 16, 0.0, id="thruster stops"),
    ],
)
def test_it_lands_whatever_fails(fault, seed, go_arounds, tmp_path):
    changes = {**fault, "seed": seed}
    result = seatrial.run_trial(
        "hydrone-drone-landing-fault", set=changes, out=tmp_path / "run", engine="native"
    )
    assert [verdict.name for verdict in result.verdicts if not verdict.passed] == []
    assert result.signals["drone.figures.landed"][-1] == 1.0
    assert result.signals["drone.landing.go_arounds"][-1] == go_arounds


@needs_kits("campaigns")
@pytest.mark.long
def test_nothing_falls_in_the_campaign_of_faults(tmp_path):
    result = seatrial.run_campaign("drone-landing-faults", out=tmp_path / "run", engine="native")
    assert {each["name"]: each["verdict"] for each in result.criteria} == {
        "nothing falls": "pass",
        "it lands, or gives up in the air": "pass",
    }
