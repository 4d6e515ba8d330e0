"""Criteria of campaigns: bounds against the books, error rates by simulation, verdicts by files."""

import json

import numpy as np
import pytest
from scipy import stats

from seatrial import load_campaign_result
from seatrial.errors import InputError
from seatrial_kits.campaigns.acceptance import (
    AcceptanceEntry,
    accepted,
    failure_bounds,
    log_mixture,
    mean_bounds,
    quantile_bounds,
    read_acceptance,
)
from seatrial_kits.campaigns.stopping_rule import failure_interval
from tests.command import seatrial


def asked(check):
    return read_acceptance(AcceptanceEntry(name="it", check=check), "c.toml")


@pytest.mark.parametrize(("failed", "count"), [(0, 59), (1, 100), (7, 20), (20, 20)])
def test_bounds_of_a_probability_are_the_exact_ones(failed, count):
    # Each side of the interval of 90 % is a bound of 95 %.
    both = failure_interval(failed, count, 0.9, "clopper-pearson")
    assert failure_bounds(failed, count, 0.95) == pytest.approx(both, abs=1e-12)


def test_59_cases_without_a_failure_show_less_than_5_percent():
    # 0.95^59 < 5 % < 0.95^58: the rule of three, exactly.
    rule = asked("probability of failure < 5 % at 95 %")
    assert rule.of_failures(0, 59, at_any_case=False) == "pass"
    assert rule.of_failures(0, 58, at_any_case=False) == "undecided"
    assert rule.of_failures(10, 59, at_any_case=False) == "fail"
    other = asked("probability of success >= 95 %")
    assert other.of_failures(0, 59, at_any_case=False) == "pass"
    assert other.of_failures(10, 59, at_any_case=False) == "fail"


def test_bounds_of_a_mean_are_those_of_student():
    values = np.random.default_rng(1).normal(3.0, 2.0, 12)
    low, high = mean_bounds(values, 0.95)
    below = stats.ttest_1samp(values, high, alternative="less").pvalue
    above = stats.ttest_1samp(values, low, alternative="greater").pvalue
    assert (below, above) == pytest.approx((0.05, 0.05), rel=1e-9)


@pytest.mark.parametrize(("share", "count"), [(0.5, 30), (0.95, 100), (0.95, 40)])
def test_bounds_of_a_quantile_hold_as_often_as_they_say(share, count):
    values = np.sort(np.random.default_rng(2).uniform(size=(1500, count)), axis=1)
    bounds = np.array([quantile_bounds(row, share, 0.95) for row in values])
    for holds in (bounds[:, 0] <= share, bounds[:, 1] >= share):
        # 3 standard errors of 1500 draws; order statistics are conservative, not by much.
        assert holds.mean() >= 0.95 - 3 * 0.0057
    # Too few for a bound at all: 0.95^40 = 13 % of samples have nothing above the quantile.
    assert np.isinf(bounds[0, 1]) == (share**count > 0.05)


@pytest.mark.parametrize("limit", [0.02, 0.5])
def test_a_look_after_every_case_keeps_the_error_rate(limit):
    """At the limit itself, the worst place, 10 000 campaigns of 200 cases decide wrongly."""
    draws = np.random.default_rng(3).random((10_000, 200)) < limit
    failed, count = np.cumsum(draws, axis=1), np.arange(1, 201)
    decided = (log_mixture(failed, count, limit) > np.log(1 / 0.05)).any(axis=1)
    assert decided.mean() <= 0.05
    if limit == 0.5:
        # The bounds of one count, looked at after every case, would not.
        naive = stats.beta.cdf(limit, failed + 1, count - failed) > 0.95
        assert naive.any(axis=1).mean() > 0.1


def test_a_sequence_decides_where_its_bounds_do():
    rule = asked("probability of failure < 10 % at 95 %")
    for failed, count in ((0, 30), (0, 60), (3, 200), (40, 200), (20, 20)):
        low, high = failure_bounds(failed, count, 0.95, at_any_case=True)
        wanted = "pass" if high < 0.1 else "fail" if low > 0.1 else "undecided"
        assert rule.of_failures(failed, count, at_any_case=True) == wanted
        exact = failure_bounds(failed, count, 0.95)
        assert low <= exact[0] <= exact[1] <= high


def test_a_false_limit_is_found_out_soon():
    draws = np.random.default_rng(4).random((2000, 1500)) < 0.05
    failed, count = np.cumsum(draws, axis=1), np.arange(1, 1501)
    decided = log_mixture(failed, count, 0.1) > np.log(1 / 0.05)
    assert decided.any(axis=1).mean() > 0.95
    assert np.median(decided.argmax(axis=1)) < 400
    right = failed / count < 0.1
    assert right[np.arange(2000), decided.argmax(axis=1)].mean() > 0.95


