"""A campaign's table: the same from anybody, whole after a stop, and of what the cases were."""

import math
import signal
import subprocess
import time
from pathlib import Path

import pandas as pd
import pyarrow.parquet as pq
import pytest
from scipy.stats import beta, binomtest

import seatrial
from seatrial.errors import InputError
from seatrial.trial.files.trial import load_trial
from seatrial_kits.campaigns.campaign import load_campaign
from seatrial_kits.campaigns.results.page import write_table_page
from seatrial_kits.campaigns.stopping_rule import StoppingRule, failure_interval
from seatrial_kits.campaigns.sweep import How, run_sweep
from tests.cli.test_stop import SEATRIAL, wait_for
from tests.command import seatrial as command
from tests.kit import needs_kits

GRID = (
    'keep = "failed"\nfigures = ["case.y"]\n[grid]\n"case.number" = ["1 m", "2 m", "3 m", "4 m"]\n'
)


def direct(jobs: int = 2, **more) -> How:
    return How("direct", jobs=jobs, **more)


def test_a_row_has_what_was_set_and_what_came_of_it(written, tmp_path):
    campaign, rows = written(GRID), []
    summary = run_sweep(
        campaign, tmp_path / "out", direct(), done=lambda case, ended: rows.append(ended.number)
    )
    assert (summary.ended, summary.failed, summary.broken, rows) == (4, 1, 0, [0, 1, 2, 3])
    table = pd.read_parquet(tmp_path / "out/results.parquet")
    assert list(table["case"]) == [1, 2, 3, 4]
    assert list(table["case.number"]) == [1.0, 2.0, 3.0, 4.0]
    assert list(table["few"]) == list(table["passed"]) == [True, True, True, False]
    assert list(table["worst of few"]) == [1.0, 4.0, 9.0, 16.0]  # squares
    expected = [1.0 - 1 / 12, 1.0 - 4 / 12, 1.0 - 9 / 12, 1.0 - 16 / 12]  # shares of the limit
    assert list(table["robustness of few"]) == pytest.approx(expected, rel=1e-12)
    assert list(table["greatest case.y"]) == list(table["last case.y"]) == [1.0, 4.0, 9.0, 16.0]
    assert list(table["least case.y"]) == [1.0, 2.0, 3.0, 4.0]
    schema = pq.read_schema(tmp_path / "out/results.parquet")
    assert schema.field("case.number").metadata == {b"unit": b"m"}
    folders = sorted(p.name for p in (tmp_path / "out").iterdir() if p.is_dir())
    assert folders == ["04-t-number-4-m"]
    assert len(pd.read_parquet(tmp_path / "out/timing.parquet")) == 4


@pytest.mark.slow
def test_the_table_does_not_depend_on_how_many_run_side_by_side(written, tmp_path):
    design = '[design]\nkind = "monte-carlo"\ncount = 30\n[design.vary]\nseed = { integers = [1, 99] }\n"case.number" = { uniform = ["0 m", "5 m"] }\n'
    campaign = written(f'keep = "none"\nsamples = 10\n{design}')
    for jobs in (1, 3):
        run_sweep(campaign, tmp_path / f"j{jobs}", direct(jobs))
    one, three = ((tmp_path / f"j{jobs}/results.parquet").read_bytes() for jobs in (1, 3))
    assert one == three
    assert len([p for p in (tmp_path / "j1").iterdir() if p.is_dir()]) == 3


@pytest.mark.slow
def test_what_dies_once_runs_again_and_what_dies_twice_has_failed(written, tmp_path):
    campaign = written(
        'keep = "failed"\n[grid]\n"case.way" = ["run", "die", "die once"]\n"case.number" = ["1 m", "2 m"]\n'
    )
    summary = run_sweep(campaign, tmp_path / "out", direct(1))
    table = pd.read_parquet(tmp_path / "out/results.parquet")
    assert list(table["status"]) == ["complete"] * 2 + ["failed"] * 2 + ["complete"] * 2
    assert summary.broken == 2
    assert all("7" in error and "case" in error for error in table["error"][2:4])


