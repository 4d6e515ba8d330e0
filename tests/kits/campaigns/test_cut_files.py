"""A loss of power leaves files cut or empty: --resume sets them aside and runs what they held."""

from __future__ import annotations

import subprocess

import pandas as pd
import pytest

from seatrial.errors import InputError
from seatrial.trial.running.hooks import Hooks
from seatrial.trial.running.measuring import Measured
from seatrial_kits.campaigns.ended import Ended
from seatrial_kits.campaigns.in_folders import run_campaign
from seatrial_kits.campaigns.sweep import How, run_sweep
from tests.cli.test_stop import SEATRIAL

GRID = 'keep = "failed"\n[grid]\n"case.number" = ["1 m", "2 m", "3 m", "4 m"]\n'
FILES = ("results.parquet", "campaign.json", "04-t-number-4-m/signals.csv")


def content(folder):
    return {name: (folder / name).read_bytes() for name in FILES}


def again(campaign, folder):
    """Go on, and return what was noted."""
    notes = []
    how = How("direct", jobs=2, resume=True)
    assert run_sweep(campaign, folder, how, Hooks(note=notes.append)).whole
    return notes


@pytest.mark.slow
@pytest.mark.parametrize("share", [0.0, 0.3, 0.999])
def test_a_table_that_is_cut(written, tmp_path, share):
    campaign, out = written(GRID), tmp_path / "out"
    run_sweep(campaign, out, How("direct", jobs=2))
    whole, table = content(out), out / "results.parquet"
    cut = whole["results.parquet"][: int(share * len(whole["results.parquet"]))]
    table.write_bytes(cut)
    (note,) = again(campaign, out)
    assert "results.parquet: this is no table of a campaign" in note
    assert (out / "results.parquet.cut-1").read_bytes() == cut
    assert content(out) == whole
    assert again(campaign, out) == []


@pytest.mark.slow
def test_a_table_whose_middle_is_lost(written, tmp_path):
    """Its end, where Parquet has what the file holds, is whole."""
    campaign, out = written(GRID), tmp_path / "out"
    run_sweep(campaign, out, How("direct", jobs=2))
    whole = content(out)
    data = whole["results.parquet"]
    size = int.from_bytes(data[-8:-4], "little") + 8
    (out / "results.parquet").write_bytes(b"PAR1" + bytes(len(data) - size - 4) + data[-size:])
    assert len(again(campaign, out)) == 1
    assert content(out) == whole


@pytest.mark.slow
def test_the_command_says_so(written, tmp_path):
    run_sweep(written(GRID), tmp_path / "out", How("direct", jobs=2))
    (tmp_path / "out/results.parquet").write_bytes(b"PAR1")
    command = [SEATRIAL, "run", "campaign.toml", "--engine", "direct", "--out", "out", "--resume"]
    done = subprocess.run([*command, "--no-report"], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 1, done.stderr
    assert "it is results.parquet.cut-1 now, and what it held runs again" in done.stdout
    assert len(pd.read_parquet(tmp_path / "out/results.parquet")) == 4


@pytest.mark.slow
def test_a_log_with_lines_that_are_none(written, tmp_path):
    """Blocks of zeros, as a file system leaves them, and a line that was never written."""
    campaign, out = written(GRID), tmp_path / "out"
    run_sweep(campaign, out, How("direct", jobs=2))
    whole, seen = content(out), tmp_path / "seen"
    stopped = Hooks(stop_requested=lambda: int(len(list(seen.glob("*"))) >= 2))
    for path in seen.glob("*"):
        path.unlink()
    run_sweep(campaign, other := tmp_path / "other", How("direct", jobs=1), stopped)
    log = other / "ended.jsonl"
    lines = log.read_text().splitlines(keepends=True)
    assert 1 <= len(lines) < 4
    log.write_text("\0" * 600 + "\n" + "".join(lines))
    (note,) = again(campaign, other)
    assert "ended.jsonl, line 1: this is no case that has ended" in note
    assert (other / "ended.jsonl.cut-1").read_text().startswith("\0")
    assert content(other) == whole


@pytest.mark.slow
def test_the_folder_of_a_case_without_a_manifest(written, tmp_path):
    """In a table and without: the case runs again, the others stay."""
    table = written(GRID)
    run_sweep(table, out := tmp_path / "table", How("direct", jobs=2))
    whole = content(out)
    ended = Ended(3, Measured("complete", None), "04-t-number-4-m")
    (out / "ended.jsonl").write_text(ended.line() + "\n")
    (out / "04-t-number-4-m/manifest.json").write_bytes(b"")
    (note,) = again(table, out)
    assert "manifest.json" in note
    assert content(out) == whole

    plain = written(GRID.replace('keep = "failed"\n', ""))
    run_campaign(plain, out := tmp_path / "plain", engine="direct", jobs=2)
    index = (out / "campaign.json").read_bytes()
    (out / "02-t-number-2-m/manifest.json").write_text('{"trial": ')
    before, notes = len(list((tmp_path / "seen").glob("*"))), []
    hooks = Hooks(note=notes.append)
    run_campaign(plain, out, engine="direct", resume=True, hooks=hooks)
    assert len(notes) == 1
    assert len(list((tmp_path / "seen").glob("*"))) == before + 1
    assert (out / "02-t-number-2-m.stopped-1/manifest.json").read_text() == '{"trial": '
    assert (out / "campaign.json").read_bytes() == index


@pytest.mark.parametrize("kept", ['keep = "failed"\n', ""])
def test_an_index_that_is_cut(written, tmp_path, kept):
    campaign, out, notes = written(GRID.replace('keep = "failed"\n', kept)), tmp_path / "out", []
    hooks = Hooks(note=notes.append)

    def run(resume):
        if kept:
            run_sweep(campaign, out, How("direct", jobs=2, resume=resume), hooks)
        else:
            run_campaign(campaign, out, engine="direct", jobs=2, resume=resume, hooks=hooks)

    run(resume=False)
    index = out / "campaign.json"
    whole = index.read_bytes()
    index.write_bytes(whole[:40])
    run(resume=True)
    assert len(notes) == 1
    assert f"all that was there is in {out / 'cut-1'} now" in notes[0]
    assert index.read_bytes() == whole
    assert (out / "cut-1/campaign.json").read_bytes() == whole[:40]
    assert (out / "cut-1/04-t-number-4-m/signals.csv").is_file()


def test_another_file_s_content_is_no_cut(written, tmp_path):
    campaign, out = written(GRID), tmp_path / "out"
    run_sweep(campaign, out, How("direct", jobs=2))
    (out / "campaign.json").write_text("{}")
    with pytest.raises(InputError, match=r"campaign\.json"):
        again(campaign, out)
