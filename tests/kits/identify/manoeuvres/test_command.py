"""seatrial calibrate: from a log to a copy of the vehicle, and what is refused."""

import json
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from seatrial.errors import InputError
from seatrial.system.parameters import load_vehicle
from seatrial_kits.identify.manoeuvres import command
from seatrial_kits.identify.manoeuvres.passes import read_pass
from seatrial_kits.identify.manoeuvres.replay import craft_of
from seatrial_kits.identify.manoeuvres.study import manoeuvre_study
from tests.command import seatrial

from .passes_of import FOLDER, kvlcc2

ZIG_ZAG = FOLDER / "kvlcc2_full_zigzag_20_20.csv"
TURN = FOLDER / "kvlcc2_full_turn_p35_current.csv"
COLUMNS = ("time=t,north=x,east=y,heading=psi", "rudder=port,propeller_order=1")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Return a folder with a log, with the rudder as the craft has it, and the result in it."""
    folder = tmp_path_factory.mktemp("identified")
    for name, reference in (("log", ZIG_ZAG), ("turn", TURN)):
        rows = np.loadtxt(reference, delimiter=",", skiprows=2)
        table = np.column_stack((rows[:, :4], np.degrees(-rows[:, 7])))[:700]
        head = "t,x,y,psi,port\ns,m,m,rad,deg"
        np.savetxt(folder / f"{name}.csv", table, delimiter=",", header=head, comments="")
    return folder


def identify(folder, *arguments, columns=COLUMNS):
    texts = (part for text in columns for part in ("--columns", text))
    return seatrial("calibrate", "kvlcc2", "log.csv", *texts, *arguments, cwd=folder)


@pytest.fixture(scope="module")
def done(folder):
    asked = ("--free", "resistance,N.v,N.r", "--check", "turn.csv", "--out", "found", "--json")
    return identify(folder, *asked)


@pytest.mark.slow
def test_it_finds_the_numbers_of_the_file_from_a_record_of_them(done):
    assert done.returncode == 0, done.stderr
    result = json.loads(done.stdout)["result"]
    found = {row["name"]: row for row in result["parameters"]}
    for name, published in (("resistance", 0.022), ("N.v", -0.137), ("N.r", -0.049)):
        assert found[name]["value"] == pytest.approx(published, rel=0.01)
    assert result["accepted"]
    # A turn that it was not fitted to, in a current: 8 km of track, of which the rudder is rounded.
    assert "turn.csv 100.0 %" in result["verdicts"][-1]["detail"]


def test_a_log_that_was_not_fitted_may_reject_the_model():
    run = kvlcc2("full_zigzag_20_20", last=150)
    mirrored = replace(run, orders={**run.orders, "rudder": -run.orders["rudder"]})
    found = manoeuvre_study("kvlcc2", [run], craft_of("kvlcc2", None), ["N.r"], None, [mirrored])
    assert [verdict.passed for verdict in found.verdicts] == [True, True, False]
    assert not found.accepted
    assert [shown.is_fitted for shown in found.shown] == [True, False]


def test_the_copy_is_the_vehicle_with_a_variant_and_all_else_as_it_was(done, folder):
    copy = folder / "found/harness/vehicles/kvlcc2-identified/vehicle.toml"
    text = copy.read_text("utf-8")
    shipped = load_vehicle("kvlcc2").read_from.path
    assert [line for line in shipped.read_text("utf-8").splitlines() if line.startswith("#")] == [
        line for line in text.splitlines() if line.startswith("#") and "parameters ide" not in line
    ]
    file = load_vehicle(str(copy)).file
    assert file.default == "identified"
    assert tomllib.loads(text)["rig"]["variant"] == "identified"
    assert tomllib.loads(copy.with_name("pilot.toml").read_text("utf-8"))["variant"] == "identified"
    entries = file.variants["identified"]["mmg-ship"]
    assert entries["N.r"].mark == "identified"
    assert "identified from log.csv: 95 % interval -0.04" in entries["N.r"].source
    assert load_vehicle(str(copy)).parameter_set("mmg-ship", None).values["length"].value == 320
    for table in file.variants["ship"].keys() - {"mmg-ship"}:
        assert file.variants["identified"][table] == file.variants["ship"][table]


def test_the_copy_is_found_by_name_and_has_the_numbers(done, folder):
    run = seatrial("describe", "vehicles/kvlcc2-identified", cwd=folder / "found")
    assert run.returncode == 0, run.stderr
    copy = folder / "found/harness/vehicles/kvlcc2-identified/vehicle.toml"
    values = load_vehicle(str(copy)).parameter_set("mmg-ship", None).values
    assert values["N.r"].value == pytest.approx(-0.049, rel=0.01)
    assert values["N.r"].value != -0.049


def test_the_page_shows_the_trial_again(done, folder):
    page = (folder / "found/report.html").read_text("utf-8")
    for text in (
        "kvlcc2 calibrated from manoeuvres",
        "Model and logs",
        "N.r",
        "log.csv",
        "turn.csv (check)",
    ):
        assert text in page


@pytest.mark.parametrize(
    ("columns", "said"),
    [
        ((COLUMNS[0],), "the order yaw is needed"),
        ((COLUMNS[0], "rudder=port"), "propeller_order lack: --columns propeller_order=NAME"),
        ((COLUMNS[0], "ruder=port"), "unknown column 'ruder'; did you mean 'rudder'"),
        ((COLUMNS[0], "rudder=prt,speed=1"), "rudder: unknown column 'prt'; did you mean 'port'"),
        ((COLUMNS[0], "yaw=port:deg,speed=1"), "unit 'deg' cannot be converted to '1'"),
        ((COLUMNS[0], "yaw=2,speed=1"), "yaw: shares from -1 to 1 are needed"),
        ((COLUMNS[0], "rudder"), "WHAT=NAME[:UNIT] or WHAT=NUMBER is needed, found 'rudder'"),
        (("time=t,north=x,east=y,heading=psi:deg", "yaw=0,speed=1"), "not deg"),
    ],
)
def test_orders_and_columns_that_do_not_fit_are_refused(folder, columns, said):
    refused = identify(folder, columns=columns)
    assert refused.returncode == 2
    assert said in refused.stderr
    assert "Traceback" not in refused.stderr


@pytest.mark.parametrize(
    ("free", "said"),
    [
        ("N.w", "unknown parameter 'N.w'; did you mean"),
        ("attachment_place.x", "attachment_place.x is 0 in"),
        ("propeller_K_Q", "does not act"),
    ],
)
def test_parameters_that_cannot_be_identified_are_refused(folder, free, said):
    refused = identify(folder, "--free", free)
    assert refused.returncode == 2
    assert said in refused.stderr


def test_a_log_with_a_gap_is_refused_and_nothing_is_written(folder, tmp_path):
    lines = (folder / "log.csv").read_text("utf-8").splitlines(keepends=True)
    (tmp_path / "log.csv").write_text("".join(lines[:100] + lines[120:]), "utf-8")
    refused = identify(tmp_path, "--out", "found")
    assert refused.returncode == 2
    assert "log.csv, line 101: a gap from" in refused.stderr
    assert not (tmp_path / "found").exists()


def test_a_folder_that_is_not_empty_is_refused_before_anything_is_fitted(folder, monkeypatch):
    monkeypatch.chdir(folder)
    monkeypatch.setattr(command, "manoeuvre_study", lambda *_: pytest.fail("it was fitted"))
    with pytest.raises(InputError, match="exists and is not an empty folder"):
        command.calibrate("kvlcc2", [Path("log.csv")], list(COLUMNS), out=folder)


def test_what_fails_leaves_no_folder(folder, monkeypatch):
    monkeypatch.chdir(folder)

    def fails(*_):
        raise InputError("no fit")

    monkeypatch.setattr(command, "manoeuvre_study", fails)
    with pytest.raises(InputError, match="no fit"):
        command.calibrate("kvlcc2", [Path("log.csv")], list(COLUMNS), out=Path("failed"))
    assert not (folder / "failed").exists()


def test_what_a_log_leaves_out_is_said(tmp_path):
    rows = np.array([[t, 0.8, 0.1 + 1e-6 * t, 0.0, 0.1 * (t > 20)] for t in np.arange(0, 60.0)])
    rows[30, 1:3] = 0.0  # no fix
    head = "time,latitude,longitude,heading,helm"
    np.savetxt(tmp_path / "fixes.csv", rows, delimiter=",", header=head, comments="")
    (note,) = read_pass(tmp_path / "fixes.csv", [], lambda what: "1").notes
    assert note == "fixes.csv: positions of 0, 0 are left out, 1 of them: the receiver had no fix"
