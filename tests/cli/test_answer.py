"""Answers for programs: one JSON document, JUnit files, quiet and verbose."""

from __future__ import annotations

import json
import os
import re
import subprocess
from pathlib import Path
from xml.etree import ElementTree

import pytest

from tests.kit import needs_kits

from ..command import SEATRIAL, seatrial

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
KEYS = ["format", "seatrial", "command", "status", "error", "notes", "result", "lines"]
PAGE = Path(__file__).parents[2] / "docs/reference/json.md"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "rig.toml").write_text(RIG)
    (tmp_path / "turns.toml").write_text(TRIAL.format(least=0.5))
    (tmp_path / "fails.toml").write_text(TRIAL.format(least=2))
    (tmp_path / "broken.toml").write_text(TRIAL.format(least="x"))
    (tmp_path / "campaign.toml").write_text('trials = ["turns.toml", "fails.toml"]\n')
    return tmp_path


def answer(*arguments: str, cwd: Path) -> dict:
    done = seatrial(*arguments, "--json", cwd=cwd)
    document = json.loads(done.stdout)
    assert list(document) == KEYS
    assert document["status"] == done.returncode
    return document


def test_a_run_answers_with_its_verdicts(folder: Path) -> None:
    found = answer("run", "turns.toml", "--engine", "direct", "--out", "a", cwd=folder)
    (run,) = found["result"]["runs"]
    assert (found["command"], found["status"], found["error"]) == ("run", 0, None)
    assert (run["folder"], run["status"], run["passed"]) == ("a", "complete", True)
    written = json.loads((folder / "a/verdicts.json").read_text())
    assert run["verdicts"] == written
    assert written[0]["robustness"] == pytest.approx(1.0)
    assert any(line.startswith("PASS  it turns") for line in found["lines"])


@needs_kits("campaigns")
def test_a_campaign_answers_with_its_cases(folder: Path) -> None:
    found = answer("run", "campaign.toml", "--engine", "direct", "--out", "c", cwd=folder)
    runs = found["result"]["runs"]
    assert [(run["case"], run["passed"]) for run in runs] == [("turns", True), ("fails", False)]
    assert found["status"] == 1


@pytest.mark.parametrize(
    ("arguments", "status", "said"),
    [
        (("run", "broken.toml"), 2, "broken.toml: criteria.0"),
        (("run", "landing"), 2, "'landing' is a rig, not a trial; its trials: hydrone-landing"),
        (("run", "oter"), 2, "unknown trial, campaign or vehicle 'oter'; did you mean 'otter'?"),
        (("run", "turns.toml", "--bogus"), 2, "not used as it is meant"),
    ],
)
def test_a_mistake_is_an_answer_too(folder: Path, arguments, status: int, said: str) -> None:
    found = answer(*arguments, cwd=folder)
    assert found["status"] == status
    assert said in found["error"]
    assert found["result"] == {}


@pytest.mark.slow
def test_every_command_of_the_page_answers(folder: Path) -> None:
    for name in ("a", "b"):
        seatrial("run", "turns.toml", "--engine", "direct", "--out", name, cwd=folder)
    rows = re.findall(r"^\| (`[^|]*) \| ([^|]*) \|$", PAGE.read_text("utf-8"), re.M)
    keys = {name: re.findall(r"`(\w+)`", said) for name, said in rows}
    calls = {
        "`list`": ("list",),
        "`describe`": ("describe", "rig.toml"),
        "`compare` of runs": ("compare", "a", "b"),
        "`doctor`": ("doctor",),
    }
    for name, arguments in calls.items():
        found = answer(*arguments, cwd=folder)
        within = {"from", "to", "factor", "offset", "name", "ok", "text"}
        wanted = set(keys[name]) - within - {"diagram"}  # the last with an option only
        assert wanted == set(found["result"]), name
        assert found["command"] == arguments[0]
    assert answer("compare", "a", "b", cwd=folder)["result"]["identical"] is True
    assert answer("report", "a", cwd=folder)["result"] == {"report": "a/report.html"}
    problems = answer("fmu", "check", "thruster", cwd=folder)
    assert (problems["command"], problems["result"]) == (
        "fmu check",
        {"problems": {"thruster": []}},
    )


@needs_kits("campaigns")
def test_a_junit_file_has_a_case_for_each_criterion(folder: Path) -> None:
    arguments = ("run", "campaign.toml", "--engine", "direct", "--out", "c", "--junit", "j.xml")
    assert seatrial(*arguments, "--no-report", cwd=folder).returncode == 1
    root = ElementTree.parse(folder / "j.xml").getroot()
    assert {key: root.get(key) for key in ("tests", "failures", "errors", "skipped")} == {
        "tests": "2", "failures": "1", "errors": "0", "skipped": "0"
    }  # fmt: skip
    turns, fails = root.iter("testcase")
    assert (turns.get("name"), list(turns)) == ("it turns", [])
    assert "ends with 1 rad at 1 s, limit 2 rad" in fails.find("failure").get("message", "")
    assert not list((folder / "c").rglob("report.html"))


