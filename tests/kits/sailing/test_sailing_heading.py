"""Heading controllers: inversion of the rudder, poles, feed-forward against figures.

Figures without a formula beside them were computed independently of this project from the
equations of [Silva2018], corrected.
"""

import math

import numpy as np
import pytest

from seatrial.model.units import conversion
from seatrial.system.parameters import load_vehicle
from seatrial_kits.sailing.control.heading_backstepping import SailingHeadingBackstepping
from seatrial_kits.sailing.control.heading_pid import SailingHeadingPid
from tests.devices.running import started

GLORIA = load_vehicle("gloria")
DEG = math.radians(1.0)
UNLIMITED = {"rudder_limit": 1e9}
HULL = {"rudder_place": [-0.562, 0.039], "rudder_area": 0.00792, "water_density": 1000.0}


def gloria(cls, table, **changes):
    """Return the controller with the boat's parameters, variant source."""
    values = {}
    for name, entry in GLORIA.parameter_set(table, "source").values.items():
        value = entry.value
        if cls.ports[name].type is float:
            factor = conversion(entry.unit, cls.ports[name].unit)[0]
            value = [factor * v for v in value] if isinstance(value, list) else factor * value
        values[name] = value
    return started(cls, **{**values, **changes})


def pid(**changes):
    return gloria(SailingHeadingPid, "sailing-heading-pid", **changes)


def backstepping(**changes):
    table = "sailing-heading-backstepping"
    return gloria(SailingHeadingBackstepping, table, **changes)


# ---------------------------------------------------------------------- inversion


@pytest.mark.parametrize(
    "nu", [(2.0, 0.0, 0.0, 0.0), (1.5, -0.1, 0.05, 0.1), (-1.0, 0.05, 0, 0.02)]
)
@pytest.mark.parametrize("wanted", [-0.3, 0.2])
def test_a_thin_foil_gives_the_moment_that_was_asked_for(nu, wanted):
    """N = l L cos(beta) with L = rho A V^2 pi alpha: 2.15, 2.25 without drag, 3.5."""
    controller = pid(K_p=1.0, K_i=0.0, K_d=0.0, heading_wanted=wanted, nu=nu, **UNLIMITED)
    u, v, p, r = nu
    a, b = -u, -v + 0.562 * r + 0.039 * p
    beta, speed = math.atan2(b, a), math.hypot(a, b)
    alpha = math.remainder(-beta + controller.get("rudder") + math.pi, math.tau)
    moment = 0.562 * 1000.0 * 0.00792 * math.pi * speed**2 * alpha * math.cos(beta)
    assert controller.get("yaw_moment") == pytest.approx(wanted, rel=1e-12)
    assert moment == pytest.approx(wanted, rel=1e-9)


def test_rudder_to_port_turns_to_port():
    assert pid(heading_wanted=-0.01, nu=[2.0, 0, 0, 0]).get("rudder") > 0.0


def test_at_rest_the_inversion_stays_finite():
    """The flow is taken as from ahead, and V^2 cos(beta) as -0.01 m2/s2."""
    controller = pid(K_p=1.0, K_i=0.0, heading_wanted=1e-3, **UNLIMITED)
    expected = -1e-3 / (0.562 * 1000.0 * 0.00792 * math.pi * 0.01)
    assert controller.get("rudder") == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(("wanted", "rudder"), [(1.0, -12.0), (-1.0, 12.0)])
def test_limit(wanted, rudder):
    assert pid(heading_wanted=wanted, nu=[1.0, 0, 0, 0]).get("rudder") == pytest.approx(
        rudder * DEG
    )


# ---------------------------------------------------------------------- PID


def slope(controller, output, name, axis=None, step=1e-6):
    """Return d(output)/d(input) by central differences."""
    values = []
    before = controller.get(name)
    for side in (step, -step):
        if axis is None:
            controller.set(name, before + side)
        else:
            controller.set(name, [v + side * (i == axis) for i, v in enumerate(before)])
        values.append(controller.get(output))
    controller.set(name, before)
    return (values[0] - values[1]) / (2 * step)


