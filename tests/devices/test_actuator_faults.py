"""Failures of actuators, against closed forms."""

import math

import numpy as np
import pytest

from seatrial.devices.actuators.actuator import INTERVAL_NS, LATE_NS
from seatrial.devices.actuators.angle_servo import AngleServo
from seatrial.devices.actuators.motor import Motor
from seatrial.devices.actuators.servo import Servo
from seatrial.devices.actuators.thruster import Thruster
from seatrial.errors import InputError, SimulationError
from seatrial.model.faults.catalogue import FAILURES as FAULTS
from seatrial_kits.ships.devices.force_actuator import ForceActuator
from seatrial_kits.ships.devices.rudder_machine import RudderMachine
from tests.kit import classes

from .running import run, started

WANTED = {
    "thruster": ("pulse", lambda x: 1.5e-3 + 0.4e-3 * x, "thrust"),
    "linear-thruster": ("command", lambda x: x, "thrust"),
    "motor": ("command", lambda x: x, "order"),
    "force-actuator": ("demand", lambda x: [1e5 * x, -1e5 * x, 1e6 * x], "force.x"),
    "servo": ("pulse", lambda x: 1.5e-3 + 0.4e-3 * x, "angle"),
    "angle-servo": ("command", lambda x: x, "angle"),
    "rudder-machine": ("command", lambda x: 0.5 * x, "angle"),
}
ALL = {cls: wanted for name, wanted in WANTED.items() for cls in classes(name)}
THRUSTERS = classes("thruster", "linear-thruster", "motor", "force-actuator")
SHAFTS = classes("servo", "angle-servo", "rudder-machine")
BROKEN_MS, REPAIRED_MS = 6_000, 12_000


def failing(cls, fault, stop_ms=20_000, wanted=lambda t_ms: 0.5, step_ms=10, **values):
    """Return the output every step; it fails from 6 s to 12 s."""
    port, command, output = ALL[cls]

    def inputs(t_ms):
        fails = BROKEN_MS <= t_ms < REPAIRED_MS
        return {port: command(wanted(t_ms)), "fault": fault if fails else "none"}

    return np.array(run(started(cls, **values), [output], stop_ms, step_ms, inputs))[:, 0]


