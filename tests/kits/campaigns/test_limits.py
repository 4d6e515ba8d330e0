"""Limits of wall time and memory: a case beyond one is a failed row, and the rest goes on."""

import re
import subprocess
import sys

import pandas as pd
import pytest

from seatrial.errors import InputError
from seatrial.trial.files.limit_entry import LimitEntry
from seatrial.trial.running.memory import resident_bytes
from seatrial_kits.campaigns.asked import asked_of
from seatrial_kits.campaigns.campaign import load_campaign
from seatrial_kits.campaigns.shipment import packed, unpacked
from seatrial_kits.campaigns.sweep import How, run_sweep
from tests.command import seatrial as command

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="memory of processes")
GREEDY = """
import time
from seatrial.model.component import Component, Output, Parameter


class Case(Component):
    \"\"\"Takes memory, or time in many short steps, from its third step on.\"\"\"

    way = Parameter("", "1", "run, grow or dawdle")
    steps = Output("1", "steps", type=int)

    def start(self, t):
        self.steps, self.held = 0, []

    def step(self, t, h):
        self.steps += 1
        if self.way == "grow" and self.steps > 2:
            self.held.append(bytearray(b"x" * 20_000_000))
        if self.way != "run":
            time.sleep(0.05)
"""
WAYS = '[grid]\n"case.way" = ["run", "{}", "run"]\n'
ASK = '[ask.set]\n"case.way" = "run"\n'
MESSAGE = r"^case: its step at t = [\d.]+ s: beyond its limit of "


def write(folder, way, limit, trial_limit=""):
    (folder / "case.py").write_text(GREEDY, "utf-8")
    (folder / "rig.toml").write_text(
        'step = "100 ms"\n[components]\ncase = { fmu = "case.py:Case" }\n', "utf-8"
    )
    (folder / "t.toml").write_text(
        f'rig = "rig.toml"\nstop = "30 s"\n{trial_limit}\n'
        '[[criteria]]\nname = "few"\ncheck = "case.steps < 1000"\n', "utf-8"
    )  # fmt: skip
    path = folder / "campaign.toml"
    path.write_text(
        f'trials = ["t.toml"]\nkeep = "none"\n{limit}\n{WAYS.format(way)}{ASK}', "utf-8"
    )
    return path


def test_memory_is_that_of_a_process_and_of_those_that_it_starts():
    psutil = pytest.importorskip("psutil", reason="it comes with Dask")
    hold = "import sys, time; held = bytearray(b'x' * 50_000_000); print(1, flush=True); time.sleep(60)"
    inner = f"import subprocess, sys; subprocess.run([sys.executable, '-c', {hold!r}])"
    with subprocess.Popen([sys.executable, "-c", inner], stdout=subprocess.PIPE) as process:
        assert process.stdout.read(1) == b"1"
        tree = psutil.Process(process.pid)
        own = [each.memory_info() for each in (tree, *tree.children(recursive=True))]
        found = resident_bytes(process.pid)
        tree.children()[0].kill()
    assert found == pytest.approx(sum(each.rss - each.shared for each in own), rel=0.05)
    assert found > 50_000_000


@pytest.mark.parametrize(
    ("way", "limit", "said"),
    [
        ("dawdle", 'limit = { wall = "500 ms" }', "0.5 s of wall time .limit.wall.$"),
        ("grow", 'limit = { memory = "100 MB" }', "100 MB of memory .limit.memory.$"),
    ],
)
def test_a_case_beyond_a_limit_is_a_failed_row_and_the_rest_goes_on(tmp_path, way, limit, said):
    campaign = load_campaign(str(write(tmp_path, way, limit)))
    summary = run_sweep(campaign, tmp_path / "out", How("direct", jobs=1))
    assert (summary.ended, summary.failed, summary.broken) == (3, 1, 1)
    table = pd.read_parquet(tmp_path / "out/results.parquet")
    assert list(table["status"]) == ["complete", "failed", "complete"]
    assert re.search(MESSAGE + said, table["error"][1])


def test_a_campaigns_limit_stands_in_place_of_its_trials_and_the_command_lines_of_both(tmp_path):
    path = write(
        tmp_path, "run", 'limit = { wall = "2 s" }', 'limit = { wall = "9 s", call = "3 s" }'
    )
    of_case = load_campaign(str(path)).cases()[0].trial.file.limit
    assert (of_case.wall_s, of_case.call_s, of_case.memory_bytes) == (2.0, 3.0, float("inf"))
    changed = load_campaign(str(path), limit={"wall": "none", "memory": "2 KiB"})
    for campaign in (changed, unpacked(packed(changed))[0]):  # as a worker of a cluster has it
        for trial in (campaign.cases()[0].trial, asked_of(campaign, "worst-case").base):
            limit = trial.file.limit
            assert (limit.wall_s, limit.call_s, limit.memory_bytes) == (float("inf"), 3.0, 2048)


@pytest.mark.slow
@pytest.mark.parametrize("keep", ["", 'keep = "none"'])
def test_a_case_that_is_beyond_its_limit_as_it_loads_is_a_failed_one(tmp_path, keep):
    path = write(tmp_path, "run", "")
    path.write_text(path.read_text().replace('keep = "none"', keep), "utf-8")
    slow = "def __init__(self, *own, **named):\n        super().__init__(*own, **named)\n"
    text = GREEDY.replace("def start(", f"{slow}        time.sleep(1.0)\n\n    def start(")
    (tmp_path / "case.py").write_text(text, "utf-8")
    limit = ("--limit", "wall=200 ms", "--engine", "direct", "--no-report", "--out", "out")
    done = command("run", "campaign.toml", *limit, "--jobs", "1", cwd=tmp_path)
    assert done.returncode == 3
    assert "0 of 3 cases pass" in done.stdout
    assert (
        "the loading of case (case.py:Case): beyond its limit of 0.2 s" in done.stdout + done.stderr
    )


@pytest.mark.slow
def test_cases_with_folders_have_limits_too(tmp_path):
    path = write(tmp_path, "dawdle", "")
    path.write_text(path.read_text().replace('keep = "none"', ""), "utf-8")
    limit = ("--limit", "wall=500 ms", "--engine", "direct", "--no-report", "--out", "out")
    done = command("run", "campaign.toml", *limit, cwd=tmp_path)
    assert done.returncode == 3
    assert "2 of 3 cases pass" in done.stdout
    assert "beyond its limit of 0.5 s of wall time (limit.wall)" in done.stderr


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"wall": "60 m"}, 'limit.wall: A time above 0 such as "60 s", or "none", is needed'),
        ({"wall": "0 s"}, 'limit.wall: A time above 0'),
        ({"memory": "1 TB"}, "limit.memory: A size above 0 .* found '1 TB'"),
        ({"memory": "-1 GB"}, "limit.memory: A size above 0"),
        ({"time": "1 s"}, "unknown key 'time'.*known: call, memory, wall"),
    ],
)  # fmt: skip
def test_a_wrong_limit_is_an_error_that_says_what_is_allowed(tmp_path, given, said):
    text = ", ".join(f'{key} = "{value}"' for key, value in given.items())
    path = write(tmp_path, "run", f"limit = {{ {text} }}")
    with pytest.raises(InputError, match=said):
        load_campaign(str(path))


@pytest.mark.parametrize(
    ("size", "expected"), [("1 kB", 1e3), ("1.5 MB", 1.5e6), ("2 GiB", 2 * 1024**3)]
)
def test_sizes_are_those_of_iec_80000(size, expected):
    assert LimitEntry(memory=size).memory_bytes == expected
