"""seatrial trials figures, and a manoeuvre of a shipped vehicle."""

import csv
import json

import pytest

from tests.command import seatrial

from .references import FIGURES, FOLDER

CAMPAIGN = """
trials    = ["turning-circle", "depth-step"]
condition = "sea-trials"
page      = "sea-trials"
"""
NAMES = "time=t,north=x,east=y,heading=psi,helm=delta"
TURN = "kvlcc2_full_turn_m35"


def figures(*arguments, cwd):
    return seatrial("trials", "figures", *arguments, cwd=cwd)


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """Return the folder of a turning circle of the Otter, in that of a campaign, cut short."""
    folder = tmp_path_factory.mktemp("trials")
    (folder / "short.toml").write_text(CAMPAIGN, "utf-8")
    settings = ("autopilot.manoeuvre.window=10 s", "autopilot.manoeuvre.turn=400 deg",
                "autopilot.manoeuvre.criteria=imo", "variant=loaded")  # fmt: skip
    done = seatrial(
        "run", "short.toml", "--vehicle", "otter", "--engine", "direct", "-o", "runs",
        *(part for text in settings for part in ("--set", text)), cwd=folder,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert "page: runs/sea-trials.html" in done.stdout
    assert "depth-step is left out: its pilot holds no depth" in done.stdout
    return folder / "runs/01-turning-circle"


def test_figures_of_a_csv_file_against_the_criteria(tmp_path):
    path = str(FOLDER / f"{TURN}.csv")
    done = figures(path, "--manoeuvre", "turning-circle", "--columns", NAMES, "--length", "320 m",
                   "--criteria", "imo", cwd=tmp_path)  # fmt: skip
    assert done.returncode == 0, done.stderr
    for text in ("3.001", "PASS  turning: advance", "margin 1.987", "largest_heel cannot be had"):
        assert text in done.stdout


def test_a_criterion_that_does_not_hold_is_status_1(tmp_path):
    path = str(FOLDER / f"{TURN}.csv")
    done = figures(path, "--manoeuvre", "turning-circle", "--columns", NAMES, "--length", "200 m",
                   "--criteria", "imo", cwd=tmp_path)  # fmt: skip
    assert done.returncode == 1
    assert "FAIL  turning: advance" in done.stdout


@pytest.mark.slow
def test_figures_of_a_run_and_of_a_log_beside_it(run, tmp_path):
    path = str(FOLDER / f"{TURN}.csv")
    done = figures(path, "--manoeuvre", "turning-circle", "--columns", NAMES, "--compare",
                   str(run), "--json", cwd=tmp_path)  # fmt: skip
    result = json.loads(done.stdout)["result"]
    advance = result["figures"]["advance"]
    assert advance["value"] / 320.0 == pytest.approx(FIGURES[TURN]["figures"]["advance"], abs=1e-3)
    # The Otter turns in some lengths of 2 m.
    assert 2.0 < result["compared"]["figures"]["advance"]["value"] < 20.0
    assert result["compared"]["missing"]["steady_diameter"].endswith("540 deg are needed")


def test_a_part_of_a_log(tmp_path):
    """Figures are those of the whole, of a log that goes on; times are those of the log."""
    done = figures(str(FOLDER / f"{TURN}.csv"), "--manoeuvre", "turning-circle", "--columns", NAMES,
                   "--to", "500 s", "--json", cwd=tmp_path)  # fmt: skip
    found = json.loads(done.stdout)["result"]["figures"]
    assert found["advance"]["value"] / 320.0 == pytest.approx(
        FIGURES[TURN]["figures"]["advance"], abs=1e-3
    )
    assert "steady_diameter" not in found


def test_without_a_helm_the_order_is_a_note(tmp_path):
    names = NAMES.replace(",helm=delta", "")
    path = str(FOLDER / f"{TURN}.csv")
    notes = []
    for order in ([], ["--order", "0 s"]):
        done = figures(
            path,
            "--manoeuvre",
            "turning-circle",
            "--columns",
            names,
            *order,
            "--json",
            cwd=tmp_path,
        )
        notes.append(json.loads(done.stdout)["notes"])
    assert notes[0][0].startswith("no helm is read: the order is taken to be given at 0 s")
    assert notes[1] == []


def test_a_run_needs_no_manoeuvre(run, tmp_path):
    done = figures(str(run), "--manoeuvre", "zig-zag", cwd=tmp_path)
    assert done.returncode == 2
    assert "a run has its own" in done.stderr


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "--manoeuvre: one of turning-circle, "),
        (["--manoeuvre", "circle"], "unknown manoeuvre 'circle'"),
        (["--manoeuvre", "crash-stop"], "crash-stop: the time of the order is needed"),
        (["--manoeuvre", "turning-circle", "--criteria", "abs"], "unknown set 'abs'"),
        (["--manoeuvre", "turning-circle", "--criteria", "imo"], "--length"),
        (["--manoeuvre", "turning-circle", "--length", "0 m"], "a length above 0"),
        (["--manoeuvre", "turning-circle", "--length", "3 s"], "--length: "),
        (["--manoeuvre", "turning-circle", "--from", "3 m"], "--from: "),
        (["--manoeuvre", "turning-circle", "--from", "5000 s"], ": no value from 5000 s"),
        (["--manoeuvre", "turning-circle", "--format", "tlog"], "time: MAVLink telemetry log has"),
    ],
)
def test_bad_options_are_refused(tmp_path, arguments, message):
    done = figures(str(FOLDER / f"{TURN}.csv"), "--columns", NAMES, *arguments, cwd=tmp_path)
    assert done.returncode == 2
    assert message in done.stderr


def test_one_page_of_all_trials_of_a_vehicle(run, tmp_path):
    page = (run.parent / "sea-trials.html").read_text("utf-8")
    for text in ("Sea trials of otter", "turning: advance", "margin", "its pilot holds no depth"):
        assert text in page
    (trial,) = json.loads((run.parent / "sea-trials.json").read_text("utf-8"))
    with (run.parent / "sea-trials.csv").open() as file:
        rows = {row["figure"]: row for row in csv.DictReader(file)}
    assert float(rows["advance"]["value"]) == trial["figures"]["advance"]["value"]
    assert float(rows["advance"]["lengths"]) == trial["figures"]["advance"]["value"] / 2.0
    assert rows["steady_diameter"]["missing"].endswith("540 deg are needed")
    assert trial["trial"] == "turning-circle"
    (advance, diameter) = trial["criteria"]
    assert advance["value"] == pytest.approx(trial["figures"]["advance"]["value"] / 2.0)
    assert advance["margin"] == pytest.approx(4.5 - advance["value"])
    assert diameter["limit"] == 5.0


def test_the_page_of_runs_elsewhere_is_without_criteria_that_are_not_for_the_craft(run, tmp_path):
    done = seatrial("trials", "page", str(run), "-o", "page", "--criteria", "none", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert json.loads((tmp_path / "page/sea-trials.json").read_text("utf-8"))[0]["criteria"] == []


def test_a_report_has_the_manoeuvre(run):
    text = (run / "report.html").read_text("utf-8")
    for title in ("Turning circle: figures", "Turning circle: track"):
        assert title in text


def test_a_folder_without_runs_has_no_page(tmp_path):
    done = seatrial("trials", "page", ".", cwd=tmp_path)
    assert done.returncode == 2
    assert "neither a run folder nor one with run folders" in done.stderr
