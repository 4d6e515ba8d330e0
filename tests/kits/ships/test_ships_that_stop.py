"""Ships with an engine: the Wageningen B4-70 in four quadrants, run-down, crash stop, backing."""

import math
from functools import cache

import numpy as np
import pytest

from seatrial_kits.fitted.parts.screws import all_quadrants
from seatrial_kits.fitted.parts.wageningen import wageningen_b, wageningen_b4_70
from tests.craft.references import shipped

SHIPS = {"kvlcc2": "sea", "mariner": "cubic"}
H = 0.2
ships = pytest.mark.parametrize("name", SHIPS)


def ship(name, **values):
    return shipped("mmg-ship", f"{name}.mmg-ship", SHIPS[name], **values)


def resistance(vessel):
    """Return k of R = k u^2, N.s2/m2, and the mass with added mass, kg."""
    k = vessel.water_density / 2 * vessel.length * vessel.draught * vessel.resistance
    return k, vessel.mass_matrix()[0, 0]


# ---------------------------------------------------------------------- four quadrants


def test_the_series_at_rest_is_that_of_smogeli():
    # O. N. Smogeli, Control of marine propellers, NTNU 2006: the propeller of 4 m.
    for n, K_T, K_Q in ((1.0, 0.445, 0.0666), (-1.0, -0.347, -0.0628)):
        thrust, moment = all_quadrants(4.0, 1000.0, n, 0.0, wageningen_b4_70())
        assert float(thrust) / 1000.0 / 4.0**4 == pytest.approx(K_T, abs=5e-4)
        assert float(moment) / 1000.0 / 4.0**5 == pytest.approx(K_Q, abs=5e-5)


@pytest.mark.parametrize("J", np.linspace(0.0, 1.1, 12))
def test_the_first_quadrant_is_that_of_the_polynomials_of_the_series(J):
    thrust, moment = all_quadrants(1.0, 1.0, 1.0, J, wageningen_b4_70())
    K_T, K_Q = (np.polynomial.polynomial.polyval(J, c) for c in wageningen_b(4, 1.0, 0.7))
    assert float(thrust) == pytest.approx(K_T, abs=0.026)
    assert float(moment) == pytest.approx(K_Q, abs=0.0021)


@pytest.mark.parametrize("J", np.linspace(0.0, 0.75, 6))
def test_the_propeller_of_the_kvlcc2_has_the_thrust_of_the_paper(J):
    vessel = ship("kvlcc2", propeller_wake=0.0, propeller_order=1.0)
    n, D = vessel.propeller_speed[0] / math.tau, vessel.propeller_diameter
    vessel.set("nu_start", [J * n * D, 0.0, 0.0])
    vessel.initialise()
    found = vessel.get("propeller_thrust") / (1025.0 * n**2 * D**4)
    assert found == pytest.approx(0.2931 - 0.2753 * J - 0.1385 * J**2, abs=0.009)


def test_a_shaft_astern_takes_the_stern_aside_and_a_moment_with_it():
    rest = np.zeros(6)
    pull = ship("kvlcc2", propeller_order=-1.0).derivatives(rest)
    other = ship("kvlcc2", propeller_order=-1.0, propeller_side_force=-0.1).derivatives(rest)
    none = ship("kvlcc2", propeller_order=-1.0, propeller_side_force=0.0).derivatives(rest)
    vessel = ship("kvlcc2")
    load = vessel.mass_matrix() @ pull[3:]
    thrust = load[0] / (1 - vessel.propeller_deduction)
    np.testing.assert_allclose(load[1:], 0.1 * thrust * np.array([1, -0.48 * 320]), rtol=1e-9)
    np.testing.assert_allclose(other[4:], -pull[4:], rtol=1e-9)
    assert not none[4:].any()
    ahead = ship("kvlcc2", propeller_order=1.0).derivatives(rest)
    assert not ahead[4:].any()


# ---------------------------------------------------------------------- resistance and thrust


@ships
def test_without_a_propeller_the_ship_runs_down_as_a_square_law_has_it(name):
    vessel = ship(name, propeller_series_share=[0.0, 0.0])
    k, mass = resistance(vessel)
    u_0 = vessel.nu_start[0]
    T = mass / (k * u_0)
    run = vessel.reference(np.linspace(0.0, 3 * T, 7), rtol=1e-9)
    np.testing.assert_allclose(run["nu.u"], u_0 / (1 + run.t / T), rtol=1e-6)
    np.testing.assert_allclose(run["eta.x"], u_0 * T * np.log1p(run.t / T), rtol=1e-6, atol=1e-6)


@ships
def test_the_order_1_holds_the_service_speed(name):
    vessel = ship(name, propeller_order=1.0)
    u_0 = vessel.nu_start[0]
    k, mass = resistance(vessel)
    slope = vessel.derivatives(np.array([0, 0, 0, u_0, 0, 0]))[3]
    assert abs(slope) * mass < 1e-3 * k * u_0**2


