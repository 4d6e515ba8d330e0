"""Lamb's factors, and the terms of a slender body, by closed forms."""

import math

import numpy as np
import pytest
from scipy.integrate import quad

from seatrial.errors import InputError
from seatrial.physics.craft.marine_craft import MarineCraft
from seatrial.physics.craft.terms.spheroid import displaced_mass, inertia, lamb


@pytest.mark.parametrize("ratio", [1.001, 1.04, 1.06, 1.5, 3.0, 8.42, 30.0])
def test_factors_are_those_of_greens_integrals(ratio):
    # Of an ellipsoid with semi-axes a, b, b: Lamb, art. 114; the variable of the integral is
    # b^2 (s / (1 - s))^2.
    a2 = ratio**2

    def integral(of_a, of_b):
        def at(s):
            x = (s / (1 - s)) ** 2
            return 2 * s / (1 - s) ** 3 * (a2 + x) ** -of_a * (1 + x) ** -of_b

        return ratio * quad(at, 0, 1, epsabs=1e-14, epsrel=1e-13)[0]

    alpha, beta = integral(1.5, 1), integral(0.5, 2)
    k = lamb(ratio, 1.0)
    assert k.k1 == pytest.approx(alpha / (2 - alpha), rel=1e-10)
    assert k.k2 == pytest.approx(beta / (2 - beta), rel=1e-10)
    difference = (a2 - 1) ** 2 * (beta - alpha) / (2 * (a2 - 1) + (a2 + 1) * (alpha - beta))
    assert k.k_prime == pytest.approx(difference / (a2 + 1), rel=1e-8)


def test_a_sphere_has_half_its_mass_and_no_inertia():
    k = lamb(2.0, 2.0)
    assert (k.k1, k.k2, k.k_prime) == pytest.approx((0.5, 0.5, 0.0), abs=1e-15)


def test_series_and_closed_form_meet():
    # e = 0.3 is where one gives way to the other.
    below, above = (lamb(1.0, math.sqrt(1 - e**2)) for e in (0.3 - 1e-9, 0.3 + 1e-9))
    for name in ("k1", "k2", "k_prime"):
        assert getattr(below, name) == pytest.approx(getattr(above, name), rel=1e-7)


def test_a_long_spheroid_has_the_added_mass_of_cylinders():
    k = lamb(1000.0, 1.0)
    assert (k.k1, k.k2, k.k_prime) == pytest.approx((0, 1, 1), abs=1e-4)


def test_mass_and_inertia_are_the_integrals():
    # Slices across: radius b sqrt(1 - x^2 / a^2).
    a, b, rho = 0.8, 0.095, 1026.0
    x = np.linspace(-a, a, 200001)
    area = math.pi * b**2 * (1 - (x / a) ** 2)
    mass = rho * np.trapezoid(area, x)
    m = displaced_mass(2 * a, 2 * b, rho)
    assert m == pytest.approx(mass, rel=1e-9)
    about = rho * np.trapezoid(area**2 / (2 * math.pi), x)
    across = about / 2 + rho * np.trapezoid(area * x**2, x)
    assert inertia(m, 2 * a, 2 * b) == pytest.approx((about, across), rel=1e-8)


@pytest.mark.parametrize(("length", "diameter"), [(1.0, 2.0), (1.0, 0.0), (-1.0, -2.0)])
def test_a_spheroid_that_is_not_prolate_is_refused(length, diameter):
    with pytest.raises(InputError, match=r"length .* and diameter .* are allowed"):
        lamb(length, diameter)


ADDED = (3.0, 30.0, 34.0, 0.0, 0.0, 0.0)
TURNED = (0.2, 4.0, 5.0, 0.0, 0.0, 0.0)


