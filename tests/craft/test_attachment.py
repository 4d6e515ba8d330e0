"""Tethers and tows on every craft in the horizontal plane, by work and by closed forms."""

import copy

import numpy as np
import pytest

from seatrial.fmi.components.index import component_class, components
from seatrial.model.component import Component, Output
from seatrial.physics.craft.marine_craft import MarineCraft
from seatrial.physics.craft.planar import PlanarCraft
from seatrial.physics.craft.six_dof import SixDofCraft
from seatrial_kits.ships.hulls.manoeuvring_ship import ManoeuvringShip
from seatrial_kits.ships.hulls.thruster_ship import ThrusterShip

PLACE, PULL = (-1.2, 0.4, -0.7), (3.0, -5.0, 2.0)
SHIP = {"mass": 40.0, "inertia": 9.0, "center_of_gravity": 0.1, "X_udot": -4.0, "Y_vdot": -30.0}


def built(cls, **values):
    craft = cls("craft")
    for name, value in {"attachment_place": PLACE, **values}.items():
        craft.set(name, value)
    return craft


def loads(craft, state):
    """Return M times what the force adds to d(nu)/dt: the load in the order of nu."""
    added = []
    for force in ((0.0, 0.0, 0.0), PULL):
        craft.set("attachment_force", force)
        added.append(craft.derivatives(state))
    half = len(state) // 2
    return craft.mass_matrix() @ (added[1] - added[0])[half:]


def output(craft, name, state):
    """Return an output of another craft of the same parameters, at a state."""
    half = len(state) // 2
    craft = copy.deepcopy(craft)
    craft.set("eta_start", state[:half])
    craft.set("nu_start", state[half:])
    craft.initialise()
    craft.begin()
    return np.array(craft.get(name))


def test_an_upright_craft_is_pulled_as_one_in_six_degrees_of_freedom():
    psi, (x, y, _) = 0.6, PLACE
    north, east, _ = PULL
    surge = north * np.cos(psi) + east * np.sin(psi)
    sway = -north * np.sin(psi) + east * np.cos(psi)
    expected = [surge, sway, x * sway - y * surge]
    state = np.array([5.0, -2.0, psi, 1.0, 0.3, -0.2])
    np.testing.assert_allclose(loads(built(ThrusterShip, **SHIP), state), expected, rtol=1e-12)
    whole = MarineCraft("craft")
    whole.set("attachment_place", PLACE)
    full = np.zeros(12)
    full[[0, 1, 5, 6, 7, 11]] = state
    pulled = loads(whole, full)
    np.testing.assert_allclose(pulled[[0, 1, 5]], expected, rtol=1e-12)


def test_the_linear_ship_is_pulled_as_at_rest():
    ship = built(ThrusterShip, **SHIP, model="linear")
    x, y, _ = PLACE
    north, east, _ = PULL
    expected = [north, east, x * east - y * north]
    state = np.array([5.0, -2.0, 0.6, 1.0, 0.3, -0.2])
    np.testing.assert_allclose(loads(ship, state), expected, rtol=1e-12)


@pytest.mark.parametrize("model", ["linear", "cubic"])
def test_a_manoeuvring_ship_has_the_mass_that_its_length_gives(model):
    own = {"mass": 8e-3, "inertia": 4e-4, "X_udot": -4e-4, "Y_vdot": -7e-3, "N_rdot": -4e-4}
    ship = built(ManoeuvringShip, model=model, length=100.0, speed=8.0, **own)
    ship.set("attachment_place", (50.0, 0.0, 0.0))
    state, pull = np.array([0, 0, 0, 8.0, 0, 0]), 1e6
    ship.set("attachment_force", (0.0, 0.0, 0.0))
    before = ship.derivatives(state)
    ship.set("attachment_force", (pull, pull, 0.0))
    surge, sway, yaw = (ship.derivatives(state) - before)[3:]
    half = 0.5 * 1025.0 * 100.0**3
    assert surge == pytest.approx(0.0 if model == "linear" else pull / (8.4e-3 * half), rel=1e-12)
    assert sway == pytest.approx(pull / (15e-3 * half), rel=1e-12)
    assert yaw == pytest.approx(50 * pull / (8e-4 * half * 100.0**2), rel=1e-12)


def gives_motion(cls: type[Component]) -> bool:
    """Return whether the motion is the craft's own, not that of what it stands on."""
    return isinstance(cls.ports[cls.terminals["motion"].members["position"]], Output)


def test_every_craft_has_an_attachment():
    classes = [component_class(name) for name in components().names()]
    craft = [cls for cls in classes if issubclass(cls, (PlanarCraft, SixDofCraft))]
    craft = [cls for cls in craft if "motion" in cls.terminals and gives_motion(cls)]
    assert len(craft) >= 2
    assert all("attachment" in cls.terminals for cls in craft)
