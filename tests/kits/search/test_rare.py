"""Rare events: probabilities in closed form, down to one in a million, and how sure they are."""

import math

import numpy as np
import pandas as pd
import pytest
from scipy.stats import chi2, norm

from seatrial.errors import InputError, SimulationError
from seatrial_kits.campaigns.sweep import How
from seatrial_kits.search.ask import ask
from seatrial_kits.search.subset import subset_simulation


def beyond_plane(probability, dimensions):
    """Fail beyond a plane at -Phi^-1(p) from the middle."""
    beta = -norm.ppf(probability)
    return lambda x: beta - x.sum(axis=1) / math.sqrt(dimensions)


def beyond_sphere(probability, dimensions):
    """Fail beyond a sphere, whose square of the radius has the chi-squared distribution."""
    radius = math.sqrt(chi2.isf(probability, dimensions))
    return lambda x: radius - np.linalg.norm(x, axis=1)


def beyond_both(probability, dimensions):
    """Fail in two regions apart."""
    beta = -norm.ppf(probability / 2.0)
    return lambda x: beta - np.abs(x[:, 0])


KNOWN = [
    (beyond_plane, 1e-5, 3),
    (beyond_plane, 1e-6, 10),
    (beyond_sphere, 1e-6, 2),
    (beyond_both, 1e-5, 2),
]


@pytest.mark.parametrize(("limit", "probability", "dimensions"), KNOWN)
def test_a_known_probability_is_within_three_deviations(limit, probability, dimensions):
    value = limit(probability, dimensions)
    found = subset_simulation(value, dimensions, 2000, 1e-9, seed=7)
    assert found.is_reached
    assert 0.1 < found.variation < 0.45
    assert abs(math.log(found.probability / probability)) < 3.0 * found.variation
    assert found == subset_simulation(value, dimensions, 2000, 1e-9, seed=7)


@pytest.mark.interop
@pytest.mark.parametrize(("limit", "probability", "dimensions"), KNOWN)
def test_estimates_spread_about_the_truth_as_they_say(limit, probability, dimensions):
    value = limit(probability, dimensions)
    found = [subset_simulation(value, dimensions, 2000, 1e-9, seed) for seed in range(200)]
    shares = np.array([rare.probability for rare in found]) / probability
    assert shares.mean() == pytest.approx(1.0, abs=0.12)
    said = float(np.mean([rare.variation for rare in found]))
    assert 0.8 < shares.std() / said < 1.3
    inside = [low <= probability <= high for low, high in (rare.interval for rare in found)]
    assert 0.85 < np.mean(inside) <= 1.0


def test_what_is_not_rare_is_a_share_of_the_first_level():
    found = subset_simulation(lambda x: 1.0 - x[:, 0], 1, 2000, 1e-9, seed=0)
    assert len(found.thresholds) == 1
    assert found.probability == pytest.approx(norm.sf(1.0), rel=0.15)
    binomial = math.sqrt((1.0 - found.probability) / (2000 * found.probability))
    assert found.variation == pytest.approx(binomial, rel=1e-9)


def test_the_search_ends_below_the_least_probability():
    found = subset_simulation(lambda x: 20.0 - x[:, 0], 2, 1000, 1e-4, seed=0)
    assert not found.is_reached
    assert 1e-5 < found.probability < 1e-4
    assert found.thresholds[-1] > 10.0


def test_values_that_say_nothing_are_refused():
    with pytest.raises(SimulationError, match="the same in whole regions"):
        subset_simulation(lambda x: np.where(x[:, 0] > 4.5, -1.0, 1.0), 1, 500, 1e-9, seed=0)


SUM = '[design]\nkind = "monte-carlo"\ncount = 10\n[design.vary]\n"form.a" = { normal = ["2 m", "1 m"] }\n"form.b" = { normal = ["-1 kg", "1 kg"] }\n"form.c" = { normal = [0, 2] }\n[[design.correlation]]\nbetween = ["form.a", "form.b"]\ncoefficient = 0.5\n'


@pytest.mark.long
@pytest.mark.interop
def test_a_trial_s_probability_is_that_of_its_closed_form(asked, tmp_path):
    """The sum over the root of three is normal: mean 1, variance 1 + 1 + 4 + 2 0.5 of it."""
    mean, spread = 1.0 / math.sqrt(3.0), math.sqrt(7.0 / 3.0)
    limit = mean - spread * float(norm.ppf(1e-5))
    text = f"{SUM}[ask.rare]\nper_level = 500\n"
    campaign = asked("sum", f"form.y < {limit!r} m", text)
    finding, folder = ask(campaign, "rare", tmp_path / "out", How("direct", jobs=2))
    found = finding.values
    assert found["reached"]
    assert found["low"] < 1e-5 < found["high"]
    assert abs(math.log(found["probability"] / 1e-5)) < 3.0 * found["variation"]
    table = pd.read_parquet(folder / "results.parquet")
    first = table.iloc[:500]
    assert first["form.a"].corr(first["form.b"]) == pytest.approx(0.5, abs=0.1)
    assert first["form.c"].std() == pytest.approx(2.0, rel=0.1)
    assert len(table) == finding.runs == 500 + 450 * (len(found["thresholds"]) - 1)


@pytest.mark.long
@pytest.mark.interop
def test_a_few_levels_of_a_trial_do_not_depend_on_who_runs_them(asked, tmp_path):
    text = f"{SUM}[ask.rare]\nper_level = 100\nleast = 0.05\n"
    campaign = asked("sum", "form.y < 5 m", text)
    for jobs in (1, 2):
        finding, _ = ask(campaign, "rare", tmp_path / f"j{jobs}", How("direct", jobs))
    for name in ("results.parquet", "answer.json", "rare.svg"):
        assert (tmp_path / "j1" / name).read_bytes() == (tmp_path / "j2" / name).read_bytes()
    assert finding.runs == 190


def test_a_level_that_cannot_be_divided_is_refused(asked, tmp_path):
    campaign = asked("sum", "form.y < 5 m", f"{SUM}[ask.rare]\nper_level = 123\n")
    with pytest.raises(InputError, match="a multiple of 10 is needed, found 123"):
        ask(campaign, "rare", tmp_path / "out", How("direct"))
