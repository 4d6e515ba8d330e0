"""Drawn decks beside means over their own rectangle, and gusts beside their recursion."""

import math

import numpy as np
import pytest

from seatrial_kits.drone.low_altitude_wind import LowAltitudeWind
from seatrial_kits.drone.prescribed_deck import PrescribedDeck
from seatrial_kits.drone.wave_follower import drawn, moved, period_of
from tests.devices.running import over, started

SIZE, HEIGHT, PERIOD, DIRECTION = (3.1, 1.7, 0.24), 0.6, 3.5, 2.3


def follower(seed=3, size=SIZE, direction=DIRECTION):
    return drawn(size, HEIGHT, PERIOD, direction, 0.3, np.random.default_rng(seed))


def test_the_waves_have_the_energy_and_shape_of_jonswap():
    omega, amplitude, phase = np.array(follower().components).T[:3]
    peak = math.tau / PERIOD
    assert np.sum(amplitude**2) / 2 == pytest.approx((HEIGHT / 4) ** 2, rel=1e-12)
    width = 3.5 * peak / 60
    assert (np.floor((omega - 0.5 * peak) / width) == np.arange(60)).all()  # one in each bin
    ratio = omega / peak
    bump = np.exp(-((ratio - 1) ** 2) / (2 * np.where(ratio > 1, 0.09, 0.07) ** 2))
    density = ratio**-5 * np.exp(-1.25 * ratio**-4) * 3.3**bump
    np.testing.assert_allclose(amplitude**2 / density, amplitude[0] ** 2 / density[0], rtol=1e-9)
    assert ((phase >= 0) & (phase < math.tau)).all()
    assert np.ptp(phase) > 5.0


@pytest.mark.parametrize("direction", [0.0, 0.7, math.pi / 2, DIRECTION])
def test_a_raft_is_moved_by_the_mean_over_its_length_and_breadth(direction):
    nodes, weights = np.polynomial.legendre.leggauss(40)
    x, y = 0.5 * SIZE[0] * nodes[:, None], 0.5 * SIZE[1] * nodes
    share = weights[:, None] * weights / 4
    for omega, _, _, *found in follower(direction=direction).components[::7]:
        k = omega**2 / 9.81
        c, s = math.cos(direction), math.sin(direction)
        # The wave exp(-i k (x cos + y sin)): heave is its mean, slopes those of the best plane.
        wave = math.exp(-k * SIZE[2]) * np.exp(-1j * k * (x * c + y * s))
        heave = (share * wave).sum()
        slopes = [(share * wave * z).sum() / (share * z**2).sum() for z in (x, y)]
        expected = [heave.real, -slopes[0].imag, -slopes[1].imag, c * heave.real, s * heave.real]
        np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-12)


def test_a_small_raft_is_a_particle_of_the_sea_that_it_names():
    deck = started(
        PrescribedDeck, size=(1e-4, 1e-4, 0.0), wave_height=HEIGHT, wave_period=PERIOD,
        wave_direction=DIRECTION, pad_height=0.3, seed=4.0,
    )  # fmt: skip
    sea = deck.sea()
    for t in (0.0, 1.0, 2.5):
        if t > deck.now:
            deck.advance(deck.now, t - deck.now)
        at = sea.motion(t, [0.0, 0.0, 0.0], stretched=False)
        phi, theta, psi = deck.get("attitude")
        np.testing.assert_allclose([math.tan(theta), math.tan(-phi)], at.slope, atol=1e-3)
        # Cosines become sines: displacement is the velocity a quarter of a period later.
        later = sea.phases(t, [0.0, 0.0])
        along = np.sum(sea.amplitude * np.sin(later) * np.exp(1j * sea.direction))
        pad = deck.get("pad_position")
        foot = [along.real - 0.3 * math.sin(theta), along.imag + 0.3 * math.sin(phi)]
        down = -at.elevation - 0.3 * math.cos(theta) * math.cos(phi)
        np.testing.assert_allclose(pad, [*foot, down], atol=1e-6)
        assert psi == 0.0
        assert deck.get("period") == PERIOD


def test_rates_are_those_of_the_motion():
    components, t, h = follower().components, 7.0, 1e-5
    values, rates = moved(components, t)
    late, early = (np.array(moved(components, t + s)[0]) for s in (h, -h))
    np.testing.assert_allclose(rates, (late - early) / (2 * h), atol=1e-8)
    assert min(map(abs, values)) > 1e-4


def test_a_period_that_is_not_given_has_a_steepness_of_one_in_25():
    assert math.tau * HEIGHT / (9.81 * period_of(HEIGHT) ** 2) == pytest.approx(0.04)


@pytest.mark.parametrize("by", ["value", "seed"])
def test_gusts_have_their_recursion_along_across_and_down(by):
    W, h = 6.0, 0.5
    wind = started(
        LowAltitudeWind, mean_speed=W, direction=2.2, direction_by=by, period=h,
        vertical_share=0.7, seed=6.0,
    )  # fmt: skip
    found = over(wind, ["velocity"], h, [{}] * 30)
    shape = 0.177 + 0.000823 * 20  # MIL-F-8785C at 20 ft
    sigma = 0.1 * W * np.array([shape**-0.4, shape**-0.4, 0.7])
    length = 20 * 0.3048 * np.array([shape**-1.2, shape**-1.2, 1.0])
    kept, gust = np.exp(-W * h / length), None
    to = 2.2 if by == "value" else math.tau * wind.generator(0, 1).random()
    for k, velocity in enumerate(found):
        fresh = sigma * wind.generator(k).normal(size=3)
        gust = fresh if gust is None else kept * gust + np.sqrt(1 - kept**2) * fresh
        across = (W + gust[0] + 1j * gust[1]) * np.exp(1j * to)
        np.testing.assert_allclose(velocity, [across.real, across.imag, gust[2]], rtol=1e-9)
