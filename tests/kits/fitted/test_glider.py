"""Glider by data: steady glides by Graver's equations, his figures, and a tool of others."""

import csv
import math

import numpy as np
import pytest
from scipy.optimize import brentq

from tests.craft.references import DATA, shipped

G, RHO = 9.816, 1025.0
K_D0, K_D, K_L, K_M = 2.15, 25.0, 132.5, -100.0
M_F1, M_F3, BATTERY, DEEP = 5.0, 70.0, 9.0, 0.05
ENGINE, TRAVEL, SIDEWAYS = 250e-6, 0.05, 0.02
PATH = math.radians(25)
STATES = ("attitude.theta", "velocity.u", "velocity.w")


def glider(variant="graver", **values):
    return shipped("fitted-craft", "glider.hull", variant, **{"position_start.z": 300, **values})


def steady(path, speed):
    """Return theta, alpha, the net mass m_0, kg, and the place of the battery r_P1, m.

    Graver 2005, equilibria of a glide along a path, rad, positive upwards: m_0 of the ballast that
    is heavier than the water displaced.
    """
    tan = math.tan(path)
    root = math.sqrt(1 - 4 * K_D / K_L**2 / tan * (K_D0 / tan))
    alpha = K_L / K_D / 2 * tan * (-1 + root)
    theta = path + alpha
    drag, lift = K_D0 + K_D * alpha**2, K_L * alpha
    net = (-math.sin(path) * drag + math.cos(path) * lift) * speed**2 / G
    u, w = speed * math.cos(alpha), speed * math.sin(alpha)
    trim = ((M_F3 - M_F1) * u * w + K_M * alpha * speed**2) / (BATTERY * G * math.cos(theta))
    return theta, alpha, net, -DEEP * math.tan(theta) + trim


def orders(net=0.0, ahead=0.0, aside=0.0):
    return {"ballast_order": [-net / (RHO * ENGINE), ahead / TRAVEL, aside / SIDEWAYS] + 5 * [0]}


@pytest.mark.slow
@pytest.mark.parametrize(("path", "speed"), [(-PATH, 0.3), (PATH, 0.5)])
def test_a_steady_glide_is_that_of_graver(path, speed):
    theta, alpha, net, ahead = steady(path, speed)
    start = {"attitude_start": (0, 0.9 * theta, 0), "velocity_start": (0.8 * speed, 0, 0)}
    run = glider(**start).reference([0.0, 600.0], lambda t, x: orders(net, ahead))
    found = [run[name][-1] for name in STATES]
    expected = [theta, speed * math.cos(alpha), speed * math.sin(alpha)]
    np.testing.assert_allclose(found, expected, atol=1e-6)
    flown = found[0] - math.atan2(found[2], found[1])
    assert flown == pytest.approx(path, abs=1e-6)
    drag, lift = K_D0 + K_D * alpha**2, K_L * alpha
    assert math.tan(abs(flown)) == pytest.approx(drag / abs(lift), rel=1e-5)


def test_his_glide_at_25_degrees_has_his_ballast_and_place_of_the_battery():
    # Graver 2005: at 0.30 m/s the ballast is 1.047 kg, 1 kg when neutral, the battery at 1.98 cm.
    theta, _, net, ahead = steady(-PATH, 0.3)
    assert 1 + net == pytest.approx(1.047, abs=5e-4)
    assert ahead == pytest.approx(0.0198, abs=5e-5)
    assert math.degrees(theta) == pytest.approx(-22.98, abs=0.01)


def rows():
    """Return the steady glides of gliderflight; below the names stands a row of units."""
    with (DATA / "glider_steady.csv").open() as file:
        _units, *found = csv.DictReader(file)
    return [{name: float(value) for name, value in row.items()} for row in found]


@pytest.mark.parametrize("row", rows(), ids=lambda row: f"{row['pitch']:g} deg")
def test_glides_of_the_variant_flight_are_those_of_gliderflight(row):
    craft = glider("flight", gravity=9.81, buoyancy=50 * 9.81)
    theta, path = math.radians(row["pitch"]), math.atan2(row["w"], row["u"])
    assert path - theta == pytest.approx(row["alpha"], abs=1e-9)
    x = np.zeros(12 + 4 * 8)
    x[2], x[4] = 300, theta
    x[6], x[8] = row["U"] * math.cos(theta - path), row["U"] * math.sin(theta - path)

    def slope(ahead):
        """Return the derivatives with the battery there, the ballast where its order is."""
        x[36:] = orders(-row["volume"] * 1e-6 * RHO, ahead)["ballast_order"]
        craft.set("ballast_order", x[36:])
        return craft.derivatives(x)[6:12]

    # Some place of the battery stops the pitch: then nothing else accelerates either.
    still = slope(brentq(lambda ahead: slope(ahead)[4], -0.05, 0.05))
    np.testing.assert_allclose(still, 0, atol=1e-8)


@pytest.mark.parametrize("way", [-1, 1])
def test_a_bank_to_starboard_turns_it_to_starboard_in_a_dive_and_to_port_in_a_climb(way):
    _, _, net, ahead = steady(way * PATH, 0.35)
    start = {"velocity_start": (0.35, 0, 0), "attitude_start": (0, way * 0.4, 0)}
    run = glider(**start).reference(
        [0.0, 150.0, 160.0], lambda t, x: orders(net, ahead, min(t / 5000, 0.01))
    )
    assert run["attitude.phi"][-1] > 0.1
    turn = np.diff(run["attitude.psi"])[-1] / 10
    assert -0.02 < way * turn < -0.001


def test_with_its_ballast_blown_it_floats_at_the_surface():
    craft = glider(**{"position_start.z": 1})
    run = craft.reference([0.0, 100.0, 110.0], lambda t, x: orders(-RHO * ENGINE))
    assert np.ptp(run["position.z"][1:]) < 0.02
    assert 0 < run["position.z"][-1] < 0.22 / 2  # its top is above water