def test_a_death_is_survived_by_running_again(written, tmp_path):
    campaign = written('keep = "none"\n[set]\n"case.way" = "die once"\n"case.number" = "2 m"\n')
    assert run_sweep(campaign, tmp_path / "out", direct(1)).failed == 0
    assert len(list((tmp_path / "seen").glob("2-die-once-*"))) == 2


@pytest.mark.slow
@needs_kits("search")
def test_a_kept_case_and_a_rerun_have_the_same_bytes(written, tmp_path):
    written(GRID)
    command = [
        SEATRIAL,
        "run",
        "campaign.toml",
        "--engine",
        "direct",
        "--out",
        "out",
        "--no-report",
    ]
    assert subprocess.run(command, cwd=tmp_path, capture_output=True).returncode == 1
    command = [SEATRIAL, "campaign", "rerun", "campaign.toml", "--case", "4", "--engine", "direct"]
    assert subprocess.run([*command, "--out", "again"], cwd=tmp_path).returncode == 1
    for name in ("signals.csv", "manifest.json", "verdicts.json"):
        kept = (tmp_path / "out/04-t-number-4-m" / name).read_bytes()
        assert kept == (tmp_path / "again" / name).read_bytes()


@pytest.mark.slow
def test_a_stopped_campaign_goes_on_to_the_same_table(written, tmp_path):
    campaign = written(
        'keep = "failed"\n[grid]\n"case.way" = ["run", "wait"]\n"case.number" = ["1 m", "2 m", "3 m", "4 m"]\n'
    )
    command = [SEATRIAL, "run", "campaign.toml", "--engine", "direct", "--jobs", "2", "--no-report"]
    command += ["--out", "out"]
    process = subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE, text=True)
    log, seen = tmp_path / "out/ended.jsonl", tmp_path / "seen"
    wait_for(lambda: log.is_file() and len(log.read_text().splitlines()) == 4)
    wait_for(lambda: len(list(seen.glob("*-wait-*"))) == 2)
    process.send_signal(signal.SIGINT)
    time.sleep(0.3)
    (seen / "go").touch()
    _, err = process.communicate(timeout=60)
    assert process.returncode == 3
    assert "4 of 8 cases came to an end: --out out --resume goes on" in err
    assert len(pd.read_parquet(tmp_path / "out/results.parquet")) == 4
    with log.open("a") as file:
        file.write('{"number": 5, "meas')  # as a kill leaves it
    before = len(list(seen.glob("*-run-*")))
    summary = run_sweep(campaign, tmp_path / "out", direct(resume=True))
    assert summary.whole
    assert len(list(seen.glob("*-run-*"))) == before == 4
    run_sweep(campaign, tmp_path / "once", direct(1))
    for name in ("results.parquet", "campaign.json"):
        assert (tmp_path / "out" / name).read_bytes() == (tmp_path / "once" / name).read_bytes()
    assert not log.exists()
    again = run_sweep(campaign, tmp_path / "out", direct(resume=True))
    assert (again.ended, again.failed) == (8, 2)


@pytest.mark.slow
def test_a_case_that_hangs_is_a_failed_row_and_the_rest_goes_on(written, tmp_path):
    written('keep = "none"\n[grid]\n"case.way" = ["run", "wait", "run"]\n"case.number" = ["1 m"]\n')
    options = ("--engine", "direct", "--limit", "call=0.5 s", "--no-report", "--out", "out")
    done = command("run", "campaign.toml", *options, cwd=tmp_path)
    assert done.returncode == 3
    assert "1 cases could not go on" in done.stderr
    table = pd.read_parquet(tmp_path / "out/results.parquet")
    assert list(table["status"]) == ["complete", "failed", "complete"]
    assert "case: its step at t = 0.0 s hung: no progress for 0.5 s" in table["error"][1]


