"""Criteria of IMO MSC.137(76)."""

import math

import pytest

from seatrial.errors import InputError
from seatrial_kits.sea_trials.evaluation import Done, criteria_name, figures_of, verdicts_of
from seatrial_kits.sea_trials.figures.criteria import (
    first_overshoot_limit,
    imo,
    second_overshoot_limit,
)
from seatrial_kits.sea_trials.figures.turning import turning_circle
from seatrial_kits.sea_trials.figures.zigzag import zig_zag

from .references import FIGURES, record


@pytest.mark.parametrize(
    ("ratio", "first", "second"),
    [(5.0, 10.0, 25.0), (10.0, 10.0, 25.0), (20.0, 15.0, 32.5), (30.0, 20.0, 40.0),
     (50.0, 20.0, 40.0)],
)  # fmt: skip
def test_limits_of_the_overshoots(ratio, first, second):
    assert first_overshoot_limit(ratio * 8.0, 8.0) == first
    assert second_overshoot_limit(ratio * 8.0, 8.0) == second


def test_a_ship_that_meets_the_criteria_has_margins():
    reference = FIGURES["kvlcc2_full_turn_m35"]
    trials = {
        "turning-circle": turning_circle(record("kvlcc2_full_turn_m35")),
        "zig-zag-20": zig_zag(record("kvlcc2_full_zigzag_20_20"), math.radians(20.0)),
    }
    verdicts = imo(trials, reference["L"], reference["U0"])
    assert [v.ability for v in verdicts] == [
        "turning: advance", "turning: tactical diameter", "20/20 zig-zag: first overshoot",
    ]  # fmt: skip
    assert all(v.passed for v in verdicts)
    margins = [v.margin for v in verdicts]
    assert margins == pytest.approx([4.5 - 3.0012, 5.0 - 3.0125, 25.0 - 10.4615], abs=1e-3)


def test_a_wide_circle_fails():
    trials = {"turning-circle": turning_circle(record("kvlcc2_full_turn_m35"))}
    assert [v.passed for v in imo(trials, 200.0, 8.0)] == [False, True]


def test_a_ship_without_a_speed_is_refused():
    with pytest.raises(InputError, match="above 0"):
        imo({}, 320.0, 0.0)


@pytest.mark.parametrize(
    ("kind", "helm", "heading", "name"),
    [
        ("turning-circle", 35.0, 10.0, "turning-circle"),
        ("turning-circle", 15.0, 10.0, "turning-circle with a helm of 15 deg"),
        ("zig-zag", 20.0, 20.0, "zig-zag-20"),
        ("zig-zag", 20.0, 10.0, "zig-zag-10 with a helm of 20 deg"),
        ("initial-turning", 10.0, 10.0, "initial-turning"),
        ("crash-stop", 35.0, 10.0, "crash-stop"),
    ],
)
def test_criteria_are_for_the_helm_that_they_name(kind, helm, heading, name):
    done = Done(kind, record("kvlcc2_full_turn_m35"), helm=math.radians(helm),
                heading=math.radians(heading))  # fmt: skip
    assert criteria_name(done) == name


@pytest.mark.parametrize(
    ("criteria", "length", "count"),
    [("length", 100.0, 2), ("length", 99.9, 0), ("imo", 99.9, 2), ("none", 320.0, 0)],
)
def test_the_criteria_are_for_ships_of_their_length_or_by_a_word(criteria, length, count):
    done = Done("turning-circle", record("kvlcc2_full_turn_m35"), length=length, criteria=criteria)
    assert len(verdicts_of(done, figures_of(done))) == count