def test_a_run_that_fails_is_an_error_of_the_junit_file(folder: Path) -> None:
    (folder / "dies.py").write_text(
        "from seatrial.model.component import Component, Output\n\n\nclass Dies(Component):\n"
        '    """Dies."""\n\n    x = Output("1", "x")\n\n'
        "    def step(self, t, h):\n        raise RuntimeError('it is dead')\n\n"
        "    def outputs(self, t):\n        self.x = 0.0\n"
    )
    (folder / "dead.toml").write_text(
        'step = "10 ms"\n[components]\nd = { fmu = "dies.py:Dies" }\n'
    )
    (folder / "t.toml").write_text('rig = "dead.toml"\nstop = "1 s"\n')
    done = seatrial("run", "t.toml", "--engine", "direct", "--junit", "j.xml", cwd=folder)
    assert done.returncode == 3
    (case,) = ElementTree.parse(folder / "j.xml").getroot().iter("testcase")
    assert "it is dead" in case.find("error").get("message", "")


def test_quiet_says_nothing_and_verbose_more(folder: Path) -> None:
    run = ("run", "turns.toml", "--engine", "direct", "--no-report")
    assert seatrial(*run, "-q", "--out", "q", cwd=folder)[:] == (0, "", "")
    assert "margin" not in seatrial(*run, "--out", "n", cwd=folder).stdout
    said = seatrial(*run, "-v", "--out", "v", cwd=folder).stdout
    assert "margin 100 %" in said
    assert "s of wall time" in said


@pytest.mark.parametrize("flag", ["-h", "--help"])
def test_help_has_a_short_name(folder: Path, flag: str) -> None:
    for command in ((), ("run",), ("fmu", "build")):
        done = seatrial(*command, flag, cwd=folder)
        assert (done.returncode, "-h, --help" in done.stdout) == (0, True)
    assert seatrial("-V", cwd=folder).stdout == seatrial("--version", cwd=folder).stdout


@pytest.mark.slow
def test_a_shell_completes_commands_options_and_trials(folder: Path) -> None:
    def completed(words: str) -> list[str]:
        environment = {
            **os.environ,
            "_SEATRIAL_COMPLETE": "complete_bash",
            "COMP_WORDS": f"seatrial {words}",
            "COMP_CWORD": str(words.count(" ") + 1),
        }
        done = subprocess.run(
            [SEATRIAL], env=environment, cwd=folder, capture_output=True, text=True, check=False
        )
        return done.stdout.split()

    assert completed("conv") == ["convergence"]
    assert completed("run --jun") == ["--junit"]
    assert "hydrone-landing" in completed("run hydrone-l")


@pytest.mark.slow
def test_what_an_fmu_prints_is_not_in_the_document(folder: Path) -> None:
    (folder / "talks.py").write_text(
        "import os\n\nfrom seatrial.model.component import Component, Output\n\n\n"
        'class Talks(Component):\n    """Talks."""\n\n    x = Output("1", "x")\n\n'
        "    def step(self, t, h):\n        os.write(1, b'chatter\\n')\n\n"
        "    def outputs(self, t):\n        self.x = 0.0\n"
    )
    (folder / "rig.toml").write_text(
        'step = "10 ms"\n[components]\nt = { fmu = "talks.py:Talks" }\n'
    )
    (folder / "t.toml").write_text('rig = "rig.toml"\nstop = "20 ms"\n')
    command = [SEATRIAL, "run", "t.toml", "--engine", "direct", "--json", "--no-report"]
    done = subprocess.run(command, capture_output=True, text=True, cwd=folder, check=False)
    assert json.loads(done.stdout)["status"] == 0
    assert "chatter" in done.stderr


@pytest.mark.slow
@pytest.mark.parametrize("json_too", [(), ("--json",)])
@pytest.mark.parametrize(("arguments", "status"), [(("list",), 3), (("describe", "nosuch"), 2)])
def test_a_full_disk_behind_stdout_is_an_error(
    arguments: tuple[str, ...], status: int, json_too: tuple[str, ...], tmp_path: Path
) -> None:
    with open("/dev/full", "wb") as full:
        done = subprocess.run(
            [SEATRIAL, *arguments, *json_too],
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            cwd=tmp_path,
            check=False,
        )
    assert done.returncode == status
    assert ("No space left" in done.stderr) == (status == 3 or bool(json_too))
    assert "Traceback" not in done.stderr
