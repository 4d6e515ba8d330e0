"""Parts of a rig inside a rig that nothing reads are left out of a run, and nothing else changes."""

import csv
import json
from pathlib import Path

import pytest

from seatrial.trial.files.trial import load_trial
from seatrial.trial.running.run import run_trial
from tests.kit import needs_kits

TRIAL = """\
rig  = "sil"
stop = "1 s"
{more}
"""


def _run(folder: Path, name: str, more: str = "") -> tuple[dict[str, list[str]], dict, list[str]]:
    """Return columns, manifest and notes of a run of the shipped rig `sil`."""
    path = folder / f"{name}.toml"
    path.write_text(TRIAL.format(more=more))
    result = run_trial(load_trial(str(path)), folder / name, engine="direct")
    with (folder / name / "signals.csv").open() as file:
        header, *rows = csv.reader(file)
    columns = dict(zip(header, map(list, zip(*rows, strict=True)), strict=True))
    manifest = json.loads((folder / name / "manifest.json").read_text())
    return columns, manifest, result.notes


def test_what_nothing_reads_is_left_out_and_the_rest_is_the_same(tmp_path: Path) -> None:
    every = '[record]\nsignals = ["*", "vehicle.imu.*"]'
    (without, manifest, notes), (whole, _, quiet) = (
        _run(tmp_path, "without"),
        _run(tmp_path, "whole", every),
    )
    gone = whole.keys() - without.keys()
    assert gone
    assert all(name.startswith("vehicle.imu.") for name in gone)
    assert without == {name: column for name, column in whole.items() if name not in gone}
    assert manifest["left_out"] == ["vehicle.imu"]
    assert any("vehicle.imu" in note and "nothing reads it" in note for note in notes)
    assert not any("nothing reads it" in note for note in quiet)


@pytest.mark.parametrize(
    "more",
    [
        '[record]\nsignals = ["vehicle.sensors.gyro"]',
        '[set]\n"vehicle.imu.period" = "20 ms"',
        '[[faults]]\nat = "500 ms"\nwhat = "stuck"\nwhere = "vehicle.failures.gyro"',
        '[[faults]]\nat = "500 ms"\nwhat = "stuck"\nwhere = "vehicle.imu"',
        '[[criteria]]\nname = "still"\ncheck = "abs(vehicle.imu.gyro.z) < 1 rad/s"',
        '[[plots]]\ntitle = "gyro"\nsignals = ["vehicle.imu.gyro.z"]\n'
        '[record]\nsignals = ["vehicle.*"]',
    ],
)
def test_a_trial_keeps_what_it_names(tmp_path: Path, more: str) -> None:
    _, manifest, _ = _run(tmp_path, "named", more)
    assert "left_out" not in manifest
    assert "vehicle.imu" in manifest["components"]


@needs_kits("nmea")
def test_what_the_whole_rig_shows_and_what_reaches_outside_stays(tmp_path: Path) -> None:
    """A bare vehicle shows its hull's motion; a link writes to programs that no rig has."""
    (tmp_path / "vehicle.toml").write_text(
        '[components]\nhull = { fmu = "marine-craft", parameters = "hydrone" }\n'
        'imu = { fmu = "imu" }\nlink = { fmu = "nmea0183" }\n'
        '[connections]\n"hull.motion" = "imu.motion"\n[shows]\nsensors = "imu.reading"\n'
    )
    (tmp_path / "outer.toml").write_text(
        'step = "10 ms"\n[components]\nvehicle = { rig = "./vehicle.toml" }\n'
        '[shows]\nsensors = "vehicle.sensors"\n'
    )
    (tmp_path / "bare.toml").write_text('rig = "./outer.toml"\nstop = "1 s"\n')
    run_trial(load_trial(str(tmp_path / "bare.toml")), tmp_path / "run", engine="direct")
    manifest = json.loads((tmp_path / "run" / "manifest.json").read_text())
    assert set(manifest["components"]) == {"vehicle.hull", "vehicle.imu", "vehicle.link"}
