import math

import numpy as np
import pytest

from seatrial.control.speed_hold import SpeedHold
from tests.devices.running import started

CRAFT = {"mass": 20.0, "linear_drag": 3.0, "quadratic_drag": 10.0, "period": 2e-3}


def run(hold, wanted, seconds, push=0.0, speed=0.0):
    """Return times, speeds and forces of a craft with the drag and mass that are given."""
    rows, begin = [], hold.now
    for k in range(round(seconds / 2e-3)):
        hold.set("speed_wanted", wanted)
        hold.set("speed", speed)
        surge = hold.get("surge")
        rows.append((2e-3 * k, speed, surge))
        hold.advance(begin + 2e-3 * k, 2e-3)
        speed += 2e-3 * (surge + push - 3.0 * speed - 10.0 * abs(speed) * speed) / 20.0
    return np.array(rows).T


@pytest.mark.parametrize("zeta", [0.6, 1.5])
def test_small_errors_decay_as_the_poles_say(zeta):
    """About U = 1 m/s the drag is d1 + 2 d2 U = 23 N s/m of damping."""
    w, wanted, step = 0.5, 1.0, 1e-3
    hold = started(SpeedHold, **CRAFT, enabled=True, natural_frequency=w, damping_ratio=zeta)
    t, speed, _ = run(hold, wanted, 20.0, speed=wanted - step)
    damping = 2 * zeta * w + 23.0 / 20.0
    # e'' + damping e' + w^2 e = 0 from e = step, e' = -damping step.
    roots = np.roots([1.0, damping, w * w]).astype(complex)
    b = (-damping - roots[0]) / (roots[1] - roots[0])
    expected = step * ((1 - b) * np.exp(roots[0] * t) + b * np.exp(roots[1] * t)).real
    np.testing.assert_allclose(wanted - speed, expected, atol=5e-3 * step)


@pytest.mark.interop
def test_a_steady_push_leaves_no_error():
    hold = started(SpeedHold, **CRAFT, enabled=True)
    _, speed, surge = run(hold, 0.8, 200.0, push=-4.0)
    assert speed[-1] == pytest.approx(0.8, abs=1e-6)
    assert surge[-1] == pytest.approx(4.0 + 3.0 * 0.8 + 10.0 * 0.64, rel=1e-5)


@pytest.mark.interop
def test_what_the_capacity_cuts_off_does_not_wind_up():
    hold = started(SpeedHold, **CRAFT, enabled=True, capacity=5.0)
    _, speed, surge = run(hold, 2.0, 100.0)
    assert surge.max() == 5.0
    assert 3.0 * speed[-1] + 10.0 * speed[-1] ** 2 == pytest.approx(5.0, rel=1e-3)
    _, back, _ = run(hold, 0.2, 40.0, speed=speed[-1])
    # 100 s at the limit are forgotten at the rate w / (2 zeta), 0.2 1/s.
    assert back[-1] == pytest.approx(0.2, abs=0.01)


def test_disabled_it_asks_nothing_and_forgets():
    hold = started(SpeedHold, **CRAFT, enabled=True)
    run(hold, 0.8, 20.0, push=-4.0)
    hold.set("enabled", False)
    assert hold.get("surge") == 0.0
    hold.advance(20.0, 2e-3)
    hold.set("enabled", True)
    hold.set("speed", 0.8)
    assert hold.get("surge") == pytest.approx(3.0 * 0.8 + 10.0 * 0.64)


def test_astern_mirrors_ahead():
    ahead = run(started(SpeedHold, **CRAFT, enabled=True), 0.6, 10.0)
    astern = run(started(SpeedHold, **CRAFT, enabled=True), -0.6, 10.0)
    np.testing.assert_allclose(astern[1:], -ahead[1:], atol=1e-12)
    assert math.isclose(ahead[1][-1], 0.6, abs_tol=0.05)
