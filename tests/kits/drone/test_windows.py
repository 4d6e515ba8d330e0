"""Windows of a landing on a deck that swings at one frequency: its motion is known beforehand."""

import math

import numpy as np
import pytest

from seatrial_kits.drone.landing import laws
from tests.kits.drone.deck_flight import Flight, at_rest

T_P = 2.1  # s: a sample every 0.15 s, 70 of them in 10.35 s
STEP = 0.05
OMEGA = 2 * math.pi / T_P
TRACK, WAIT, DESCEND, GO_AROUND = 3.0, 4.0, 5.0, 7.0


def swinging(heave=0.15, roll=0.12, pitch=0.09, height=1.5, **values):
    """Return a flight with its feet ``height`` over the mean of a pad that heaves and tilts."""
    flight = Flight(control="predictive", wave_period=T_P, settle=0.0, step=STEP, **values)
    flight.position = at_rest(0.0, 0.0, -0.45 - height)
    flight.pad = lambda t: np.array([0.0, 0.0, -0.2 - heave * math.sin(OMEGA * t)])
    flight.pad_velocity = lambda t: np.array([0, 0, -heave * OMEGA * math.cos(OMEGA * t)])
    flight.deck = lambda t: np.array(
        [roll * math.sin(OMEGA * t + 1.0), pitch * math.sin(OMEGA * t - 0.4), 0.0]
    )
    flight.rates = lambda t: np.array(
        [roll * OMEGA * math.cos(OMEGA * t + 1.0), pitch * OMEGA * math.cos(OMEGA * t - 0.4), 0]
    )
    return flight


def tilt(flight, t):
    phi, theta, _ = np.transpose([flight.deck(each) for each in t])
    return np.arctan(np.hypot(np.tan(theta), np.tan(phi)))


def costs(flight, t, times):
    """Return the cost of a touch-down ``times`` after ``t``, by the specification."""
    at = t + times
    rate = np.array([-flight.pad_velocity(each)[2] for each in at])
    late = 0.35 * times / T_P
    return (tilt(flight, at) / math.radians(4.0)) ** 2 + (rate / 0.8) ** 2 + late**2


@pytest.mark.parametrize("predictor", ["autoregressive", "harmonic"])
def test_the_deck_that_it_foresees(predictor):
    flight = swinging(predictor=predictor)
    control = flight.to(15.0)
    apart = []
    for ahead in np.arange(0.2, 1.2, 0.25):
        heave, north, east = control.predicted(15.0 + ahead)
        phi, theta, _ = flight.deck(15.0 + ahead)
        down = flight.pad(15.0 + ahead)[2]
        apart.append([heave + down, north - math.tan(theta), east + math.tan(phi)])
    # The harmonic model expects a sea with no such lines, and draws towards the mean.
    limit = 0.012 if predictor == "autoregressive" else 0.06
    assert np.abs(apart).max() < limit


@pytest.mark.parametrize("height", [0.2, 1.5])
def test_it_commits_to_the_quietest_instant(height):
    flight = swinging(heave=0.05, roll=0.05, pitch=0.03, height=height)
    control = flight.to(12.0)
    control.forget_window()
    control._searched = -math.inf
    least = max(0.9, 1.1 * math.sqrt(height))
    times = least + np.arange(29) / 28 * T_P
    expected = costs(flight, 12.0, times)
    assert control.finds_window(12.0, 0.0, height)
    chosen = control._target - 12.0
    assert least - 1e-9 <= chosen <= least + T_P
    assert costs(flight, 12.0, np.array([chosen]))[0] < expected.min() + 0.03
    assert expected.min() < 0.4 < expected.max()
    # Not again within 0.1 s.
    assert not control.finds_window(12.09, 0.0, height)
    assert control.finds_window(12.1, 0.0, height)