def load(nu, terms, **values):
    """Return the load (6,) of the terms at ``nu``, deep in still water."""
    component = MarineCraft("craft")
    settings = {"restoring": "submerged", "added_mass": ADDED, "added_inertia": TURNED, **values}
    for name, value in {**settings, "mass": 20.0, "terms": terms}.items():
        component.set(name, value)
    x = np.array([0, 0, 0, 0, 0, 0, *nu], dtype=float)
    slope = component.derivatives(x)
    component.set("terms", "")
    return component.mass_matrix() @ (slope - component.derivatives(x))[6:]


def test_without_cross_pairs_the_matrix_lacks_eight_elements():
    nu = u, v, w, p, q, r = np.array([1.2, -0.3, 0.4, 0.2, -0.5, 0.6])
    found = load(nu, "coriolis", coriolis="without-cross-pairs", inertia=(1, 2, 3, 0, 0, 0))
    m = 20.0
    rigid = np.array(
        [
            *(m * (q * w - r * v), m * (r * u - p * w), m * (p * v - q * u)),
            *((3 - 2) * q * r, (1 - 3) * p * r, (2 - 1) * p * q),
        ]
    )
    a, b = ADDED[1:3], TURNED
    # C_A of Fossen, with a_u, a_v, a_w along and those of the pairs (u, q), (w, q), (u, r), (v, r) out.
    added = np.array(
        [
            *(0, -a[1] * w * p, a[0] * v * p),
            (a[1] - a[0]) * v * w + (b[2] - b[1]) * q * r,
            *((b[0] - b[2]) * p * r, (b[1] - b[0]) * p * q),
        ]
    )
    np.testing.assert_allclose(found, -(rigid + added), atol=1e-12)


def test_body_lift_is_that_of_a_wing():
    S, b, e, c_d0, rho = 0.2, 0.2, 0.7, 0.06, 1025.0
    u, v, w = 1.5, -0.2, 0.25
    settings = {"body_lift_area": S, "body_lift_span": b, "body_lift_drag": c_d0}
    found = load((u, v, w, 0, 0, 0), "body-lift", body_lift_efficiency=e, **settings)
    alpha, aspect, q = math.atan(w / u), b * b / S, rho / 2 * (u * u + v * v + w * w) * S
    lift = q * math.pi * aspect * alpha / (1 + math.sqrt(1 + aspect**2 / 4))
    drag = q * c_d0 + lift**2 / (q * math.pi * e * aspect)
    flow, across = np.array([u, 0, w]) / math.hypot(u, w), np.array([w, 0, -u]) / math.hypot(u, w)
    np.testing.assert_allclose(found[:3], -drag * flow + lift * across, rtol=1e-12)
    np.testing.assert_allclose(found[3:], 0, atol=1e-12)


def test_fading_damping_fades_with_the_whole_speed():
    nu = (0.3, -0.2, 0.6, 0.4, 0.5, 0.6)
    settings = {"fading_damping_force": (4.0, 7.0), "fading_damping_rate": 3.0}
    found = load(nu, "fading-damping", **settings)
    faded = math.exp(-3 * math.hypot(0.3, 0.2, 0.6))
    np.testing.assert_allclose(found, [-4 * 0.3 * faded, 7 * 0.2 * faded, 0, 0, 0, 0], atol=1e-13)


def test_stations_have_the_weight_of_one_strip_more():
    hull = {"crossflow_length": 2.0, "crossflow_draught": 0.3, "crossflow_coefficient": 0.9}
    sway = 1025.0 / 2 * 2 * 0.3 * 0.9 * 0.4**2
    found = load((0, 0.4, 0, 0, 0, 0), "station-drag", **hull)
    np.testing.assert_allclose(found, [0, -1.05 * sway, 0, 0, 0, 0], rtol=1e-12, atol=1e-12)
    yaw = 1025.0 / 2 * 0.3 * 0.9 * 0.5**2 * 2 * 1.0**4 / 4
    found = load((0, 0, 0, 0, 0, 0.5), "station-drag", **hull)
    np.testing.assert_allclose(found, [0, 0, 0, 0, 0, -1.21 * yaw], rtol=1e-12, atol=1e-12)
