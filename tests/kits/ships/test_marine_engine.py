"""Main engine: closed forms of the shaft, limits of torque, reversal, telegraph."""

import itertools

import numpy as np
import pytest

from seatrial.errors import InputError
from seatrial_kits.ships.devices.marine_engine import MarineEngine
from tests.devices.running import run, started

RATED, TORQUE, J, H = 8.0, 3e6, 5e5, 0.1
ENGINE = {"rated_speed": [RATED, 6.0], "rated_torque": [TORQUE, 2e6], "inertia": J}


def turned(load, seconds, **values):
    """Return speed, torque and load at every 0.1 s, the load a function of the speed, rad/s."""
    engine, rows = started(MarineEngine, **ENGINE, **values), []
    for k in range(round(seconds / H) + 1):
        speed = engine.get("speed")
        engine.set("load", load(speed))
        rows.append([speed, engine.get("torque"), load(speed)])
        engine.advance(k * H, H)
    return np.array(rows)


def propeller(speed):
    """Return the moment, N.m, of a propeller that takes 0.8 of the torque at the rated speed."""
    return 0.8 * TORQUE * speed * abs(speed) / RATED**2


def test_a_constant_torque_runs_the_shaft_up_evenly():
    rows = turned(lambda _: 4e5, 0.8, command=1.0, friction=1e5, governor_gain=1e6)
    np.testing.assert_allclose(rows[:, 0], np.arange(9) * H * (TORQUE - 5e5) / J, rtol=1e-12)


def test_under_load_time_the_speed_grows_with_the_square_of_time():
    rows = turned(lambda _: 0.0, 5.0, command=1.0, load_time=20.0, governor_gain=1e6)
    t = np.arange(51) * H
    np.testing.assert_allclose(rows[:, 1], TORQUE * t / 20.0, rtol=1e-12, atol=1e-6)
    # Of M that grows by steps of h the speed is M_r t (t + h) / (2 J T).
    np.testing.assert_allclose(rows[:, 0], TORQUE * t * (t + H) / (40.0 * J), rtol=1e-12)


def test_the_work_of_the_moments_is_the_energy_of_the_shaft():
    rows = turned(propeller, 60.0, command=1.0, load_time=10.0)
    speed, load = rows[:, 0], rows[:, 2]
    driving = rows[1:, 1]
    mean = (speed[1:] + speed[:-1]) / 2
    work = np.cumsum((driving - load[:-1]) * mean * H)
    np.testing.assert_allclose(work, J * speed[1:] ** 2 / 2, rtol=1e-9, atol=1e-3)


@pytest.mark.parametrize("order", [1.0, 0.4, -0.7])
def test_the_governor_holds_the_speed_that_is_ordered(order):
    speed = order * (RATED if order > 0 else 6.0)
    found = turned(propeller, 120.0, command=order)[-1]
    np.testing.assert_allclose(found, [speed, propeller(speed), propeller(speed)], rtol=1e-6)


@pytest.mark.parametrize("at_rest", [0.5, 1.0, 2.0])
def test_the_torque_keeps_its_limit(at_rest):
    def heavy(speed):
        return 2.0 * propeller(speed)

    rows = turned(heavy, 200.0, command=1.0, torque_at_rest=at_rest, load_time=5.0)
    limit = TORQUE * (at_rest + (1 - at_rest) * rows[:-1, 0] / RATED)
    assert (rows[1:, 1] <= limit * (1 + 1e-12)).all()
    # Where the limit meets the load: a quadratic in the share s = omega / n_r.
    s = np.roots([1.6, -(1 - at_rest), -at_rest]).max()
    assert rows[-1, 0] == pytest.approx(s * RATED, rel=1e-3)


def test_an_engine_reverses_when_the_shaft_is_slow_enough():
    engine = started(MarineEngine, **ENGINE, command=1.0, reversing_speed=0.4)
    for k in range(300):
        engine.set("load", propeller(engine.get("speed")))
        engine.advance(k * H, H)
    engine.set("command", -1.0)
    seen = []
    for k in range(300, 900):
        engine.set("load", propeller(engine.get("speed")))
        before = engine.get("speed")
        engine.advance(k * H, H)
        seen.append((before, engine.get("torque")))
    assert all((torque < 0) == (speed <= 0.4 * RATED) for speed, torque in seen)
    assert engine.get("speed") == pytest.approx(-6.0, rel=1e-6)
    assert engine.get("shaft_order") == pytest.approx(-1.0, rel=1e-6)
    assert engine.get("power") == pytest.approx(propeller(6.0) * 6.0, rel=1e-6)


def test_a_stopped_engine_is_driven_by_its_propeller_against_the_friction():
    rows = turned(lambda _: -3e5, 2.0, command=0.0, friction=1e5)
    np.testing.assert_allclose(rows[:, 0], np.arange(21) * H * 2e5 / J, rtol=1e-12)
    assert not turned(lambda _: -9e4, 2.0, command=0.0, friction=1e5)[:, 0].any()


def test_the_telegraph_orders_shares_of_the_rated_speed():
    shares = (0.3, 0.5, 0.6, 0.9)
    for (step, share), (side, most) in itertools.product(
        zip(("dead slow", "slow", "half", "full"), shares, strict=True),
        (("ahead", RATED), ("astern", -6.0)),
    ):
        rows = turned(
            propeller, 120.0, telegraph=f"{step} {side}", telegraph_speeds=shares, command=0.1
        )
        assert rows[-1, 0] == pytest.approx(share * most, rel=1e-6)
    assert turned(propeller, 1.0, telegraph="stop", command=1.0)[-1, 0] == 0.0
    assert turned(propeller, 1.0, telegraph="remote", command=1.0)[-1, 0] > 0.0


def test_an_order_that_no_telegraph_has_is_refused():
    with pytest.raises(InputError, match=r"telegraph order 'haf ahead'.*'half ahead'"):
        turned(propeller, 1.0, telegraph="haf ahead")


def test_failures_stop_halve_and_slow_the_engine():
    def driven(**values):
        return run(started(MarineEngine, **ENGINE, command=1.0, **values), ["torque"], 1000, 100)

    assert driven(fault="off")[-1] == [0.0]
    assert driven(fault="wrong", governor_gain=1e6)[1] == [TORQUE / 2]
    quick, slow = (driven(fault=f, load_time=50.0)[-1][0] for f in ("none", "slow"))
    assert quick == pytest.approx(10 * slow)
