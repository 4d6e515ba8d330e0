"""Uncertainty of figures: closed forms of how errors of rows reach them."""

import numpy as np
import pytest

from seatrial.errors import InputError
from seatrial_kits.sea_trials.evaluation import Done, figures_of
from seatrial_kits.sea_trials.figures.record import Record
from seatrial_kits.sea_trials.uncertainty import read_errors, with_uncertainty

RATE, RADIUS = np.pi / 200.0, 100.0
"""Of a circle whose heading has changed by 90 deg at a row, 100 s after the order."""


@pytest.fixture(scope="module")
def circle():
    time = np.arange(-60.0, 500.0, 1.0)
    psi = RATE * np.maximum(time, 0.0)
    north = np.where(time < 0.0, RATE * RADIUS * time, RADIUS * np.sin(psi))
    east = RADIUS * (1.0 - np.cos(psi))
    helm = 0.6 * (time >= 0.0)
    return Done("turning-circle", Record(time, north, east, psi, helm), (0.0,))


def halves(done, *errors):
    found = with_uncertainty(done, figures_of(done), read_errors(errors))
    return {name: figure.uncertainty for name, figure in found.found.items()}


def test_an_error_of_position_enters_a_distance_at_its_two_ends(circle):
    # Independent errors at the order and at 90 deg: sqrt(2) times that of one row. A hundred draws
    # know a standard deviation to 7 %; three of these are allowed.
    found = halves(circle, "north=0.5 m")
    assert found["advance"] == pytest.approx(1.96 * np.sqrt(2.0) * 0.5, rel=0.21)
    assert found["transfer"] is None
    assert halves(circle, "east=2m")["transfer"] == pytest.approx(1.96 * np.sqrt(8.0), rel=0.21)


def test_an_error_of_heading_enters_a_time_by_the_rate_of_turn(circle):
    found = halves(circle, "heading=0.1 deg")
    at_two_ends = np.sqrt(2.0) * np.radians(0.1) / RATE
    assert found["time_180"] == pytest.approx(1.96 * at_two_ends, rel=0.21)


def test_the_same_errors_give_the_same_uncertainty(circle):
    assert halves(circle, "north=0.5m,heading=0.1deg") == halves(
        circle, "north=0.5m", "heading=0.1deg"
    )


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("north", "WHAT=VALUE UNIT is needed, found 'north'"),
        ("nort=1 m", "unknown column 'nort'; did you mean 'north'"),
        ("time=1 s", "unknown column 'time'"),
        ("north=1 deg", "north"),
        ("north=0 m", "a value above 0 is needed, found '0 m'"),
    ],
)
def test_other_errors_are_refused(text, said):
    with pytest.raises(InputError, match=said.replace("(", r"\(")):
        read_errors([text])


def test_an_error_of_what_was_not_measured_is_refused(circle):
    with pytest.raises(InputError, match="the record has no roll"):
        halves(circle, "roll=1 deg")
