"""Rates of landings over many seeds: on a deck at rest, and with a late sight."""

import numpy as np
import pytest

import seatrial
from seatrial_kits.campaigns.table import read_rows
from tests.kit import needs_kits

pytestmark = [needs_kits("campaigns", "native"), pytest.mark.long]

CAMPAIGN = """
keep    = "none"
figures = ["drone.touch_error"]
design  = {{ kind = "full-factorial", vary = {{ seed = {{ integers = [1, {seeds}] }} }} }}

[[trials]]
trial = "drone-landing-deck"

[trials.set]
{settings}

[trials.grid]
{grid}
"""
REST = """
"deck.raft.wave_height" = "0 m"
"wind.mean_speed" = "0 m/s"
"""
ROUGH = """
"choices.deck" = "wamv"
"choices.control" = "relative"
"drone.body.position_start" = ["0 m", "0 m", "-5.25 m"]
"deck.raft.wave_height" = "3.25 m"
"wind.mean_speed" = "12.6 m/s"
"drone.radio.delay" = "{delay}"
"""


def flown(folder, **parts):
    """Return whether each landed, and its error at the touch."""
    (folder / "many.toml").write_text(CAMPAIGN.format(**parts), "utf-8")
    result = seatrial.run_campaign(folder / "many.toml", out=folder / "run", engine="native")
    columns = ["passed", "greatest drone.touch_error"]
    rows = [[row[name] for name in columns] for row in read_rows(result.table, columns)]
    landed, error = zip(*rows, strict=True)
    return np.array(landed), np.array(error)


@pytest.mark.parametrize("control", ["naive", "relative", "predictive"])
def test_every_landing_on_a_deck_at_rest_succeeds(control, tmp_path):
    landed, error = flown(
        tmp_path, seeds=60, settings=REST, grid=f'"choices.control" = ["{control}"]'
    )
    assert landed.all()
    assert np.percentile(error, 95) < 0.10


def test_a_late_sight_and_report_lower_the_rate(tmp_path):
    rates = []
    for delay in ("0.06 s", "0.3 s"):
        folder = tmp_path / delay
        folder.mkdir()
        landed, _ = flown(
            folder,
            seeds=100,
            settings=ROUGH.format(delay=delay),
            grid=f'"drone.camera.delay" = ["{delay}"]',
        )
        rates.append(landed.mean())
    assert rates[1] < rates[0]
