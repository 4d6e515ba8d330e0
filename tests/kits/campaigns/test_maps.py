"""Maps of campaigns: what is drawn is what the cases came to; the shipped ones against what is known."""

import json
import math
from dataclasses import replace
from pathlib import Path

import pandas as pd
import pytest

from seatrial.errors import InputError
from seatrial_kits.campaigns.campaign import load_campaign
from seatrial_kits.campaigns.designs import Design
from seatrial_kits.campaigns.results.maps import campaign_map, map_figure, said_of
from seatrial_kits.campaigns.results.page import write_table_page
from seatrial_kits.campaigns.sweep import How, run_sweep
from seatrial_kits.campaigns.table import units_of

REFERENCE = Path(__file__).parents[2] / "reference"
DIRECT = How("direct", jobs=2)
TWO = 'step = "100 ms"\n[components]\ncase = { fmu = "case.py:Case" }\nother = { fmu = "case.py:Case" }\n'
GRID = """
keep = "none"
[grid]
"case.number" = ["1 m", "2 m", "3 m", "4 m"]
"other.number" = ["0 m", "5 m", "6 m", "7 m", "8 m"]
"""


def map_of(folder):
    path = folder / "results.parquet"
    index = json.loads((folder / "campaign.json").read_text())
    return campaign_map(path, index["map"], units_of(path))


def swept(written, text, folder):
    written("")
    (folder / "rig.toml").write_text(TWO)
    run_sweep(written(text), folder / "out", DIRECT)
    return folder / "out"


def heatmaps(found):
    return [each for each in map_figure(found).data if each["type"] == "heatmap"]


def test_a_grid_of_two_numbers_is_drawn_by_itself(written, tmp_path):
    out = swept(written, GRID, tmp_path)
    found = map_of(out)
    assert (found.entry.x, found.entry.y) == ("other.number", "case.number")
    (field,) = heatmaps(found)
    margins = [
        1.0 - number**2 / 12.0 for number in (1, 2, 3, 4)
    ]  # of "case.y < 12 m", y its square
    assert field["z"] == [[round(margin, 4)] * 5 for margin in margins]
    assert field["customdata"][1] == [6, 7, 8, 9, 10]
    assert "Map" in write_table_page(out).read_text("utf-8")


@pytest.mark.slow
def test_repetitions_are_a_share(written, tmp_path):
    faults = '[faults]\nnothing = []\nhigh = [{ what = "bias", where = "case.y", value = "5 m", at = "0 s" }]\n'
    entry = '[map]\nx = "other.number"\ny = "case.number"\n'
    found = map_of(swept(written, GRID + faults + entry, tmp_path))
    (field,) = heatmaps(found)
    # 1 + 5, 4 + 5 < 12; 9 + 5 and 16 are not
    assert [row[0] for row in field["z"]] == [1.0, 1.0, 0.5, 0.0]
    assert "up to 2" in said_of(found)


@pytest.mark.slow
def test_points_are_on_the_panel_that_they_name(written, tmp_path):
    entry = '[map]\nx = "other.number"\ny = "case.number"\ncolumns = "case.way"\n[[map.points]]\nname = "p"\nat = ["5 m", "2 m"]\npanel = { "case.way" = "run" }\nholds = true\n'
    found = map_of(swept(written, GRID + '"case.way" = ["run", "other"]\n' + entry, tmp_path))
    scatters = [each for each in map_figure(found).data if each["type"] == "scatter"]
    assert [(s["x"], s["y"], s["text"], s["xaxis"]) for s in scatters] == [
        ([5.0], [2.0], ["p"], "x")
    ]
    assert len(heatmaps(found)) == 2


@pytest.mark.parametrize(
    ("entry", "said"),
    [
        ('x = "other.numbr"\ny = "case.number"', "map: unknown key that cases set 'other.numbr'; did you mean"),
        ('x = "case.way"\ny = "case.number"', "map.x: case.way is no number"),
    ],
)  # fmt: skip
def test_a_map_of_what_is_not_set_is_refused_before_anything_runs(written, tmp_path, entry, said):
    with pytest.raises(InputError, match=said):
        swept(written, f'{GRID}"case.way" = ["run"]\n[map]\n{entry}\n', tmp_path)
    assert not (tmp_path / "out").exists()


