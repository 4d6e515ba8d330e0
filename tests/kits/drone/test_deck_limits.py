"""Forces on the landing gear of a drone that is carried, and immersion of the bow: closed forms."""

import math

import pytest

from seatrial_kits.drone.deck_limits import DeckLimits

G = 9.81


def deck(**values):
    made = DeckLimits("deck")
    for name, value in {"bow": [0.638, 0, 0], **values}.items():
        made.set(name, value)
    made.setup(0.0)
    made.initialise()
    made.begin()
    return made


def test_on_a_deck_that_heels_the_gear_carries_the_weight_across_and_along():
    at = deck(attitude=[math.radians(14.0), 0, 0.7])
    assert at.gear_force == pytest.approx(
        (0.0, -98.1 * math.sin(math.radians(14)), -98.1 * math.cos(math.radians(14)))
    )
    # [Timm2026], eq. 77: 24 % of the weight at 14 degrees.
    assert at.lateral_share == pytest.approx(0.2419, abs=1e-4)
    assert at.sliding == pytest.approx(math.tan(math.radians(14.0)) / 0.6)
    assert at.tipping == pytest.approx(math.tan(math.radians(14.0)) * 0.25 / 0.2)


@pytest.mark.parametrize("share", ["sliding", "tipping"])
def test_it_slides_and_tips_at_the_angles_of_friction_and_legs(share):
    angle = math.atan(0.6 if share == "sliding" else 0.2 / 0.25)
    assert getattr(deck(attitude=[0, angle, 0]), share) == pytest.approx(1.0)


def test_angular_acceleration_pushes_what_stands_above_the_axis():
    # Eq. 77: m (g sin(phi) + phi'' z_pad), z_pad = -0.2 m: it falls away to the other side.
    at = deck(pad=[0, 0, -0.2], rates=[0.1, 0, 0])
    at.step(0.0, 0.01)
    at.set("rates", [0.1 + 3.0 * 0.01, 0, 0])
    at.outputs(0.01)
    rolling = 0.2 * 3.0
    whirl = -0.2 * 0.13**2
    assert at.gear_force[1] == pytest.approx(10.0 * rolling)
    assert at.gear_force[2] == pytest.approx(-10.0 * (G + whirl), rel=1e-9)


def test_a_turning_deck_throws_outwards():
    at = deck(pad=[0.3, 0, 0], rates=[0, 0, 2.0])
    assert at.gear_force[0] == pytest.approx(-10.0 * 0.3 * 4.0)
    assert at.lateral_share == pytest.approx(0.3 * 4.0 / G)


@pytest.mark.parametrize(
    "values", [{"on_deck": False}, {"acceleration": [0.0, 2.0, G + 0.1]}], ids=["flies", "falls"]
)
def test_without_weight_on_the_legs_there_is_no_limit(values):
    at = deck(attitude=[0.2, 0, 0] if "on_deck" in values else [0, 0, 0], **values)
    assert at.gear_force == (0.0, 0.0, 0.0)
    assert (at.lateral_share, at.sliding, at.tipping) == (0.0, 0.0, 0.0)


def test_the_bow_goes_down_by_pitch_and_sinkage():
    # [Timm2026], eq. 73: 0.638 m sin(7 degrees) = 7.8 cm.
    at = deck(attitude=[0, math.radians(-7.0), 1.0])
    assert at.bow_immersion == pytest.approx(0.0778, abs=1e-4)
    sunk = deck(attitude=[0, math.radians(-7.0), 1.0], position=[5, 5, 0.02])
    assert sunk.bow_immersion == pytest.approx(at.bow_immersion + 0.02)
