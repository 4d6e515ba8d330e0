"""The page of a campaign in which nothing fails: what was run, and what it came to."""

import re

import numpy as np
import pyarrow.parquet as pq
import pytest

from seatrial_kits.campaigns.results.overview import Overview
from seatrial_kits.campaigns.results.page import write_table_page
from seatrial_kits.campaigns.sweep import run_sweep
from seatrial_kits.campaigns.table import read_rows, units_of

from .test_table import direct

PASSING = 'keep = "none"\nfigures = ["case.y"]\n[grid]\n"case.number" = ["1 m", "2 m", "3 m"]\n'


@pytest.fixture
def folder(written, tmp_path):
    run_sweep(written(PASSING), tmp_path / "out", direct(1))
    return tmp_path / "out"


@pytest.fixture
def overview(folder):
    path = folder / "results.parquet"
    units = units_of(path)
    found = Overview(list(units), units)
    for row in read_rows(path):
        found.add(row)
    return found


def test_a_page_without_a_failure_shows_cases_and_values(folder):
    page = write_table_page(folder).read_text("utf-8")
    assert re.findall(r"<h2>(.*?)</h2>", page) == [
        "What was run", "Criteria", "Values of the cases", "Cases"
    ]  # fmt: skip
    assert "campaign.toml" in page
    assert "engine direct" in page


def test_what_was_run_has_every_setting(overview):
    assert overview.run().rows == [
        ["trial", "t"], ["case.number", "1 m, 2 m, 3 m"], ["seed", "1"]
    ]  # fmt: skip


def test_values_are_those_of_numpy(overview):
    values = {row[0]: row[1:] for row in overview.values().rows}
    squares = [1.0, 4.0, 9.0]
    expected = [3, 1.0, 4.0, np.mean(squares), np.quantile(squares, 0.95), 9.0]
    assert values["worst of few"] == ["m", *expected]
    assert values["greatest case.y"][1:] == expected
    assert [row[0] for row in overview.cases().rows] == [1, 2, 3]
    assert overview.cases().columns == [
        "case",
        "trial",
        "case.number, m",
        "seed",
        "worst of few, m",
    ]
    assert len(list(overview.figures())) == 4


def test_settings_with_many_values_have_their_ends(overview, folder):
    row = next(read_rows(folder / "results.parquet"))
    for place in range(20):
        overview.add({**row, "case.number": 10.0 + place})
    assert overview.run().rows[1] == ["case.number", "1 to 29 m, 23 values"]


def test_a_seed_that_is_drawn_is_a_setting_of_the_page(written, tmp_path):
    grid = '[grid]\nseed = [5, 6]\n"case.number" = ["4 m"]\n'
    run_sweep(written(f'keep = "none"\n{grid}'), tmp_path / "out", direct(1))
    assert "seed (2)" in pq.read_schema(tmp_path / "out/results.parquet").names
    page = write_table_page(tmp_path / "out").read_text("utf-8")
    table = page[page.index("Failed cases") :]
    assert "<th>seed</th><th>case.number, m</th>" in table