def test_near_service_speed_the_mariner_is_that_of_chislett_and_stroem_tejsen():
    published = shipped("manoeuvring-ship", "mariner.manoeuvring-ship", "cubic")
    vessel = ship("mariner", propeller_order=1.0)
    ahead = np.array([0, 0, 0, 7.7175, 0, 0])
    found, expected = (each.linearise(ahead).A[3:, 3:] for each in (vessel, published))
    # Resistance and thrust are not the paper's; how the speed comes back is, within 5 %.
    assert found[0, 0] == pytest.approx(expected[0, 0], rel=0.05)
    np.testing.assert_allclose(found[1:, 1:], expected[1:, 1:], rtol=0.04)
    helm = {}
    for each in (vessel, published):
        slopes = []
        for angle in (-0.1, 0.1):
            each.set("rudder", angle)
            slopes.append(each.derivatives(ahead)[4:])
        helm[each] = slopes[1] - slopes[0]
    np.testing.assert_allclose(helm[vessel], helm[published], rtol=0.08)


def tactical_diameter(vessel):
    """Return that of full helm to starboard, in ship lengths."""
    run = vessel.reference(
        np.arange(0.0, 500.0, 2.0), lambda t, _x: {"rudder": -min(0.611, 0.0873 * t)}, [7.0]
    )
    return np.interp(math.pi, run["eta.psi"], run["eta.y"]) / vessel.length


def test_the_mariner_turns_widely_by_the_derivatives_that_weaken_the_rudder_with_the_speed():
    published = shipped("manoeuvring-ship", "mariner.manoeuvring-ship", "cubic")
    assert tactical_diameter(published) == pytest.approx(6.40, abs=0.01)
    for name in ("Y", "N"):
        values = list(getattr(published, name))
        assert values[8:10] == [pytest.approx(k * values[6]) for k in (2.0, 1.0)]
        published.set(name, [*values[:8], 0.0, 0.0, *values[10:]])
    fixed = tactical_diameter(published)
    assert fixed == pytest.approx(4.77, abs=0.01)
    assert tactical_diameter(ship("mariner", propeller_order=1.0)) == pytest.approx(fixed, rel=0.06)


# ---------------------------------------------------------------------- crash stop


@cache
def crash_stop(name, **values):
    """Return rows of t, x, y, psi, u, v, r, torque, shaft speed, from full astern until stopped."""
    vessel = ship(name, **values)
    engine = shipped("marine-engine", f"{name}.engine", SHIPS[name])
    for each in (vessel, engine):
        each.setup(0.0)
        each.initialise()
        each.begin()
    rows, ordered = [], 60.0
    for k in range(20000):
        t = k * H
        vessel.set("propeller_order", engine.get("shaft_order"))
        engine.set("load", vessel.get("propeller_torque"))
        engine.set("command", 1.0 if t < ordered else -1.0)
        if t >= ordered:
            shaft = engine.get("torque"), engine.get("speed")
            rows.append([t - ordered, *vessel.get("eta"), *vessel.get("nu"), *shaft])
            if rows[-1][4] <= 0.0:
                return np.array(rows), engine
        vessel.advance(t, H)
        engine.advance(t, H)
    raise AssertionError("the ship does not stop")


REACHES = {"kvlcc2": (10.0, 20.0), "mariner": (3.0, 8.0)}
"""Ship lengths. Of supertankers: 10 to 15 L at 100,000 t deadweight (The reverse stopping ability of
supertankers, J. Navigation), up to 20 L allowed to large displacement (IMO MSC.137(76)). Of a
cargo ship: less than half of IMO's 15 L, and more than the lower bound below."""


@ships
def test_the_track_reach_of_a_crash_stop_is_that_of_such_ships(name):
    rows, engine = crash_stop(name)
    reach = np.hypot(*np.diff(rows[:, 1:3], axis=0).T).sum()
    least, most = REACHES[name]
    assert least < reach / ship(name).length < most
    assert rows[-1, 3] > math.radians(20.0)  # the stern goes to port
    torque, speed = rows[:, 7], rows[:, 8]
    assert (torque >= -engine.rated_torque[1] * max(engine.torque_at_rest, 1.0) * 1.001).all()
    assert speed.min() > -engine.rated_speed[1] * 1.01


@ships
def test_no_ship_stops_before_a_thrust_that_acts_at_once_would_have_stopped_her(name):
    # M u u' = -(F + k u^2), F all that the propeller ever gives: s = M / 2k ln(1 + k u0^2 / F).
    rows, _ = crash_stop(name, propeller_side_force=0.0)
    vessel = ship(name)
    k, mass = resistance(vessel)
    u = rows[:, 4]
    most = (-mass * np.gradient(u, rows[:, 0]) - k * u**2)[5:].max()
    reach = rows[-1, 1] - rows[0, 1]
    bound = mass / (2 * k) * math.log1p(k * u[0] ** 2 / most)
    assert bound < reach < 4 * bound
    assert np.abs(rows[:, 3]).max() < 1e-9


@ships
def test_full_astern_from_rest_backs_to_where_thrust_and_resistance_balance(name):
    vessel = ship(name, propeller_order=-1.0, propeller_side_force=0.0, nu_start=[0, 0, 0])
    run = vessel.reference([0.0, 20000.0], rtol=1e-8)
    u = run["nu.u"][-1]
    assert u < -0.3 * ship(name).nu_start[0]
    vessel.set("nu_start", [u, 0.0, 0.0])
    vessel.initialise()
    k, _mass = resistance(vessel)
    thrust = (1 - vessel.propeller_deduction) * vessel.get("propeller_thrust")
    assert thrust == pytest.approx(-k * u**2, rel=1e-3)
