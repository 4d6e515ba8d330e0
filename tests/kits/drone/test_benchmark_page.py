"""The benchmark's table in the page against the rates and percentiles of an independent one."""

import csv
import math
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
PAGE = ROOT / "docs/kits/drone/land-a-drone.md"
THEIRS = ROOT / "tests/reference/drone/benchmark.csv"
LAWS = ("naive", "relative", "predictive")
BEYOND = {("wamv", "3.25", "predictive", "relative tilt p95 [deg]")}
"""Figures that the page names as worse by more than a quarter."""


def ours():
    """Return the page's cells by deck, height and law."""
    found = {}
    for line in PAGE.read_text("utf-8").splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if len(cells) == 10 and cells[1] in LAWS:
            deck, height = cells[0].split(" m,")[0].split()
            found[deck, height, cells[1]] = cells[2:]
    return found


def theirs():
    with THEIRS.open(newline="") as file:
        rows = list(csv.DictReader(file))
    return {
        (row["deck"], f"{float(row['Hs [m]']):g}", row["controller"]): row
        for row in rows
        if float(row["Hs [m]"])
    }


ROWS = ours()


def test_every_sea_has_every_law():
    assert ROWS.keys() == theirs().keys()
    assert len(ROWS) == 27


@pytest.mark.parametrize("key", ROWS, ids=" ".join)
def test_rates_are_those_required_with_wilsons_interval(key):
    landed, rate, required, *_ = ROWS[key]
    share = int(landed) / 200
    z2 = 1.96**2 / 200
    middle = (share + z2 / 2) / (1 + z2)
    half = 1.96 * math.sqrt(share * (1 - share) / 200 + z2 / 800) / (1 + z2)
    low, high = (round(100 * (middle + sign * half)) for sign in (-1, 1))
    assert rate == f"{100 * share:.1f}, {low} to {high}"
    if required != "-":
        assert 100 * share >= float(required)


@pytest.mark.parametrize("key", [key for key in ROWS if key[2] != "naive"], ids=" ".join)
def test_percentiles_are_within_a_quarter_of_theirs(key):
    _, _, _, error, speed, tilt, time, _ = ROWS[key]
    row = theirs()[key]
    for name, cell, last in (
        ("error p95 [m]", error, 0.005),
        ("normal speed p95 [m/s]", speed, 0.005),
        ("relative tilt p95 [deg]", tilt, 0.05),
        ("time p50 [s]", time, 0.05),
    ):
        limit = 1.25 * float(row[name]) + last
        assert (float(cell.split(", ")[-1]) <= limit) == ((*key, name) not in BEYOND), name


@pytest.mark.parametrize("height", ["1.88", "3.25", "5"])
def test_naive_is_the_negative_control(height):
    naive, relative = (int(ROWS["wamv", height, law][0]) / 2 for law in LAWS[:2])
    assert naive <= relative - 20.0
