"""Course stability, handling and diving against closed forms."""

import math

import numpy as np
import pytest

from seatrial.errors import InputError
from seatrial_kits.sea_trials.figures.course_stability import is_stable, loop, pull_out, spiral
from seatrial_kits.sea_trials.figures.handling import station_box, turn_on_the_spot, williamson
from seatrial_kits.sea_trials.figures.record import Record
from seatrial_kits.sea_trials.figures.vertical import depth_step, pitch_zig_zag

from .references import FIGURES


def test_the_loop_of_a_known_curve():
    helm = np.radians([20, 10, 0, -10, -20, -10, 0, 10, 20])
    rate = [0.4, 0.3, 0.2, -0.3, -0.4, -0.3, -0.2, 0.3, 0.4]
    found = loop(helm, rate)
    assert found.height == pytest.approx(0.4)
    # The branches differ by 0.4 (1 - |helm| / 10 deg): by a tenth of the height at 9 deg.
    assert found.width == pytest.approx(math.radians(18.0), abs=math.radians(0.05))


def test_a_stable_curve_has_no_loop():
    rows = np.array(FIGURES["kvlcc2_spiral_l7"]["rows"])
    helm = np.radians(np.concatenate((rows[:, 0], rows[::-1, 0][1:])))
    rate = np.concatenate((rows[:, 1], rows[::-1, 1][1:]))
    assert loop(helm, rate).height == 0.0


def test_one_branch_is_no_spiral():
    with pytest.raises(InputError, match="two branches"):
        loop([0.3, 0.1, -0.3], [0.3, 0.1, -0.3])


def test_a_spiral_has_the_rates_of_its_steps():
    rates, speed, hold, length = np.array([0.02, 0.01, -0.01]), 5.0, 400, 100.0
    rate = np.repeat(rates, hold)
    time = np.arange(len(rate), dtype=float)
    psi = np.concatenate(([0.0], np.cumsum(rate[:-1])))
    way = np.cumsum(speed * np.exp(1j * psi))
    helm, scaled = spiral(Record(time, way.real, way.imag, psi, np.repeat([0.3, 0.1, -0.1], hold)),
                          length)  # fmt: skip
    assert helm == pytest.approx([0.3, 0.1, -0.1])
    assert scaled == pytest.approx(rates * length / speed, rel=1e-3)


def test_a_pull_out_of_a_stable_vessel_has_no_residual_rate():
    time = np.arange(0.0, 400.0, 0.5)
    after = np.maximum(time - 200.0, 0.0)
    psi = 0.02 * np.minimum(time, 200.0) + 0.02 * 10.0 * (1.0 - np.exp(-after / 10.0))
    found = pull_out(Record(time, time, time, psi), 200.0)
    assert found["rate_before"] == pytest.approx(0.02, rel=1e-3)
    assert found["residual_rate"] == pytest.approx(0.0, abs=1e-8)
    assert is_stable(found["residual_rate"], 0.0, found["rate_before"])
    assert not is_stable(0.004, -0.004, 0.02)


def test_a_williamson_turn_of_two_arcs():
    radius, rate = 50.0, 0.05
    time = np.arange(-20.0, 200.0, 0.25)
    turned = rate * np.maximum(time, 0.0)
    first = math.radians(70.0)
    psi = np.where(turned < first, turned, 2.0 * first - turned)
    velocity = radius * rate * np.exp(1j * psi)
    way = np.concatenate(([0.0], np.cumsum((velocity[1:] + velocity[:-1]) / 2.0 * 0.25)))
    found = williamson(Record(time, way.real, way.imag, psi, np.where(time >= 0.0, 0.6, 0.0)))
    # Two arcs of one radius about centres at (0, R) and (2 R sin a, R - 2 R cos a), a = 70 deg.
    assert found["turn_time"] == pytest.approx((2.0 * first + math.pi) / rate, rel=1e-3)
    assert found["advance"] == pytest.approx(2.0 * radius * math.sin(first), abs=0.2)
    across = radius - 2.0 * radius * math.cos(first) - radius
    assert found["offset"] == pytest.approx(across, abs=0.2)


def test_a_turn_on_the_spot_about_a_point_ahead():
    rate, ahead = 0.2, 0.3
    time = np.arange(0.0, 60.0, 0.1)
    psi = rate * time
    rec = Record(time, ahead * (1 - np.cos(psi)), -ahead * np.sin(psi), psi)
    rec = Record(rec.time, rec.north + 0.001 * time, rec.east, np.where(time > 0, psi, 0.0))
    found = turn_on_the_spot(rec)
    assert found["rate_of_turn"] == pytest.approx(rate)
    assert found["time_360"] == pytest.approx(math.tau / rate)
    assert found["pivot_drift"] == pytest.approx(0.001 * math.tau / rate, rel=1e-3)
    assert found["largest_drift"] == pytest.approx(2.0 * ahead, rel=0.05)


def test_the_radius_of_a_station_that_is_left_evenly():
    time = np.linspace(0.0, 100.0, 2001)
    rec = Record(time, 10.0 + time / 10.0, 0.0 * time, np.full_like(time, 6.2), power=2.0 * time)
    found = station_box(rec, 10.0, 0.0, 6.2 - math.tau + 0.1)
    assert found["radius_95"] == pytest.approx(9.5, abs=0.01)
    assert found["heading_error_rms"] == pytest.approx(0.1)
    assert found["power"] == pytest.approx(100.0)


def second_order(time, damping, frequency):
    """Return the response to a unit step at 0 s."""
    after, root = np.maximum(time, 0.0), math.sqrt(1.0 - damping**2)
    phase = frequency * root * after
    return 1.0 - np.exp(-damping * frequency * after) * (
        np.cos(phase) + damping / root * np.sin(phase)
    )


def test_the_overshoot_of_a_depth_step_is_that_of_its_damping():
    time, damping = np.arange(-5.0, 60.0, 0.05), 0.5
    depth = 2.0 + 3.0 * second_order(time, damping, 0.5)
    found = depth_step(Record(time, time, time, 0.0 * time, depth=depth), 0.0, 5.0)
    share = math.exp(-math.pi * damping / math.sqrt(1.0 - damping**2))
    assert found["overshoot_share"] == pytest.approx(share, rel=1e-4)
    assert found["overshoot"] == pytest.approx(3.0 * share, rel=1e-4)
    # Normalised settling time of damping 0.5 to 5 %: 5.29; rise from 10 to 90 %: 1.64.
    assert found["settling_time"] == pytest.approx(5.29 / 0.5, rel=2e-3)
    assert found["rise_time"] == pytest.approx(1.64 / 0.5, rel=2e-3)


def test_a_pitch_zig_zag_that_is_a_sine():
    time = np.arange(0.0, 40.0, 0.1)
    peak, frequency = math.radians(15.0), 0.2
    pitch, depth = peak * np.sin(frequency * time), 20.0 - 10.0 * np.sin(frequency * time - 0.8)
    rec = Record(time, time, time, 0.0 * time, depth=depth, pitch=pitch)
    found = pitch_zig_zag(rec, math.radians(10.0), 0.0)
    executed = math.asin(10.0 / 15.0) / frequency
    assert found["execute_time"] == pytest.approx(executed, rel=1e-5)
    assert found["overshoot_pitch"] == pytest.approx(math.radians(5.0), rel=1e-5)
    assert found["reach_time"] == pytest.approx(math.pi / frequency, rel=1e-5)
    least = -10.0 * (1.0 - math.sin(frequency * executed - 0.8))
    assert found["overshoot_depth"] == pytest.approx(least, rel=1e-4)
