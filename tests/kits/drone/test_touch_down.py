"""Figures of a landing against vectors in {n}, and each verdict at its limit."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from seatrial_kits.drone.touch_down import TouchDown
from tests.devices.running import started

HIGH = {"position": [0.0, 0.0, -2.0], "legs_down": 0.0}
STANDS = {"position": [0.0, 0.0, -0.45], "legs_down": 4.0}
FEET, PAD = 0.25, -0.2  # m, of the defaults: the CG of a drone that stands is at z = -0.45 m


def moved(component, until, h=0.5, **values):
    for name, value in values.items():
        component.set(name, value)
    while component.now < until - 1e-9:
        component.advance(component.now, h)
    return component


def touched(at=1.0, **values):
    """Return a drone that was high above the deck and touches it at ``at`` s."""
    landing = moved(started(TouchDown), at, **HIGH)
    return moved(landing, at + 0.5, **{**STANDS, **values})


@pytest.mark.parametrize("seed", range(4))
def test_figures_of_the_first_contact_at_random_poses(seed):
    draw = np.random.default_rng(seed)
    own, deck = draw.uniform(-0.4, 0.4, (2, 3))
    v, w, deck_v, deck_w, deck_place = draw.normal(size=(5, 3))
    pad, feet = draw.uniform(-0.5, 0.5, 3), draw.uniform(0.2, 0.5, 3)
    R, D = (Rotation.from_euler("ZYX", each[::-1]) for each in (own, deck))
    above = draw.uniform(0.2, 0.5, 3) * [1, -1, -1]
    place = deck_place + D.apply(pad + above)  # of the middle of the feet
    position = place - R.apply([0.0, 0.0, feet[2]])
    speed = R.apply(v) + np.cross(R.apply(w), place - position)
    speed -= D.apply(deck_v) + np.cross(D.apply(deck_w), place - deck_place)
    over = D.inv().apply(speed)
    ports = {
        "position": position, "velocity": v, "attitude": own, "rates": w, "deck_position": deck_place,
        "deck_velocity": deck_v, "deck_attitude": deck, "deck_rates": deck_w, "pad": pad, "feet": feet,
    }  # fmt: skip
    landing = started(TouchDown, **{name: value.tolist() for name, value in ports.items()})
    moved(landing, 1.0)
    assert landing.get("height") == pytest.approx(-above[2])
    assert landing.get("touch_error") == 0.0
    moved(landing, 1.5, legs_down=1.0)
    assert landing.get("touch_time") == 1.0
    assert landing.get("touch_error") == pytest.approx(math.hypot(*above[:2]))
    assert landing.get("touch_speed") == pytest.approx(over[2])
    assert landing.get("touch_aside") == pytest.approx(math.hypot(*over[:2]))
    between = R.apply([0.0, 0.0, 1.0]) @ D.apply([0.0, 0.0, 1.0])
    assert landing.get("touch_tilt") == pytest.approx(math.acos(between))
    assert landing.get("deck_tilt") == pytest.approx(math.acos(D.apply([0.0, 0.0, 1.0])[2]))
    held = [landing.get(name) for name in TouchDown._LATCHED]
    moved(landing, 2.5, position=[9.0, 9.0, -9.0], velocity=[5.0, 5.0, 5.0])
    assert [landing.get(name) for name in TouchDown._LATCHED] == held


def test_it_has_landed_four_seconds_after_it_touched():
    landing = touched(1.0)
    assert (landing.get("touched"), landing.get("landed")) == (True, 0.0)
    moved(landing, 5.0)
    assert landing.get("landed") == 0.0
    moved(landing, 5.5)
    assert (landing.get("landed"), landing.get("failure")) == (1.0, 0.0)
    assert landing.get("touch_time") == 1.0


def test_a_drone_that_takes_off_has_not_touched():
    landing = moved(started(TouchDown), 3.0, **STANDS)
    moved(landing, 4.0, position=[0.0, 0.0, -0.549])  # 0.099 m over the deck
    assert not moved(landing, 6.0, **STANDS).get("touched")
    moved(landing, 7.0, position=[0.0, 0.0, -0.551], legs_down=0.0)
    assert not landing.get("touched")
    moved(landing, 7.5, **STANDS)
    assert (landing.get("touched"), landing.get("touch_time")) == (True, 7.0)


@pytest.mark.parametrize("side", [0.99, 1.01])
@pytest.mark.parametrize(
    ("number", "values"),
    [
        (2.0, lambda share: {"position": [0.18 * share, -0.24 * share, PAD - FEET]}),
        (3.0, lambda share: {"velocity": [0.0, 0.0, 1.0 * share]}),
        (4.0, lambda share: {"velocity": [-0.36 * share, 0.48 * share, 0.0]}),
        (5.0, lambda share: {"attitude": [0.0, math.radians(12.0) * share, 2.0]}),
    ],
)
def test_a_limit_that_the_contact_misses_is_named(number, values, side):
    landing = touched(**values(side))
    assert landing.get("failure") == (number if side > 1.0 else 0.0)
    moved(landing, 5.5, velocity=[0.0] * 3)
    assert landing.get("landed") == (-1.0 if side > 1.0 else 1.0)
    assert landing.get("failure") == (number if side > 1.0 else 0.0)


@pytest.mark.parametrize(
    ("values", "landed"),
    [
        ({"position": [0.08, 0.12, PAD - FEET]}, 1.0),
        ({"position": [0.10, 0.12, PAD - FEET]}, -1.0),
        ({"attitude": [math.radians(14.9), 0.0, 0.0]}, 1.0),
        ({"attitude": [math.radians(15.1), 0.0, 0.0]}, -1.0),
        ({"legs_down": 0.0}, -1.0),
    ],
)
def test_it_has_to_rest_where_it_touched(values, landed):
    landing = moved(touched(1.0), 5.5, **values)
    assert landing.get("landed") == landed
    assert landing.get("failure") == (0.0 if landed > 0 else 6.0)
    # From the origin of the deck it may be farther away: the way counts from the contact.
    away = touched(1.0, position=[0.1, 0.2, PAD - FEET])
    assert moved(away, 5.5, position=[0.2, 0.1, PAD - FEET]).get("landed") == 1.0


def test_without_contact_by_the_time_limit_it_has_not_landed():
    landing = TouchDown("late")
    landing.set("time_limit", 10.0)
    landing.set("position", HIGH["position"])
    landing.setup(5.0)
    landing.initialise()
    landing.begin()
    moved(landing, 15.0)
    assert landing.get("landed") == 0.0
    moved(landing, 15.5)
    assert (landing.get("landed"), landing.get("failure")) == (-1.0, 1.0)
    assert (landing.get("touched"), landing.get("touch_time")) == (False, 0.0)


def test_energy_until_the_contact_and_the_largest_load():
    landing = moved(started(TouchDown), 2.0, power=300.0, load=40.0, **HIGH)
    moved(landing, 3.0, power=100.0, load=90.0)
    moved(landing, 3.5, **STANDS, load=70.0)
    moved(landing, 6.0, power=500.0, load=60.0)
    # The step in which it touches counts as before it.
    assert landing.get("energy") == pytest.approx(300.0 * 2.0 + 100.0 * 1.5)
    assert landing.get("peak_load") == 90.0
