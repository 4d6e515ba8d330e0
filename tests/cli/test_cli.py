"""The command line as its user meets it: output, exit status, one clear message."""

from __future__ import annotations

import json
import shlex
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from seatrial.cli.commands import commands, examples, loaded
from seatrial.errors import unknown
from tests.command import SEATRIAL, seatrial
from tests.kit import needs_kits

BAD = '''
"""Fails."""
from seatrial.model.component import Component, Output, Parameter


class Bad(Component):
    """Fails after a while."""

    how = Parameter("raise", "1", "how", choices=("raise", "nan"))
    y = Output("m", "y")

    def step(self, t, h):
        if t > 0.2:
            if self.how == "nan":
                self.y = float("nan")
            else:
                raise RuntimeError("flooded")
'''


@pytest.fixture
def boat(write, tmp_path: Path) -> Path:
    write("bad.py", BAD)
    write("rig.toml", 'step = "10 ms"\n[components]\nboat = { fmu = "bad.py:Bad" }\n')
    write("trial.toml", 'rig = "rig.toml"\nstop = "1 s"\n')
    return tmp_path


def test_a_trial_passes_and_leaves_a_whole_folder(tmp_path: Path) -> None:
    done = seatrial("run", "hydrone-landing", "--set", "drone.pad=nominal", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("PASS") == 5
    (folder,) = (tmp_path / "runs").iterdir()
    assert {p.name for p in folder.iterdir()} == {
        "signals.csv", "manifest.json", "timing.json", "verdicts.json", "report.html"
    }  # fmt: skip
    again = seatrial("report", str(folder), cwd=tmp_path)
    assert again.returncode == 0


def test_a_criterion_that_fails_is_status_one(tmp_path: Path) -> None:
    done = seatrial(
        "run",
        "hydrone-open-landing",
        "--engine",
        "direct",
        "--out",
        "x",
        "--set",
        "downwash.pad=transversal",
        cwd=tmp_path,
    )
    assert done.returncode == 1
    assert "FAIL" in done.stdout
    assert "seatrial:" not in done.stderr  # nothing but progress


@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["run", "hydrone-landnig"], "did you mean 'hydrone-landing'"),
        (["run", "nothing.toml"], "there is no file"),
        (["run", "hydrone-landing", "--set", "vehicle.hull.masss=3"], "did you mean 'mass'"),
        (
            ["run", "hydrone-landing", "--set", "vehicle.hull.mass=3 N"],
            "'N' cannot be converted to 'kg'",
        ),
        (["run", "hydrone-landing", "--set", "drone.pad=aft"], "unknown preset 'aft'"),
        (["run", "hydrone-landing", "--set", "vairant=source"], "did you mean 'variant'"),
        (["run", "hydrone-landing", "--set", "variant=sauce"], "did you mean 'source'"),
        (
            ["run", "hydrone-landing", "--set", "vehicle.hull.mass=-3"],
            "not in its range 0.0 <= mass",
        ),
        (["run", "hydrone-landing", "--set", "vehicle.hull.coriolis=fulll"], "did you mean 'full'"),
        (["run", "hydrone-landing", "--set", "nonsense"], "KEY=VALUE is needed"),
        (
            ["run", "hydrone-landing", "--set", "vehicle.hull.velocity=3"],
            "output and cannot be set",
        ),
        (["run", "hydrone-landing", "--engine", "warp"], "'fmu', 'direct' or 'native'"),
        pytest.param(
            ["run", "hydrone-pads", "--set", "seeds=3"],
            "unknown key 'seeds'",
            marks=needs_kits("campaigns"),
        ),
        (
            ["run", "hydrone-landing", "--real-time", "0"],
            "factor: Input should be greater than or equal to",
        ),
        (["run", "hydrone-landing", "--real-time", "nan"], "factor: Input should be"),
        (["run", "hydrone-landing", "--real-time", "1", "--overrun", "wait"], "'catch-up', 'slip'"),
        (["run", "hydrone-landing", "--overrun", "slip"], "--overrun needs --real-time"),
        (["run", "hydrone-pads", "--real-time", "2"], "work with a trial, not with a campaign"),
        (["run", "hydrone-pads", "--record", "all"], "works with a trial, not with a campaign"),
        (["run", "hydrone-landing", "--record", "some"], "unknown level 'some'"),
        (["convergence", "hydrone-pads"], "hydrone-pads is a campaign"),
        (
            ["convergence", "hydrone-landing", "--halvings", "1"],
            "at least 2 are needed to see an order",
        ),
        (["run", "otter", "--vehicle", "bluerov2"], "another one is chosen, 'bluerov2'"),
        (["report", "nowhere"], "nowhere"),
        pytest.param(["compare", "nowhere", "neither"], "nowhere", marks=needs_kits("logs")),
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


@pytest.mark.parametrize(("how", "expected"), [("raise", "flooded"), ("nan", "output y is nan")])
def test_a_component_that_fails_is_status_three(how: str, expected: str, boat: Path) -> None:
    done = seatrial("run", "trial.toml", "--set", f"boat.how={how}", "--out", "run", cwd=boat)
    assert done.returncode == 3
    assert expected in done.stderr
    assert "FAILED" in done.stdout
    rows = (boat / "run" / "signals.csv").read_text().splitlines()
    assert 21 <= len(rows) - 1 <= 22
    assert (boat / "run" / "report.html").is_file()


