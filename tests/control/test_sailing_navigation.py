import math

import pytest

from seatrial.control.sailing_navigation import SailingNavigation
from seatrial.devices.anemometer import Anemometer
from tests.devices.running import started

IDEAL = {
    **dict.fromkeys(("speed_noise", "speed_resolution"), 0.0),
    **dict.fromkeys(("angle_noise", "angle_instability", "angle_resolution"), 0.0),
}


def seen(psi, phi, velocity, wind):
    """Return what ideal sensors give the navigation of a boat's motion and the wind."""
    u, v = velocity
    c, s = math.cos(psi), math.sin(psi)
    over_ground = [c * u - s * v * math.cos(phi), s * u + c * v * math.cos(phi), 0.0]
    vane = started(
        Anemometer, **IDEAL, wind=wind, attitude=[phi, 0, psi], velocity=[u, v, 0], rates=[0] * 3
    )
    apparent = [vane.get("speed"), vane.get("angle")]
    return {"velocity_n": over_ground, "heading": psi, "heel": phi, "apparent_wind": apparent}


@pytest.mark.parametrize(
    ("psi", "phi", "velocity"),
    [(0.0, 0.0, (2.0, 0.0)), (2.1, 0.0, (1.5, -0.2)), (-1.0, 0.5, (2.0, 0.0)), (3.0, -0.7, (1, 0))],
)
def test_true_wind_and_velocity_are_found_again(psi, phi, velocity):
    wind = [4.0, -2.5]
    navigation = started(SailingNavigation, **seen(psi, phi, velocity, wind), gyro=[0.1, 0.2, 0.3])
    assert navigation.get("wind") == pytest.approx(wind, rel=1e-12)
    assert navigation.get("nu") == pytest.approx([*velocity, 0.1, 0.3], rel=1e-12, abs=1e-15)


def test_leeway_of_a_heeled_boat_costs_its_vertical_part_only():
    """v sin^2(phi) / cos(phi): the heave that four degrees of freedom leave out."""
    inputs = seen(0.0, 0.5, (2.0, 0.1), [4.0, -2.5])
    navigation = started(SailingNavigation, **inputs)
    error = 0.1 * math.sin(0.5) ** 2 / math.cos(0.5)
    assert navigation.get("wind") == pytest.approx([4.0, -2.5 - error], rel=1e-12)


def test_wind_follows_with_a_first_order_lag_from_its_first_value():
    navigation = started(SailingNavigation, time_constant=2.0, apparent_wind=[5.0, 0.0])
    assert navigation.get("wind") == [5.0, 0.0]
    navigation.advance(0.0, 0.02)
    navigation.set("apparent_wind", [9.0, 0.0])
    for k in range(1, 51):
        navigation.advance(0.02 * k, 0.02)
    # 51 instants since: what they have seen is 51 periods of the lag.
    assert navigation.get("wind")[0] == pytest.approx(9.0 - 4.0 * math.exp(-1.02 / 2.0), rel=1e-9)


def test_without_a_valid_velocity_the_wind_stays():
    navigation = started(SailingNavigation, velocity_valid=False, apparent_wind=[5.0, 0.0])
    assert navigation.get("wind") == [0.0, 0.0]
    navigation.set("velocity_valid", True)
    assert navigation.get("wind") == [5.0, 0.0]
    navigation.advance(0.0, 0.02)
    navigation.set("velocity_valid", False)
    navigation.set("apparent_wind", [1.0, 1.0])
    assert navigation.get("wind") == [5.0, 0.0]
