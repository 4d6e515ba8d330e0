"""Orders of the landing autopilot against the laws of its specification, and its states."""

import math

import numpy as np
import pytest

from tests.kits.drone.deck_flight import Flight, H, Swing, at_rest

TRACK, WAIT, DESCEND, LANDED, GO_AROUND, ABORT = 3.0, 4.0, 5.0, 6.0, 7.0, 8.0
FEET = 0.25  # m, below the CG


def over_the_pad(height, away, v, **values):
    """Return a flight ``away`` from a pad at rest, m, {n}, whose drone moves with ``v`` at last."""
    flight = Flight(**{"settle": 0.0, **values})
    flight.pad = at_rest(4.0, -3.0, -0.2)
    flight.position = at_rest(4.0 - away[0], -3.0 - away[1], -0.2 - FEET - height)
    flight.velocity = at_rest(*v)
    return flight


@pytest.mark.parametrize("control", ["naive", "relative"])
@pytest.mark.parametrize("seed", range(4))
def test_orders_of_a_descent(control, seed):
    draw = np.random.default_rng(seed)
    away, v = draw.uniform(-0.2, 0.2, 2), draw.uniform(-0.3, 0.3, 3)
    height = draw.uniform(0.7, 1.5)
    flight = over_the_pad(height, away, v, control=control, mass=7.0)
    flight.attitude = at_rest(*draw.uniform(-0.3, 0.3, 3))
    control = flight.to(0.02)
    assert control.get("mode") == DESCEND
    assert control.get("error") == pytest.approx(math.hypot(*away))
    assert control.get("height") == pytest.approx(height)
    # The integral has two instants; the radio says that the deck is at rest.
    wanted = 3.0 * away - 3.4 * v[:2] + 1.5 * away * 2 * H
    fall = 0.4 if control.control == "naive" else min(0.4 + 0.3 * (height - 0.5), 0.8)
    np.testing.assert_allclose(flight.acceleration(), [*wanted, 4.0 * (fall - v[2])], atol=1e-6)


@pytest.mark.parametrize("settle", [0.0, 10.0])
def test_a_deck_that_moves_is_fed_forward(settle):
    swing = Swing((0.0, 0.0, 0.0), (0.2, -0.3, 0.1), (0.15, 0.1, -0.2), period=4.0)
    flight = Flight(settle=settle, wave_period=4.0)
    flight.pad = swing.place
    flight.pad_velocity = flight.velocity = swing.velocity
    flight.position = lambda t: flight.pad(t) - [0.1, -0.05, 1.0 + FEET]
    flight.deck = at_rest(0.0, 0.0, 0.4)
    flight.to(4.0)
    slip = np.array([0.3, 0.2, -0.25])
    flight.velocity = lambda t: swing.velocity(t) + slip
    control = flight.to(4.01)
    deck, a, _ = swing.derivatives(4.0)
    aside = 3.0 * np.array([0.1, -0.05]) - 3.4 * slip[:2] + 1.5 * np.array([0.1, -0.05]) * 401 * H
    aside += swing.derivatives(4.2)[1][:2]
    down = 4.0 * (0.4 + 0.3 * 0.5 - slip[2]) + 0.7 * a[2]
    if settle:
        # Track: to the height above the mean of the pad, over the samples that there are.
        level = np.mean([swing.place(4.0 / 14 * n)[2] for n in range(15)]) - 2.0
        climb = max(-1.5, min(level - (flight.pad(4.0)[2] - 1.0), 1.0))
        down = 2.5 * (climb - (deck[2] + slip[2]))
    np.testing.assert_allclose(flight.acceleration(), [*aside, down], atol=0.02)
    assert control.get("mode") == (TRACK if settle else DESCEND)
    assert control.get("attitude_wanted")[2] == 0.4


