"""Foil tables and forces against the published tables and the published equations."""

import csv
import hashlib
import math
from importlib.resources import files

import casadi as ca
import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from seatrial.errors import InputError
from seatrial.physics.craft.foils import coefficients, flow_at, foil_load
from seatrial.physics.foils import foil_naca63010, sail_naca0015

ANGLES = st.floats(-math.pi, math.pi)
FLAPS = st.floats(0.0, math.radians(30.0))
# Angle of attack and flap, deg, then C_L and C_D: interpolated by hand in the printed tables.
SAIL_PROBES = [
    (7.5, 0, 1.1, 0.2034),
    (87, 12, 0.11296, 5.086136),
    (42, 27.5, 0.56, 2.53199),
    (177.5, 15, -1.5, 0.18165),
]
FOIL_PROBES = [
    (2.5, 0.2835, 0.01283),
    (12, 0.7056, 0.131594),
    (33, 0.1134, 0.957954),
    (88, 0.0198, 1.966594),
    (-7, -0.6442, 0.043634),
    (177.5, 0.284, 0.01282),
]


def published(name):
    with (files("seatrial") / "physics" / name).open(encoding="ascii", newline="") as file:
        return [{k: float(v) for k, v in row.items()} for row in csv.DictReader(file)]


def looked_up(table, alpha, flap=0.0):
    """Return what the expressions of the plant give."""
    return tuple(float(ca.DM(c)) for c in coefficients(table, ca.DM(alpha), ca.DM(flap)))


# ---------------------------------------------------------------------- tables


@pytest.mark.parametrize(
    ("name", "digest"),
    [
        (
            "foil_naca63010.csv",
            "50e9d4a44954fde2f80de16fe1fd9609e7014c5c07a2f43922c9bcfe4d6cc810",
        ),
        (
            "sail_naca0015.csv",
            "1345bbe865c0676a579f4967380f97794a2bc44990622f547fcccc35d6286993",
        ),
    ],
)
def test_the_printed_digits_are_untouched(name, digest):
    assert hashlib.sha256((files("seatrial") / "physics" / name).read_bytes()).hexdigest() == digest


@pytest.mark.parametrize("look_up", [lambda t, *at: t.coefficients(*at), looked_up])
def test_probe_values(look_up):
    for alpha, flap, c_l, c_d in SAIL_PROBES:
        found = look_up(sail_naca0015(), math.radians(alpha), math.radians(flap))
        assert found == pytest.approx((c_l, c_d), rel=1e-12)
    for alpha, c_l, c_d in FOIL_PROBES:
        found = look_up(foil_naca63010(), math.radians(alpha))
        assert found == pytest.approx((c_l, c_d), rel=1e-12)


@pytest.mark.parametrize("look_up", [lambda t, *at: t.coefficients(*at), looked_up])
def test_every_printed_point_comes_back(look_up):
    for row in published("sail_naca0015.csv"):
        at = math.radians(row["alpha_deg"]), math.radians(row["flap_deg"])
        found = look_up(sail_naca0015(), *at)
        assert found == pytest.approx((row["cl"], row["cd"]), abs=1e-13)
    for row in published("foil_naca63010.csv"):
        found = look_up(foil_naca63010(), math.radians(row["alpha_deg"]))
        assert found == pytest.approx((row["cl"], row["cd"]), abs=1e-13)


@given(ANGLES, FLAPS)
def test_expressions_and_numbers_look_up_the_same(alpha, flap):
    for table in (sail_naca0015("patched", "physical"), foil_naca63010()):
        found = looked_up(table, alpha, flap)
        assert found == pytest.approx(table.coefficients(alpha, flap), abs=1e-13)


@given(st.floats(1e-9, math.pi - 1e-9), FLAPS)
def test_port_and_starboard_differ_in_the_sign_of_lift_alone(alpha, flap):
    c_l, c_d = sail_naca0015().coefficients(alpha, flap)
    assert sail_naca0015().coefficients(-alpha, flap) == (-c_l, c_d)


@given(ANGLES, FLAPS)
def test_angles_of_attack_are_taken_round_the_circle(alpha, flap):
    found = sail_naca0015().coefficients(alpha + math.tau, flap)
    # Adding a full turn rounds alpha, and 26 is the greatest slope of a coefficient per radian.
    near = [sail_naca0015().coefficients(alpha + d, flap) for d in (-1e-15, 0.0, 1e-15)]
    assert any(found == pytest.approx(one, abs=1e-13) for one in near)


@pytest.mark.parametrize("look_up", [lambda t, *at: t.coefficients(*at), looked_up])
def test_a_flap_beyond_the_table_counts_as_the_nearest(look_up):
    table, alpha = sail_naca0015(), math.radians(12.0)
    assert look_up(table, alpha, 2.0) == look_up(table, alpha, math.radians(30.0))
    assert look_up(table, alpha, -0.1) == look_up(table, alpha, 0.0)


def test_the_patch_changes_one_entry():
    as_printed, patched = sail_naca0015(), sail_naca0015("patched")
    changed = [
        (row, column)
        for row in range(7)
        for column in range(37)
        if as_printed.lift[row][column] != patched.lift[row][column]
    ]
    assert changed == [(3, 35)]
    assert (as_printed.lift[3][35], patched.lift[3][35]) == (-1.6, -0.6)
    assert as_printed.drag == patched.drag