def test_values_that_lack_leave_it_undecided():
    rows = [{"passed": True, "worst of roll": 2.0 + 0.01 * n, "unit of roll": "deg"}
            for n in range(50)]  # fmt: skip
    rule = [
        asked('mean of "worst of roll" < 3 deg'),
        asked('quantile 90 % of "worst of roll" > 1 deg'),
    ]
    assert [each.verdict for each in accepted(rule, rows, {})] == ["pass", "pass"]
    assert "deg" in accepted(rule, rows, {})[0].detail
    assert [each.verdict for each in accepted(rule, [], {})] == ["undecided", "undecided"]
    rows[7]["worst of roll"] = None
    found = accepted(rule, rows, {})
    assert [each.verdict for each in found] == ["undecided", "undecided"]
    assert "1 cases have no value" in found[0].detail


def test_cases_of_trials_without_a_criterion_say_nothing_of_it():
    rows = [{"trial": "a", "passed": True, "upright": True, "worst of upright": 2.0,
             "unit of upright": "deg"}] * 60  # fmt: skip
    rows += [{"trial": "b", "passed": True, "upright": None, "worst of upright": None,
              "unit of upright": None}] * 60  # fmt: skip
    checks = ('probability of failure of "upright" < 5 %', 'mean of "worst of upright" <= 2 deg')
    found = accepted([asked(check) for check in checks], rows, {"upright": {"a"}})
    assert [each.verdict for each in found] == ["pass", "pass"]
    rows[0] = {**rows[0], "upright": None}  # a case of its own that could not go on
    assert accepted([asked(checks[0])], rows, {"upright": {"a"}})[0].verdict == "undecided"


def test_a_column_that_the_table_will_not_have_is_refused_before_the_first_case(written, tmp_path):
    check = "check = 'mean of \"worst of few\" < 3 m'"
    written(
        DESIGN.replace('check = "probability of failure < LIMIT at 95 %"', check).replace(
            "few", "fw"
        )
    )
    done = seatrial("run", "campaign.toml", "--engine", "direct", "--out", "out", cwd=tmp_path)
    assert done.returncode == 2
    assert (
        "criteria: reliable: unknown column 'worst of fw'; did you mean 'worst of few'"
        in done.stderr
    )
    assert not (tmp_path / "out").exists()
    assert not list((tmp_path / "seen").iterdir())


@pytest.mark.parametrize(
    ("check", "said"),
    [
        ("failures < 10 %", "is none of the forms"),
        ("probability of failure < 10", "the limit must lie between 0 and 100 %, found 1000 %"),
        ("probability of failure < 10 % at 95", "the confidence must lie between"),
        ("mean < 3 deg", "a column is needed"),
        ('quantile 200 % of "a" < 3 deg', "the quantile must lie between"),
    ],
)
def test_what_cannot_be_asked_is_refused(check, said):
    with pytest.raises(InputError) as caught:
        asked(check)
    assert said in str(caught.value)
    assert "c.toml: criteria: it" in str(caught.value)


DESIGN = """
keep = "none"
[design]
kind = "monte-carlo"
count = 160
[design.vary]
"case.number" = { uniform = ["0 m", "4 m"] }
[[criteria]]
name = "reliable"
check = "probability of failure < LIMIT at 95 %"
"""
"""Fails where number^2 >= 12: with a probability of 1 - sqrt(12) / 4, 13.4 %."""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("limit", "word", "status", "ended"),
    [("30 %", "PASS", 0, 160), ("3 %", "FAIL", 1, 160), ("13.4 %", "UNDECIDED", 1, 160)],
)
def test_a_campaign_ends_where_it_is_decided(written, tmp_path, limit, word, status, ended):
    until = "until = { decided = true, least = 20 }"
    written(until + DESIGN.replace("LIMIT", limit))
    done = seatrial("run", "campaign.toml", "--engine", "direct", "--out", "out", cwd=tmp_path)
    assert done.returncode == status, done.stderr
    assert f"{word}  reliable: probability of failure" in done.stdout
    index = json.loads((tmp_path / "out/campaign.json").read_bytes())
    assert index["criteria"][0]["verdict"] == word.lower()
    assert load_campaign_result(tmp_path / "out").passed is (word == "PASS")
    ran = int(done.stdout.split(" cases pass")[0].split(" of ")[-1])
    assert ran == ended if word == "UNDECIDED" else ran < ended
    assert "Criteria of the campaign" in (tmp_path / "out/report.html").read_text("utf-8")


def test_what_ends_it_must_be_the_number_of_failures(written, tmp_path):
    text = DESIGN.replace("probability of failure < LIMIT", 'mean of "worst of few" < 3 m')
    with pytest.raises(InputError, match="decided needs criteria of the probability"):
        written('until = { decided = true }\n' + text.replace("\"worst of few\"", "'x'")
                .replace("check = \"", "check = '").replace("at 95 %\"", "at 95 %'")
                .replace("'x'", "\"worst of few\""))  # fmt: skip
    with pytest.raises(InputError, match="half_width = NUMBER or decided = true"):
        written('until = {}\nkeep = "none"')
