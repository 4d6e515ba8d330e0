"""Quantities of different rates on one time axis: known answers."""

import math
from pathlib import Path

import numpy as np
import pytest

from seatrial.errors import InputError
from seatrial.trial.logs.channels import Log, Samples, channel, distinguished
from seatrial.trial.logs.quantities import Column, chosen
from seatrial_kits.logs.paired.common_time import together
from seatrial_kits.sea_trials.log_motion import motion


def log_of(**series):
    """Return a log of channels (time, values, unit) that serve the quantities of their names."""
    channels = {
        name: channel(name, unit, time, values) for name, (time, values, unit) in series.items()
    }
    return Log(Path("boat.log"), channels, {name: [name] for name in series})


def at_heading(log, window=(-math.inf, math.inf), without=()):
    found = chosen(log, {}, log.channels)
    return together(found, "heading", found.keys() - set(without), window)


FAST, SLOW = np.arange(0.0, 10.0, 0.1), np.arange(0.25, 9.0, 1.0)


def test_straight_lines_are_met_and_nothing_is_extrapolated():
    log = log_of(
        heading=(FAST, 0.0 * FAST, "rad"), north=(SLOW, 3.0 * SLOW, "m"), east=(SLOW, 0 * SLOW, "m")
    )
    found = at_heading(log)
    assert found.time[0] == pytest.approx(0.3)
    assert found.time[-1] == pytest.approx(8.2)
    np.testing.assert_allclose(found.values["north"], 3.0 * found.time, atol=1e-12)


def test_a_heading_over_north_is_interpolated_over_north():
    log = log_of(
        course=([0.0, 1.0], [350.0, 10.0], "deg"), heading=([0.25, 0.5, 0.75], [0, 0, 0], "rad")
    )
    course = np.degrees(at_heading(log).values["course"])
    np.testing.assert_allclose(course, [355.0, 360.0, 365.0])


def test_an_order_stands_until_the_next():
    log = log_of(
        command=([0.0, 1.0, 5.0], [0.0, 1.0, -1.0], "1"),
        heading=([0.5, 2.0, 3.5, 5.0], [0] * 4, "rad"),
    )
    assert at_heading(log).values["command"].tolist() == [0.0, 1.0, 1.0, -1.0]


def test_equal_times_are_left_out_with_a_count():
    log = log_of(heading=([0.0, 1.0, 1.0, 2.0], [0.0, 0.1, 0.9, 0.2], "rad"))
    found = at_heading(log)
    assert found.values["heading"].tolist() == [0.0, 0.1, 0.2]
    assert found.notes == (
        "heading (heading): 1 entries with the time of the one before are left out",
    )


def test_what_covers_too_little_is_left_out_with_a_note():
    log = log_of(heading=(FAST, 0.0 * FAST, "rad"), roll=([0.0, 1.0], [0.0, 0.0], "rad"))
    found = at_heading(log, without=["roll"])
    assert list(found.values) == ["heading"]
    assert found.notes == ("roll (roll, from 0 s to 1 s) is left out: it covers too little",)


GAP = np.concatenate((SLOW[:3], SLOW[:3] + 40.0))


@pytest.mark.parametrize(
    ("series", "message"),
    [
        ({"heading": ([0.0, 1.0, 0.5, 2.0], [0] * 4, "rad")},
         r"boat.log, message 3, channel 'heading': the time goes from 1 s to 0.5 s"),
        ({"heading": (np.arange(50.0), np.zeros(50), "rad"), "north": (GAP, GAP, "m")},
         r"message 4, channel 'north': a gap from 2.25 s to 40.25 s: 37 rows missing; they are usually 1 s"),
        ({"heading": ([0.0, 1.0], [0, 0], "rad"), "north": ([5.0, 6.0], [0, 0], "m")},
         r"no time is common to heading \(heading, from 0 s to 1 s\); north .* from 5 s"),
    ],
)  # fmt: skip
def test_faults_have_their_places(series, message):
    log = log_of(**series)
    found = chosen(log, {}, log.channels)
    with pytest.raises(InputError, match=message):
        together(found, "heading", series)


