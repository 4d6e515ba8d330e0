"""Propellers by K_T and K_Q, the Wageningen B series, four quadrants."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from seatrial_kits.fitted.parts.wageningen import wageningen_b
from tests.kits.fitted.fitting import DENSITY, craft, load, padded, shown

D = 0.3
SCREW = {
    "propulsor_position_1": (-1.0, 0.2, 0.1),
    "propulsor_diameter_1": D,
    "propulsor_speed_1": (60.0, 40.0),
    "propulsor_wake_1": 0.2,
    "propulsor_deduction_1": 0.15,
    "propulsor_moment_share_1": 0.7,
}
CURVES = {"propulsor_K_T_1": (0.4, -0.3, -0.15), "propulsor_K_Q_1": (0.05, -0.02, -0.03)}


def pushed(thrust, moment, hand=1):
    """Return the load of a propeller of `SCREW` that gives thrust and takes a moment."""
    force = 0.85 * thrust * np.array([1, 0, 0])
    reaction = np.array([-hand * 0.7 * moment, 0, 0])
    return np.concatenate([force, np.cross(SCREW["propulsor_position_1"], force) + reaction])


@pytest.mark.parametrize("hand", [1, -1])
@pytest.mark.parametrize("speed", [0.0, 0.7, 1.4])
def test_a_propeller_follows_its_curves(hand, speed):
    part = craft(propulsors="propeller", propulsor_hand_1=hand, **SCREW, **CURVES)
    found = load(part, (speed, 0.3, 0, 0, 0, 0), propulsor_order=padded(0.5))
    n = 30 / math.tau
    J = 0.8 * speed / (n * D)
    K_T, K_Q = 0.4 - 0.3 * J - 0.15 * J**2, 0.05 - 0.02 * J - 0.03 * J**2
    T, Q = DENSITY * n**2 * D**4 * K_T, DENSITY * n**2 * D**5 * K_Q
    np.testing.assert_allclose(found, pushed(T, Q, hand), rtol=1e-12, atol=1e-12)
    shows = shown(part, (speed, 0.3, 0, 0, 0, 0), propulsor_order=padded(0.5))
    assert shows("propulsor_power") == pytest.approx(math.tau * n * Q, rel=1e-12)
    assert shows("propulsor_rate") == pytest.approx(30, rel=1e-15)
    assert shows("propulsor_force") == pytest.approx(0.85 * T, rel=1e-12)


def test_in_reverse_the_advance_does_not_act():
    part = craft(propulsors="propeller", **SCREW, **CURVES)
    n = 20 / math.tau
    still = pushed(-DENSITY * n**2 * D**4 * 0.4, -DENSITY * n**2 * D**5 * 0.05)
    for speed in (0, 1.0, -1.0):
        found = load(part, (speed, 0, 0, 0, 0, 0), propulsor_order=padded(-0.5))
        np.testing.assert_allclose(found, still, rtol=1e-12, atol=1e-12)


def test_beyond_its_limits_j_is_held_and_a_shaft_that_stops_stops_pushing():
    part = craft(propulsors="propeller", propulsor_advance_limit_1=0.9, **SCREW, **CURVES)
    n = 6 / math.tau
    K_T, K_Q = 0.4 - 0.3 * 0.9 - 0.15 * 0.81, 0.05 - 0.02 * 0.9 - 0.03 * 0.81
    held = pushed(DENSITY * n**2 * D**4 * K_T, DENSITY * n**2 * D**5 * K_Q)
    found = load(part, (2.0, 0, 0, 0, 0, 0), propulsor_order=padded(0.1))
    np.testing.assert_allclose(found, held, rtol=1e-12, atol=1e-12)
    astern = load(part, (-2.0, 0, 0, 0, 0, 0), propulsor_order=padded(0.1))
    np.testing.assert_allclose(
        astern,
        pushed(DENSITY * n**2 * D**4 * 0.4, DENSITY * n**2 * D**5 * 0.05),
        rtol=1e-12,
        atol=1e-12,
    )
    stopping = load(part, (2.0, 0, 0, 0, 0, 0), propulsor_order=padded(1e-7))
    np.testing.assert_allclose(stopping, 0, atol=1e-10)
    assert not load(part, (2.0, 0, 0, 0, 0, 0), propulsor_order=padded(0)).any()


def test_rates_of_the_body_are_part_of_the_advance():
    # A propeller to starboard of the axis advances less as the craft turns to starboard.
    part = craft(propulsors="propeller", **SCREW, **CURVES)
    turning = load(part, (1.0, 0, 0, 0, 0, 0.5), propulsor_order=padded(0.5))
    slower = load(part, (1.0 - 0.2 * 0.5, 0, 0, 0, 0, 0), propulsor_order=padded(0.5))
    np.testing.assert_allclose(turning, slower, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize(
    ("J", "K_T", "K_Q"),
    [(0, 0.4566, 0.0700), (0.6632, 0.1798, 0.0312)],  # MSS, wageningen(J, 1, 0.718, 3)
)
def test_the_series_is_that_of_mss(J, K_T, K_Q):
    thrust, moment = wageningen_b(3, 1.0, 0.718)
    assert np.polyval(thrust[::-1], J) == pytest.approx(K_T, abs=5.1e-5)
    assert np.polyval(moment[::-1], J) == pytest.approx(K_Q, abs=5.1e-5)


@pytest.mark.parametrize("blades", [2, 4, 7])
@pytest.mark.parametrize("pitch", [0.6, 1.0, 1.4])
def test_propellers_of_the_series_are_less_than_perfect(blades, pitch):
    # eta = J K_T / (2 pi K_Q) is below that of an actuator disk, 2 / (1 + sqrt(1 + 8 K_T / (pi J^2))).
    thrust, moment = (np.polynomial.Polynomial(each) for each in wageningen_b(blades, pitch, 0.6))
    zero = min(r.real for r in thrust.roots() if abs(r.imag) < 1e-9 and r.real > 0)
    J = np.linspace(0.05, 0.95, 50) * zero
    efficiency = J * thrust(J) / (math.tau * moment(J))
    ideal = 2 / (1 + np.sqrt(1 + 8 * thrust(J) / (math.pi * J**2)))
    assert (efficiency < ideal).all()
    assert 0.4 < efficiency.max() < 0.85
    assert 0.8 * pitch < zero < 1.25 * pitch  # without thrust at about the pitch's advance


def test_a_propeller_of_the_series_pushes_by_its_polynomials():
    series = {"blades": 4, "pitch_ratio": 1.1, "area_ratio": 0.55}
    part = craft(
        propulsors="wageningen-b", **SCREW, **{f"propulsor_{k}_1": v for k, v in series.items()}
    )
    found = load(part, (1.2, 0, 0, 0, 0, 0), propulsor_order=padded(0.9))
    n = 54 / math.tau
    J = 0.8 * 1.2 / (n * D)
    K_T, K_Q = (np.polyval(c[::-1], J) for c in wageningen_b(4, 1.1, 0.55))
    expected = pushed(DENSITY * n**2 * D**4 * K_T, DENSITY * n**2 * D**5 * K_Q)
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-12)


C_T = (0.02, 0.3, 0.01, -0.02, 0.005, -0.8, 0.03, 0.04, -0.006)
C_Q = (0.001, 0.04, -0.002, 0.003, 0.001, -0.1, 0.002, 0.005, 0.001)


@pytest.mark.parametrize("order", [0.5, -0.5, 0.0])
@pytest.mark.parametrize("speed", [1.0, -1.0])
def test_four_quadrants_are_a_series_in_the_angle_of_advance(order, speed):
    part = craft(propulsors="four-quadrant", propulsor_C_T_1=C_T, propulsor_C_Q_1=C_Q, **SCREW)
    found = load(part, (speed, 0, 0, 0, 0, 0), propulsor_order=padded(order))
    n = order * (60 if order > 0 else 40) / math.tau
    advance, blade = 0.8 * speed, 0.7 * math.pi * n * D
    beta, pressure = math.atan2(advance, blade), DENSITY / 2 * (advance**2 + blade**2)
    area = math.pi / 4 * D**2

    def series(c):
        harmonics = range(1, 5)
        return c[0] + sum(
            c[k] * math.cos(k * beta) + c[4 + k] * math.sin(k * beta) for k in harmonics
        )

    expected = pushed(pressure * area * series(C_T), pressure * area * D * series(C_Q))
    np.testing.assert_allclose(found, expected, rtol=1e-11, atol=1e-11)


def test_a_propeller_of_one_harmonic_is_a_straight_line_in_j():
    # C_T* = a cos(beta) + b sin(beta): T = rho/8 pi D^2 V (a 0.7 pi n D + b V_a).
    part = craft(
        propulsors="four-quadrant",
        propulsor_C_T_1=(0, 0.5, 0, 0, 0, -0.6, 0, 0, 0),
        **{**SCREW, "propulsor_wake_1": 0.0},
    )
    speed, n = 1.2, 60 / math.tau
    blade = 0.7 * math.pi * n * D
    T = DENSITY * math.pi / 8 * D**2 * math.hypot(speed, blade) * (0.5 * blade - 0.6 * speed)
    found = load(part, (speed, 0, 0, 0, 0, 0), propulsor_order=padded(1))
    np.testing.assert_allclose(found, pushed(T, 0), rtol=1e-12, atol=1e-11)


@settings(max_examples=60, deadline=None)
@given(
    order=st.floats(0.01, 1),
    speed=st.floats(0, 4),
    pitch=st.floats(0.5, 1.4),
    area=st.floats(0.35, 1.05),
    blades=st.sampled_from([3, 4, 5]),
)
def test_no_work_comes_from_nothing(order, speed, pitch, area, blades):
    # From J = 0 to the J of no thrust, where the series was measured.
    thrust, _ = (np.polynomial.Polynomial(each) for each in wageningen_b(blades, pitch, area))
    roots = [r.real for r in thrust.roots() if abs(r.imag) < 1e-9 and r.real > 0]
    n = order * 60 / math.tau
    speed = min(speed, 0.999 * min(roots) * n * D)
    part = craft(
        propulsors="wageningen-b",
        propulsor_blades_1=blades,
        propulsor_pitch_ratio_1=pitch,
        propulsor_area_ratio_1=area,
        **{**SCREW, "propulsor_wake_1": 0.0, "propulsor_deduction_1": 0.0},
    )
    nu, orders = (speed, 0, 0, 0, 0, 0), padded(order)
    done = load(part, nu, propulsor_order=orders)[0] * speed
    power = shown(part, nu, propulsor_order=orders)("propulsor_power")
    assert 0 <= done <= power
