"""Allocation: what the thrusters make of the commands is what was asked for."""

import numpy as np
import pytest

from seatrial.devices.actuators.propulsion import Propulsion
from seatrial_kits.videoray.vessel.thruster_allocation import ThrusterAllocation
from tests.devices.running import started


def commands(**wanted):
    component = started(ThrusterAllocation, **wanted)
    return [component.get(name) for name in ("port", "starboard", "vertical")]


def load(port, starboard, vertical):
    """Return force and moment of thrusters placed as the allocation has them."""
    propulsion = started(
        Propulsion,
        position_1=[0.0, -0.1, 0.0],
        position_2=[0.0, 0.1, 0.0],
        direction_1=[1, 0, 0],
        direction_2=[1, 0, 0],
        direction_3=[0, 0, 1],
        thrust=[46.7 * port, 46.7 * starboard, 25.0 * vertical, *[0.0] * 13],
    )
    return np.array([*propulsion.get("force"), *propulsion.get("moment")])


@pytest.mark.parametrize(
    ("surge", "moment", "heave"), [(20.0, 0.0, 0.0), (0.0, 3.0, -7.0), (-30.0, -2.0, 24.0)]
)
def test_what_fits_is_given(surge, moment, heave):
    given = load(*commands(surge=surge, yaw_moment=moment, heave=heave))
    np.testing.assert_allclose(given, [surge, 0, heave, 0, 0, moment], atol=1e-12)


@pytest.mark.parametrize("ahead", [1, -1])
@pytest.mark.parametrize("side", [1, -1])
def test_the_moment_comes_first(ahead, side):
    given = load(*commands(surge=ahead * 1e3, yaw_moment=side * 3.0))
    np.testing.assert_allclose(given[5], side * 3.0, rtol=1e-12)
    np.testing.assert_allclose(given[0], ahead * 2 * (46.7 - 3.0 / 0.2), rtol=1e-12)


def test_no_command_is_beyond_1():
    for wanted in (1e6, -1e6):
        found = commands(surge=wanted, yaw_moment=wanted, heave=wanted)
        assert max(map(abs, found)) == 1.0
        assert found == [np.sign(wanted), -np.sign(wanted), np.sign(wanted)]
