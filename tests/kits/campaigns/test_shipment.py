"""Travel of a campaign to a cluster's workers: all that it needs, wherever its files say it is."""

import io
import tarfile

import pytest

from seatrial.errors import InputError
from seatrial.system.parameters import load_vehicle
from seatrial_kits.campaigns.campaign import load_campaign
from seatrial_kits.campaigns.evaluator import Evaluator, Plan
from seatrial_kits.campaigns.shipment import (
    needed_files,
    pack_folder,
    packed,
    unpack_folder,
    unpacked,
)

COMPONENT = """
from seatrial.model.component import Component, Output, Parameter


class Boat(Component):
    length = Parameter(1.0, "m", "length")
    y = Output("m", "length")

    def start(self, t):
        self.y = self.length
"""
RIG = 'step = "100 ms"\n[components]\nboat = {{ fmu = "{fmu}", parameters = "{parameters}" }}\n'
TRIAL = 'rig = "{rig}"\nstop = "100 ms"\n[[criteria]]\nname = "short"\ncheck = "boat.y < 8 m"\n'
CAMPAIGN = 'trials = ["{trial}"]\nkeep = "none"\n'
VEHICLE = """
title = "mine"
source = "measured"
[hull]
length = { value = 4, unit = "m", source = "tape", mark = "identified" }
"""


@pytest.fixture
def robustness(tmp_path, monkeypatch):
    """Return a function: of the only case, where the project is no longer to be found."""

    def robustness(path: str, here: str) -> float:
        (tmp_path / "there").mkdir()
        with monkeypatch.context() as patched:
            patched.chdir(tmp_path / "project" / here)
            archive = packed(load_campaign(path))
        (tmp_path / "project").rename(tmp_path / "moved")
        monkeypatch.chdir(tmp_path / "there")
        campaign, home = unpacked(archive)
        with Evaluator(campaign.cases(), Plan("direct"), home=home) as evaluator:
            [verdict] = evaluator.measured(0).verdicts
        return verdict["robustness"]

    return robustness


LAYOUTS = {
    "folder by kind": (
        ("campaigns/c.toml", CAMPAIGN.format(trial="../trials/t.toml")),
        ("trials/t.toml", TRIAL.format(rig="../rigs/r.toml")),
        ("rigs/r.toml", RIG.format(fmu="../parts/b.py:Boat", parameters="../b.toml.hull")),
        ("parts/b.py", COMPONENT),
        ("b.toml", VEHICLE),
    ),
    "component above": (
        ("inside/c.toml", CAMPAIGN.format(trial="t.toml")),
        ("inside/t.toml", TRIAL.format(rig="r.toml")),
        ("inside/r.toml", RIG.format(fmu="../parts/b.py:Boat", parameters="b.toml.hull")),
        ("inside/b.toml", VEHICLE),
        ("parts/b.py", COMPONENT),
    ),
    "vehicle below the current folder": (
        ("inside/c.toml", CAMPAIGN.format(trial="t.toml")),
        ("inside/t.toml", TRIAL.format(rig="r.toml")),
        ("inside/r.toml", RIG.format(fmu="b.py:Boat", parameters="mine.hull")),
        ("inside/b.py", COMPONENT),
        ("vehicles/mine.toml", VEHICLE),
    ),
}


@pytest.mark.parametrize(
    ("layout", "here", "path"),
    [
        ("folder by kind", "", "campaigns/c.toml"),
        ("folder by kind", "campaigns", "c.toml"),
        ("component above", "inside", "c.toml"),
        ("vehicle below the current folder", "", "inside/c.toml"),
        ("vehicle below the current folder", "below", "../inside/c.toml"),
    ],
)
def test_what_a_campaign_needs_travels_with_it(write, robustness, layout, here, path):
    for name, text in LAYOUTS[layout]:
        write(f"project/{name.replace('vehicles', f'{here}/vehicles')}", text)
    assert robustness(path, here) == pytest.approx(1.0 - 4.0 / 8.0, rel=1e-12)


def test_a_shipped_campaign_takes_along_a_user_s_vehicle_alone(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    campaign = load_campaign("hydrone-landing-map")
    assert needed_files(campaign) == []
    shipped = load_vehicle("hydrone").read_from.path
    (tmp_path / "vehicles").mkdir()
    own = tmp_path / "vehicles/hydrone.toml"
    own.write_bytes(shipped.read_bytes())
    assert set(needed_files(campaign)) == {tmp_path, own}


def test_a_project_too_large_to_travel_is_refused(write, monkeypatch):
    for name, text in LAYOUTS["component above"]:
        write(f"project/{name}", text)
    path = write("project/inside/readme", "x" * 20_000).parent
    monkeypatch.chdir(path)
    monkeypatch.setattr("seatrial_kits.campaigns.shipment.MOST_BYTES", 10_000)
    with pytest.raises(InputError, match="put it and what it needs in a folder apart"):
        packed(load_campaign("c.toml"))


def test_a_run_folder_arrives_whole(write, tmp_path):
    write("case/inside/empty", "")
    folder = write("case/verdicts.json", "{}").parent
    (folder / "none").mkdir()
    unpack_folder(pack_folder(folder), tmp_path / "there")
    found = {p.relative_to(tmp_path / "there").as_posix() for p in (tmp_path / "there").rglob("*")}
    there = {"case", "case/none", "case/inside", "case/inside/empty", "case/verdicts.json"}
    assert found == there
    assert (tmp_path / "there/case/verdicts.json").read_text() == "{}"


@pytest.mark.parametrize(
    ("name", "kind"),
    [("../out", tarfile.REGTYPE), ("/out", tarfile.REGTYPE), ("out", tarfile.SYMTYPE)],
)
def test_an_archive_leads_nowhere_else(tmp_path, name, kind):
    stream, member = io.BytesIO(), tarfile.TarInfo(name)
    member.type, member.linkname = kind, "/"
    with tarfile.open(fileobj=stream, mode="w") as archive:
        archive.addfile(member, io.BytesIO())
    with pytest.raises(InputError, match=f"'{name}', and not files and folders alone"):
        unpack_folder(stream.getvalue(), tmp_path / "below")
    assert list(tmp_path.iterdir()) == []
