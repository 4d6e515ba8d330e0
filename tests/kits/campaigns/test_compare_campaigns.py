"""Two campaigns compared: which cases are pairs, what changed, and the status that follows."""

import json
import re
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from seatrial.errors import InputError
from seatrial_kits.campaigns.in_folders import run_campaign
from seatrial_kits.campaigns.results.comparison import compare_campaigns
from seatrial_kits.campaigns.results.comparison_page import write_comparison_page
from tests.command import seatrial

JSON = Path(__file__).parents[3] / "docs/reference/json.md"
OFFSETS = [0.0, 0.5, 1.0, 1.5]


@pytest.fixture
def folder(tmp_path):
    """Return a function that writes a campaign's folder: a table of cases, as a sweep does."""

    def write(name, gain, robustness, seeds=(1, 2, 3, 4), units="deg", criteria=()):
        path = tmp_path / name
        path.mkdir()
        count = len(robustness)
        columns = {
            "case": range(1, count + 1),
            "trial": ["t"] * count,
            "pilot.kp": [gain] * count,
            "hull.offset": OFFSETS[:count],
            "seed": list(seeds)[:count],
            "status": ["complete"] * count,
            "passed": [value > 0 for value in robustness],
            "error": [""] * count,
            "steady": [value > 0 for value in robustness],
            "robustness of steady": robustness,
            "worst of steady": [5.0 * (1.0 - value) for value in robustness],
            "unit of steady": [units] * count,
        }
        table = pa.table({key: list(values) for key, values in columns.items()})
        pq.write_table(table, path / "results.parquet")
        index = {
            "name": "station",
            "cases": [],
            "criteria": [
                {"name": key, "check": "", "verdict": verdict, "detail": ""}
                for key, verdict in criteria
            ],
            "identity": {"program": {"seatrial": "1"}, "files": {"t": {"t.toml": f"{gain}" * 20}}},
        }
        (path / "campaign.json").write_text(json.dumps(index), "utf-8")
        return path

    return write


BEFORE, AFTER = [0.5, 0.2, -0.1, 0.4], [0.6, -0.2, 0.3, 0.4]


def test_cases_are_pairs_by_what_varies_and_a_common_setting_is_the_change(folder):
    found = compare_campaigns(folder("a", 1.0, BEFORE), folder("b", 2.0, AFTER))
    assert [(one.number, other.number) for one, other in found.pairs.found] == [
        (1, 1), (2, 2), (3, 3), (4, 4)
    ]  # fmt: skip
    assert found.pairs.varying == ["hull.offset", "seed"]
    assert found.pairs.changed == [("pilot.kp", (1.0, ""), (2.0, ""))]
    [changes] = [t for t in found.tables() if t.title == "Set differently"]
    assert changes.rows == [["pilot.kp", "1", "2"], ["t.toml", "1.01.01.01.0", "2.02.02.02.0"]]
    assert [(c.name, c.a, c.b, c.criteria) for c in found.changed] == [
        ("hull.offset 0.5, seed 2", "pass", "fail", "steady"),
        ("hull.offset 1, seed 3", "fail", "pass", "steady"),
    ]
    assert found.is_worse


def test_columns_have_the_mean_of_the_differences(folder):
    found = compare_campaigns(folder("a", 1.0, BEFORE), folder("b", 2.0, AFTER))
    columns = {each.name: each for each in found.columns}
    assert columns["robustness of steady"].difference == pytest.approx((0.1 - 0.4 + 0.4 + 0.0) / 4)
    assert columns["worst of steady"].unit == "deg"
    assert columns["worst of steady"].difference == pytest.approx(-5 * 0.1 / 4)
    rate = found.rates[0]
    assert (rate.pairs, rate.a, rate.b, rate.broken, rate.repaired) == (4, 0.75, 0.75, 1, 1)


def test_the_worst_cases_stand_side_by_side(folder):
    found = compare_campaigns(folder("a", 1.0, BEFORE), folder("b", 2.0, AFTER))
    assert [(w.worst_in, w.case_a, w.a, w.b) for w in found.worst] == [
        ("a", 3, -0.1, 0.3), ("b", 2, 0.2, -0.2)
    ]  # fmt: skip


