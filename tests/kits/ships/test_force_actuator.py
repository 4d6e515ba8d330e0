import math

import pytest

from seatrial_kits.ships.devices.force_actuator import ForceActuator
from tests.devices.running import run, started

FULL = [2.5e5, 2.5e5, 1e7]


def load(actuator):
    return [*actuator.get("force"), actuator.get("moment")]


def test_ideal_thrusters_give_the_demand_at_once():
    actuator = started(ForceActuator)
    actuator.set("demand", [1e5, -2e5, 3e6])
    assert load(actuator) == [1e5, -2e5, 3e6]


@pytest.mark.parametrize("time_constant", [0.0, 5.0])
@pytest.mark.parametrize("sign", [1, -1])
def test_capacity_holds_on_each_axis_by_itself(sign, time_constant):
    actuator = started(ForceActuator, time_constant=time_constant)
    actuator.set("demand", [sign * 1e6, sign * 1e5, sign * 1e9])
    actuator.advance(0.0, 1000.0)
    assert load(actuator) == pytest.approx([sign * 2.5e5, sign * 1e5, sign * 1e7], rel=1e-12)


@pytest.mark.parametrize("step_ms", [100, 500, 2500])
def test_lag_is_exact_whatever_the_step(step_ms):
    actuator = started(ForceActuator, time_constant=5.0)
    actuator.set("demand", FULL)
    rows = run(actuator, ["force", "moment"], 10000, step_ms)
    for index, (force, moment) in enumerate(rows):
        share = -math.expm1(-index * step_ms / 1000 / 5.0)
        expected = [share * value for value in FULL]
        assert [*force, moment] == pytest.approx(expected, rel=1e-12)


def test_a_demand_beyond_the_capacity_is_not_followed_faster():
    ends = []
    for demand in (FULL, [10 * value for value in FULL]):
        actuator = started(ForceActuator, time_constant=5.0, demand=demand)
        actuator.advance(0.0, 1.0)
        ends.append(load(actuator))
    assert ends[0] == ends[1]
