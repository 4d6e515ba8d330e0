"""Depth and heading hold: gains against pole placement, limits, and loops in closed form."""

import math

import numpy as np
import pytest

from seatrial.control.depth_hold import DepthHold
from seatrial.control.heading_hold import HeadingHold
from seatrial.control.tilt_hold import TiltHold
from tests.devices.running import started

FAST = {"rate_limit": 1e9, "rate_filter": 0.0, "capacity": 1e12}
w, zeta, sigma, m = 0.7, 0.9, 0.1, 10.45
GAINS = {"natural_frequency": w, "damping_ratio": zeta, "integral_pole": sigma, "mass": m}
_ONE, KD, KP, KI = m * np.polymul([1, sigma], [1, 2 * zeta * w, w**2])


def depth(**values):
    return started(DepthHold, **{**FAST, **GAINS, **values})


def test_gains_place_the_poles():
    hold = depth(depth_wanted=2.0, depth=2.0)
    assert hold.get("heave") == 0.0
    hold.advance(0.0, 0.1)
    hold.set("depth", 1.9)  # moved by -1 m/s for one period
    assert hold.get("heave") == pytest.approx(KP * 0.1 + KD * 1.0)
    hold.advance(0.1, 0.1)
    # Now at rest: what is left is Kp e and what the integral learnt in one period.
    assert hold.get("heave") == pytest.approx(KP * 0.1 + KI * 0.1 * 0.1)


@pytest.mark.parametrize(("kind", "axis"), [(DepthHold, "depth"), (HeadingHold, "heading")])
def test_it_begins_where_the_first_valid_measurement_is(kind, axis):
    """A sensor that is late has nothing at first: its 0 is no place to start from."""
    late = started(kind, **{f"{axis}_valid": False, f"{axis}_wanted": 2.0, axis: 0.0})
    demand = {"depth": "heave", "heading": "yaw_moment"}[axis]
    for k in range(5):
        assert late.get(demand) == 0.0
        late.advance(0.1 * k, 0.1)
    values = {f"{axis}_valid": True, f"{axis}_wanted": 2.5, axis: 2.5}
    at_once = started(kind, **values)
    for name, value in values.items():
        late.set(name, value)
    for k in range(5):
        assert late.get(demand) == at_once.get(demand) == 0.0
        late.advance(0.5 + 0.1 * k, 0.1)
        at_once.advance(0.1 * k, 0.1)
    for one in (late, at_once):
        one.set(f"{axis}_valid", False)  # lost later: the last one stays
        one.set(f"{axis}_wanted", 2.0)
    for k in range(5):
        assert late.get(demand) == at_once.get(demand) != 0.0
        late.advance(1.0 + 0.1 * k, 0.1)
        at_once.advance(0.5 + 0.1 * k, 0.1)


def test_own_damping_is_added_by_speed():
    """Full ahead for long: D = 2 + 17 |2.16|, for the moving target and in the gains."""
    more = {"damping": 2.0, "damping_per_speed": 17.0, "damping_rate": 1.2, "surge": 93.4}
    hold = depth(**more, depth_wanted=2.0, depth=2.0, rate_limit=0.3)
    hold.advance(0.0, 60.0)
    D = 2.0 + 17.0 * 2.16
    hold.set("depth_wanted", 5.0)
    moving = KD * 0.3 + D * 0.3
    assert hold.get("heave") == pytest.approx(moving)
    hold.advance(60.0, 0.1)
    assert hold.get("heave") == pytest.approx(moving + (KP + 1.2 * D) * 0.03)
    hold.advance(60.1, 0.1)
    learnt = (KI + 1.2 * sigma * D) * 0.03 * 0.1
    assert hold.get("heave") == pytest.approx(moving + (KP + 1.2 * D) * 0.06 + learnt)


def test_speed_is_estimated_from_the_surge_force():
    """A quarter of the force astern is half of the speed; it comes with a first-order lag."""
    more = {"damping_per_speed": 17.0, "surge": -93.4 / 4, "speed_lag": 0.5}
    hold = depth(**more, integral_pole=0.0, rate_limit=0.3, depth_wanted=1e3)
    for k in range(1, 20):
        speed = 1.08 * (1.0 - math.exp(-0.1 * k / 0.5))
        behind = 0.3 * 0.1 * (k - 1)
        asked = m * w**2 * behind + m * 2 * zeta * w * 0.3 + 17.0 * speed * 0.3
        assert hold.get("heave") == pytest.approx(asked), k
        hold.advance(0.1 * (k - 1), 0.1)


