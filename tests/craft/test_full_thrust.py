"""Default variants with their actuators at the limits, without a pilot: none turns over or runs away."""

import itertools
import math

import numpy as np
import pytest

from tests.kit import needs_kits

from .references import shipped

STEP = 0.1
UPRIGHT = math.radians(75)
AHEAD, ACROSS, ROUND = (1, 1, -1, -1), (-1, 1, -1, 1), (-1, 1, 1, -1)
PATTERNS = [AHEAD, ACROSS, ROUND, (1, 1, 1, -1), (1, -1, -1, -1)]
"""Horizontal thrusters of the BlueROV2; the other corners mirror them."""
VERTICALS = (0, 1, -1)


def rov(name, variant, thrusts):
    deep = {"eta_start": (0, 0, 200, 0, 0, 0)}
    return shipped("rov", f"{name}.rov", variant, thrust=thrusts, **deep)


def bluerov2(variant, horizontal, vertical):
    orders = (*horizontal, *[vertical] * 4)
    return rov("bluerov2", variant, [30.6 * order for order in orders])


def videoray(variant, port, starboard, vertical):
    return rov("videoray", variant, [46.7 * port, 46.7 * starboard, 25.0 * vertical, *[0] * 5])


def otter(variant, *orders):
    port, starboard = (119.7 * s if s > 0 else 66.7 * s for s in orders)
    load = {"force_1": (port + starboard, 0, 0), "moment_1": (0, 0, 0.395 * (port - starboard))}
    off = {"rates_start.r": 0.01}
    return shipped("marine-craft", "otter.marine-craft", variant, **load, **off)


def driven(craft, seconds):
    """Return the largest roll or pitch, rad, and speed, m/s."""
    craft.initialise()
    craft.begin()
    tilt = speed = 0.0
    for k in range(round(seconds / STEP)):
        craft.advance(k * STEP, STEP)
        phi, theta, _ = craft.get("attitude")
        # The roll of a rov in (-pi, pi]: turned over is beyond UPRIGHT either way.
        tilt, speed = (
            max(tilt, abs(phi), abs(theta)),
            max(speed, np.hypot(*craft.get("velocity")[:2])),
        )
    return tilt, speed


@pytest.mark.parametrize("k", range(len(PATTERNS)))
def test_the_bluerov2_keeps_upright(k):
    tilt, speed = driven(bluerov2(None, PATTERNS[k], VERTICALS[k % 3]), 30)
    assert tilt < UPRIGHT
    assert speed < 2.0


@pytest.mark.long
@pytest.mark.parametrize("vertical", VERTICALS)
def test_the_bluerov2_keeps_upright_in_every_corner(vertical):
    for horizontal in itertools.product((1, -1), repeat=4):
        tilt, speed = driven(bluerov2(None, horizontal, vertical), 60)
        assert tilt < UPRIGHT, horizontal
        assert speed < 2.0, horizontal


def test_its_published_set_turns_over():
    tilt, _ = driven(bluerov2("benchmark", AHEAD, 0), 12)
    assert tilt > UPRIGHT


@needs_kits("videoray")
@pytest.mark.parametrize("orders", [(1, 1, 0), (1, 1, 1), (1, 1, -1), (1, -1, 0), (1, 0, 1)])
def test_the_videoray_keeps_upright(orders):
    tilt, speed = driven(videoray(None, *orders), 30)
    assert tilt < UPRIGHT
    assert speed < 2.5


@pytest.mark.parametrize("orders", [(1, 1), (1, 0), (1, -1), (0, -1), (-1, -1)])
def test_the_otter_goes_where_it_is_steered(orders):
    """Equal propellers keep it straight from a disturbance of 0.01 rad/s; see test_otter."""
    craft = otter(None, *orders)
    tilt, speed = driven(craft, 60)
    assert tilt < math.radians(10)
    assert speed < 1.02 * 6 * 0.514444
    turning = craft.get("rates")[2]
    wanted = np.sign(max(orders[0], -1) - orders[1])
    assert abs(turning) < 1e-4 if wanted == 0 else np.sign(turning) == wanted
