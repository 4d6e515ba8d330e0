"""The summary of the GitHub action: a change of a gain between two commits, in a clone of ours."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.kit import needs_kits

SCRIPT = Path(__file__).parents[2] / ".github/actions/sea-trials/summary.py"
FILES = {
    "heel.py": '''import math

from seatrial.model.component import Component, Output, Parameter


class Heel(Component):
    """Heel under a load on deck: tan(phi) = m y / (M GM_T)."""

    load = Parameter(2.0, "kg", "mass on deck")
    GM_T = Parameter(0.5, "m", "transverse metacentric height")
    phi = Output("rad", "heel")

    def start(self, t):
        self.phi = math.atan(self.load * 0.3 / (22.0 * self.GM_T))
''',
    "rig.toml": 'step = "100 ms"\n[components]\ndeck = { fmu = "heel.py:Heel", set = { GM_T = "0.5 m" } }\n',
    "level.toml": 'rig = "rig.toml"\nstop = "100 ms"\n\n[[criteria]]\nname = "level"\ncheck = "deck.phi < 5 deg"\n',
    "loads.toml": (
        'trials = ["level.toml"]\nkeep = "none"\n\n'
        '[[criteria]]\nname = "mostly level"\ncheck = "probability of failure < 50 % at 90 %"\n\n'
        '[design]\nkind = "latin-hypercube"\ncount = 8\n[design.vary]\n'
        '"deck.load" = { uniform = ["1 kg", "3 kg"] }\n'
    ),
}


@pytest.fixture
def clone(tmp_path):
    folder = tmp_path / "clone"
    folder.mkdir()
    for name, text in FILES.items():
        (folder / name).write_text(text, "utf-8")
    for words in (["init", "-q"], ["add", "."], ["commit", "-qm", "before"]):
        git(folder, *words)
    return folder


def git(folder, *words):
    who = ["-c", "user.name=a", "-c", "user.email=a@example.org", "-c", "commit.gpgsign=false"]
    subprocess.run(["git", *who, *words], cwd=folder, check=True, capture_output=True)


def summary(folder, **environment):
    target = folder.parent / "summary.md"
    target.unlink(missing_ok=True)
    done = subprocess.run(
        [sys.executable, str(SCRIPT)],
        cwd=folder,
        env={
            **os.environ, "ENGINE": "direct", "CAMPAIGNS": "", "BASE": "",
            "GITHUB_STEP_SUMMARY": str(target), **environment,
        },
        capture_output=True,
        text=True,
        check=False,
    )  # fmt: skip
    return done, target.read_text("utf-8") if target.is_file() else ""


@needs_kits("campaigns")
@pytest.mark.long
def test_a_change_that_breaks_a_campaign_is_in_the_summary_and_at_its_line(clone):
    rig = clone / "rig.toml"
    rig.write_text(rig.read_text("utf-8").replace("0.5 m", "0.1 m"), "utf-8")  # all cases fail
    done, text = summary(clone, CAMPAIGNS="loads.toml", PULL_BASE="HEAD")
    assert done.returncode == 1, done.stderr
    place = "file=loads.toml,line=5,title=mostly level"
    assert (
        f"::error {place}::probability of failure < 50 %25 at 90 %25: fail: 8 of 8" in done.stdout
    )
    assert "a verdict went from pass to fail since HEAD" in done.stdout
    assert "| mostly level | probability of failure < 50 % at 90 % | ✗ fail |" in text
    assert "- cases from pass to fail: 8; from fail to pass: 0" in text
    assert "rig.toml" in text  # the file that differs
    assert (clone / "sea-trials/loads.html").is_file()
    listed = subprocess.run(
        ["git", "worktree", "list"], cwd=clone, capture_output=True, text=True, check=True
    )
    assert len(listed.stdout.splitlines()) == 1


def test_mistakes_in_the_inputs_are_errors(clone):
    done, text = summary(clone, CAMPAIGNS="rig.toml none-*.toml", BASE="no-such-branch")
    assert done.returncode == 1
    assert "::error title=campaigns::no file is called none-*.toml" in done.stdout
    assert "::error title=base::there is no revision no-such-branch" in done.stdout
    assert "::error file=rig.toml,title=rig::" in done.stdout
    assert "## rig.toml" in text


def test_failed_tests_of_a_junit_file_are_annotated_at_their_criteria(clone):
    (clone / "sea-trials").mkdir()
    (clone / "sea-trials/junit.xml").write_text(
        '<testsuites><testsuite><testcase classname="level.toml" name="level">'
        "<failure>level: deck.phi &lt; 5 deg: does not hold\n  worst 9 deg</failure></testcase>"
        '<testcase classname="heel.Tests" name="test_x"><failure>def test_x():\n&gt;   assert 1 == 2\nE   assert 1 == 2\n</failure></testcase>'
        '<testcase classname="heel" name="test_y"/></testsuite></testsuites>',
        "utf-8",
    )
    done, text = summary(clone)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines() == [
        "::error file=level.toml,line=5,title=level::level: deck.phi < 5 deg: does not hold; worst 9 deg",
        "::error file=heel.py,title=test_x::assert 1 == 2",
    ]
    assert "1 of 3 tests pass." in text
    assert "| level | level: deck.phi < 5 deg: does not hold; worst 9 deg |" in text