def test_poles_of_the_design():
    """I = 28.541 kg m2 without damping of yaw: 0.76 rad/s with damping 0.6, as 3.8 has it."""
    controller = pid(period=1e-3)
    K_p = -slope(controller, "yaw_moment", "heading") - 2.3e-3
    K_d = -slope(controller, "yaw_moment", "nu", axis=3)
    controller.set("heading_wanted", 0.1)
    before = controller.get("yaw_moment")
    controller.set("nu", [30.0, 0.0, 0.0, 0.0])  # fast enough for the rudder not to saturate
    controller.advance(0.0, 1.0)
    K_i = (controller.get("yaw_moment") - before) / 0.1
    poles = sorted(np.roots([28.541, K_d, K_p, K_i]), key=lambda z: (z.real, z.imag))
    expected = [-0.456238 - 0.610812j, -0.456238 + 0.610812j, -0.138643]
    np.testing.assert_allclose(poles, expected, atol=2e-6)
    assert abs(poles[0]) == pytest.approx(0.762394, abs=2e-6)


def moments(controller, errors):
    """Return the moment at each instant of 20 ms, for these errors of heading."""
    found = []
    for k, error in enumerate(errors):
        controller.set("heading_wanted", error)
        found.append(controller.get("yaw_moment"))
        controller.advance(0.02 * k, 0.02)
    return found


def test_integral_grows_before_it_is_used():
    fast = {"nu": [10.0, 0, 0, 0]}
    found = moments(pid(**fast), [0.1, 0.1, 0.2])
    proportional = [20.2 * e for e in (0.1, 0.1, 0.2)]
    integral = [2.3 * 0.02 * e for e in (0.1, 0.2, 0.4)]
    assert found == pytest.approx(np.add(proportional, integral).tolist(), rel=1e-12)


def test_integral_freezes_after_an_instant_at_the_limit():
    found = moments(pid(nu=[1.0, 0, 0, 0]), [1.0, 1.0, 1.0])
    assert found == pytest.approx([20.2 + 2.3 * 0.02] * 3, rel=1e-12)


def test_integral_is_limited():
    found = moments(pid(nu=[10.0, 0, 0, 0], integral_limit=0.05), [0.5] * 10)
    assert found == pytest.approx([20.2 * 0.5 + 2.3 * 0.01, 20.2 * 0.5 + 0.046] + [10.15] * 8)


def test_heel_shortens_the_rate_of_the_heading():
    turning = pid(nu=[2.0, 0, 0, 0.1], heel=60 * DEG)
    assert turning.get("yaw_moment") == pytest.approx(-30.0 * 0.1 * 0.5, rel=1e-12)


def test_the_shorter_way_round():
    nu = [2.0, 0, 0, 0]
    assert pid(heading=3.0, heading_wanted=-3.0, nu=nu).get("yaw_moment") > 0.0
    assert pid(heading=-3.0, heading_wanted=3.0, nu=nu).get("yaw_moment") < 0.0


# ---------------------------------------------------------------------- backstepping

# A boat with phi = 0.1, psi = 0.6, wind of 5 m/s northwards, sail at 0.7, flap at 0.2 rad:
# the yaw moments of sail, keel, Coriolis and damping (both on the left-hand side).
NU = (1.2, -0.05, 0.03, 0.02)
SAIL, KEEL, CORIOLIS, DAMPING = -0.05622531174, -1.669748085, -1.20102, 0.96


def probe(**changes):
    north = [5.0 * math.cos(0.6), -5.0 * math.sin(0.6) * math.cos(0.1)]
    u, v, p, r = NU
    a, b = north[0] - u, north[1] - v - 0.115 * r - 0.867 * p
    apparent = [math.hypot(a, b), math.atan2(b, a)]
    state = {"nu": list(NU), "apparent_wind": apparent, "sail_start": 0.7, "flap_start": 0.2}
    return backstepping(**{**state, "heading": 0.6, "heading_wanted": 0.6, **changes})


def test_feed_forward_is_the_moment_of_the_boat():
    e, r, K_p, K_i, K_d = 0.0, NU[3], 0.2, 0.001, 0.07
    d2, d2_dot = 0.0, -K_i * r - K_p * r
    expected = -(SAIL + KEEL - CORIOLIS - DAMPING) + 28.541 * (d2_dot - e - K_d * (r - d2))
    assert probe().get("yaw_moment") == pytest.approx(expected, rel=1e-9)


