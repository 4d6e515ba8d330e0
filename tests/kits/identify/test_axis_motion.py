"""One axis against closed forms."""

import numpy as np
import pytest

from seatrial_kits.identify.axis_motion import AxisMotion, AxisRotation


def motion(cls=AxisMotion, **settings):
    made = cls("axis")
    for name, value in settings.items():
        made.set(name, value)
    return made


@pytest.mark.parametrize("cls", [AxisMotion, AxisRotation])
def test_terminal_velocity(cls):
    axis = motion(cls, linear=-0.1, quadratic=-2.0, thrust=10.0, offset=0.3, command=0.25)
    final = axis.reference([0.0, 200.0])["velocity"][-1]
    force = 0.25 * 10.0 + 0.3
    expected = (-0.1 + np.sqrt(0.1**2 + 4 * 2.0 * force)) / (2 * 2.0)
    assert final == pytest.approx(expected, rel=1e-9)


def test_quadratic_drag_alone_is_a_hyperbolic_tangent():
    axis = motion(quadratic=-2.0, thrust=10.0, command=-0.3)
    t = np.linspace(0.0, 2.0, 21)
    found = axis.reference(t)
    U = np.sqrt(3.0 / 2.0)
    np.testing.assert_allclose(found["velocity"], -U * np.tanh(t * 3.0 / U), atol=1e-9)
    np.testing.assert_allclose(
        found["place"], -np.log(np.cosh(t * 3.0 / U)) * U**2 / 3.0, atol=1e-9
    )


def test_quadratic_thrust_reverses():
    ahead, astern = (
        motion(thrust_law="quadratic", thrust=8.0, command=beta).derivatives(np.zeros(3))
        for beta in (0.5, -0.5)
    )
    np.testing.assert_allclose([ahead[1], astern[1]], [2.0, -2.0])


def test_a_lag_without_drag():
    axis = motion(lag="thruster", time_constant=0.2, thrust=4.0, command=0.5)
    t = np.linspace(0.0, 1.0, 11)
    found = axis.reference(t)["velocity"]
    np.testing.assert_allclose(found, 2.0 * (t - 0.2 * -np.expm1(-t / 0.2)), atol=1e-9)