@pytest.mark.slow
def test_two_runs_compare_equal_and_different(tmp_path: Path) -> None:
    for out, stop in (("a", "2 s"), ("b", "2 s"), ("c", "3 s")):
        seatrial("run", "hydrone-open-landing", "--set", f"stop={stop}", "--engine", "direct",
                 "--out", out, cwd=tmp_path)  # fmt: skip
    assert seatrial("compare", "a", "b", cwd=tmp_path).returncode == 0
    assert seatrial("compare", "a", "c", cwd=tmp_path).returncode == 1


@pytest.mark.interop
@pytest.mark.parametrize(
    ("trial", "status", "expected"),
    [
        ("hydrone-open-landing", 0, "hull.position.y"),
        ("hydrone-landing", 1, "outputs do not converge"),
    ],
)
def test_convergence_of_a_trial(trial: str, status: int, expected: str, tmp_path: Path) -> None:
    short = ("--set", "stop=5 s", "--engine", "direct", "--halvings", "3")
    done = seatrial("convergence", trial, *short, "--out", "c", cwd=tmp_path)
    assert done.returncode == status
    assert "seatrial:" not in done.stderr  # nothing but progress
    assert expected in done.stdout
    assert {p.name for p in (tmp_path / "c").glob("step-*")} == {
        "step-5ms", "step-2.5ms", "step-1.25ms"
    }  # fmt: skip
    page = tmp_path / "c" / "report.html"
    page.unlink()
    assert seatrial("report", "c", cwd=tmp_path).returncode == 0
    assert "Accuracy of the coupling" in page.read_text("utf-8")


def test_the_command_line_sets_the_pace(boat: Path) -> None:
    pace = ("--real-time", "2", "--overrun", "slip", "--set", "stop=0.2 s")
    done = seatrial("run", "trial.toml", "--engine", "direct", "--out", "r", *pace, cwd=boat)
    assert done.returncode == 0, done.stderr
    assert "deadline" in done.stdout
    pacing = json.loads((boat / "r" / "timing.json").read_text("utf-8"))["pacing"]
    assert (pacing["factor"], pacing["overrun"]) == (2.0, "slip")


@needs_kits("campaigns")
def test_a_campaign_runs_and_reports(boat: Path, write) -> None:
    criteria = '[[criteria]]\nname = "dry"\ncheck = "boat.y > 1 m"\n'
    write("short.toml", f'rig = "rig.toml"\nstop = "50 ms"\n{criteria}')
    write("campaign.toml", 'trials = ["short.toml"]\n[grid]\nstop = ["50 ms", "90 ms"]\n')
    done = seatrial("run", "campaign.toml", "--engine", "direct", "--out", "c", cwd=boat)
    assert (done.returncode, done.stderr) == (1, "")
    assert "0 of 2 cases pass" in done.stdout
    assert (boat / "c" / "report.html").is_file()


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


@pytest.mark.slow
def test_the_installed_command(tmp_path: Path) -> None:
    done = subprocess.run([SEATRIAL, "--version"], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith("seatrial ")
    done = subprocess.run([SEATRIAL, "run", "x"], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith("seatrial: unknown trial, campaign or vehicle 'x'")


def test_near_misses() -> None:
    assert unknown("port", "atitude", ["attitude", "force"]) == (
        "unknown port 'atitude'; did you mean 'attitude'? (known: attitude, force)"
    )


def test_a_word_lists_what_begins_with_it_by_vehicle(tmp_path: Path) -> None:
    done = seatrial("list", "otter", cwd=tmp_path)
    assert done.returncode == 0
    lines = done.stdout.splitlines()
    assert lines[0] == "trials"
    assert "  otter" in lines
    assert any(line.startswith("    otter-straight ") for line in lines)
    assert "mariner-chart-plotter" not in done.stdout
    done = seatrial("list", "xyzzy", cwd=tmp_path)
    assert done.returncode == 2
    assert "no name or title matches 'xyzzy'" in done.stderr


def test_pages_of_the_documentation(tmp_path: Path) -> None:
    listing = seatrial("docs", cwd=tmp_path).stdout
    for line in ("core  ", "vehicles/otter  ", "how-to/write-a-kit  "):
        assert line in listing
    page = (Path(__file__).parents[2] / "docs/vehicles/otter.md").read_text("utf-8")
    assert seatrial("docs", "otter", cwd=tmp_path).stdout.rstrip() == page.rstrip()
    done = seatrial("docs", "xyzzy", cwd=tmp_path)
    assert done.returncode == 2
    assert done.stderr.startswith("seatrial: no page matches 'xyzzy'; (known: bibliography, core, ")


def test_it_runs_as_a_module(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "seatrial", "--version"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout.split()[0]) == (0, "seatrial")


def leaves(command: Any, path: str) -> Iterator[tuple[str, Any]]:
    """Yield every command that has none below, with its path."""
    below = getattr(command, "commands", {})
    if not below:
        yield path, command
    for name, one in below.items():
        yield from leaves(one, f"{path} {name}")


def test_every_help_ends_with_an_example_of_its_options() -> None:
    known = examples()
    seen = set()
    for name in commands():
        for path, command in leaves(loaded(name), name):
            seen |= {path, name}
            assert command.epilog == f"Example: {known[path]}"
            words = shlex.split(known[path])
            assert words[0] == "seatrial"
            assert words[1 : 1 + len(path.split())] == path.split() or "CAMPAIGN" in path
            options = {option for one in command.params for option in one.opts}
            assert {word for word in words if word.startswith("-")} <= options, path
    assert set(known) == seen