def test_rate_is_low_passed():
    hold = depth(depth_wanted=2.0, depth=2.0, rate_filter=0.3, integral_pole=0.0)
    hold.advance(0.0, 0.1)
    for k in range(1, 30):  # 1 m/s for long, the target with it
        hold.set("depth", 2.0 + 0.1 * k)
        hold.set("depth_wanted", 2.0 + 0.1 * k)
        found = hold.get("heave")
        hold.advance(0.1 * k, 0.1)
        f = 1.0 - math.exp(-0.1 * k / 0.3)
        # The target goes where it is wanted one period later: it is 0.1 m behind.
        kp, kd = m * w**2, m * 2 * zeta * w
        assert found == pytest.approx(kp * -0.1 + kd * (1.0 - f)), k


def test_target_goes_at_its_rate_limit():
    hold = depth(rate_limit=0.25, integral_pole=0.0, depth_wanted=0.0)
    hold.advance(0.0, 1.0)
    hold.set("depth_wanted", 10.0)
    hold.advance(1.0, 4.0)
    assert hold.get("heave") == pytest.approx(m * w**2 * 1.0 + m * 2 * zeta * w * 0.25)


def test_capacity_holds_and_the_integral_does_not_wind_up():
    # So slow a filter takes no notice of the jumps below.
    hold = started(DepthHold, depth_wanted=0.0, rate_filter=1e9)
    hold.advance(0.0, 1.0)
    hold.set("depth", 50.0)
    hold.advance(1.0, 600.0)
    assert hold.get("heave") == -20.0
    # An integral that had wound up would ask for -20 N for minutes.
    hold.set("depth", -3.0)
    hold.advance(601.0, 2.0)
    assert hold.get("heave") > 5.0


@pytest.mark.parametrize(("heading", "wanted", "error"), [(179, -179, 2), (-179, 179, -2)])
def test_heading_goes_the_shorter_way(heading, wanted, error):
    start = math.radians(heading)
    hold = started(
        HeadingHold,
        heading=start,
        heading_wanted=start,
        **FAST,
        integral_pole=0.0,
        natural_frequency=1.0,
        inertia=2.0,
    )
    hold.advance(0.0, 0.1)
    hold.set("heading_wanted", math.radians(wanted) + math.tau)
    hold.advance(0.1, 0.2)
    assert hold.get("yaw_moment") == pytest.approx(2.0 * math.radians(error))


def test_a_turn_past_south_is_no_jump_of_the_rate():
    # A turn through +-180 degrees and one through 0, in the same steps, ask for the same.
    moments = []
    for middle in (math.pi, 0.0):
        start = math.remainder(middle - 0.1, math.tau)
        hold = started(HeadingHold, heading=start, heading_wanted=start, **FAST)
        hold.advance(0.0, 0.1)
        seen = []
        for k in range(1, 5):
            hold.set("heading", math.remainder(middle - 0.1 + 0.05 * k, math.tau))
            seen.append(hold.get("yaw_moment"))
            hold.advance(0.1 * k, 0.1)
        moments.append(seen)
    np.testing.assert_allclose(moments[0], moments[1], rtol=1e-9)


@pytest.mark.slow
def test_ideal_loop_is_that_of_its_poles():
    """A mass and a sudden force: m z'' = F - Kd z' - Kp z - Ki int z, in closed form."""
    T, F = 0.001, 5.0
    hold = depth(period=T, depth_wanted=0.0, depth=0.0)
    z = v = 0.0
    found = []
    for k in range(20000):
        hold.set("depth", z)
        found.append(z)
        a = (F + hold.get("heave")) / m
        z, v = z + T * v + 0.5 * T * T * a, v + T * a
        hold.advance(k * T, T)
    t = T * np.arange(20000)
    poles = np.roots([1, 2 * zeta * w + sigma, w**2 + 2 * zeta * w * sigma, w**2 * sigma])
    # z = F / m over the cubic: residues at its poles.
    exact = sum(
        F / m * np.exp(p * t) / np.prod([p - q for q in poles if q != p]) for p in poles
    ).real
    # Held for 1 ms, and the rate by differences half of that late again.
    assert np.abs(found - exact).max() < 3e-3 * exact.max()


def test_a_tilt_is_held_while_enabled_and_forgotten_else():
    tilt = {**FAST, "natural_frequency": w, "damping_ratio": zeta, "integral_pole": sigma}
    hold = started(TiltHold, **tilt, inertia=m, angle=-0.1, enabled=True)
    hold.advance(0.0, 0.2)  # its target starts where it is, and goes to 0 at once
    learnt = pytest.approx(KP * 0.1 + KI * 0.1 * 0.1)
    assert hold.get("moment") == learnt
    hold.advance(0.2, 9.9)
    hold.set("enabled", False)
    hold.advance(10.1, 0.2)
    assert hold.get("moment") == 0.0
    hold.set("enabled", True)  # without what it had learnt
    hold.advance(10.3, 0.2)
    assert hold.get("moment") == learnt