def test_the_folder_of_another_campaign_is_refused(written, tmp_path):
    run_sweep(written(GRID), tmp_path / "out", direct())
    other = written(GRID.replace("4 m", "5 m"))
    with pytest.raises(InputError, match="it is of another campaign"):
        run_sweep(other, tmp_path / "out", direct(resume=True))


def test_of_many_cases_those_at_the_edges_are_checked(written, tmp_path):
    numbers = ", ".join(f'"{n} m"' for n in range(300))
    campaign = written(f'keep = "none"\n[grid]\n"case.number" = [{numbers}, "1 kg"]\n')
    with pytest.raises(InputError, match="kg"):
        run_sweep(campaign, tmp_path / "out", direct())
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(("failed", "count"), [(0, 50), (3, 100), (50, 100)])
def test_intervals_are_those_of_the_books(failed, count):
    z, share = 1.959963984540054, failed / count
    centre = (share + z * z / (2 * count)) / (1 + z * z / count)
    half = z * math.sqrt(share * (1 - share) / count + z * z / (4 * count**2)) / (1 + z * z / count)
    assert failure_interval(failed, count) == pytest.approx(
        (centre - half, centre + half), abs=1e-9
    )
    scipys = binomtest(failed, count).proportion_ci(0.95, method="wilson")
    assert failure_interval(failed, count) == pytest.approx(tuple(scipys), rel=1e-13)
    low = beta.ppf(0.025, failed, count - failed + 1) if failed else 0.0
    exact = (low, beta.ppf(0.975, failed + 1, count - failed))
    assert failure_interval(failed, count, interval="clopper-pearson") == pytest.approx(
        exact, abs=1e-9
    )


@pytest.mark.slow
def test_a_campaign_ends_where_its_interval_is_narrow(written, tmp_path):
    design = '[design]\nkind = "monte-carlo"\ncount = 1000\n[design.vary]\n"case.number" = { uniform = ["0 m", "3.7 m"] }\n'
    campaign = written(f'keep = "none"\nuntil = {{ half_width = 0.06, least = 50 }}\n{design}')
    tables = []
    for jobs in (1, 2):
        summary = run_sweep(campaign, tmp_path / f"j{jobs}", direct(jobs))
        assert summary.enough
        tables.append((tmp_path / f"j{jobs}/results.parquet").read_bytes())
    assert tables[0] == tables[1]
    rule = StoppingRule(half_width=0.06, least=50)
    failed = list(~pd.read_parquet(tmp_path / "j1/results.parquet")["passed"])
    met = [n for n in range(50, len(failed) + 1, 50) if rule.met(sum(failed[:n]), n)]
    assert met == [len(failed)]


@pytest.mark.slow
def test_the_page_of_a_hundred_thousand_cases_is_small(written, tmp_path):
    run_sweep(written(GRID), tmp_path / "out", direct())
    path = tmp_path / "out/results.parquet"
    table = pq.read_table(path)
    many = pd.concat([table.to_pandas()] * 25_000, ignore_index=True)
    many["case"] = range(1, len(many) + 1)
    pq.write_table(type(table).from_pandas(many, schema=table.schema), path)
    page = write_table_page(tmp_path / "out")
    assert page.stat().st_size < 4e6
    text = page.read_text("utf-8")
    assert "100000 cases" in text
    assert "25000 failed" in text
    assert "The first 500 of 25000" in text


def test_shipped_campaigns_have_as_many_cases_as_their_lists_say():
    assert len(load_campaign("hydrone-pads").cases()) == 10
    assert len(load_campaign("hydrone-sensitivity").cases()) == 14
    assert Path(load_campaign("hydrone-pads").read_from.path).is_file()


