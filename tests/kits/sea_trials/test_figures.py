"""Figures of turning circles and zig-zags against those of the KVLCC2."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from seatrial_kits.sea_trials.figures.record import Record
from seatrial_kits.sea_trials.figures.turning import turning_circle
from seatrial_kits.sea_trials.figures.zigzag import initial_turning, zig_zag

from .references import FIGURES, TURNS, ZIG_ZAGS, record

TOLERANCE = 1e-3
NAMES = {
    "steady_drift_deg": "steady_drift",
    "steady_rate_deg_s": "steady_rate",
    "time_to_first_execute": "initial_turning_time",
    **{f"execute_{n}_time": f"reversal_{n}_time" for n in (2, 3, 4)},
    **{f"overshoot_{n}_deg": f"overshoot_{n}" for n in (1, 2, 3, 4)},
}


def figures(name, rec):
    if name in TURNS:
        return turning_circle(rec)
    return zig_zag(rec, math.radians(FIGURES[name]["heading_deg"]))


def shown(found, length):
    """Return figures in ship lengths, degrees and seconds."""
    scale = {"m": 1.0 / length, "rad": math.degrees(1.0), "rad/s": math.degrees(1.0)}
    return {name: each.value * scale.get(each.unit, 1.0) for name, each in found.found.items()}


def assert_as_reference(name, found, mirrored=1.0):
    reference = FIGURES[name]
    values = shown(found, reference["L"])
    for key, expected in reference["figures"].items():
        if key == "execute_times_exact":
            continue
        sign = mirrored if key in ("steady_drift_deg", "steady_rate_deg_s") else 1.0
        assert values[NAMES.get(key, key)] == pytest.approx(sign * expected, abs=TOLERANCE), key


@pytest.mark.parametrize("every", [1, 2])
@pytest.mark.parametrize("name", [*TURNS, *ZIG_ZAGS])
def test_figures_are_those_of_the_reference(name, every):
    assert_as_reference(name, figures(name, record(name, every)))


@pytest.mark.parametrize("name", ZIG_ZAGS)
def test_reversals_are_at_the_exact_times(name):
    found = figures(name, record(name))
    for number, expected in enumerate(FIGURES[name]["figures"]["execute_times_exact"], 1):
        assert found[f"reversal_{number}_time"] == pytest.approx(expected, abs=TOLERANCE)


def test_the_current_is_found_from_the_circle():
    found = turning_circle(record("kvlcc2_full_turn_p35_current"))
    assert (found["current_north"], found["current_east"]) == pytest.approx((0.5, 1.0), abs=1e-4)


@settings(max_examples=6, deadline=None)
@given(
    name=st.sampled_from([*TURNS, "kvlcc2_l7_zigzag_10_10"]),
    angle=st.floats(-math.pi, math.pi),
    offset=st.floats(-1e5, 1e5),
    mirror=st.sampled_from([1.0, -1.0]),
    wrapped=st.booleans(),
    every=st.sampled_from([1, 2]),
)
def test_figures_do_not_depend_on_frame_side_clock_or_rows(
    name, angle, offset, mirror, wrapped, every
):
    rec = record(name, every)
    cos, sin = math.cos(angle), math.sin(angle)
    north, east = rec.north, mirror * rec.east
    heading = mirror * rec.heading + angle
    moved = Record(
        rec.time + offset,
        cos * north - sin * east + 1e4,
        sin * north + cos * east - 2e3,
        np.remainder(heading, math.tau) if wrapped else heading,
        mirror * rec.helm,
    )
    assert_as_reference(name, figures(name, moved), mirror)


@settings(max_examples=3, deadline=None)
@given(
    speed=st.floats(0.0, 0.2),
    towards=st.floats(0.0, math.tau),
    every=st.sampled_from([1, 2]),
)
def test_a_current_moves_no_figure_of_the_water(speed, towards, every):
    def drifting(name):
        away = -speed * math.cos(towards), -speed * math.sin(towards)
        return record(name, every).through_water(*away, 0.0)

    assert_as_reference("kvlcc2_l7_turn_p35", turning_circle(drifting("kvlcc2_l7_turn_p35")))
    zig_zag_10 = "kvlcc2_l7_zigzag_10_10"
    found, still = (figures(zig_zag_10, rec) for rec in (drifting(zig_zag_10), record(zig_zag_10)))
    for name in ("overshoot_1", "overshoot_2"):
        assert found[name] == pytest.approx(still[name], abs=math.radians(TOLERANCE)), name
    for name in ("reversal_3_time", "period"):
        assert found[name] == pytest.approx(still[name], abs=TOLERANCE), name


def test_a_point_ahead_of_midship_describes_a_wider_start():
    rec = record("kvlcc2_full_turn_m35")
    midship, bow = turning_circle(rec), turning_circle(rec.of_point(160.0))
    # At a heading change of 90 deg the bow is 160 m across, and it began 160 m ahead.
    assert bow["advance"] == pytest.approx(midship["advance"] - 160.0, abs=0.1)
    assert bow["transfer"] == pytest.approx(midship["transfer"] + 160.0, abs=0.1)
    assert bow["tactical_diameter"] == pytest.approx(midship["tactical_diameter"], abs=0.1)


def test_a_zig_zag_starts_as_the_test_of_initial_turning():
    name = "kvlcc2_l7_zigzag_10_10"
    found = initial_turning(record(name))
    expected = FIGURES[name]["figures"]["initial_turning_track"]
    assert found.in_lengths(7.0)["initial_turning_track"] == pytest.approx(expected, abs=TOLERANCE)


def test_an_ideal_circle_has_the_figures_of_a_circle():
    radius, rate, speed = 100.0, 0.05, 5.0
    time = np.arange(-60.0, 300.0, 0.5)
    psi = rate * np.maximum(time, 0.0)
    straight = np.minimum(speed * time, 0.0)
    rec = Record(time, straight + radius * np.sin(psi), radius * (1 - np.cos(psi)), psi,
                 np.where(time >= 0.0, 0.3, 0.0), 0.1 * np.sin(psi))  # fmt: skip
    found = turning_circle(rec)
    for name, expected in {"advance": radius, "transfer": radius, "tactical_diameter": 2 * radius,
                           "maximum_advance": radius, "steady_diameter": 2 * radius,
                           "time_90": math.pi / 2 / rate, "steady_speed_ratio": 1.0,
                           "largest_heel": 0.1}.items():  # fmt: skip
        assert found[name] == pytest.approx(expected, rel=5e-3), name
    assert found["steady_drift"] == pytest.approx(0.0, abs=1e-3)


def test_times_of_checking_the_yaw_lie_between_reversal_and_return():
    found = figures("kvlcc2_full_zigzag_20_20", record("kvlcc2_full_zigzag_20_20"))
    assert 0.0 < found["time_to_check_yaw_1"] < found["overshoot_time_1"]
    assert found["reversal_1_time"] < found["reach"] < found["reversal_2_time"]
    assert found["reversal_2_time"] < found["period"] < found["reversal_3_time"]


def test_roll_that_was_not_measured_is_said():
    found = turning_circle(replace(record("kvlcc2_l7_turn_p35"), roll=None))
    assert found.missing["largest_heel"] == "the record has no roll"


def test_a_helm_order_that_is_over_from_the_first_row_is_the_first_order():
    name = "kvlcc2_full_zigzag_20_20"
    rec = record(name)
    ordered = np.full(len(rec.time), math.radians(20.0))
    for number, at in enumerate(FIGURES[name]["figures"]["execute_times_exact"]):
        ordered[rec.time >= at] = math.radians(20.0) * (-1.0) ** (number + 1)
    assert_as_reference(name, figures(name, replace(rec, helm=ordered)))


def test_noise_of_the_compass_does_not_look_like_a_turn():
    name = "kvlcc2_full_zigzag_20_20"
    rec = record(name)
    noise = math.radians(0.3) * np.random.default_rng(1).standard_normal(len(rec.time))
    found = figures(name, replace(rec, heading=rec.heading + noise))
    expected = FIGURES[name]["figures"]["time_to_first_execute"]
    # The heading turns by 0.45 deg/s there: 2 s of it are three deviations of the noise.
    assert found["initial_turning_time"] == pytest.approx(expected, abs=2.5)
