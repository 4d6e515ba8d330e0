"""Cases of a campaign side by side: the same results, the same ends, and what goes on."""

import itertools
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from seatrial.errors import InputError
from seatrial.trial.running.run import Result
from seatrial_kits.campaigns import in_folders as campaigns
from seatrial_kits.campaigns.campaign import load_campaign
from seatrial_kits.campaigns.cases import case_folders, changed_cases, run_cases
from seatrial_kits.campaigns.in_folders import run_campaign
from seatrial_kits.campaigns.pool import Pool
from tests.cli.test_stop import SEATRIAL, wait_for

COMPONENT = '''
import os, time
from pathlib import Path
from seatrial.model.component import Component, Output, Parameter


class Case(Component):
    """Leaves a file while it lives; dies, or waits, if it is to."""

    way = Parameter("", "1", "run, die or wait")
    number = Parameter(0.0, "1", "of the case")
    links = Parameter("", "1", "links")
    address = Output("1", "address", type=str, role="address")
    y = Output("1", "number of the case")

    def start(self, t):
        self.y = self.number

    def step(self, t, h):
        here = Path(os.environ["CASES"])
        if self.way == "die":
            os._exit(7)
        (here / f"{os.getpid()}-{self.way}-{self.number:g}").touch()
        while self.way == "wait" and not (here / "go").exists():
            time.sleep(0.01)
'''
RIG = 'step = "100 ms"\n[components]\ncase = { fmu = "case.py:Case" }\n'
TRIAL = 'rig = "rig.toml"\nstop = "300 ms"\n[[criteria]]\nname = "few"\ncheck = "case.y < 3.5"\n'


@pytest.fixture
def cases(tmp_path, monkeypatch):
    """Return a function that writes a campaign; a folder "seen" has a file for each step."""
    monkeypatch.setenv("CASES", str(tmp_path / "seen"))
    (tmp_path / "seen").mkdir()
    for name, text in (("case.py", COMPONENT), ("rig.toml", RIG), ("t.toml", TRIAL)):
        (tmp_path / name).write_text(text, "utf-8")

    def written(grid: str):
        path = tmp_path / "campaign.toml"
        path.write_text(f'trials = ["t.toml"]\n[grid]\n{grid}', "utf-8")
        return load_campaign(str(path))

    return written


NUMBERS = '"case.number" = [1, 2, 3, 4, 5]\n'


def content(folder: Path) -> dict[str, bytes]:
    files = [*folder.glob("*.json"), *folder.glob("*/signals.csv"), *folder.glob("*/manifest.json")]
    return {str(path.relative_to(folder)): path.read_bytes() for path in files}


@pytest.mark.slow
def test_what_they_leave_does_not_depend_on_how_many_run_side_by_side(cases, tmp_path):
    campaign, left = cases(NUMBERS), []
    for jobs in (1, 3):
        ended = []
        folder, results = run_campaign(
            campaign,
            tmp_path / f"j{jobs}",
            engine="direct",
            jobs=jobs,
            done=lambda case, result, ended=ended: ended.append((case.name, result.passed)),
        )
        assert ended == [(f"t, number {n}", n < 3.5) for n in range(1, 6)]
        assert [result.passed for _, result in results] == [passed for _, passed in ended]
        left.append({n: d for n, d in content(folder).items() if "manifest" not in n})
    assert left[0] == left[1]
    assert len(left[0]) == 6
    seen = {path.name.split("-")[0] for path in (tmp_path / "seen").iterdir()}
    assert len(seen) == 1 + 3


@pytest.mark.slow
def test_one_that_dies_takes_none_with_it(cases, tmp_path):
    campaign = cases('"case.way" = ["run", "die", "run", "run"]\n')
    _, results = run_campaign(campaign, tmp_path / "out", engine="direct", jobs=2)
    assert [result.status for _, result in results] == ["complete", "failed", *["complete"] * 2]
    assert "7" in str(results[1][1].error)


@pytest.mark.slow
def test_cases_of_a_list_of_settings_come_in_its_order(cases, tmp_path):
    (trial,) = cases(NUMBERS).trials
    settings = [{"case.number": n, "case.way": "wait" if n == 5 else "run"} for n in (5, 1, 4)]
    listed, ended = changed_cases(trial, settings, "here"), []

    def note(number, _result):
        ended.append(number)
        if len(ended) == 2:
            (tmp_path / "seen/go").touch()

    running = run_cases(listed, lambda: tmp_path, engine="direct", jobs=2, ended=note)
    results = list(running)
    assert ended == [1, 2, 0]
    assert [(number, result.passed) for number, result in results] == [
        (0, False),
        (1, True),
        (2, False),
    ]
    assert [result.folder.name for _, result in results] == [
        "01-t-number-5-way-wait",
        "02-t-number-1-way-run",
        "03-t-number-4-way-run",
    ]
    unknown = changed_cases(trial, [{"case.nothing": 1}], "here")
    with pytest.raises(InputError, match=r"here.*nothing"):
        next(run_cases(unknown, lambda: tmp_path / "never", engine="direct"))


