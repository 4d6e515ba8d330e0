"""Depth by pitch: the outer loop in closed form, the inner by its poles, and both on a body."""

import math

import numpy as np
import pytest

from seatrial_kits.fitted.control.depth_by_pitch import DepthByPitch
from tests.devices.running import started

FAST = {"rate_limit": 1e9, "rate_filter": 0.0, "capacity": 1e12}
OUTER = {"depth_frequency": 0.2, "depth_integral_pole": 0.03, "speed": 1.5}
DEPTH, HEADING, NONE = [True, True, True], [False, True, False], [False, False, False]
DIVE = [0.0, 0.0, 0.0, 0.5]
w, sigma, U = 0.2, 0.03, 1.5


def hold(**values):
    return started(DepthByPitch, **{"engaged": DEPTH, **values})


def test_gains_place_the_poles_of_depth():
    # A pitch that follows at once: z' = -U pitch, from an error of 0.5 m.
    T = 0.01
    held = hold(**OUTER, period=T, depth=10.5, depth_wanted=10.0)
    depth, found = 10.5, []
    for k in range(3000):
        held.set("depth", depth)
        pitch = held.get("pitch_ordered")
        found.append(depth - 10.0)
        held.advance(k * T, T)
        depth -= T * U * pitch
    t = T * np.arange(3000)
    exact = 0.5 * (w * np.exp(-w * t) - sigma * np.exp(-sigma * t)) / (w - sigma)
    # An order is held for 10 ms.
    assert np.abs(found - exact).max() < 1.5 * w * T * 0.5


def test_a_fast_craft_pitches_less():
    slow, fast = (
        hold(depth=10.5, depth_wanted=10.0, speed=speed).get("pitch_ordered")
        for speed in (1.0, 2.0)
    )
    assert slow == pytest.approx(2.0 * fast, rel=1e-12)
    assert slow > 0.0  # too deep: bow up
    still = hold(depth=10.5, depth_wanted=10.0, speed=0.0, least_speed=0.5)
    assert still.get("pitch_ordered") == pytest.approx(2.0 * slow, rel=1e-12)


def test_gains_place_the_poles_of_pitch():
    zeta, w_n, sigma_n, inertia = 0.9, 1.2, 0.3, 8.0
    _, kd, kp, ki = inertia * np.polymul([1, sigma_n], [1, 2 * zeta * w_n, w_n**2])
    gains = {"natural_frequency": w_n, "damping_ratio": zeta, "integral_pole": sigma_n}
    held = hold(**FAST, **gains, inertia=inertia, depth=5.0, depth_wanted=5.0)
    assert held.get("pitch_moment") == 0.0
    held.advance(0.0, 0.1)
    held.set("pitch", -0.02)  # turned by -0.2 rad/s for one period
    assert held.get("pitch_moment") == pytest.approx(kp * 0.02 + kd * 0.2)
    held.advance(0.1, 0.1)
    assert held.get("pitch_moment") == pytest.approx(kp * 0.02 + ki * 0.02 * 0.1)


def test_pitch_and_moment_stay_within_their_limits_and_nothing_winds_up():
    held = hold(depth=0.0, depth_wanted=50.0, speed=1.5, pitch_limit=0.4, capacity=2.0)
    for k in range(600):
        assert -0.4 <= held.get("pitch_ordered") <= 0.4
        assert abs(held.get("pitch_moment")) <= 2.0
        held.advance(0.1 * k, 0.1)
    held.set("depth", 50.0)  # arrived after a minute at the limit
    assert held.get("pitch_ordered") == pytest.approx(0.0, abs=1e-12)


def test_manual_heave_pitches_the_bow_down_with_the_heading_held_and_is_the_moment_without():
    held = hold(engaged=HEADING, direct=DIVE, depth=3.0, depth_wanted=9.0)
    assert held.get("pitch_ordered") == -0.25  # half of 0.5 rad
    held.advance(0.0, 0.1)
    assert held.get("pitch_moment") < 0.0
    manual = hold(engaged=NONE, direct=DIVE, depth=3.0, depth_wanted=9.0)
    assert manual.get("pitch_moment") == -1.5  # half of 3 N.m
    assert hold(engaged=NONE).get("pitch_moment") == 0.0


def test_it_begins_with_the_first_valid_depth():
    late = hold(depth_valid=False, depth_wanted=20.0, pitch=0.1)
    for k in range(5):
        assert late.get("pitch_moment") == late.get("pitch_ordered") == 0.0
        late.advance(0.1 * k, 0.1)
    late.set("depth_valid", True)
    late.set("depth", 20.0)
    assert late.get("pitch_ordered") == 0.0
    late.set("depth_wanted", 21.0)
    assert late.get("pitch_ordered") < 0.0


def dive(seconds, buoyancy, T=0.05):
    """Return the depths of a body that rises by itself and is bow-heavy, on its way to 10 m."""
    held = hold(period=T, speed=1.5, depth=5.0, depth_wanted=10.0)
    depth, pitch, rate, depths = 5.0, 0.0, 0.0, []
    for k in range(round(seconds / T)):
        held.set("depth", depth)
        held.set("pitch", pitch)
        moment = held.get("pitch_moment") - 0.8 - 4.0 * rate
        depths.append(depth)
        held.advance(k * T, T)
        rate += T * moment / 8.0
        pitch += T * rate
        depth += T * (-1.5 * math.sin(pitch) - buoyancy)
    return np.array(depths)


@pytest.mark.parametrize("buoyancy", [0.0, 0.1])
def test_a_body_that_is_bow_heavy_and_rises_by_itself_is_held_at_its_depth(buoyancy):
    depths = dive(400.0, buoyancy)
    assert depths[-200:] == pytest.approx(10.0, abs=1e-3)
    assert depths.max() < 10.5
    assert depths[600] > 9.0  # after half a minute


def test_the_pitch_for_a_depth_is_its_recursion():
    draw, T, most, learnt, held_back = np.random.default_rng(6), 0.2, 0.3, 0.0, 0
    depths, speeds = 10.0 + draw.normal(0, 2.0, 60), draw.uniform(-2.5, 2.5, 60)
    held = hold(
        depth_frequency=0.17, depth_integral_pole=0.04, least_speed=0.6, pitch_limit=most,
        period=T, depth=depths[0], depth_wanted=10.0,
    )  # fmt: skip
    for k, (depth, speed) in enumerate(zip(depths, speeds, strict=True)):
        held.set("depth", depth)
        held.set("speed", speed)
        stiff = 0.21 / max(abs(speed), 0.6) * (depth - 10.0)
        clipped = min(max(stiff, -most), most)
        ordered = min(max(clipped + learnt, -most), most)
        assert held.get("pitch_ordered") == pytest.approx(ordered, abs=1e-12)
        rate = 0.17 * 0.04 / 0.21
        inside = stiff if stiff == clipped else 0.0
        learnt += T * rate * (inside + ordered - clipped - learnt)
        held_back += stiff != clipped
        held.advance(T * k, T)
    assert 5 < held_back < 55
