"""Craft of the shipped vehicle files, and runs of them that several tests look at."""

import numpy as np

from seatrial.fmi.direct import DirectInstance
from seatrial.physics.craft.manoeuvring_ship import ManoeuvringShip
from seatrial.physics.craft.marine_craft import MarineCraft
from seatrial.physics.craft.rov import Rov
from seatrial.physics.craft.sailboat import Sailboat
from seatrial.physics.craft.surface_vessel import SurfaceVessel
from seatrial.physics.craft.thruster_ship import ThrusterShip
from seatrial.physics.parts.mmg_ship import MmgShip
from seatrial.system.parameters import load_vehicle
from seatrial.system.references.values import from_entry, port_scalars

FLEET = {
    "hydrone": ("marine-craft", MarineCraft),
    "otter": ("marine-craft", MarineCraft),
    "mariner": ("manoeuvring-ship", ManoeuvringShip),
    "kvlcc2": ("mmg-ship", MmgShip),
    "thruster-ship": ("thruster-ship", ThrusterShip),
    "gloria": ("sailboat", Sailboat),
    "videoray": ("rov", Rov),
    "videoray-surface": ("surface-vessel", SurfaceVessel),
}


def craft(vehicle, variant=None, **changes):
    """Return the hull of a vehicle with the parameters of its file."""
    table, kind = FLEET[vehicle]
    component = kind(vehicle)
    variables = DirectInstance(component).variables
    for name, entry in load_vehicle(vehicle).parameter_set(table, variant).values.items():
        for scalar, given in from_entry(entry, port_scalars(variables, name), name).items():
            component.set(scalar, given.value)
    for name, value in changes.items():
        component.set(name, value)
    return component


def states(component, duration, h):
    """Return the stacked states at the communication points, the start among them."""
    component.setup(0.0)
    component.initialise()
    component.begin()
    rows = [component._x.copy()]
    for i in range(round(duration / h)):
        component.advance(i * h, h)
        rows.append(component._x.copy())
    return np.array(rows)
