"""The notch of wave filters against its closed form, and controllers that do not answer waves."""

import math

import numpy as np
import pytest
from scipy import signal

from seatrial_kits.ships.control.dynamic_positioning import DynamicPositioning
from seatrial_kits.ships.control.heading_autopilot import HeadingAutopilot


def autopilot(**values):
    pilot = HeadingAutopilot("pilot")
    for name, value in values.items():
        pilot.set(name, value)
    return pilot


def answers(component, output, inputs, steps=3000):
    """Return the output over samples of 0.1 s with inputs by name as functions of time."""
    for name, of_time in inputs.items():
        component.set(name, of_time(0.0))
    component.setup(0.0)
    component.initialise()
    component.begin()
    found = []
    for k in range(steps):
        for name, of_time in inputs.items():
            component.set(name, of_time(k * 0.1))
        found.append(component.get(output))
        component.advance(k * 0.1, 0.1)
    return np.array(found)


@pytest.mark.parametrize("omega", [0.05, 0.4, 0.8, 1.6, 5.0])
def test_the_notch_has_its_closed_form(omega):
    w, z, period = 0.8, 0.15, 0.1
    values = {"wave_frequency": w, "wave_damping": z, "derivative_gain": 0.0, "rudder_limit": 10.0}
    pilot = autopilot(proportional_gain=1.0, **values)
    found = answers(pilot, "rudder", {"heading": lambda t: 0.1 * math.cos(omega * t)})
    # The bilinear rule in scipy, its frequencies bent so that w is in its place.
    scale = w * period / 2 / math.tan(w * period / 2)
    b, a = signal.bilinear([1, 2 * z * w, w * w], [1, 2 * w, w * w], fs=1 / period * scale)
    _, (gain,) = signal.freqz(b, a, [omega * period])
    t = np.arange(len(found)) * period
    wanted = 0.1 * (gain * np.exp(1j * omega * t)).real
    np.testing.assert_allclose(found[1500:], wanted[1500:], atol=1e-9)
    if omega == w:
        assert abs(gain) == pytest.approx(z, rel=1e-12)


def test_a_heading_goes_round_through_the_filter():
    pilot = autopilot(
        proportional_gain=1.0, derivative_gain=0.0, wave_frequency=0.8, rudder_limit=10.0
    )

    def turning(t):
        return math.remainder(0.5 * t, math.tau)

    found = answers(pilot, "rudder", {"heading": turning}, 400)
    # A steady turn comes through late by 2 (1 - z)/w.
    late = np.array([math.remainder(0.5 * (0.1 * k - 2 * 0.9 / 0.8), math.tau) for k in range(400)])
    off = np.abs(np.remainder(found - late + math.pi, math.tau) - math.pi)[200:]
    assert off.max() < 1e-3


def test_without_a_frequency_nothing_is_filtered():
    inputs = {"heading": lambda t: 0.2 * math.sin(t), "yaw_rate": lambda t: 0.2 * math.cos(t)}
    plain = answers(autopilot(), "rudder", inputs, 50)
    wanted = [
        0.860783 * 0.2 * math.sin(0.1 * k) + 22.504992 * 0.2 * math.cos(0.1 * k) for k in range(50)
    ]
    np.testing.assert_allclose(plain, np.clip(wanted, -0.610865, 0.610865), atol=1e-6)


def test_positioning_does_not_answer_waves():
    inputs = {
        "position": lambda t: [math.sin(0.8 * t), 0.5 * math.sin(0.8 * t), 0.0],
        "velocity": lambda t: [0.8 * math.cos(0.8 * t), 0.4 * math.cos(0.8 * t), 0.0],
        "attitude": lambda t: [0.0, 0.0, math.pi + 0.02 * math.sin(0.8 * t)],
        "rates": lambda t: [0.0, 0.0, 0.016 * math.cos(0.8 * t)],
        "station_heading": lambda t: math.pi,
    }
    demands = {}
    for frequency in (0.0, 0.8):
        keeper = DynamicPositioning("keeper")
        keeper.set("capacity", [1e9, 1e9, 1e12])
        keeper.set("wave_frequency", frequency)
        demands[frequency] = np.abs(answers(keeper, "demand", inputs, 1500)[1000:]).max(0)
    assert (demands[0.8] < 0.13 * demands[0.0]).all()
