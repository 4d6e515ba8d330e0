"""What a landing drone knows of a deck, against the deck's own motion."""

import math

import numpy as np
import pytest

from seatrial_kits.drone.landing.prediction import PER_PERIOD, WINDOW
from tests.kits.drone.deck_flight import Flight, H, Swing, at_rest

PAD = (1.0, -2.0, -0.3)


def test_nothing_is_known_before_a_sight():
    flight = Flight()
    flight.sees = False
    control = flight.to(1.0)
    assert control.lost_for(1.0) == math.inf
    assert control.mean_down() is None
    np.testing.assert_array_equal(control.deck_at(1.0), [[0, 0, 1e3 - 2.45], [0] * 3, [0] * 3])
    assert (control.get("height"), control.get("error")) == (0.0, 0.0)
    assert (control.get("time_ahead"), control.get("pad")) == (0.0, [0.0] * 3)


def test_a_late_sight_counts_from_where_the_drone_was():
    flight = Flight(delay=0.125)  # between two of the drone's own positions
    flight.pad = at_rest(*PAD)
    flight.position = lambda t: np.array([0.8 * t, -1.1 * t, -2.0 - 0.4 * t])
    control = flight.to(1.02)
    np.testing.assert_allclose(control.deck_at(1.0), [PAD, [0] * 3, [0] * 3], atol=1e-9)
    assert control.lost_for(1.02) == pytest.approx(1.02 - 1.0 + 0.125)
    own = flight.position(1.01)  # of the instant before
    assert control.get("height") == pytest.approx(PAD[2] - own[2] - 0.25)
    assert control.get("error") == pytest.approx(math.hypot(*(np.array(PAD) - own)[:2]))


@pytest.mark.parametrize("delay", [0.0, 0.1])
def test_a_deck_that_swings_is_followed_and_foreseen(delay):
    swing = Swing(PAD, velocity=(-0.5, 0.4, 0.2), acceleration=(0.3, -0.2, 0.4), period=4.0)
    flight = Flight(delay=delay, wave_period=4.0)
    flight.pad, flight.pad_velocity = swing.place, swing.velocity
    flight.position = lambda t: np.array([0.0, 0.0, -3.0])
    control = flight.to(8.01)
    late = 8.0 - delay
    for age in (0.0, 0.2, 0.5):
        expected = [swing.place(late + age), *swing.derivatives(late + age)[:2]]
        # What the filter knew first, rest, is forgotten but for some 1e-4.
        np.testing.assert_allclose(control.deck_at(late + age), expected, atol=1e-3)
    # No farther than 0.5 s.
    np.testing.assert_array_equal(control.deck_at(late + 3.0), control.deck_at(late + 0.5))
    np.testing.assert_array_equal(control.deck_at(late - 3.0), control.deck_at(late))


def test_samples_are_heave_and_slopes_at_shares_of_the_period():
    flight = Flight(delay=0.1, wave_period=2.8)  # a sample every 0.2 s
    flight.pad = lambda t: np.array([0.0, 0.0, -0.3 + 0.1 * t])
    flight.pad_velocity = at_rest(0.0, 0.0, 0.1)
    phi, theta, psi = 0.2, -0.15, 0.9
    flight.deck = lambda t: np.array([phi + 0.05 * t, theta - 0.04 * t, psi])

    def rates(t):
        # Of phi' = 0.05, theta' = -0.04, psi' = 0 by Euler's kinematics, axes of the deck.
        roll = phi + 0.05 * t
        return np.array([0.05, -0.04 * math.cos(roll), 0.04 * math.sin(roll)])

    flight.rates = rates
    control = flight.to(4.0)
    times = 0.2 * np.arange(len(control._samples))
    assert len(times) == 20
    north, east = [], []
    for t in times:
        ahead, aside = math.tan(theta - 0.04 * t), -math.tan(phi + 0.05 * t)
        north.append(ahead * math.cos(psi) - aside * math.sin(psi))
        east.append(ahead * math.sin(psi) + aside * math.cos(psi))
    found = np.array(control._samples)
    # Rates are those of the report, up to 0.05 s away: theta' changes by 2e-4 of it.
    np.testing.assert_allclose(found[:, 1:], np.column_stack([north, east]), atol=1e-5)
    np.testing.assert_allclose(found[6:, 0], 0.3 - 0.1 * times[6:], atol=3e-3)
    assert control.deck_heading() == psi
    assert control.get("attitude_wanted")[2] == psi
    assert control.mean_down() == pytest.approx(-found[:, 0].mean())
    assert control.sample_step() == pytest.approx(2.8 / PER_PERIOD)