@pytest.mark.parametrize("away", [(0.2, -0.15), (0.004, 0.003)])
def test_near_the_deck_it_hardly_tilts(away):
    flight = over_the_pad(0.3, away, (0.1, -0.2, 0.0))
    flight.to(0.01)
    more = 3.0 * np.array(away) - 3.4 * np.array([0.1, -0.2])
    more *= min(1.0, 9.81 * (0.06 + 0.7 * 0.2) / np.hypot(*more))
    expected = more + 1.5 * H * np.array(away)
    np.testing.assert_allclose(flight.acceleration()[:2], expected, atol=1e-6)


def test_it_tracks_for_as_long_as_it_has_to_settle():
    flight = over_the_pad(2.0, (0.0, 0.0), (0.0, 0.0, 0.0), settle=1.0)
    assert flight.to(1.0).get("mode") == TRACK
    assert flight.to(1.02).get("mode") == DESCEND
    astray = over_the_pad(2.0, (0.19, 0.24), (0.0, 0.0, 0.0), settle=1.0)
    assert astray.to(2.0).get("mode") == TRACK  # 0.306 m away
    unseen = over_the_pad(2.0, (0.0, 0.0), (0.0, 0.0, 0.0), settle=1.0)
    unseen.to(0.4)
    unseen.sees = False
    assert unseen.to(2.0).get("mode") == TRACK


def test_motors_are_off_once_the_legs_have_carried_for_a_while():
    flight = over_the_pad(0.0, (0.0, 0.0), (0.0, 0.0, 0.0))
    flight.load = 9.0  # a tenth of the weight is 9.81 N
    assert flight.to(1.0).get("motors") is True
    flight.load = 10.5
    assert flight.to(1.05).get("mode") == DESCEND
    control = flight.to(1.07)
    assert control.get("mode") == LANDED
    assert (control.get("motors"), control.get("thrust")) == (False, 0.0)
    assert control.get("attitude_wanted") == [0.0, 0.0, 0.0]


@pytest.mark.parametrize(("again", "lands"), [(1.4, 1.6), (1.55, 2.15)])
def test_a_bounce_counts_on_for_half_a_second(again, lands):
    flight = over_the_pad(0.0, (0.0, 0.0), (0.0, 0.0, 0.0), legs_time=0.6)
    flight.to(1.0)
    flight.load = 20.0
    flight.to(1.03)
    flight.load = 0.0
    flight.to(again)
    flight.load = 20.0
    assert flight.to(lands).get("mode") == DESCEND
    assert flight.to(lands + 0.02).get("mode") == LANDED


@pytest.mark.parametrize(("height", "mode"), [(0.48, DESCEND), (0.52, GO_AROUND)])
def test_a_mark_that_is_lost_above_half_a_metre_makes_it_go_around(height, mode):
    flight = over_the_pad(height, (0.0, 0.0), (0.0, 0.0, 0.0))
    flight.to(1.01)
    flight.sees = False
    assert flight.to(2.0).get("mode") == DESCEND
    control = flight.to(2.02)
    assert control.get("mode") == mode
    assert control.get("go_arounds") == (1.0 if mode == GO_AROUND else 0.0)


@pytest.mark.parametrize(
    ("height", "away", "mode"),
    [
        (0.32, 0.48, DESCEND),
        (0.32, 0.52, GO_AROUND),
        (0.29, 0.52, DESCEND),
        (0.29, 0.72, GO_AROUND),  # its feet would miss the deck
    ],
)
def test_a_drone_astray_goes_around_unless_its_feet_meet_the_deck(height, away, mode):
    flight = over_the_pad(height, (0.1, 0.1), (0.0, 0.0, 0.0), astray=0.7)
    flight.to(0.5)
    flight.position = at_rest(4.0, -3.0 - away, -0.2 - FEET - height)
    assert flight.to(0.52).get("mode") == mode
    low = over_the_pad(height, (0.1, 0.1), (0.0, 0.0, 0.0))
    low.load = 50.0
    low.control.set("legs_load", 50.0)
    low.to(0.03)
    low.position = flight.position
    assert low.to(0.05).get("mode") == DESCEND  # it stands, or is about to


