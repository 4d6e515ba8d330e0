"""Slope of lift, between the limits that theory gives."""

import math

import pytest

from seatrial_kits.fitted.parts.lift import lift_slope


def test_an_endless_span_has_nine_tenths_of_thin_foils_slope():
    assert lift_slope(1e9) == pytest.approx(0.9 * math.tau, rel=1e-6)


def test_a_short_span_is_near_jones_slender_wing():
    # 0.9 * 2 pi A / 3.8 for A -> 0; Jones (1946): pi A / 2.
    assert lift_slope(1e-6) / 1e-6 == pytest.approx(math.pi / 2, rel=0.06)


@pytest.mark.parametrize("aspect_ratio", [1.0, 2.0, 3.0])
def test_it_is_within_a_tenth_of_helmbolds_formula(aspect_ratio):
    helmbold = math.tau * aspect_ratio / (2.0 + math.sqrt(aspect_ratio**2 + 4.0))
    assert lift_slope(aspect_ratio) == pytest.approx(helmbold, rel=0.1)