@pytest.mark.slow
def test_python_has_the_same_table(written, tmp_path):
    campaign, seen = written(GRID), []
    run_sweep(campaign, tmp_path / "once", direct())
    path = tmp_path / "campaign.toml"
    out = tmp_path / "out"
    result = seatrial.run_campaign(
        path, out=out, jobs=2, progress=lambda n, of: seen.append((n, of))
    )
    assert seen == [(1, 4), (2, 4), (3, 4), (4, 4)]
    assert result.table.read_bytes() == (tmp_path / "once/results.parquet").read_bytes()
    assert not result.passed
    assert "3 of 4 cases pass" in repr(result)
    assert [(case.name, case.result.passed) for case in result.cases] == [("t, number 4 m", False)]
    assert list(result.to_pandas().loc[3:, "few"]) == [True, False]
    assert result.report() == out / "report.html"
    assert seatrial.run_campaign(path, out=out, resume=True).table == result.table
    kept = seatrial.run_campaign(path, out=tmp_path / "all", keep="all")
    assert len(kept.cases) == 4
    with pytest.raises(InputError, match="keep: unknown choice 'some'"):
        seatrial.run_campaign(path, keep="some")


FAULTS = """
keep = "none"
figures = ["case.y"]
[set]
"case.number" = "2 m"
[faults]
nothing = []
high = [{ what = "bias", where = "case.y", value = "1 m", at = "100 ms" }]
[design]
kind = "full-factorial"
[design.vary]
"faults.high.value" = { levels = ["10 m", "20 m"] }
"faults.high.at" = { levels = ["100 ms", "9 s"] }
"""


@pytest.mark.slow
def test_keys_of_a_fault_are_drawn_for_the_cases_that_have_it(written, tmp_path):
    campaign = written(FAULTS.replace('"9 s"', '"200 ms"'))
    run_sweep(campaign, tmp_path / "out", direct())
    table = pd.read_parquet(tmp_path / "out/results.parquet")
    assert list(table["faults"]) == ["nothing", "high"] * 4
    assert [v if v == v else None for v in table["faults.high.value"]] == [None, 10, None, 10, None, 20, None, 20]  # fmt: skip
    assert list(table["greatest case.y"]) == [4, 14, 4, 14, 4, 24, 4, 24]
    late = written(FAULTS)
    with pytest.raises(InputError, match="'9 s' is outside the trial's time"):
        run_sweep(late, tmp_path / "late", direct())


def test_keys_of_a_trials_own_faults_are_settings(written, tmp_path):
    written("")
    trial = tmp_path / "t.toml"
    with trial.open("a") as file:
        file.write('[[faults]]\nwhat = "bias"\nwhere = "case.y"\nvalue = "1 m"\nat = "0 s"\n')
    campaign = written(
        'keep = "none"\nfigures = ["case.y"]\n[grid]\n"faults.0.value" = ["3 m", "5 m"]\n'
    )
    run_sweep(campaign, tmp_path / "out", direct())
    assert list(pd.read_parquet(tmp_path / "out/results.parquet")["last case.y"]) == [3, 5]
    for key, said in (
        ("faults.1.at", "there is no fault 1: the trial has 1, from 0"),
        ("faults.0.a", "unknown key of a fault 'a'"),
    ):
        with pytest.raises(InputError, match=said):
            load_trial(str(trial), changes={key: "1 s"}, origin="--set")


@pytest.mark.interop
def test_components_in_c_leave_the_same_table(write, tmp_path):
    path = write(
        "landings.toml",
        'trials = ["hydrone-open-landing"]\nkeep = "none"\nfigures = ["hull.attitude.phi"]\n'
        '[design]\nkind = "latin-hypercube"\ncount = 6\n[design.vary]\n'
        '"downwash.mass" = { uniform = ["1 kg", "9 kg"] }\n'
        '"hull.GM_T" = { uniform = ["0.3 m", "0.6 m"] }\n',
    )
    for engine in ("direct", "native"):
        run_sweep(load_campaign(str(path)), tmp_path / engine, How(engine, jobs=1))
    direct, native = (
        (tmp_path / engine / "results.parquet").read_bytes() for engine in ("direct", "native")
    )
    assert direct == native
    assert set(pd.read_parquet(tmp_path / "native/results.parquet")["passed"]) == {True, False}