def test_a_map_of_values_at_random_is_refused(written, tmp_path):
    design = 'keep = "none"\n[design]\nkind = "monte-carlo"\ncount = 300\n[design.vary]\n'
    vary = "".join(
        f'"{key}.number" = {{ uniform = ["1 m", "5 m"] }}\n' for key in ("case", "other")
    )
    entry = '[map]\nx = "case.number"\ny = "other.number"\n'
    with pytest.raises(InputError, match=r"map\.x: case\.number has 300 values, and 200 at most"):
        swept(written, design + vary + entry, tmp_path)
    assert not (tmp_path / "out").exists()


def drawn(name, vary):
    """A shipped campaign with other values of its keys."""
    campaign = load_campaign(name)
    design = Design.model_validate({"kind": "full-factorial", "vary": vary})
    return replace(campaign, file=campaign.file.model_copy(update={"design": design}))


@pytest.mark.slow
def test_the_published_landing_points_lie_right(tmp_path):
    vary = {
        "downwash.pad.y": {"spaced": ["-0.25 m", "0.25 m", 3]},
        "downwash.pad.x": {"spaced": ["-0.319 m", "0.319 m", 3]},
        "downwash.mass": {"levels": ["10 kg"]},
        "hull.GM_T": {"levels": ["0.603 m"]},
    }
    run_sweep(drawn("hydrone-landing-map", vary), tmp_path / "out", DIRECT)
    found = map_of(tmp_path / "out")
    points = {point.name: point for point in found.entry.points}
    stated = {"nominal": True, "longitudinal": True, "transversal": False, "diagonal-aft": False, "diagonal-fore": False}  # fmt: skip
    assert {name: point.holds for name, point in points.items()} == stated  # table 8, landing
    for name, point in points.items():
        x, y = (float(value.split()[0]) for value in point.at)
        cell = found.cells[x, y, 10.0, 0.603]
        assert (cell.passed == 1) is stated[name]
        assert (cell.margin > 0.0) is stated[name]


@pytest.mark.slow
def test_the_edge_of_the_landing_envelope_is_that_of_metacentric_stability(tmp_path):
    vary = {
        "downwash.pad.y": {"levels": ["0.125 m", "0.25 m"]},
        "downwash.pad.x": {"levels": ["0 m"]},
        "downwash.mass": {"levels": ["7 kg", "13 kg"]},
        "hull.GM_T": {"levels": ["0.603 m", "0.7236 m"]},
    }
    run_sweep(drawn("hydrone-landing-map", vary), tmp_path / "out", DIRECT)
    table = pd.read_parquet(tmp_path / "out/results.parquet")
    assert len(table) == 8
    for _, row in table.iterrows():
        # W GM_T sin phi = m g y; the slowest roll, of 2.3 s, is within 1 % after 16 s
        sine = row["downwash.mass"] * row["downwash.pad.y"] / (21.987 * row["hull.GM_T"])
        heel = math.degrees(math.asin(sine))
        assert row["worst of roll stays below 10 degrees"] == pytest.approx(heel, rel=0.01)
        assert row["roll stays below 10 degrees"] == (heel < 10.0)


@pytest.mark.interop
def test_gloria_capsizes_in_more_wind_than_metacentric_stability_needs(tmp_path):
    vary = {
        "wind.mean_direction": {"levels": ["90 deg"]},
        "wind.mean_speed": {"levels": ["2 m/s", "6 m/s"]},
        "trimmer.roll_limit": {"levels": ["off", "on"]},
    }
    run_sweep(drawn("gloria-capsize-map", vary), tmp_path / "out", DIRECT)
    table = pd.read_parquet(tmp_path / "out/results.parquet")
    # 2 m/s: M phi < m g GM sin(phi)^2 / 2 for the greatest force of the sail, applied at once
    sail = pd.read_csv(REFERENCE / "gloria_sail_naca0015.csv", comment="#")
    greatest = (sail["cl"] ** 2 + sail["cd"] ** 2).max() ** 0.5
    moment = 0.5 * 1.225 * 0.9 * greatest * 2.0**2 * 1.18
    assert moment < 0.7246 * 27.2 * 9.81 * 0.2 / 2.0  # tan(phi) = 2 phi
    assert list(table["passed"]) == [True, True, False, True]
    heel = table["worst of it stays upright"]
    assert heel[0] == heel[1] < 15.0  # too little for the limit to do anything
    assert heel[3] < 25.0
