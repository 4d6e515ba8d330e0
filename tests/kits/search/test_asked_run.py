"""A run of a question again: it is what the table says, by the command that the page shows."""

import math
import re
import shlex
import subprocess

import pandas as pd
import pytest

from seatrial.errors import InputError
from seatrial_kits.campaigns.results.page import write_table_page
from seatrial_kits.campaigns.sweep import How
from seatrial_kits.search.ask import ask
from seatrial_kits.search.asked_run import asked_run
from tests.cli.test_stop import SEATRIAL

VARIED = (
    '[ask.vary]\n"form.a" = { levels = ["0 m", "3 m", "900 cm"] }\n'
    '"form.b" = { normal = ["4 kg", "1 kg"] }\n"form.c" = { uniform = [0, 9] }\nseed = { integers = [1, 9] }\n'
    "[ask.sensitivity]\nsamples = 4\ntrajectories = 2\n"
)


@pytest.fixture
def answered(asked, tmp_path):
    """Return a campaign that was asked which keys matter, and the folder with the answer."""
    campaign = asked("sum", "form.y < 5 m", VARIED)
    return campaign, ask(campaign, "sensitivity", tmp_path / "answer", How("direct", jobs=1))[1]


@pytest.mark.slow
def test_a_run_sets_what_its_row_says(answered):
    campaign, folder = answered
    table = pd.read_parquet(folder / "results.parquet")
    assert len(table) == 4 * 6 + 2 * 5
    for number, row in enumerate(table.to_dict("records"), 1):
        case = asked_run(campaign, folder, number)
        metres = {"0 m": 0.0, "3 m": 3.0, "900 cm": 9.0}[case.set["form.a"]]
        said = metres + float(case.set["form.b"].removesuffix(" kg")) + case.set["form.c"]
        assert said / math.sqrt(3.0) == pytest.approx(row["worst of within"], rel=1e-12)
        assert case.set["seed"] == row["seed"]


@pytest.mark.slow
def test_the_page_s_command_runs_it_again(answered, tmp_path):
    _, folder = answered
    page = write_table_page(folder).read_text("utf-8")
    shown = re.search(r"<code>seatrial (.*?)NUMBER</code>", page)
    command = [SEATRIAL, *shlex.split(shown[1]), "5", "--out", "again"]
    ran = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    row = pd.read_parquet(folder / "results.parquet").iloc[4]
    assert ran.returncode == (0 if row["passed"] else 1), ran.stderr
    signals = pd.read_csv(tmp_path / "again/signals.csv")
    assert signals["form.y"].iloc[-1] == row["worst of within"]


@pytest.mark.slow
def test_folders_of_others_and_numbers_beyond_are_refused(answered, asked, tmp_path):
    campaign, folder = answered
    with pytest.raises(InputError, match="from 1 to 34 is needed, found 35"):
        asked_run(campaign, folder, 35)
    with pytest.raises(InputError, match=r"answer\.json: this is no answer"):
        asked_run(campaign, tmp_path, 1)
    other = asked("sum", "form.y < 6 m", VARIED)
    with pytest.raises(InputError, match=r"changed since: form\.toml: no run would be the same"):
        asked_run(other, folder, 1)