def at(values, t_ms):
    return values[t_ms // 10]


def turning(t_ms):
    """A command that never rests."""
    return 0.8 * math.sin(t_ms / 1000)


every = pytest.mark.parametrize("cls", ALL, ids=lambda cls: cls.__name__)
thruster = pytest.mark.parametrize("cls", THRUSTERS, ids=lambda cls: cls.__name__)
shaft = pytest.mark.parametrize("cls", SHAFTS, ids=lambda cls: cls.__name__)


@pytest.mark.sampled(3)
@every
@pytest.mark.parametrize("fault", FAULTS)
def test_it_acts_while_it_lasts(cls, fault):
    healthy, failed = failing(cls, "none", wanted=turning), failing(cls, fault, wanted=turning)
    first = BROKEN_MS // 10
    assert (failed[:first] == healthy[:first]).all()
    assert not np.allclose(failed[first:], healthy[first:])
    # Repaired it comes back: lags are at most 1 s.
    assert at(failed, 20_000) == pytest.approx(at(healthy, 20_000), abs=0.06 * np.ptp(healthy))


@thruster
def test_off_is_no_thrust(cls):
    failed = failing(cls, "off", time_constant=0.15)
    before = at(failed, BROKEN_MS)
    assert before != 0.0
    assert at(failed, BROKEN_MS + 300) == pytest.approx(before * math.exp(-2.0), rel=1e-9)
    assert at(failed, REPAIRED_MS - 10) == pytest.approx(0.0, abs=abs(before) * 1e-8)


@shaft
@pytest.mark.parametrize("fault", ["off", "stuck"])
def test_a_shaft_stays_where_it_is(cls, fault):
    failed = failing(cls, fault, wanted=turning)
    held = failed[BROKEN_MS // 10 + 2 : REPAIRED_MS // 10]
    assert np.ptp(held) == 0.0
    assert held[0] == pytest.approx(at(failed, BROKEN_MS), abs=0.12)  # within a frame of its rate


@thruster
def test_stuck_keeps_the_command(cls):
    failed = failing(cls, "stuck", wanted=lambda t: 0.5 if t < BROKEN_MS else -0.5)
    assert at(failed, REPAIRED_MS - 10) == pytest.approx(at(failed, BROKEN_MS), rel=1e-6)
    assert at(failed, 20_000) < 0.0


@thruster
def test_wrong_is_half_of_the_thrust(cls):
    failed = failing(cls, "wrong")
    assert at(failed, REPAIRED_MS - 10) == pytest.approx(0.5 * at(failed, BROKEN_MS - 10), rel=1e-6)


@pytest.mark.parametrize(
    ("cls", "expected"),
    [
        # 0.5 of half the range from the middle, and a tenth of the range; the servo stops a dead
        # band short of both.
        (Servo, 0.1 * math.pi / 2),
        (AngleServo, 0.1 * math.pi),
        (RudderMachine, 0.2 * math.radians(35.0)),
    ],
)
def test_a_wrong_shaft_is_a_tenth_of_its_range_off(cls, expected):
    failed = failing(cls, "wrong")
    moved = at(failed, REPAIRED_MS - 10) - at(failed, BROKEN_MS - 10)
    assert moved == pytest.approx(expected, abs=5e-3)


def test_a_wrong_shaft_stays_within_its_range():
    assert failing(Servo, "wrong", wanted=lambda _: 1.0).max() <= math.pi / 4
    assert failing(AngleServo, "wrong", wanted=lambda _: 1.5).max() <= math.pi / 2
    assert failing(RudderMachine, "wrong", wanted=lambda _: 2.0).max() <= math.radians(35.0)


@thruster
def test_slow_is_a_lag_ten_times_as_long(cls):
    failed = failing(cls, "slow", time_constant=0.15, wanted=lambda t: float(t >= BROKEN_MS))
    end = at(failing(cls, "none", time_constant=0.15, wanted=lambda t: 1.0), 20_000)
    for t in (500, 1500, 3000):
        expected = end * (1.0 - math.exp(-t / 1500))
        assert at(failed, BROKEN_MS + t) == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize(("cls", "full"), [(ForceActuator, 1e5), (Motor, 1.0)])
def test_an_ideal_actuator_that_is_slow_has_a_lag_of_a_second(cls, full):
    failed = failing(cls, "slow", wanted=lambda t: float(t >= BROKEN_MS))
    assert at(failed, BROKEN_MS) == 0.0
    assert at(failed, BROKEN_MS + 1000) == pytest.approx(full * (1.0 - math.exp(-1.0)), rel=1e-9)


@pytest.mark.parametrize(
    ("cls", "rate"), [(Servo, math.radians(60) / 0.21), (AngleServo, math.radians(120))]
)
def test_a_slow_shaft_turns_at_a_tenth_of_its_rate(cls, rate):
    failed = failing(cls, "slow", wanted=lambda t: 1.0 if t >= BROKEN_MS else -0.5)
    turned = at(failed, BROKEN_MS + 1000) - at(failed, BROKEN_MS + 500)
    assert turned == pytest.approx(0.5 * 0.1 * rate, rel=0.05)


def test_a_slow_rudder_is_where_a_healthy_one_was_in_a_tenth_of_the_time():
    wanted = {"wanted": lambda t: float(t >= BROKEN_MS)}
    failed, healthy = (failing(RudderMachine, fault, **wanted) for fault in ("slow", "none"))
    for t in (1000, 2000, 3000):
        expected = at(healthy, BROKEN_MS + t // 10)
        assert at(failed, BROKEN_MS + t) == pytest.approx(expected, rel=1e-3)


@every
def test_delayed_follows_what_was_wanted_half_a_second_ago(cls):
    late_ms = LATE_NS // 1_000_000
    failed = failing(cls, "delayed", wanted=turning)
    # What a healthy one does with the command held for so long, and then late.
    healthy = failing(
        cls,
        "none",
        wanted=lambda t: turning(
            t if not BROKEN_MS <= t < REPAIRED_MS else max(BROKEN_MS - 10, t - late_ms)
        ),
    )
    # A frame may have begun with the command just before, so that a shaft is a frame behind.
    assert failed == pytest.approx(healthy, abs=0.1 * np.ptp(healthy))
    if cls in classes("thruster", "linear-thruster"):
        inside = slice(BROKEN_MS // 10, (BROKEN_MS + late_ms) // 10 - 1)
        assert failed[inside] == pytest.approx(healthy[inside], rel=1e-12)


@pytest.mark.slow
def test_garbage_is_uniform_over_the_range_and_another_every_interval():
    port, _, _ = ALL[ForceActuator]
    ship = started(ForceActuator, fault="garbage")
    rows = np.array(run(ship, ["force.x"], 400_000, 100, lambda t: {port: [1.0, 1.0, 1.0]}))[:-1, 0]
    pairs = rows.reshape(-1, INTERVAL_NS // 100_000_000)
    assert (pairs.min(axis=1) == pairs.max(axis=1)).all()
    share = np.sort(pairs[:, 0] / 2.5e5 * 0.5 + 0.5)
    n = len(share)
    assert n == len(np.unique(share))
    assert np.abs(share - (np.arange(n) + 0.5) / n).max() < 2.2 / math.sqrt(n)


@pytest.mark.slow
def test_intermittent_is_off_in_half_of_the_intervals():
    ship = started(ForceActuator, fault="intermittent")
    wanted = {"demand": [7.0, 8.0, 9.0]}
    rows = np.array(run(ship, ["force.x"], 400_000, 100, lambda t: wanted))[:-1, 0]
    pairs = rows.reshape(-1, INTERVAL_NS // 100_000_000)
    assert set(np.unique(rows)) == {0.0, 7.0}
    assert (pairs.min(axis=1) == pairs.max(axis=1)).all()
    assert pairs.mean() / 7.0 == pytest.approx(0.5, abs=3.9 * 0.5 / math.sqrt(len(pairs)))


@pytest.mark.interop
@every
@pytest.mark.parametrize("fault", ["garbage", "intermittent"])
def test_random_failures_are_those_of_the_seed(cls, fault):
    one, again = (failing(cls, fault, wanted=turning) for _ in range(2))
    other = failing(cls, fault, wanted=turning, seed=2.0)
    assert (one == again).all()
    assert not np.allclose(one, other)


def test_current_flows_through_a_wrong_thruster_but_not_through_one_that_is_off():
    for fault, share in (("wrong", 1.0), ("off", 0.0)):
        motor = started(Thruster, pulse=1.8e-3, fault=fault)
        (end,) = run(motor, ["current"], 3000, 10)[-1]
        healthy = run(started(Thruster, pulse=1.8e-3), ["current"], 3000, 10)[-1][0]
        assert end == pytest.approx(share * healthy, abs=1e-6)


@every
def test_an_unknown_failure_is_refused(cls):
    motor = started(cls)
    motor.set("fault", "broken")
    with pytest.raises((InputError, SimulationError), match="unknown fault 'broken'"):
        motor.advance(0.0, 0.1)
