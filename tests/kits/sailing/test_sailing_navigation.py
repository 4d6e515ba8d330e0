import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from seatrial.devices.anemometer import Anemometer
from seatrial_kits.sailing.control.navigation import SailingNavigation
from tests.devices.running import started

WIND = [4.0, -2.5]
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


speeds = st.floats(-3, 3)


@given(st.floats(-4, 4), st.floats(-1.2, 1.2), st.tuples(speeds, speeds))
def test_velocity_and_true_wind_are_found_again(psi, phi, velocity):
    """All but, in the wind, v sin^2(phi) / cos(phi) abeam: the heave that is left out."""
    inputs = seen(psi, phi, velocity, WIND)
    navigation = started(SailingNavigation, **inputs, gyro=[0.1, 0.2, 0.3])
    assert navigation.get("nu") == pytest.approx([*velocity, 0.1, 0.3], rel=1e-9, abs=1e-12)
    heave = velocity[1] * math.sin(phi) ** 2 / math.cos(phi)
    expected = [WIND[0] + heave * math.sin(psi), WIND[1] - heave * math.cos(psi)]
    assert navigation.get("wind") == pytest.approx(expected, rel=1e-9, abs=1e-9)


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