def test_samples_begin_where_the_first_report_is_lost():
    flight = Flight(wave_period=2.8)  # a sample every 0.2 s
    flight.reports = False
    flight.to(0.03)
    flight.reports = True
    control = flight.to(1.0)  # the second report, of 0.05 s, comes between two samples
    np.testing.assert_allclose(control._samples, [[0.2, 0.0, 0.0]] * 5, atol=1e-9)


def test_no_more_than_a_window_of_samples_is_kept():
    flight = Flight(wave_period=0.7)
    control = flight.to(0.5)
    assert len(control._samples) == 10  # from 0 to 0.45 s, every 0.05 s
    assert control.mean_down() == pytest.approx(-0.2)  # where the pad is: too few for a mean
    control = flight.to(8.0)
    assert len(control._samples) == WINDOW


def test_rates_carry_a_tilt_no_farther_than_half_a_second():
    flight = Flight(wave_period=1.4)  # a sample every 0.1 s
    flight.deck, flight.rates = at_rest(0.0, 0.05, 0.0), at_rest(0.0, 0.02, 0.0)
    flight.to(1.0)
    flight.reports = False
    control = flight.to(3.0)
    found = np.array(control._samples)[:, 1]
    later = np.minimum(0.1 * np.arange(len(found)) - 0.95, 0.5)[11:]
    np.testing.assert_allclose(found[11:], np.tan(0.05 + 0.02 * later), atol=1e-9)


def test_what_is_older_than_the_estimate_changes_nothing():
    flight = Flight()
    control = flight.to(1.0)
    before = control.deck_at(1.0)
    control.set("exposed", 0.3)
    control.set("offset", [5.0, 5.0, 5.0])
    control.set("sight_count", 999)
    control.set("sight_valid", True)
    control.advance(1.0, H)
    np.testing.assert_array_equal(control.deck_at(1.0), before)


def test_pad_and_deck_are_told_a_moment_ahead():
    flight = Flight(wave_period=4.0)
    omega = 1.15 * 2 * math.pi / 4.0  # that of which the deck is taken to oscillate
    flight.pad = lambda t: np.array([1.0, -2.0, -0.3 - 0.2 * math.sin(omega * t)])
    flight.pad_velocity = lambda t: np.array([0.0, 0.0, -0.2 * omega * math.cos(omega * t)])
    flight.deck = at_rest(0.1, -0.15, 0.9)
    control = flight.to(4.01)
    now = 4.0  # orders of the instant before
    assert control.get("time_ahead") == pytest.approx(now + 0.2)
    assert control.get("pad") == pytest.approx(flight.pad(now), abs=0.01)
    assert control.get("pad_ahead") == pytest.approx(flight.pad(now + 0.2), abs=0.02)
    assert control.get("deck_ahead") == pytest.approx([0.1, -0.15, 0.9])


@pytest.mark.slow
def test_with_a_window_pad_and_deck_are_told_of_its_time():
    flight = Flight(control="predictive", wave_period=2.8, settle=0.5)
    omega = 2 * math.pi / 2.8
    flight.pad = lambda t: np.array([0.0, 0.0, -0.2 - 0.05 * math.sin(omega * t)])
    flight.pad_velocity = lambda t: np.array([0.0, 0.0, -0.05 * omega * math.cos(omega * t)])
    control = flight.to(15.0)  # from 70 samples, 14 s, on
    window = control.get("window")
    assert window > 0.0
    assert control.get("time_ahead") == window
    assert control.get("pad_ahead") == pytest.approx(flight.pad(window), abs=0.02)
    assert control.get("deck_ahead") == pytest.approx([0.0, 0.0, 0.0], abs=1e-3)


def test_a_late_sight_of_a_drone_that_swings_counts_from_where_it_was():
    flight = Flight(delay=0.125)
    flight.pad = at_rest(*PAD)
    flight.position = lambda t: np.array([math.sin(4 * t), math.cos(3 * t), -2.0 - t**2])
    control = flight.to(1.02)
    # Linear over 10 ms: h^2 / 8 of its acceleration.
    np.testing.assert_allclose(control.deck_at(1.0)[0], PAD, atol=5e-4)