def test_it_waits_for_enough_samples_and_then_grows_less_patient():
    # A tilt of 0.12 rad at all times, whose direction turns.
    flight = swinging(heave=0.05)
    flight.deck = lambda t: np.array([0.12 * math.sin(OMEGA * t), 0.12 * math.cos(OMEGA * t), 0])
    flight.rates = at_rest(0.0, 0.0, 0.0)
    assert len(flight.to(10.3)._samples) == 69
    control = flight.to(12.0)
    assert control.get("mode") == WAIT
    assert control.get("window") == 0.0
    times = 1.1 * math.sqrt(1.5) + np.arange(29) / 28 * T_P
    before, after = ([control.predicted(12.0 + T + h) for T in times] for h in (-0.075, 0.075))
    rate = np.subtract(after, before)[:, 0] / 0.15
    slope = np.hypot(*np.add(after, before)[:, 1:].T / 2)
    expected = (np.arctan(slope) / math.radians(4.0)) ** 2 + (rate / 0.8) ** 2
    expected += (0.35 * times / T_P) ** 2
    patient = 10.0 + (expected.min() - 0.5) / 0.1  # s, when the limit has risen to the least cost
    assert patient > 20.0
    for waited, found in ((patient - 0.01, False), (patient + 0.01, True)):
        control._searched = -math.inf
        assert control.finds_window(12.0, waited, 1.5) is found
    assert control._target == pytest.approx(12.0 + times[expected.argmin()])


@pytest.mark.parametrize(("pitch", "too_far"), [(0.13, False), (0.18, True)])
def test_a_tilt_of_more_than_nine_degrees_is_too_far(pitch, too_far):
    # 9 degrees are 0.157 rad.
    flight = swinging(roll=0.0, pitch=pitch)
    control = flight.to(12.0)
    crest = 12.0 + (0.5 * math.pi + 0.4 - OMEGA * 12.0) % (2 * math.pi) / OMEGA
    control._target = crest
    assert control.tilts_too_far(12.0) is too_far
    assert not control.tilts_too_far(crest)
    control._target = crest + 0.25 * T_P  # level
    assert not control.tilts_too_far(12.0)
    early = swinging(roll=0.0, pitch=0.3).to(5.0)
    early._target = 7.0
    assert not early.tilts_too_far(5.0)


def test_it_meets_the_deck_with_the_speed_of_a_touch():
    flight = swinging(heave=0.2, height=1.2)
    control = flight.to(14.0)
    for ahead in (0.6, 0.9, 1.3):
        control._target = 14.0 + ahead
        way = flight.pad(14.0 + ahead)[2] - -1.4
        speed = flight.pad_velocity(14.0 + ahead)[2] + 0.35
        expected = 6.0 * (way - 0.3 * ahead) / ahead**2 - 2.0 * (speed - 0.3) / ahead
        # 2 cm of the place and 4 cm/s of the speed.
        found = control.meets(14.0, -1.4, 0.3, ahead)
        assert found == pytest.approx(expected, abs=6 * 0.02 / ahead**2 + 2 * 0.04 / ahead)


def committed(flight):
    """Return the autopilot of a flight that has gone on until it descends to a window."""
    while flight.control.get("mode") != DESCEND:
        flight.to(flight.control.now + STEP)
    return flight.control


def test_a_descent_by_prediction_ends_as_the_relative_one():
    flight = swinging(heave=0.05, roll=0.02, pitch=0.02)
    flight.velocity = at_rest(0.0, 0.0, 0.2)
    control = committed(flight)
    target = control.get("window")
    assert 1.1 * math.sqrt(1.5) - STEP < target - control.now < 1.1 * math.sqrt(1.5) + T_P
    own = flight.position(0.0)[2] + 0.25
    laws_used = set()
    while control.now < target:
        at = control.now
        flight.to(at + STEP)
        if target - at > 0.15 * T_P:
            expected = control.meets(at, own, 0.2, target - at)
        else:
            deck = control.deck_at(at)
            wanted = deck[1][2] + laws.sinking(deck[0][2] - own)
            expected = 4.0 * (wanted - 0.2) + 0.7 * deck[2][2]
        laws_used.add(target - at > 0.15 * T_P)
        # No more than 0.7 of its weight does a drone let itself fall.
        assert flight.acceleration()[2] == pytest.approx(min(expected, 0.7 * 9.81), abs=1e-6)
    assert laws_used == {True, False}


def test_a_deck_that_begins_to_tilt_makes_it_go_around():
    flight = swinging(heave=0.05, roll=0.02, pitch=0.02)
    begin, level = committed(flight).now, flight.deck
    flight.deck = lambda t: level(t) + np.array([0.0, 0.5 * max(0.0, t - begin), 0.0])
    modes = [flight.to(begin + STEP * k).get("mode") for k in range(1, 25)]
    assert GO_AROUND in modes
    assert flight.control.get("window") == 0.0


def test_a_mark_that_is_lost_makes_it_track_again():
    waiting = swinging(heave=0.3)
    waiting.to(4.0)
    waiting.sees = False
    assert waiting.to(4.9).get("mode") == WAIT
    assert waiting.to(5.1).get("mode") == TRACK
