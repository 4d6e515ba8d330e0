"""Campaigns that are changed from outside, left out trials, and pages beside the report."""

import pytest

from seatrial.errors import InputError
from seatrial.trial.records.run_folder import load_run
from seatrial_kits.campaigns.campaign import load_campaign
from seatrial_kits.campaigns.in_folders import run_campaign
from seatrial_kits.campaigns.shipment import packed, unpacked
from tests.command import seatrial
from tests.kit import needs_kits

GRID = '[grid]\n"case.number" = [1, 2]\n'


def test_a_change_replaces_what_the_file_and_its_trials_set(written, tmp_path):
    written('set = { "case.number" = 1 }')
    path = tmp_path / "campaign.toml"
    path.write_text('trials = [{ trial = "t.toml", set = { "case.number" = 2 } }]', "utf-8")
    campaign = load_campaign(str(path), {"case.number": 3.0})
    folder, [(case, _)] = run_campaign(campaign, tmp_path / "out", engine="direct")
    assert case.set == {"case.number": 3.0}
    (run,) = folder.glob("*/manifest.json")
    assert load_run(run.parent).signals["case.y"][-1] == 9.0


def test_a_key_with_several_values_cannot_be_set(written, tmp_path):
    written(GRID)
    with pytest.raises(InputError, match=r"grid: case.number has a list of values here"):
        load_campaign(str(tmp_path / "campaign.toml"), {"case.number": 3.0})


def test_a_change_travels_to_the_workers_of_a_cluster(written, tmp_path):
    written("")
    campaign = load_campaign(str(tmp_path / "campaign.toml"), {"case.number": 3.0})
    there, _ = unpacked(packed(campaign))
    assert there.cases()[0].set == {"case.number": 3.0}


@needs_kits("sea_trials")
@pytest.mark.parametrize("key", ["condition", "page"])
def test_an_unknown_name_of_a_kit_s_part_is_refused(written, key):
    said = f"unknown {key} of campaigns 'sea-trails'; did you mean 'sea-trials'"
    with pytest.raises(InputError, match=said):
        written(f'{key} = "sea-trails"')


@needs_kits("sea_trials")
def test_a_condition_needs_one_rig(written):
    with pytest.raises(InputError, match=r"choices.vehicle: one rig is needed"):
        written('condition = "sea-trials"\n[grid]\n"choices.vehicle" = ["otter", "mariner"]\n')


@needs_kits("sea_trials")
def test_a_page_needs_the_folder_of_every_case(written, tmp_path):
    written('page = "sea-trials"')
    done = seatrial("run", "campaign.toml", "--keep", "none", cwd=tmp_path)
    assert done.returncode == 2
    assert "this campaign makes a page of all" in done.stderr