@pytest.mark.slow
def test_whoever_has_seen_enough_cases_closes_the_iterator(cases, tmp_path):
    (trial,) = cases(NUMBERS).trials
    ways = ["run", *["wait"] * 5]
    listed = changed_cases(trial, [{"case.way": way} for way in ways], "here")
    running = run_cases(listed, lambda: tmp_path / "out", engine="direct", jobs=2)
    assert next(running)[0] == 0
    running.close()
    assert len(list((tmp_path / "out").iterdir())) <= 2


@pytest.mark.slow
def test_what_programs_outside_connect_to_runs_alone(cases, tmp_path):
    campaign = cases('"case.links" = ["tcpin:127.0.0.1:1", ""]\n"case.number" = [1, 2]\n')
    trials = [case.trial for case in campaign.cases()]
    with Pool(trials, "direct", None, 4) as pool:
        pool.check()
        assert pool._alone == {0, 1}


@pytest.mark.slow
def test_of_several_mistakes_the_first_is_raised(cases, tmp_path):
    campaign = cases('"case.number" = [1, "two", "three"]\n')
    with pytest.raises(InputError, match="two"):
        run_campaign(campaign, tmp_path / "out", engine="direct", jobs=3)
    assert not (tmp_path / "out").exists()


def started(folder: Path, *more: str) -> subprocess.Popen[str]:
    command = [SEATRIAL, "run", "campaign.toml", "--engine", "direct"]
    return subprocess.Popen(
        [*command, "--out", "out", *more],
        cwd=folder,
        text=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )


@pytest.mark.slow
def test_a_campaign_that_was_stopped_goes_on(cases, tmp_path):
    campaign = cases('"case.way" = ["run", "wait"]\n"case.number" = [1, 2, 3]\n')
    process = started(tmp_path, "--jobs", "2", "--no-report")
    index, seen = tmp_path / "out/campaign.json", tmp_path / "seen"
    wait_for(lambda: index.is_file() and index.read_text().count('"complete"') == 3)
    wait_for(lambda: len(list(seen.glob("*"))) >= 5)
    process.send_signal(signal.SIGINT)  # ends runs after the step that they are in
    time.sleep(0.5)
    (seen / "go").touch()
    out, err = process.communicate(timeout=60)
    assert process.returncode == 3, out + err
    assert "3 of 6 cases came to an end: --out out --resume goes on" in err
    kept = content(tmp_path / "out")
    before = len(list(seen.glob("*")))
    process = started(tmp_path, "--resume", "--no-report")
    out, err = process.communicate(timeout=60)
    assert out.splitlines()[-1] == "6 of 6 cases pass", out + err
    assert len(list(seen.glob("*"))) == before + 3
    left = content(tmp_path / "out")
    assert all(left[name] == data for name, data in kept.items() if name.startswith(("01", "02")))
    assert list((tmp_path / "out").glob("0*.stopped-1"))
    run_campaign(campaign, tmp_path / "once", engine="direct", jobs=1)
    assert left["campaign.json"] == content(tmp_path / "once")["campaign.json"]


@pytest.mark.slow
def test_an_index_costs_no_more_per_case_in_a_long_campaign(cases, tmp_path, monkeypatch):
    campaign = cases(f'"case.number" = {[*range(400)]}\n')
    sizes, ends = [], []

    def ended_at_once(cases, folder, *, kept, ended, **_how):
        assert not kept
        below = folder()
        for number, name in enumerate(case_folders(cases)):
            result = Result(below / name, "complete", None, [], [])
            ended(number, result)
            yield number, result
            ends.append(number)
            if number == 350:
                raise KeyboardInterrupt

    write = campaigns.write_json

    def counted(path, content, **how):
        write(path, content, **how)
        sizes.append(len(content["cases"]))

    monkeypatch.setattr(campaigns, "run_cases", ended_at_once)
    monkeypatch.setattr(campaigns, "write_json", counted)
    with pytest.raises(KeyboardInterrupt):
        run_campaign(campaign, tmp_path / "out", engine="direct")
    assert sizes[:101] == [*range(101)]
    assert all(b - a <= 1 + 0.01 * a for a, b in itertools.pairwise(sizes))
    assert len(sizes) < 250
    assert sizes[-1] == len(ends) == 351


@pytest.mark.slow
def test_another_campaign_does_not_go_on(cases, tmp_path):
    run_campaign(cases(NUMBERS), tmp_path / "out", engine="direct", jobs=2)
    before = content(tmp_path / "out")
    with pytest.raises(InputError, match="it has the case 't, number 1', which this campaign has"):
        run_campaign(
            cases('"case.number" = [7, 8]\n'), tmp_path / "out", engine="direct", resume=True
        )
    assert content(tmp_path / "out") == before
    assert len(json.loads(before["campaign.json"])["cases"]) == 5


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="/proc")
def test_when_it_is_killed_no_process_of_its_own_stays(cases, tmp_path):
    cases('"case.way" = ["wait"]\n"case.number" = [1, 2, 3]\n')
    process = started(tmp_path, "--jobs", "3")
    seen = tmp_path / "seen"
    wait_for(lambda: len(list(seen.glob("*"))) == 3)
    children = [int(path.name.split("-")[0]) for path in seen.iterdir()]
    process.kill()
    process.communicate(timeout=60)
    (seen / "go").touch()
    wait_for(lambda: not any(_lives(pid) for pid in children))


def _lives(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    time.sleep(0.01)
    return True
