"""Craft of the shipped vehicle files, and runs of them that several tests look at."""

import numpy as np

from seatrial.fmi.components.index import component_class
from seatrial.fmi.direct import DirectInstance
from seatrial.system.parameters import load_vehicle
from seatrial.system.references.values import from_entry, port_scalars
from tests.kit import vehicles

TABLES = {
    "hydrone": "marine-craft",
    "otter": "marine-craft",
    "mariner": "manoeuvring-ship",
    "kvlcc2": "mmg-ship",
    "thruster-ship": "thruster-ship",
    "gloria": "sailboat",
    "videoray": "rov",
    "videoray-surface": "surface-vessel",
}
FLEET = {name: (TABLES[name], component_class(TABLES[name])) for name in vehicles(*TABLES)}
"""Component and class of each vehicle whose kit is here."""


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
