"""The plugin as another project's tests use it."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.kit import needs_kits

from .running import cases, pytest_in

RIG = """
step = "10 ms"

[components]
servo = { fmu = "angle-servo", set = { period = "10 ms", rate = "1 rad/s" } }
"""
TRIAL = """
rig  = "rig.toml"
stop = "1 s"

[set]
"servo.command" = 1.0

[[criteria]]
name  = "it turns"
check = "finally servo.angle > {least} rad"
"""
TESTS = """
import pytest


@pytest.mark.trial("turns.toml", seeds=[1, 2])
def test_seeds(trial):
    trial.assert_passed()
    trial.assert_holds("servo.angle < 0.6 rad", during=("0 s", "0.5 s"))


@pytest.mark.trial("fails.toml")
def test_criteria(trial):
    trial.assert_passed()


@pytest.mark.trial("turns.toml", set={"servo.command": 0.8})
def test_condition(trial, assert_holds):
    assert_holds("servo.angle < 0.25 rad", during="0.1 s")


@pytest.mark.trial("turns.toml", set={"servo.comand": 0.8})
def test_mistake(trial):
    pass


def test_steps(simulation, assert_holds):
    sim = simulation("rig.toml", set={"servo.command": 0.3})
    sim.run("1 s")
    assert_holds("servo.angle <= 0.3 rad")
    assert_holds("eventually[0 s, 0.4 s] servo.angle > 0.29 rad")
"""


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A project whose tests have run, with two workers."""
    folder = tmp_path_factory.mktemp("project")
    (folder / "rig.toml").write_text(RIG)
    (folder / "turns.toml").write_text(TRIAL.format(least=0.5))
    (folder / "fails.toml").write_text(TRIAL.format(least=2))
    (folder / "test_servo.py").write_text(TESTS)
    done = pytest_in(folder, "-n", "2", "--junitxml", "junit.xml")
    (folder / "output.txt").write_text(done.stdout + done.stderr)
    return folder


def failure(project: Path, name: str) -> str:
    found = cases(project / "junit.xml")[name].find("failure")
    return "" if found is None else found.text or ""


@pytest.mark.slow
def test_what_holds_passes_and_what_does_not_fails(project: Path) -> None:
    found = cases(project / "junit.xml")
    passed = {name for name, case in found.items() if len(list(case.iter("failure"))) == 0}
    errors = {name for name, case in found.items() if len(list(case.iter("error"))) == 1}
    assert set(found) - passed == {"test_criteria", "test_condition"}
    assert errors == {"test_mistake"}
    assert {"test_seeds[turns-seed1]", "test_seeds[turns-seed2]", "test_steps"} <= passed


def test_a_message_shows_the_worst_moment_and_a_plot(project: Path) -> None:
    text = failure(project, "test_condition")
    # At 1 rad/s from 0.1 s on it passes 0.25 rad; it rests at the command.
    assert re.search(r"worst 0\.8 rad at 0\.(79|8)", text)
    assert "servo.angle, rad (*), limit (-)" in text
    plotted = [line for line in text.splitlines() if "|" in line]
    assert len(plotted) == 9
    assert any("-" in line.split("|")[1] for line in plotted)
    assert "hold_or_fail" not in text  # no line of the plugin's own


def test_a_failing_criterion_is_named_with_its_value(project: Path) -> None:
    text = failure(project, "test_criteria")
    assert "it turns: finally servo.angle > 2 rad: does not hold in fails" in text
    assert "ends with 1 rad at 1 s, limit 2 rad" in text


def test_a_failing_trial_keeps_its_folder_and_names_it(project: Path) -> None:
    kept = sorted(folder.name for folder in (project / "runs").iterdir())
    assert [name.split("-20")[0] for name in kept] == [
        "test-servo.py-test-condition",
        "test-servo.py-test-criteria",
    ]
    output = (project / "output.txt").read_text()
    for name in kept:
        assert f"run folder: {project / 'runs' / name}" in output
        assert (project / "runs" / name / "report.html").is_file()
    properties = cases(project / "junit.xml")["test_criteria"].iter("property")
    assert {p.get("name"): p.get("value") for p in properties}["seatrial_run"].endswith(kept[1])


