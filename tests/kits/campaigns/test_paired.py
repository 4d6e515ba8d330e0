"""Statistics of pairs against published tables, SciPy and simulation."""

import numpy as np
import pytest
from scipy import stats

from seatrial_kits.campaigns.results.paired import mcnemar, mean_difference, rate_difference


@pytest.mark.parametrize(
    ("counts", "difference", "interval"),
    [
        # Newcombe (1998), method 10, of a - b: 36, 12, 2, 0 has 0.20, 0.0569 to 0.3404.
        ((36, 2, 12, 0), 0.20, (0.0569, 0.3404)),
        # Fagerland, Lydersen and Laake (Statistics in Medicine 33, 2014), Bentur's data.
        ((1, 7, 1, 12), -0.286, (-0.507, -0.026)),
    ],
)
def test_the_interval_of_a_difference_is_the_published_one(counts, difference, interval):
    found = rate_difference(*counts)
    assert found[0] == pytest.approx(difference, abs=5e-4)
    assert found[1:] == pytest.approx(interval, abs=5e-4)


def test_swapped_campaigns_have_the_opposite_interval():
    gap, low, high = rate_difference(30, 5, 9, 6)
    assert rate_difference(30, 9, 5, 6) == pytest.approx((-gap, -high, -low), abs=1e-15)


@pytest.mark.parametrize("count", [1, 40])
def test_pairs_that_all_agree_have_an_interval_about_zero(count):
    gap, low, high = rate_difference(count, 0, 0, 0)
    assert gap == 0.0
    assert -1.0 < low < 0.0 < high < 1.0


def test_the_interval_holds_as_often_as_it_says():
    shares = (0.55, 0.15, 0.25, 0.05)
    drawn = np.random.default_rng(1).multinomial(60, shares, size=1500)
    covered = [
        low <= 0.10 <= high for _, low, high in (rate_difference(*map(int, d)) for d in drawn)
    ]
    assert np.mean(covered) == pytest.approx(0.95, abs=3 * 0.0057)  # three standard errors


def test_mcnemar_is_the_exact_test_of_bentur():
    assert mcnemar(1, 7) == pytest.approx(0.070, abs=5e-4)  # Fagerland et al. (2014)
    assert mcnemar(0, 0) == 1.0


def test_the_mean_difference_is_that_of_the_paired_t_test():
    random = np.random.default_rng(3)
    a = random.normal(2.0, 1.0, 25)
    b = a + random.normal(0.3, 0.2, 25)
    mean, low, high = mean_difference(list(a), list(b))
    expected = stats.ttest_rel(b, a).confidence_interval(0.95)
    assert (low, high) == pytest.approx((expected.low, expected.high), rel=1e-12)
    assert mean == pytest.approx(float(np.mean(b) - np.mean(a)), rel=1e-12)
    assert mean_difference([1.0], [3.0]) == (2.0, -np.inf, np.inf)
