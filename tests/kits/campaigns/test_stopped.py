"""A campaign with one case that hangs: one signal ends it, and what has ended stays."""

import json
import signal
import subprocess
import sys

import pandas as pd
import pytest

from seatrial_kits.campaigns.campaign import load_campaign
from seatrial_kits.campaigns.sweep import How, run_sweep
from tests.cli.test_stop import wait_for
from tests.command import SEATRIAL
from tests.command import seatrial as command

pytestmark = [
    pytest.mark.skipif(sys.platform == "win32", reason="POSIX signals"),
    pytest.mark.slow,
]
HANGER = """
import time
from pathlib import Path
from seatrial.model.component import Component, Output, Parameter


class Case(Component):
    \"\"\"Hangs in its start or a step if it is number 2 and there is no file that ends in "go".\"\"\"

    where = Parameter("step", "1", "where it hangs")
    number = Parameter(0.0, "m", "of the case")
    y = Output("m", "number of the case")

    def start(self, t):
        self.y = self.number
        self.hang("start")

    def step(self, t, h):
        self.hang("step")

    def hang(self, where):
        if where == self.where and self.number == 2 and not Path(f"{where}-go").exists():
            Path(f"{where}-hangs").touch()
            time.sleep(600)
"""


def write(folder, where, keep=""):
    (folder / "case.py").write_text(HANGER, "utf-8")
    (folder / "rig.toml").write_text(
        'step = "100 ms"\n[components]\ncase = { fmu = "case.py:Case" }\n', "utf-8"
    )
    (folder / "t.toml").write_text(
        'rig = "rig.toml"\nstop = "300 ms"\n'
        '[[criteria]]\nname = "few"\ncheck = "case.y < 12 m"\n', "utf-8"
    )  # fmt: skip
    numbers = ", ".join(f'"{n} m"' for n in range(1, 5))
    (folder / "campaign.toml").write_text(
        f'trials = ["t.toml"]\n{keep}\n[set]\n"case.where" = "{where}"\n'
        f'[grid]\n"case.number" = [{numbers}]\n', "utf-8"
    )  # fmt: skip


def stopped(folder, number, are_others_done):
    """Run the campaign, send one signal when one case hangs, and return what it has printed."""
    arguments = ("run", "campaign.toml", "--engine", "direct", "--no-report", "--out", "out")
    process = subprocess.Popen(
        [SEATRIAL, *arguments, "--jobs", "2"], cwd=folder, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE,
    )  # fmt: skip
    wait_for(lambda: list(folder.glob("*-hangs")) and are_others_done(folder / "out"))
    process.send_signal(number)
    out, err = process.communicate(timeout=30)
    assert process.returncode == 3, err
    assert "3 of 4 cases came to an end: --out out --resume goes on" in err
    return out


def resumed(folder, where):
    (folder / f"{where}-go").touch()
    done = command("run", "campaign.toml", "--engine", "direct", "--no-report", "--out", "out",
                   "--resume", cwd=folder)  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert "4 of 4 cases pass" in done.stdout


@pytest.mark.parametrize(
    ("where", "number"), [("step", signal.SIGINT), ("start", signal.SIGTERM)]
)  # fmt: skip
def test_one_signal_ends_cases_in_folders(tmp_path, where, number):
    write(tmp_path, where)

    def others(out):
        manifests = [path.read_text() for path in out.glob("*/manifest.json")]
        return sum('"status": "complete"' in text for text in manifests) == 3

    stopped(tmp_path, number, others)
    cases = json.loads((tmp_path / "out/campaign.json").read_text("utf-8"))["cases"]
    assert sum(case["status"] == "complete" for case in cases) == 3
    resumed(tmp_path, where)


@pytest.mark.parametrize(
    ("where", "number"), [("step", signal.SIGTERM), ("start", signal.SIGINT)]
)  # fmt: skip
def test_one_signal_ends_cases_of_a_table(tmp_path, where, number):
    write(tmp_path, where, 'keep = "none"')
    log = "ended.jsonl"
    stopped(
        tmp_path,
        number,
        lambda out: (out / log).is_file() and len((out / log).read_text().splitlines()) == 3,
    )
    assert len(pd.read_parquet(tmp_path / "out/results.parquet")) == 3
    resumed(tmp_path, where)


def test_a_case_that_hangs_as_it_starts_is_a_failed_row(tmp_path, monkeypatch):
    write(tmp_path, "start", 'keep = "none"')
    monkeypatch.chdir(tmp_path)
    campaign = load_campaign("campaign.toml", limit={"call": "400 ms"})
    summary = run_sweep(campaign, tmp_path / "out", How("direct", jobs=1))
    assert (summary.ended, summary.broken) == (4, 1)
    errors = pd.read_parquet(tmp_path / "out/results.parquet")["error"]
    assert errors[1].startswith("case: its initialisation at t = 0.0 s hung: no progress for 0.4 s")