@pytest.mark.parametrize("make", [lambda h: sail_naca0015(high_alpha=h), foil_naca63010])
def test_physical_lift_changes_sign_beyond_a_right_angle(make):
    for alpha in (95.0, 120.0, 172.0):
        c_l, c_d = make("table").coefficients(math.radians(alpha))
        assert make("physical").coefficients(math.radians(alpha)) == (-c_l, c_d)
        assert c_l > 0.0
    for alpha in (3.0, 60.0, 90.0):
        angle = math.radians(alpha)
        assert make("physical").coefficients(angle) == make("table").coefficients(angle)


def test_other_words_are_refused():
    with pytest.raises(InputError, match=r"unknown entry 'corrected'.*patched, verbatim"):
        sail_naca0015("corrected")
    with pytest.raises(InputError, match=r"unknown high_alpha 'flat'.*physical, table"):
        foil_naca63010("flat")


# ---------------------------------------------------------------------- forces


def published_sail(nu, wind, lam, kappa):
    """Eqs 2.15 to 2.21 as printed, without the rate of the sail; wind in body axes."""
    rho, area, h1, l1, l2 = 1.225, 0.9, 0.867, -0.343, 0.228
    u, v, p, r = nu
    a = wind[0] - u - r * l2 * math.sin(lam)
    b = wind[1] - v + r * (l1 + l2 * math.cos(lam)) - p * h1
    beta = math.atan2(b, a)
    alpha = math.remainder(beta - lam + math.pi, math.tau)
    c_l, c_d = sail_naca0015().coefficients(alpha, kappa)
    L, D = (0.5 * rho * area * c * (a * a + b * b) for c in (c_l, c_d))
    X = -L * math.sin(beta) + D * math.cos(beta)
    Y = L * math.cos(beta) + D * math.sin(beta)
    return [X, Y, h1 * Y, X * l2 * math.sin(lam) - Y * (l1 + l2 * math.cos(lam))]


def published_rudder(nu, current, sigma):
    """Eqs 2.15, 2.16, 2.22, 2.23 and 2.25 as printed, with alpha as 2.28 and 3.5 have it."""
    rho, area, h3, l4 = 1000.0, 0.132 * 0.06, 0.039, 0.562
    u, v, p, r = nu
    a, b = current[0] - u, current[1] - v + r * l4 + p * h3
    beta = math.atan2(b, a)
    alpha = math.remainder(-beta + sigma + math.pi, math.tau)
    c_l, c_d = foil_naca63010().coefficients(alpha)
    L, D = (0.5 * rho * area * c * (a * a + b * b) for c in (c_l, c_d))
    s, c = math.sin(beta), math.cos(beta)
    across = L * c - D * s
    return [L * s + D * c, -across, h3 * across, l4 * across]


SPEEDS = st.tuples(*[st.floats(-3.0, 3.0)] * 4)
FLUID = st.tuples(st.floats(-5.0, 5.0), st.floats(-5.0, 5.0))


@given(SPEEDS, FLUID, st.floats(-1.6, 1.6), FLAPS)
def test_sail_load_is_that_of_the_published_equations(nu, wind, lam, kappa):
    place = ca.DM([0.343 - 0.228 * math.cos(lam), -0.228 * math.sin(lam), -0.867])
    flow = flow_at(place, ca.DM(wind), ca.DM(nu))
    a, b = np.array(flow).ravel()
    # With a flap the lift jumps at alpha = 0 and 180 deg, where rounding decides on the side.
    assume(abs(math.sin(math.atan2(b, a) - lam)) > 1e-9)
    found = foil_load(sail_naca0015(), place, flow, lam, 0.5 * 1.225 * 0.9, kappa)
    np.testing.assert_allclose(
        np.array(found).ravel(), published_sail(nu, wind, lam, kappa), rtol=1e-9, atol=1e-9
    )


@given(SPEEDS, FLUID, st.floats(-0.5, 0.5))
def test_rudder_load_is_that_of_the_corrected_equations(nu, current, sigma):
    place = ca.DM([-0.562, 0.0, 0.039])
    flow = flow_at(place, ca.DM(current), ca.DM(nu))
    found = foil_load(foil_naca63010(), place, flow, sigma, 0.5 * 1000.0 * 0.00792)
    np.testing.assert_allclose(
        np.array(found).ravel(), published_rudder(nu, current, sigma), rtol=1e-9, atol=1e-9
    )


def test_slopes_at_no_angle_of_attack_are_those_of_a_symmetric_foil():
    alpha = ca.SX.sym("alpha")
    slopes = [ca.jacobian(c, alpha) for c in coefficients(foil_naca63010(), alpha, 0.0)]
    lift, drag = ca.Function("slopes", [alpha], slopes)(0.0)
    assert float(lift) == pytest.approx(0.567 / math.radians(5.0), rel=1e-12)
    assert float(drag) == 0.0


def test_derivatives_are_finite_where_nothing_flows():
    flow = ca.SX.sym("flow", 2)
    load = foil_load(sail_naca0015(), ca.DM([0.1, 0.0, -0.8]), flow, 0.3, 1.0, 0.1)
    slope = ca.Function("slope", [flow], [ca.jacobian(load, flow)])
    np.testing.assert_allclose(np.array(slope([0.0, 0.0])), 0.0, atol=1e-10)