def test_it_climbs_to_its_hover_and_tracks_again_until_it_gives_up():
    flight = over_the_pad(1.0, (0.0, 0.0), (0.0, 0.0, 0.0), attempts=2.0, settle=0.5)
    hover = flight.position(0.0)
    low, astray, high = hover, hover + np.array([0.6, 0.0, 0.0]), hover - [0.0, 0.0, 0.71]
    modes = []
    for place, until in (
        (low, 1.0), (astray, 1.1), (low, 1.5), (high, 1.6), (high, 2.2), (astray, 2.3), (low, 5.0)
    ):  # fmt: skip
        flight.position = at_rest(*place)
        modes.append(flight.to(until).get("mode"))
    assert modes == [DESCEND, GO_AROUND, GO_AROUND, TRACK, DESCEND, ABORT, ABORT]
    assert flight.control.get("go_arounds") == 2.0
    # It holds where it was an instant before it gave up, 2 m over the pad: 1 m higher.
    away = np.array([0.2, -0.1])
    flight.position = at_rest(*(low - [*away, 0.0]))
    flight.to(5.01)
    # The integral has been 0.6 m astray for 0.2 s.
    expected = 3.0 * away + 1.5 * (np.array([-0.12, 0.0]) + away * H)
    np.testing.assert_allclose(flight.acceleration(), [*expected, 2.5 * -1.0], atol=1e-6)


def test_before_it_sees_the_pad_it_stays_where_it_began():
    flight = Flight(waypoint=[0.0, 0.0])
    flight.sees = flight.reports = False
    flight.position, flight.attitude = at_rest(5.0, -7.0, -3.0), at_rest(0.0, 0.0, 1.1)
    assert flight.control.get("attitude_wanted") == [0.0, 0.0, 0.0]
    flight.to(0.01)
    flight.position = at_rest(5.3, -7.4, -3.2)
    flight.velocity = at_rest(0.2, -0.1, 0.3)
    control = flight.to(0.02)
    away = np.array([-0.3, 0.4])
    expected = 3.0 * away - 3.4 * np.array([0.2, -0.1]) + 1.5 * away * H
    np.testing.assert_allclose(flight.acceleration(), [*expected, 2.5 * (0.2 - 0.3)], atol=1e-6)
    assert control.get("mode") == TRACK
    assert control.get("attitude_wanted")[2] == pytest.approx(1.1)


def test_it_takes_off_flies_out_and_comes_back():
    out = np.array([20.0, -10.0])
    flight = Flight(starts_from="deck", waypoint=out.tolist(), settle=0.0, hover_height=3.0)
    start = np.array([2.0, 1.0, -0.45])
    flight.sees = flight.reports = False
    modes = []

    def at(north, east, up, until):
        flight.position = at_rest(start[0] + north, start[1] + east, start[2] - up)
        modes.append(flight.to(until).get("mode"))

    at(0.0, 0.0, 0.0, 0.1)
    # It rises to its hover height over where its feet stood, at 1.5 m/s.
    np.testing.assert_allclose(flight.acceleration(), [0.0, 0.0, 2.5 * -1.5], atol=1e-6)
    at(0.0, 0.0, 2.69, 0.2)
    at(0.0, 0.0, 2.71, 0.3)
    # 2 m of the way count.
    flight.to(0.31)
    wanted = 3.0 * 2.0 * out / np.hypot(*out)
    tilted = flight.acceleration()
    assert tilted[:2] @ wanted == pytest.approx(np.hypot(*tilted[:2]) * np.hypot(*wanted))
    assert np.hypot(*tilted[:2]) == pytest.approx(
        min(6.0, (9.81 - tilted[2]) * math.tan(0.40)), rel=1e-6
    )
    assert tilted[2] == pytest.approx(2.5 * (3.0 - 2.71) * -1.0, abs=1e-6)
    at(19.5, -10.9, 3.0, 0.4)  # 1.03 m away
    at(19.5, -9.2, 3.0, 0.5)  # 0.94 m
    at(0.9, 0.5, 3.0, 0.6)
    at(0.5, 0.8, 3.0, 0.7)
    assert modes == [1.0, 1.0, 2.0, 2.0, 2.0, 2.0, TRACK]