def test_cases_that_one_alone_has_are_named(folder):
    found = compare_campaigns(
        folder("a", 1.0, BEFORE), folder("b", 1.0, AFTER[:3], seeds=(1, 2, 9))
    )
    assert [[case.number for case in only] for only in found.pairs.only] == [[3, 4], [3]]
    assert found.lines[0] == "2 cases in both; 2 only in a, 1 only in b"


def test_campaigns_without_a_common_case_are_refused(folder):
    a, b = folder("a", 1.0, BEFORE), folder("b", 1.0, AFTER, seeds=(5, 6, 7, 8))
    with pytest.raises(InputError, match=r"no case in common; cases are paired by hull.offset, se"):
        compare_campaigns(a, b)


def test_columns_of_other_units_are_not_compared(folder):
    found = compare_campaigns(folder("a", 1.0, BEFORE), folder("b", 1.0, AFTER, units="rad"))
    assert found.skipped == {"worst of steady": "its values are in deg and rad"}


@pytest.mark.parametrize(
    ("before", "after", "worse"),
    [("pass", "pass", False), ("pass", "undecided", False), ("pass", "fail", True)],
)
def test_criteria_of_the_campaigns_decide_before_single_cases(folder, before, after, worse):
    a = folder("a", 1.0, BEFORE, criteria=[("reliable", before)])
    b = folder("b", 1.0, AFTER, criteria=[("reliable", after)])
    found = compare_campaigns(a, b)
    assert found.is_worse == worse
    assert ("went from pass to fail: reliable" in found.lines) == worse


def test_the_command_says_it_in_tables_in_json_and_on_a_page(folder, tmp_path):
    folder("a", 1.0, BEFORE), folder("b", 2.0, AFTER)
    done = seatrial("compare", "a", "b", "--page", "c.html", "--json", cwd=tmp_path)
    assert done.returncode == 1, done.stderr
    document = json.loads(done.stdout)
    assert document["result"]["worse"] is True
    [said] = re.findall(r"^\| `compare` of campaigns \| (.*) \|$", JSON.read_text("utf-8"), re.M)
    assert set(re.findall(r"`(\w+)`", said)) == set(document["result"])
    assert document["result"]["changed"][0]["case_b"] == 2
    assert "cases from pass to fail: 1; from fail to pass: 1" in document["lines"]
    assert "went from pass to fail: 1 cases" in document["lines"]
    page = (tmp_path / "c.html").read_text("utf-8")
    assert "hull.offset 0.5, seed 2" in page
    assert (tmp_path / "plotly.js").is_file()
    assert seatrial("compare", "b", "b", cwd=tmp_path).returncode == 0


def test_a_run_and_a_campaign_are_no_pair(folder, tmp_path):
    folder("a", 1.0, BEFORE)
    done = seatrial("compare", "a", "elsewhere", cwd=tmp_path)
    assert done.returncode == 2
    assert "a is a campaign, and elsewhere has no campaign.json" in done.stderr


def test_a_table_and_folders_of_the_same_cases_are_pairs(written, tmp_path):
    """A campaign of folders and a table of it have the same cases, of which seeds play no part."""
    grid = '[grid]\n"case.number" = ["1 m", "4 m"]\n'
    run_campaign(written(grid), tmp_path / "one", engine="direct", jobs=1)
    done = seatrial(
        "run", "campaign.toml", "--keep", "none", "--engine", "direct", "--out", "two",
        "--set", "stop=0.2 s", cwd=tmp_path,
    )  # fmt: skip
    assert done.returncode == 1, done.stderr
    found = compare_campaigns(tmp_path / "one", tmp_path / "two")
    assert [found.pairs.name(one) for one, _ in found.pairs.found] == [
        "case.number 1 m", "case.number 4 m"
    ]  # fmt: skip
    assert found.pairs.changed == [("stop", None, (0.2, "s"))]
    assert {each.name: each.difference for each in found.columns} == {
        "robustness of few": 0.0, "worst of few": 0.0
    }  # fmt: skip
    page = write_comparison_page(found, tmp_path / "page.html")
    assert 'case.number 4 m: <a href="one/02-t-number-4-m/">one</a>' in page.read_text("utf-8")
    elsewhere = write_comparison_page(found, tmp_path / "two/page.html")
    assert '<a href="../one/02-t-number-4-m/">' in elsewhere.read_text("utf-8")