def test_a_window_leaves_a_gap_aside():
    log = log_of(heading=(np.arange(50.0), np.zeros(50), "rad"), north=(GAP, GAP, "m"))
    found = at_heading(log, (0.0, 2.0))
    np.testing.assert_allclose(found.values["north"], [1.0, 2.0])


def test_a_course_that_turns_too_fast_for_its_rate_is_refused():
    log = log_of(course=(SLOW, 2.0 * SLOW, "rad"), heading=(FAST, 0.0 * FAST, "rad"))
    with pytest.raises(
        InputError, match=r"channel 'course': it turns by 114.6 deg from 0.25 s to 1.25 s"
    ):
        at_heading(log)


def test_positions_without_a_fix_are_left_out():
    time = np.arange(10.0)
    where = np.where(time < 4.0, 0.0, 45.0)
    log = log_of(
        heading=(time, 0.0 * time, "rad"),
        latitude=(time, where, "deg"),
        longitude=(time, where, "deg"),
    )
    found = motion(log, {}, ())
    assert found.time.tolist() == [4.0, 5.0, 6.0, 7.0, 8.0, 9.0]
    assert found.notes[0] == "positions of 0, 0 are left out, 4 of them: the receiver had no fix"
    with pytest.raises(InputError, match="no fix: latitude"):
        motion(
            log_of(
                heading=(time, time, "rad"),
                latitude=(time, 0 * time, "deg"),
                longitude=(time, 0 * time, "deg"),
            ),
            {},
            (),
        )


@pytest.mark.parametrize(
    ("columns", "unit", "message"),
    [
        (
            {},
            None,
            r"message 1, channel 'latitude': latitude is 45 rad, beyond 1.571; is it in degrees",
        ),
        ({"latitude": Column("latitude", "m")}, None, "unit 'm' cannot be converted to 'rad'"),
        ({"latitude": Column("latitude", "rad")}, "deg", "the file has it in deg, not rad"),
        (
            {"latitude": Column("latitud")},
            "deg",
            "latitude: unknown channel 'latitud'; did you mean 'latitude'",
        ),
    ],
)
def test_units_and_names(columns, unit, message):
    log = log_of(
        heading=([0.0, 1.0], [0, 0], "rad"),
        latitude=([0.0, 1.0], [45.0, 45.0], unit),
        longitude=([0.0, 1.0], [0.1, 0.1], "deg"),
    )
    with pytest.raises(InputError, match=message):
        motion(log, columns, ())


def test_a_log_without_position_says_what_it_has():
    with pytest.raises(
        InputError,
        match=r"no channel serves as position: north and east.* names one of heading, roll",
    ):
        motion(log_of(heading=([0.0], [0.0], "rad"), roll=([0.0], [0.0], "rad")), {}, ())


def test_a_minus_turns_the_sign():
    log = log_of(heading=([0.0, 1.0], [1.0, 2.0], "rad"))
    assert chosen(log, {"helm": Column("-heading")}, ["helm"])["helm"].values.tolist() == [
        -1.0,
        -2.0,
    ]


def test_two_sources_of_one_channel_are_distinguished():
    samples = Samples()
    for source, value in (("GP", 1.0), ("GN", 2.0), ("GP", 3.0)):
        samples.add("GGA.lat", "deg", value, value, 1, source)
    assert {name: each.values.tolist() for name, each in samples.channels().items()} == {
        "GGA.lat": [1.0, 3.0], "GN/GGA.lat": [2.0]}  # fmt: skip
    first, second = channel("a", "m", [0.0], [1.0]), channel("a", "m", [0.0], [2.0])
    assert list(distinguished({("a", "1"): first, ("a", "2"): second}, "2")) == ["1/a", "a"]
