"""Angles as instruments show them: within their circle, whatever the motion and the errors."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from seatrial.devices.ahrs import Ahrs
from seatrial.devices.anemometer import Anemometer
from seatrial.devices.compass import Compass

from .running import started

HALF, FULL = (-math.pi, math.pi), (0.0, math.tau)
LARGE = st.floats(-20, 20)
BY_PHI, BY_PSI = (lambda angle: [angle, 0.0, 0.0]), (lambda angle: [0.0, 0.0, angle])
# Component, output, its place, its circle, attitude by angle, other inputs, sign of the angle.
ANGLES = [
    pytest.param(Ahrs, "euler", 0, HALF, BY_PHI, {}, 1.0, id="ahrs roll"),
    pytest.param(Ahrs, "euler", 2, FULL, BY_PSI, {}, 1.0, id="ahrs heading"),
    pytest.param(Compass, "heading", None, FULL, BY_PSI, {"deviation": [0.0] * 4}, 1.0, id="compass"),
    pytest.param(Anemometer, "angle", None, HALF, BY_PSI, {"wind": [5.0, 0.0]}, -1.0, id="vane"),
]  # fmt: skip


def shown(cls, output, place, attitude, inputs, bias):
    errors = {
        name: [0.0] * port.size if port.axes else 0.0
        for name, port in cls.ports.items()
        if name.endswith(("_noise", "_instability", "_resolution"))
    }
    axes = cls.ports[output].size
    biased = bias if place is None else [bias if i == place else 0.0 for i in range(axes)]
    sensor = started(cls, **errors, **inputs, **{f"{output}_bias": biased}, attitude=attitude)
    value = sensor.get(output)
    return value if place is None else value[place]


@pytest.mark.parametrize(("cls", "output", "place", "circle", "attitude", "inputs", "sign"), ANGLES)
@given(angle=LARGE, bias=LARGE)
def test_an_angle_stays_in_its_circle(cls, output, place, circle, attitude, inputs, sign, angle, bias):  # fmt: skip
    low, high = circle
    for error in (0.0, bias):
        found = shown(cls, output, place, attitude(angle), inputs, error)
        assert low <= found <= high
        assert found != (low if circle is HALF else high)
        expected = sign * angle + error
        assert math.remainder(found - expected, math.tau) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(("cls", "output", "place", "circle", "attitude", "inputs", "sign"), ANGLES)
def test_a_bias_leads_across_the_end_of_the_circle(
    cls, output, place, circle, attitude, inputs, sign
):
    end = circle[1]
    found = shown(cls, output, place, attitude(sign * (end - 0.01)), inputs, 0.02)
    assert found == pytest.approx(circle[0] + 0.01, abs=1e-12)
