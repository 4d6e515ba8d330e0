"""Waves at the parts of a craft, against Airy's formulas in deep water."""

import math

import numpy as np
import pytest

from seatrial.physics.craft.around import Places, WavesAtParts
from seatrial.physics.sea.orbital import Orbital
from seatrial.physics.sea.waves import regular
from tests.kits.fitted.fitting import craft

HEIGHT, PERIOD = 1.2, 4.0
OMEGA = 2 * math.pi / PERIOD
K = OMEGA**2 / 9.81
PLACES = Places(0, 1, 2, 5, 6, 7)
AT, TURNED = np.array([1.0, 2.0, 3.0]), 0.3


def airy(x, z):
    """Return the velocity north and down at t = 0 of a wave to the north, drawn to the surface."""
    elevation = HEIGHT / 2 * math.cos(K * x)
    speed = HEIGHT / 2 * OMEGA * math.exp(-K * max(z + elevation, 0.0))
    return np.array([speed * math.cos(K * x), 0.0, -speed * math.sin(K * x)])


def ahead(place):
    """Return where a place of the craft is in {n}."""
    cos, sin = math.cos(TURNED), math.sin(TURNED)
    across = sin * place[0] + cos * place[1]
    return AT + np.array([cos * place[0] - sin * place[1], across, place[2]])


@pytest.mark.parametrize("place", [(0, 0, 2.0), (-12.5, 0, 0.5), (6, -3, -1.0), (0, 8, -5.0)])
@pytest.mark.parametrize("carried", [True, False])
def test_each_part_meets_the_waves_where_it_is(place, carried):
    orbital = Orbital(regular(HEIGHT, PERIOD, 0.0))
    parts = WavesAtParts(orbital, (3,), np.array([place]), 16)
    own = orbital.at(0.0, *AT)[1][:3] if carried else np.zeros(3)
    met = parts.at(0.0, np.array([*AT, 0, 0, TURNED, *[0] * 6]), PLACES, own)
    assert not met[[0, 2, 4, 15]].any()
    origin = airy(AT[0], AT[2]) if carried else 0.0
    x, _, z = ahead(place)
    np.testing.assert_allclose(met[3], airy(x, z) - origin, atol=1e-12)


@pytest.mark.parametrize("place", [(0, 0, 2.0), (-12.5, 0, 0.5), (6, -3, -1.0)])
@pytest.mark.parametrize("slot", [1, 3])
def test_thrust_fades_in_the_waves_at_the_propulsor(place, slot):
    # A tunnel loses (u / u_0)^2 of its thrust, u along the bow. Those before it are elsewhere.
    part = craft(
        propulsors=" ".join(["tunnel"] * slot),
        **{
            f"propulsor_{key}_{k}": value
            for k in range(1, slot + 1)
            for key, value in {
                "position": place if k == slot else (3.0 * k, 0, 4.0),
                "axis": (0, 1, 0),
                "thrust": (30.0, 30.0),
                "fading_speed": 2.0,
            }.items()
        },
        propulsor_order=[float(k == slot) for k in range(1, 9)],
        position_start=AT,
        attitude_start=(0, 0, TURNED),
        sea_spectrum="regular",
        sea_height=HEIGHT,
        sea_period=PERIOD,
    )
    part.initialise()
    x, _, z = ahead(place)
    u = math.cos(TURNED) * airy(x, z)[0]
    assert part.get("propulsor_force")[slot - 1] == pytest.approx(30 * (1 - (u / 2) ** 2), rel=1e-9)


def test_a_craft_on_long_waves_feels_no_difference():
    # 0.1 m are a ten-thousandth of the wave: the difference is k r of the velocity at most.
    shares = []
    for period in (10.0, 20.0):
        orbital = Orbital(regular(1.0, period, 0.0))
        parts = WavesAtParts(orbital, (0,), np.array([[0.1, 0, 0]]), 16)
        own = orbital.at(1.0, 0.0, 0.0, 5.0)[1][:3]
        met = parts.at(1.0, np.array([0, 0, 5.0, *[0] * 9]), PLACES, own)[0]
        shares.append(np.linalg.norm(met) / (math.pi / period))
    assert shares[0] < 0.1 * (2 * math.pi / 10.0) ** 2 / 9.81
    assert shares[1] < shares[0]