def test_a_mistake_in_the_mark_is_explained(project: Path) -> None:
    assert "did you mean 'command'" in (project / "output.txt").read_text()


@needs_kits("campaigns")
@pytest.mark.slow
@pytest.mark.parametrize("engine", ["direct", "fmu"])
def test_trials_in_toml_are_tests(tmp_path: Path, engine: str) -> None:
    (tmp_path / "rig.toml").write_text(RIG)
    (tmp_path / "turns.toml").write_text(TRIAL.format(least=0.5))
    (tmp_path / "fails.toml").write_text(TRIAL.format(least=2))
    (tmp_path / "campaign.toml").write_text(
        'trials = ["turns.toml"]\n[grid]\n"servo.command" = [0.4, 1.0]\n'
    )
    (tmp_path / "other.toml").write_text("[tool]\nx = 1\n")
    arguments = ("--seatrial", "--seatrial-engine", engine, "--junitxml", "junit.xml")
    done = pytest_in(tmp_path, *arguments)
    found = cases(tmp_path / "junit.xml")
    assert set(found) == {"turns", "fails", "turns, command 0.4", "turns, command 1.0"}
    failed = {name for name, case in found.items() if case.find("failure") is not None}
    assert failed == {"fails", "turns, command 0.4"}
    assert "ends with 1 rad at 1 s, limit 2 rad" in done.stdout
    assert "Traceback" not in done.stdout
    assert len(list((tmp_path / "runs").iterdir())) == 2


def test_toml_files_are_left_alone_unless_asked_for(tmp_path: Path) -> None:
    (tmp_path / "rig.toml").write_text(RIG)
    (tmp_path / "turns.toml").write_text(TRIAL.format(least=0.5))
    assert "no tests ran" in pytest_in(tmp_path).stdout


@pytest.mark.slow
def test_projects_without_trials_import_nothing(tmp_path: Path) -> None:
    (tmp_path / "test_other.py").write_text(
        "import sys\n\n\ndef test_modules():\n"
        "    ours = {n for n in sys.modules if n.startswith('seatrial')}\n"
        "    assert ours <= {'seatrial', 'seatrial.moved', 'seatrial.testing', 'seatrial.testing.plugin'}\n"
    )
    done = pytest_in(tmp_path)
    assert done.returncode == 0, done.stdout


def test_the_plugin_is_in_the_metadata() -> None:
    import tomllib

    project = tomllib.loads((Path(__file__).parents[2] / "pyproject.toml").read_text("utf-8"))
    assert project["project"]["entry-points"]["pytest11"] == {"seatrial": "seatrial.testing.plugin"}


@pytest.mark.slow
def test_a_run_beyond_a_limit_of_the_mark_or_of_the_option_fails_its_test(tmp_path: Path) -> None:
    mark = '@pytest.mark.trial("long.toml", limit={"memory": "1 kB"})'
    (tmp_path / "rig.toml").write_text(RIG)
    (tmp_path / "long.toml").write_text(TRIAL.format(least=0.5).replace('"1 s"', '"1000 s"'))
    (tmp_path / "test_long.py").write_text(f"import pytest\n{mark}\ndef test(trial): pass\n")
    for arguments in (["test_long.py"], ["--seatrial", "long.toml", "--seatrial-limit"]):
        given = ["memory=1 kB"] if len(arguments) > 1 else []
        done = pytest_in(tmp_path, *arguments, *given)
        assert done.returncode == 1
        assert "beyond its limit of 0.001 MB of memory (limit.memory)" in done.stdout
    wrong = pytest_in(tmp_path, *arguments, "memory")
    assert "--seatrial-limit: KEY=VALUE is needed, found 'memory'" in wrong.stdout
