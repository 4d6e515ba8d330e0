"""The command line as its user meets it: output, exit status, one clear message."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from seatrial.errors import unknown

SEATRIAL = str(Path(sys.executable).with_name("seatrial"))

BAD = '''
"""Fails."""
from seatrial.component import Component, Output, Parameter


class Bad(Component):
    """Fails after a while."""

    how = Parameter("raise", "1", "how", choices=("raise", "nan", "slow"))
    y = Output("m", "y")

    def step(self, t, h):
        if self.how == "slow":
            import time
            time.sleep(0.01)
        elif t > 0.2:
            if self.how == "nan":
                self.y = float("nan")
            else:
                raise RuntimeError("flooded")
'''


def seatrial(*arguments: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [SEATRIAL, *arguments], cwd=cwd, capture_output=True, text=True, check=False
    )


@pytest.fixture
def boat(write, tmp_path: Path) -> Path:
    write("bad.py", BAD)
    write("rig.toml", 'step = "10 ms"\n[components]\nboat = { fmu = "bad.py:Bad" }\n')
    write("trial.toml", 'rig = "rig.toml"\nstop = "1 s"\n')
    return tmp_path


def test_a_trial_passes_and_leaves_a_whole_folder(tmp_path: Path) -> None:
    done = seatrial("run", "hydrone-landing", "--set", "downwash.pad=nominal", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("PASS") == 5
    (folder,) = (tmp_path / "runs").iterdir()
    assert {p.name for p in folder.iterdir()} == {
        "signals.csv", "manifest.json", "timing.json", "verdicts.json", "report.html"
    }  # fmt: skip
    again = seatrial("report", str(folder), cwd=tmp_path)
    assert again.returncode == 0


def test_a_criterion_that_fails_is_status_one(tmp_path: Path) -> None:
    done = seatrial("run", "hydrone-open-landing", "--engine", "direct", "--out", "x", cwd=tmp_path)
    assert done.returncode == 1
    assert "FAIL" in done.stdout
    assert done.stderr == ""


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["run", "hydrone-landnig"], "did you mean 'hydrone-landing'"),
        (["run", "nothing.toml"], "there is no file"),
        (["run", "hydrone-landing", "--set", "hull.masss=3"], "did you mean 'mass'"),
        (["run", "hydrone-landing", "--set", "hull.mass=3 N"], "'N' cannot be converted to 'kg'"),
        (["run", "hydrone-landing", "--set", "downwash.pad=aft"], "unknown preset 'aft'"),
        (["run", "hydrone-landing", "--set", "vairant=source"], "did you mean 'variant'"),
        (["run", "hydrone-landing", "--set", "variant=sauce"], "did you mean 'source'"),
        (["run", "hydrone-landing", "--set", "hull.mass=-3"], "not in its range 0.0 <= mass"),
        (["run", "hydrone-landing", "--set", "hull.coriolis=fulll"], "did you mean 'full'"),
        (["run", "hydrone-landing", "--set", "nonsense"], "KEY=VALUE is needed"),
        (["run", "hydrone-landing", "--set", "hull.velocity=3"], "output and cannot be set"),
        (["run", "hydrone-landing", "--engine", "warp"], "'fmu' or 'direct'"),
        (["run", "hydrone-pads", "--set", "seed=3"], "--set works with a trial"),
        (["report", "nowhere"], "nowhere"),
        (["compare", "nowhere", "neither"], "nowhere"),
        (["fmu", "build", "trhuster"], "did you mean 'thruster'"),
        (["fmu", "build", "hull.fmu"], "there is no FMU"),
        (["fmu", "describe", "boat.py:Boat"], "there is no file"),
        (["fmu", "build", "thruster", "--parameters", "hydron"], "did you mean 'hydrone'"),
        (["fmu", "build", "thruster", "--parameters", "hydrone"], "component table 'thruster'"),
    ],
)
def test_bad_input_is_one_message_and_status_two(
    arguments: list[str], message: str, tmp_path: Path
) -> None:
    done = seatrial(*arguments, cwd=tmp_path)
    assert done.returncode == 2
    assert message in done.stderr
    assert "Traceback" not in done.stderr + done.stdout
    assert done.stderr.startswith("seatrial: ")
    assert list(tmp_path.iterdir()) == []


def test_broken_toml_names_file_and_line(boat: Path, write) -> None:
    write("trial.toml", 'rig = "rig.toml"\nstop = "1 s\n')
    done = seatrial("run", "trial.toml", cwd=boat)
    assert done.returncode == 2
    assert "trial.toml: not TOML" in done.stderr
    assert "line 2" in done.stderr


@pytest.mark.parametrize(("how", "said"), [("raise", "flooded"), ("nan", "output y is nan")])
def test_a_component_that_fails_is_status_three(how: str, said: str, boat: Path) -> None:
    done = seatrial("run", "trial.toml", "--set", f"boat.how={how}", "--out", "run", cwd=boat)
    assert done.returncode == 3
    assert said in done.stderr
    assert "FAILED" in done.stdout
    rows = (boat / "run" / "signals.csv").read_text().splitlines()
    assert 21 <= len(rows) - 1 <= 22
    assert (boat / "run" / "report.html").is_file()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_leaves_a_whole_record(number: int, boat: Path) -> None:
    command = [SEATRIAL, "run", "trial.toml", "--set", "boat.how=slow", "--set", "stop=1000 s"]
    process = subprocess.Popen(
        [*command, "--out", "run"], cwd=boat, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )
    signals = boat / "run" / "signals.csv"
    for _ in range(600):
        if signals.is_file() and signals.stat().st_size > 100:
            break
        time.sleep(0.05)
    time.sleep(0.3)
    os.kill(process.pid, number)
    _, stderr = process.communicate(timeout=30)
    assert process.returncode == 3
    assert b"stopped" in stderr
    lines = signals.read_text().splitlines()
    assert len(lines) > 10
    assert all(line.count(",") == 1 for line in lines)


def test_two_runs_compare_equal_and_different(tmp_path: Path) -> None:
    for out, stop in (("a", "2 s"), ("b", "2 s"), ("c", "3 s")):
        seatrial("run", "hydrone-open-landing", "--set", f"stop={stop}", "--engine", "direct",
                 "--out", out, cwd=tmp_path)  # fmt: skip
    assert seatrial("compare", "a", "b", cwd=tmp_path).returncode == 0
    assert seatrial("compare", "a", "c", cwd=tmp_path).returncode == 1


def test_a_campaign_runs_and_reports(tmp_path: Path) -> None:
    done = seatrial("run", "hydrone-open-pads", "--engine", "direct", "--out", "c", cwd=tmp_path)
    assert done.returncode == 1
    assert "3 of 10 cases pass" in done.stdout
    assert (tmp_path / "c" / "report.html").is_file()


def test_fmu_commands(tmp_path: Path) -> None:
    listed = seatrial("fmu", "list", cwd=tmp_path)
    assert "marine-craft" in listed.stdout
    built = seatrial(
        "fmu", "build", "marine-craft", "--parameters", "hydrone", "--variant", "source",
        "--out", "fmus", cwd=tmp_path,
    )  # fmt: skip
    assert built.returncode == 0, built.stderr
    checked = seatrial("fmu", "check", "fmus/marine-craft.fmu", cwd=tmp_path)
    assert (checked.returncode, "no problem found" in checked.stdout) == (0, True)
    described = seatrial("fmu", "describe", "fmus/marine-craft.fmu", cwd=tmp_path)
    assert "21.987" in described.stdout
    assert "diagonal" in described.stdout


def test_doctor_and_list(tmp_path: Path) -> None:
    assert "LD_PRELOAD=" in seatrial("doctor", cwd=tmp_path).stdout
    listing = seatrial("list", cwd=tmp_path).stdout
    for name in ("hydrone-landing", "hydrone-pads", "marine-craft", "hydrone-open-loop"):
        assert name in listing
    assert seatrial("--version", cwd=tmp_path).stdout.startswith("seatrial ")


def test_near_misses() -> None:
    assert unknown("port", "atitude", ["attitude", "force"]) == (
        "unknown port 'atitude'; did you mean 'attitude'? (known: attitude, force)"
    )


@pytest.mark.parametrize("engine", ["fmu", "direct"])
def test_a_second_signal_ends_a_component_that_hangs(engine: str, boat: Path, write) -> None:
    write("bad.py", BAD.replace("time.sleep(0.01)", "time.sleep(0.01 if t < 0.05 else 100)"))
    command = [SEATRIAL, "run", "trial.toml", "--set", "boat.how=slow", "--engine", engine]
    process = subprocess.Popen(
        [*command, "--out", "run"], cwd=boat, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )
    manifest = boat / "run" / "manifest.json"
    for _ in range(600):
        if manifest.is_file() and manifest.stat().st_size > 100:
            break
        time.sleep(0.05)
    time.sleep(1.0)
    os.kill(process.pid, signal.SIGINT)
    time.sleep(0.3)
    os.kill(process.pid, signal.SIGINT)
    _, stderr = process.communicate(timeout=30)
    assert process.returncode == 3
    assert b"Traceback" not in stderr
    assert len((boat / "run" / "signals.csv").read_text().splitlines()) >= 5
    assert '"status": "running"' not in manifest.read_text()
