"""Nomoto's model found from zig-zags made by exact integration of its equation."""

import math

import numpy as np
import pytest

from seatrial.errors import InputError
from seatrial_kits.sea_trials.figures.nomoto import nomoto
from seatrial_kits.sea_trials.figures.record import Record

GAIN, LAG, OFFSET = 0.155, 80.5, math.radians(0.5)
RATE, STEP = math.radians(2.34), 0.05
LENGTH, SPEED = 320.0, 8.0


def exact_step(psi, r, helm, slope, h):
    """Solve T r' + r = K (helm + slope t + delta_0) over h: returns heading and rate."""
    decay = math.exp(-h / LAG)
    level, ramp = GAIN * (helm + OFFSET - slope * LAG), GAIN * slope
    after = level + ramp * h + (r - level) * decay
    return psi + level * h + ramp * h * h / 2.0 + (r - level) * LAG * (1.0 - decay), after


def made_zig_zag(duration=900.0):
    """Return time, heading and helm of a 10/10 zig-zag at 1 Hz."""
    psi = r = helm = 0.0
    angle = math.radians(10.0)
    order, rows = angle, []
    for n in range(round(duration / STEP) + 1):
        if n % 20 == 0:
            rows.append((n * STEP, psi, helm))
        if psi * math.copysign(1.0, order) >= angle:
            order = -order
        moved = min(max(order - helm, -RATE * STEP), RATE * STEP)
        psi, r = exact_step(psi, r, helm, moved / STEP, STEP)
        helm += moved
    return np.array(rows).T


@pytest.fixture(scope="module")
def zig_zag():
    return made_zig_zag()


def record(zig_zag, noise=0.0, seed=0):
    time, heading, helm = zig_zag
    error = noise * np.random.default_rng(seed).standard_normal(len(time))
    return Record(time, SPEED * time, 0.0 * time, heading + error, helm)


def test_without_noise_it_is_exact_to_a_thousandth(zig_zag):
    found = nomoto(record(zig_zag))
    values = found.K, found.T, found.delta_0
    assert values == pytest.approx((GAIN, LAG, OFFSET), rel=1e-3)
    assert found.residual < math.radians(0.03)


def test_mirrored_the_offset_changes_sign(zig_zag):
    time, heading, helm = zig_zag
    found = nomoto(Record(time, SPEED * time, 0.0 * time, -heading, -helm))
    values = found.K, found.delta_0
    assert values == pytest.approx((GAIN, -OFFSET), rel=1e-3)


def test_scaled_values(zig_zag):
    gain, lag = nomoto(record(zig_zag)).nondimensional(LENGTH, SPEED)
    assert gain == pytest.approx(GAIN * LENGTH / SPEED, rel=1e-3)
    assert lag == pytest.approx(LAG * SPEED / LENGTH, rel=1e-3)


def test_with_heading_noise_within_half_a_percent_and_intervals_that_cover(zig_zag):
    noise, seeds = math.radians(0.3), 200
    found = [nomoto(record(zig_zag, noise, seed)) for seed in range(seeds)]
    worst = max(max(abs(each.K / GAIN - 1.0), abs(each.T / LAG - 1.0)) for each in found)
    assert worst < 0.005
    for index, true in enumerate((GAIN, LAG)):
        values = [(each.K, each.T)[index] for each in found]
        inside = sum(
            abs(value - true) < 1.96 * each.deviations[index]
            for value, each in zip(values, found, strict=True)
        )
        assert 0.90 * seeds <= inside <= 0.99 * seeds
    assert np.mean([each.residual for each in found]) == pytest.approx(noise, rel=0.02)


def test_without_a_helm_that_changes_it_is_refused():
    time = np.arange(10.0)
    with pytest.raises(InputError, match="helm that changes"):
        nomoto(Record(time, time, time, 0.0 * time))