def test_feed_forward_takes_sail_and_flap_of_the_instant_before():
    controller = probe()
    before = controller.get("yaw_moment")
    controller.set("sail", 1.2)
    controller.set("flap", 0.0)
    assert controller.get("yaw_moment") == before
    controller.advance(0.0, 0.02)
    moved = probe(sail_start=1.2, flap_start=0.0)
    assert controller.get("yaw_moment") == pytest.approx(moved.get("yaw_moment"), rel=1e-12)
    assert controller.get("yaw_moment") != pytest.approx(before, rel=1e-3)


EMPTY = {"sail_area": 0.0, "keel_area": 0.0, "Y_rdot": 0.0, "N_r": 0.0}


def test_closed_loop_of_the_design_model_has_the_eigenvalues_of_z():
    """psi' = r, I r' = yaw_moment, z1' = e: those of 3.33, with a damping of 0.083."""
    controller = backstepping(**EMPTY, **UNLIMITED)
    by_psi = slope(controller, "yaw_moment", "heading") / 28.541
    by_r = slope(controller, "yaw_moment", "nu", axis=3) / 28.541
    controller.set("nu", [30.0, 0.0, 0.0, 0.0])
    controller.set("heading", 0.1)
    controller.advance(0.0, 0.02)  # z1 = 0.002
    by_z1 = (controller.get("yaw_moment") / 28.541 - 0.1 * by_psi) / 0.002
    A = np.array([[0, 1, 0], [by_psi, by_r, by_z1], [1, 0, 0]])
    found = sorted(np.linalg.eigvals(A), key=lambda z: (z.real, z.imag))
    expected = [-0.117799 - 1.411401j, -0.117799 + 1.411401j, -0.035402]
    np.testing.assert_allclose(found, expected, atol=2e-6)


def lyapunov_error(h):
    """Return V(0) and the largest error of V against the integral of its rate, over 8 s."""
    K_p, K_i, K_d = 0.2, 0.001, 0.07
    controller = backstepping(**EMPTY, **UNLIMITED, period=h)
    psi, r, z1, V, powers = 0.5, 0.0, 0.0, [], []
    for k in range(round(8.0 / h)):
        controller.set("heading", psi)
        controller.set("nu", [30.0, 0.0, 0.0, r])
        turning = controller.get("yaw_moment") / 28.541
        V.append(controller.get("lyapunov"))
        z2 = psi + K_i * z1
        z3 = r + K_i * psi + K_p * z2 + z1
        powers.append(K_i * z1**2 + K_p * z2**2 + K_d * z3**2)
        controller.advance(k * h, h)
        z1 += h * psi
        psi, r = psi + h * r + 0.5 * h * h * turning, r + h * turning
    assert (np.diff(V) < 0.0).all()
    V, powers = np.array(V), np.array(powers)
    lost = np.cumsum(0.5 * (powers[1:] + powers[:-1]) * h)
    return V[0], np.abs(V[1:] - V[0] + lost).max()


def test_lyapunov_function_decays_as_the_design_says():
    """dV/dt = -(K_i z1^2 + K_p z2^2 + K_d z3^2), but for what holding the moment costs."""
    start, coarse = lyapunov_error(4e-3)
    _, fine = lyapunov_error(2e-3)
    assert start == pytest.approx(0.5 * (0.5**2 + (0.0005 + 0.1) ** 2), rel=1e-9)
    assert fine < 0.01 * start
    assert coarse / fine == pytest.approx(2.0, abs=0.05)  # of first order in the period


def test_integral_of_backstepping_freezes_after_an_instant_at_the_limit():
    controller = backstepping(**EMPTY, heading=1.0, nu=[1.0, 0, 0, 0])
    controller.advance(0.0, 0.1)  # instants at 0 to 0.08 s, the first of them counts
    still = controller.get("lyapunov")
    controller.advance(0.1, 0.1)
    assert controller.get("lyapunov") == still
