import pytest

from seatrial.control.allocation.pulse_allocation import PulseAllocation
from seatrial.devices.actuators.propulsion import Propulsion
from seatrial.devices.actuators.thruster import Thruster
from seatrial.errors import InputError
from tests.devices.running import started


def forces(surge, moment):
    """Return what two T200 thrusters 0.4 m from the centre line do with the pulses."""
    found = started(PulseAllocation, surge=surge, yaw_moment=moment)
    thrusts = []
    for side in ("port", "starboard"):
        thruster = started(Thruster, pulse=found.get(f"pulse_{side}"))
        thruster.advance(0.0, 10.0)
        thrusts.append(thruster.get("thrust"))
    pair = started(
        Propulsion,
        position_1=[0, -0.4, 0], position_2=[0, 0.4, 0],
        direction_1=[1, 0, 0], direction_2=[1, 0, 0], thrust=[*thrusts, *[0] * 14],
    )  # fmt: skip
    return pair.get("force.x"), pair.get("moment.z")


@pytest.mark.parametrize("demand", [(0, 0), (30, 0), (-20, 5), (60, -8), (0, 12), (10, 25)])
def test_the_thrusters_do_what_is_asked(demand):
    surge, moment = forces(*demand)
    # Each thruster within 1.52 N of the table.
    assert surge == pytest.approx(demand[0], abs=2 * 1.52)
    assert moment == pytest.approx(demand[1], abs=0.8 * 1.52)


def test_the_moment_comes_first():
    surge, moment = forces(1000.0, 20.0)
    assert moment == pytest.approx(20.0, abs=0.8 * 1.52)
    assert surge == pytest.approx(2 * (51.4 - 20.0 / 0.8), abs=2 * 1.52)
    _, moment = forces(0.0, 1000.0)
    assert moment == pytest.approx(0.8 * 39.9, abs=0.8 * 1.52)


def test_nothing_asked_is_neutral():
    found = started(PulseAllocation)
    assert (found.get("pulse_port"), found.get("pulse_starboard")) == (1.5e-3, 1.5e-3)


def test_refuses_pulses_that_do_not_rise():
    with pytest.raises(InputError, match="must rise"):
        started(PulseAllocation, pulse_neutral=1.9e-3)
