"""A rangefinder over a deck and over water, against geometry."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from seatrial_kits.drone.deck_range import DeckRange

EXACT = {"distance_noise": 0.0, "distance_resolution": 0.0}


def measured(**values):
    sensor = DeckRange("range")
    for name, value in {**EXACT, **values}.items():
        sensor.set(name, value)
    sensor.initialise()
    sensor.begin()
    return sensor.get("valid"), sensor.get("distance")


def test_a_level_drone_over_a_level_deck_and_beside_it():
    """The sensor is 0.1 m below the CG, the pad 0.2 m above the craft's origin."""
    assert measured(position=[0, 0, -3.0]) == (True, pytest.approx(2.7, abs=1e-12))
    assert measured(position=[0.637, 0.499, -3.0]) == (True, pytest.approx(2.7, abs=1e-12))
    assert measured(position=[0.639, 0.0, -3.0]) == (True, pytest.approx(2.9, abs=1e-12))
    assert measured(position=[0.0, 0.501, -3.0]) == (True, pytest.approx(2.9, abs=1e-12))


@pytest.mark.parametrize("seed", range(20))
def test_it_meets_the_plane_of_a_deck_in_any_pose(seed):
    draw = np.random.default_rng(seed)
    own, deck = draw.uniform(-0.3, 0.3, (2, 3)) + np.array([[0, 0, 1], [0, 0, 2]])
    # High over the water, which the plane of a deck would meet.
    position, origin = draw.uniform(-0.2, 0.2, (2, 3)) - np.array([[0, 0, 5], [0, 0, 3]])
    mine = Rotation.from_euler("ZYX", own[::-1]).as_matrix()
    craft = Rotation.from_euler("ZYX", deck[::-1]).as_matrix()
    sensor, axis = position + mine @ [0.05, 0.02, 0.1], mine[:, 2]
    normal, pad = craft[:, 2], origin + craft @ [0, 0, -0.2]
    expected = normal @ (pad - sensor) / (normal @ axis)
    valid, distance = measured(
        position=position.tolist(), attitude=own.tolist(), place=[0.05, 0.02, 0.1],
        deck_position=origin.tolist(), deck_attitude=deck.tolist(), deck_size=[9.0, 9.0],
    )  # fmt: skip
    assert valid
    assert distance == pytest.approx(expected, abs=1e-12)


def test_out_of_range_is_not_measured():
    assert measured(position=[0, 0, -0.35]) == (False, 0.0)  # 5 cm over the deck
    assert measured(position=[9, 0, -101.0]) == (False, 0.0)
    assert measured(position=[0, 0, -3.0], attitude=[math.pi, 0, 0]) == (False, 0.0)
    assert not measured(position=[0, 0, -3.0], attitude=[math.pi / 2, 0, 0])[0]
