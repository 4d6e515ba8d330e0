"""Records that hold no manoeuvre, or not all of it."""

import math

import numpy as np
import pytest

from seatrial.errors import InputError
from seatrial_kits.sea_trials.figures.record import Record
from seatrial_kits.sea_trials.figures.turning import turning_circle
from seatrial_kits.sea_trials.figures.zigzag import initial_turning, zig_zag

from .references import columns

TURN, ZIG_ZAG = "kvlcc2_full_turn_m35", "kvlcc2_l7_zigzag_10_10"


def cut(name, first=0, last=None):
    return Record(*(each[first:last] for each in columns(name)))  # fmt: skip


def changed(name, column, change):
    values = [each.copy() for each in columns(name)]
    change(values[column])
    return values


def test_a_turn_cut_short_gives_the_rest():
    found = turning_circle(cut(TURN, last=250))
    assert found["advance"] == pytest.approx(3.0012 * 320.0, rel=1e-3)
    with pytest.raises(
        InputError, match=r"tactical_diameter cannot be had: the heading changes by 13.*180 deg"
    ):
        found["tactical_diameter"]
    assert "steady_diameter" in found.missing


def test_a_record_without_a_turn_of_90_degrees_still_has_the_approach():
    found = turning_circle(cut(TURN, last=60))
    assert set(found) == {"approach_speed"}
    assert "90 deg are needed" in found.missing["advance"]


def test_a_zig_zag_without_the_fourth_overshoot_gives_the_rest():
    found = zig_zag(cut(ZIG_ZAG), math.radians(10.0))
    assert "overshoot_3" in found
    with pytest.raises(InputError, match="overshoot_4 cannot be had: the record ends"):
        found["overshoot_4"]


def test_a_heading_that_is_never_reached_is_named():
    with pytest.raises(
        InputError, match="holds no initial turning: the heading never changes by 100 deg"
    ):
        initial_turning(cut(ZIG_ZAG), math.radians(100.0))


def test_a_record_that_starts_in_a_turn_is_refused():
    with pytest.raises(InputError, match="the record starts in a turn"):
        turning_circle(cut(TURN, first=100))


@pytest.mark.parametrize(
    ("column", "change", "message"),
    [
        (0, lambda t: t.__setitem__(9, t[8]), "time must rise"),
        (0, lambda t: t.__setitem__(slice(9, None), t[9:] + 60.0), "a gap from 8 s to 69 s"),
        (1, lambda x: x.__setitem__(9, np.nan), "north: row 10: a finite number"),
        (3, lambda psi: psi.__imul__(math.degrees(1.0)), "up to 90 deg .* is in degrees"),
        (3, lambda psi: psi.__setitem__(slice(9, None), psi[9:] + 359.0), "more than 30 rad/s"),
        (4, lambda helm: helm.__imul__(math.degrees(1.0)), "helm: 35 is beyond pi"),
    ],
)  # fmt: skip
def test_bad_columns_are_refused(column, change, message):
    name = "kvlcc2_l7_turn_p35" if message.startswith("up to") else TURN
    values = changed(name, column, change)
    if message.startswith("up to"):
        values = [each[::10] for each in values]
    with pytest.raises(InputError, match=message):
        Record(*values)


def test_columns_of_different_lengths_are_refused():
    time = np.arange(10.0)
    with pytest.raises(InputError, match="east: 10 values are needed"):
        Record(time, time, time[1:], time)


def test_a_figure_that_there_is_not_is_refused():
    with pytest.raises(InputError, match="unknown figure 'advanse'; did you mean 'advance'"):
        turning_circle(cut(TURN))["advanse"]


@pytest.mark.parametrize("heading", [0.0, -0.1, 10.0])
def test_a_zig_zag_without_a_proper_angle_is_refused(heading):
    with pytest.raises(InputError, match="an angle above 0 up to pi rad"):
        zig_zag(cut(ZIG_ZAG), heading)


@pytest.mark.parametrize(
    ("name", "figures", "message"),
    [
        (TURN, turning_circle, "to starboard, and the heading goes to port: .* name it -NAME"),
        (ZIG_ZAG, lambda r: zig_zag(r, math.radians(10.0)), "to port, .* goes to starboard"),
    ],
)
def test_helm_of_the_opposite_sign_is_refused(name, figures, message):
    values = changed(name, 4, lambda helm: helm.__imul__(-1.0))
    with pytest.raises(InputError, match=f"the helm is {message}"):
        figures(Record(*values))
