"""Manoeuvres that apply to the shipped vehicles, as their rigs have it."""

import re

import pytest

from seatrial.errors import InputError
from seatrial.trial.files.trial import load_trial
from seatrial_kits.campaigns.campaign import load_campaign
from seatrial_kits.sea_trials.abilities import reason_against


@pytest.mark.parametrize(
    ("vehicle", "trial", "reason"),
    [
        ("mariner", "crash-stop", "no command reaches its propulsion"),
        ("mariner", "zig-zag-20", None),
        ("remus100", "turn-on-the-spot", "its pilot keeps it under way"),
        ("remus100", "vertical-zig-zag", None),
        ("otter", "depth-step", "its pilot holds no depth"),
        ("otter", "bollard-pull", None),
        (
            "kvlcc2",
            "bollard-pull",
            r"its \[mooring\] has no line, or fins alone hold its pitch, which need speed",
        ),
        ("remus100", "bollard-pull", ".*fins alone hold its pitch"),
        ("bluerov2", "vertical-zig-zag", "its pilot does not dive by pitch"),
        ("bluerov2", "station-keeping", None),
        ("glider", "turning-circle", "its pilot takes no order of speed"),
    ],
)
def test_a_vehicle_does_what_it_can(vehicle, trial, reason):
    loaded = load_trial(trial, changes={"choices.vehicle": vehicle}, origin="test")
    assert re.match(reason or "None", str(reason_against(loaded)))


def test_the_campaign_has_both_sides_and_says_what_it_leaves_out():
    campaign = load_campaign("sea-trials", {"choices.vehicle": "mariner"})
    sides = [case.set.get("autopilot.manoeuvre.side") for case in campaign.cases()]
    assert sides.count("port") == sides.count("starboard") == 6
    assert "crash-stop" in campaign.left_out
    assert {trial.name for trial in campaign.trials} >= {"spiral", "reverse-spiral"}


def test_a_sailing_boat_has_no_trials():
    with pytest.raises(InputError, match=r"no trial applies: .* the wind drives it"):
        load_campaign("sea-trials", {"choices.vehicle": "gloria"})
