"""Dynamic positioning: gains against pole placement, and loops with the thruster ship."""

import math

import numpy as np
import pytest

from seatrial.system.parameters import load_vehicle
from seatrial_kits.ships.control.dynamic_positioning import DynamicPositioning
from seatrial_kits.ships.devices.force_actuator import ForceActuator
from seatrial_kits.ships.hulls.thruster_ship import ThrusterShip
from tests.devices.running import started

MASS = np.array([7.88e6, 1.364e7, 4.31e9])
CAPACITY = np.array([2.5e5, 2.5e5, 1e7])
SOFT = {"natural_frequency": 0.1, "damping_ratio": 0.8, "integral_pole": 0.02}
WIDE = {**SOFT, "capacity": [1e12] * 3}
_ONE, KD, KP, KI = np.polymul([1, 0.02], [1, 2 * 0.8 * 0.1, 0.1**2])


def demand(**values):
    return np.array(started(DynamicPositioning, **values).get("demand"))


def test_gains_place_the_poles():
    off = {"position": [-1.0, -2.0, 0.0], "station_heading": 0.1}
    error = np.array([1.0, 2.0, 0.1])
    np.testing.assert_allclose(demand(**off, **WIDE), MASS * KP * error, rtol=1e-12)
    moving = {"velocity": [1.0, 2.0, 0.0], "rates": [0.0, 0.0, 0.1]}
    np.testing.assert_allclose(demand(**moving, **WIDE), -MASS * KD * error, rtol=1e-12)
    positioning = started(DynamicPositioning, **off, **WIDE)
    positioning.advance(0.0, 10.0)
    grown = np.array(positioning.get("demand")) - demand(**off, **WIDE)
    np.testing.assert_allclose(grown, 10.0 * MASS * KI * error, rtol=1e-12)


def test_error_of_position_turns_into_body_axes():
    # The station is 1 m north of a ship that heads east: 1 m to port.
    found = demand(station=[1.0, 0.0], attitude=[0, 0, math.pi / 2], station_heading=math.pi / 2)
    assert found[1] < 0
    assert found[[0, 2]] == pytest.approx([0, 0], abs=1e-6)


def test_what_was_learnt_stays_north_when_the_ship_turns():
    positioning = started(DynamicPositioning, station=[0.1, 0.0], **WIDE)
    positioning.advance(0.0, 10.0)
    north = positioning.get("demand")[0] - MASS[0] * KP * 0.1
    positioning.set("station", [0.0, 0.0])
    positioning.set("attitude", [0.0, 0.0, math.pi / 2])
    positioning.set("station_heading", math.pi / 2)
    assert positioning.get("demand") == pytest.approx([0.0, -north, 0.0], abs=1e-6 * north)


@pytest.mark.parametrize(("heading", "wanted", "error"), [(179, -179, 2), (-179, 179, -2)])
def test_heading_error_is_the_shorter_way(heading, wanted, error):
    angles = {"attitude": [0, 0, math.radians(heading)], "station_heading": math.radians(wanted)}
    assert demand(**angles, **WIDE)[2] == pytest.approx(MASS[2] * KP * math.radians(error))


def test_capacity_holds_and_the_integral_does_not_wind_up():
    positioning = started(DynamicPositioning, station=[1e3, -1e3], station_heading=3.0)
    positioning.advance(0.0, 3600.0)
    np.testing.assert_array_equal(positioning.get("demand"), CAPACITY * [1, -1, 1])
    positioning.set("station", [0.0, 0.0])
    positioning.set("station_heading", 0.0)
    np.testing.assert_allclose(positioning.get("demand"), 0.0, atol=1e-6)


