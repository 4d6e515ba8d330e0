"""Names of files are relative to the file that says them."""

import pytest

from seatrial.system.assembling.assembly import assemble
from seatrial.system.flattening import load_rig
from seatrial.trial.files.trial import load_trial
from seatrial.trial.running.preparation import prepare
from seatrial.trial.running.run import Hooks
from tests.kit import needs_kits

GRID = "north,east,depth\n0,0,5\n0,9,5\n9,0,5\n9,9,5\n"
RIG = 'step = "10 ms"\n[components]\nsounder = {{ fmu = "echo-sounder"{} }}\n'
VEHICLE = (
    'title = "x"\nsource = "x"\n[echo-sounder]\n'
    'seabed_file = { value = "bed.csv", unit = "1", source = "x", mark = "stated" }\n'
)


@pytest.fixture
def elsewhere(tmp_path, monkeypatch):
    """Return a folder with a grid in the one beside it; we are in neither."""
    for name in ("boat", "away"):
        (tmp_path / name).mkdir()
    monkeypatch.chdir(tmp_path / "away")
    (tmp_path / "boat/bed.csv").write_text(GRID, "ascii")
    return tmp_path / "boat"


def depth_file(system):
    try:
        return system.parts["sounder"].given["seabed_file"].value
    finally:
        system.free()


@needs_kits("underwater")
@pytest.mark.parametrize("said", [', set = { seabed_file = "bed.csv" }', ', parameters = "v.toml"'])
def test_of_a_rig_and_of_a_vehicle_file(elsewhere, said):
    (elsewhere / "v.toml").write_text(VEHICLE, "utf-8")
    (elsewhere / "r.toml").write_text(RIG.format(said), "utf-8")
    found = depth_file(assemble(load_rig(str(elsewhere / "r.toml")), "direct"))
    assert found == str(elsewhere / "bed.csv")


@needs_kits("underwater")
def test_of_a_trial(elsewhere):
    (elsewhere / "r.toml").write_text(RIG.format(""), "utf-8")
    trial = 'rig = "r.toml"\nstop = "1 s"\n[set]\n"sounder.seabed_file" = "bed.csv"\n'
    (elsewhere / "t.toml").write_text(trial, "utf-8")
    prepared = prepare(load_trial(str(elsewhere / "t.toml")), "direct", Hooks())
    assert depth_file(prepared.system) == str(elsewhere / "bed.csv")


@needs_kits("underwater")
def test_else_to_where_the_run_begins(elsewhere):
    (elsewhere / "bed.csv").rename(elsewhere.parent / "away/bed.csv")
    (elsewhere / "r.toml").write_text(RIG.format(', set = { seabed_file = "bed.csv" }'), "utf-8")
    assert depth_file(assemble(load_rig(str(elsewhere / "r.toml")), "direct")) == "bed.csv"
