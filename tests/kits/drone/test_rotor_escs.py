"""Speed controllers of a quadrotor against their line."""

import pytest

from seatrial.errors import InputError
from seatrial_kits.drone.rotor_escs import RotorEscs


def escs(**values):
    made = RotorEscs("escs")
    for name, value in values.items():
        made.set(name, value)
    made.initialise()
    made.begin()
    return made


def test_pulses_are_speeds_on_a_line_that_ends():
    made = escs(max_speed=800.0, pulse=[1.0e-3, 1.25e-3, 2.0e-3, 2.2e-3])
    assert made.get("speed") == pytest.approx([0.0, 200.0, 800.0, 800.0])


def test_no_pulse_stops():
    assert escs(pulse=[0.0, 0.9e-3, 1e-3, 0.0]).get("speed") == [0.0] * 4


def test_pulses_must_rise():
    with pytest.raises(InputError, match=r"pulse_min must be less than pulse_max, got 0\.002"):
        escs(pulse_min=2e-3)