def test_thrusters_with_a_lag_are_asked_for_more():
    # A small error that comes suddenly: thrusters of 5 s then answer with 1 s.
    lag = {"thruster_time_constant": 5.0, "thruster_response": 1.0, "integral_pole": 0.0}
    positioning = started(DynamicPositioning, **{**SOFT, **lag}, station=[0.01, 0.0])
    thrusters = started(ForceActuator, time_constant=5.0)
    goal = MASS[0] * 0.1**2 * 0.01
    assert positioning.get("demand")[0] == pytest.approx(5 * goal)
    for k in range(50):
        thrusters.set("demand", positioning.get("demand"))
        thrusters.advance(0.1 * k, 0.1)
        positioning.advance(0.1 * k, 0.1)
        if k == 9:
            assert thrusters.get("force")[0] == pytest.approx(goal * (1 - math.exp(-1)), rel=0.05)
    assert thrusters.get("force")[0] == pytest.approx(goal, rel=0.01)


# ---------------------------------------------------------------------- with the ship


def held(load, stop, time_constant=0.0, share=1.0, station=(0.0, 0.0, 0.0)):
    """Return x, y, psi every 0.1 s under a load from the start; ``share`` scales the capacity."""
    ship = ThrusterShip("ship")
    for name, entry in load_vehicle("thruster-ship").file.components["thruster-ship"].items():
        ship.set(name, entry.value)
    ship.set("force_2", load[:2])
    ship.set("moment_2", load[2])
    ship.initialise()
    ship.begin()
    thrusters = started(ForceActuator, time_constant=time_constant, capacity=share * CAPACITY)
    positioning = started(
        DynamicPositioning,
        capacity=share * CAPACITY,
        thruster_time_constant=time_constant,
        station=station[:2],
        station_heading=station[2],
    )
    places = []
    for k in range(round(stop / 0.1)):
        places.append(ship.get("eta"))
        for name in ("position", "attitude", "velocity", "rates"):
            positioning.set(name, ship.get(name))
        thrusters.set("demand", positioning.get("demand"))
        ship.set("force_1", thrusters.get("force"))
        ship.set("moment_1", thrusters.get("moment"))
        for component in (ship, thrusters, positioning):
            component.advance(0.1 * k, 0.1)
    return np.array(places)


@pytest.mark.parametrize("time_constant", [0.0, 5.0])
@pytest.mark.parametrize("share", [1.0, pytest.param(5.0, marks=pytest.mark.interop)])
def test_a_fifth_of_the_capacity_moves_it_by_less_than_a_metre(share, time_constant):
    eta = np.abs(held(0.2 * share * CAPACITY, 400.0, time_constant, share))
    assert eta[:, :2].max() < 1.0
    assert eta[:, 2].max() < math.radians(1.0)
    assert eta[-1, :2].max() < 0.01
    assert eta[-1, 2] < math.radians(0.01)
    assert eta[:, :2].max() > 0.05  # the load is felt


def test_ideal_loop_is_that_of_its_poles():
    # Surge alone: m x'' = -Kd x' - Kp x - Ki int x + F, in closed form by its poles.
    w, sigma, F = 0.2, 0.02, 5e4
    poles = np.array([-sigma, -w])
    eta = held((F, 0.0, 0.0), 100.0)
    t = 0.1 * np.arange(len(eta))
    # x = F / m  s / ((s + sigma) (s + w)^2) / s: residues of a simple and a double pole.
    a = 1 / (w - sigma) ** 2
    exact = F / MASS[0] * (a * np.exp(poles[0] * t) - (a + t / (w - sigma)) * np.exp(poles[1] * t))
    # The controller acts every 0.1 s and its forces are held: half a sample late.
    assert np.abs(eta[:, 0] - exact).max() < 0.01 * exact.max()


@pytest.mark.slow
@pytest.mark.parametrize("time_constant", [5.0, pytest.param(0.0, marks=pytest.mark.interop)])
def test_a_new_station_is_reached_without_going_too_far(time_constant):
    goal = (5.0, 5.0, math.radians(10.0))
    eta = held((0.0, 0.0, 0.0), 500.0, time_constant, station=goal)
    np.testing.assert_allclose(eta[-1], goal, atol=1e-3)
    assert np.all(eta.max(axis=0) < np.array(goal) * 1.1)
