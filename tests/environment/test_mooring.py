"""The mooring line against the damped oscillator, and its end."""

import math

import pytest

from seatrial.physics.environment.mooring import Mooring
from tests.devices.running import started

MASS, STIFFNESS, DAMPING, STEP = 20.0, 50.0, 12.0, 1e-3


def swung(force, seconds, **values):
    """Push a mass on the line from rest with a force north, N; return its place, m."""
    line = started(Mooring, stiffness=STIFFNESS, damping=DAMPING, armed=False, **values)
    place = speed = 0.0
    for k in range(round(seconds / STEP)):
        line.set("point", [7.0 + place, -3.0, 0.4])
        line.set("velocity", [speed, 0.0, 0.1])
        line.advance(k * STEP, STEP)
        pull = line.get("force")
        assert pull[1:] == [0.0, 0.0]  # no force on what does not move, and none down
        speed += STEP * (force + pull[0]) / MASS
        place += STEP * speed
    return place


@pytest.mark.parametrize("seconds", [0.7, 2.0, 4.0])
def test_a_push_swings_it_as_an_oscillator(seconds):
    omega, zeta = math.sqrt(STIFFNESS / MASS), DAMPING / (2 * math.sqrt(STIFFNESS * MASS))
    damped = omega * math.sqrt(1 - zeta**2)
    decay = math.exp(-zeta * omega * seconds)
    swing = math.cos(damped * seconds) + zeta * omega / damped * math.sin(damped * seconds)
    expected = 5.0 / STIFFNESS * (1 - decay * swing)
    assert swung(5.0, seconds) == pytest.approx(expected, abs=2e-4)  # of steps of 1 ms


def test_it_pulls_back_and_resists_on_both_axes():
    line = started(
        Mooring, stiffness=STIFFNESS, damping=DAMPING, armed=False, point=[7.0, -3.0, 0.4]
    )
    line.advance(0.0, STEP)
    line.set("point", [7.3, -3.8, 0.9])
    line.set("velocity", [0.2, 0.5, 1.0])
    expected = [-STIFFNESS * 0.3 - DAMPING * 0.2, STIFFNESS * 0.8 - DAMPING * 0.5, 0.0]
    assert line.get("force") == pytest.approx(expected)


def test_it_is_cast_off_for_good_when_the_autopilot_is_armed():
    line = started(Mooring, stiffness=STIFFNESS, armed=False, point=[1.0, 2.0, 0.0])
    line.advance(0.0, 0.1)
    line.set("point", [2.0, 2.0, 0.0])
    line.advance(0.1, 0.1)
    assert (line.get("force"), line.get("holds")) == ([-STIFFNESS, 0.0, 0.0], True)
    for k, armed in enumerate((True, False), 2):
        line.set("armed", armed)
        line.advance(0.1 * k, 0.1)
        assert (line.get("force"), line.get("holds")) == ([0.0, 0.0, 0.0], False)


def test_without_an_autopilot_or_stiffness_there_is_no_line():
    for values in ({"stiffness": STIFFNESS}, {"armed": False}):
        line = started(Mooring, **values)
        line.advance(0.0, 0.1)
        line.set("point", [2.0, 2.0, 0.0])
        line.advance(0.1, 0.1)
        assert (line.get("force"), line.get("holds")) == ([0.0, 0.0, 0.0], False)
