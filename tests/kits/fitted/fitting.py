"""Fitted craft for tests: one part on a plain body, and the load that it gives."""

import numpy as np

from seatrial_kits.fitted.fitted_craft import FittedCraft

DENSITY = 1025.0
BODY = {
    "restoring": "submerged",
    "terms": "restoring coriolis damping",
    "mass": 40.0,
    "buoyancy": 40.0 * 9.81,
    "inertia": (0.8, 6.0, 6.2, 0.0, 0.0, 0.0),
    "center_of_gravity": (0.0, 0.0, 0.03),
    "added_mass": (3.0, 30.0, 32.0, 0.0, 0.0, 0.0),
    "added_inertia": (0.2, 4.0, 4.1, 0.0, 0.0, 0.0),
    "linear_damping_force": (4.0, 20.0, 22.0),
    "linear_damping_moment": (2.0, 15.0, 14.0),
    "quadratic_damping_force": (9.0, 80.0, 90.0),
}


def craft(**values):
    component = FittedCraft("craft")
    for name, value in {**BODY, **values}.items():
        component.set(name, value)
    return component


def padded(*values):
    return [*values, *[0.0] * (8 - len(values))]


def state(component, nu=(0,) * 6, attitude=(0, 0, 0), **lagged):
    """Return the stacked state at the origin, lags at 0 unless named."""
    parts = [lagged.get(p.name, [0.0] * 8) for p in component.state_ports[4:]]
    return np.concatenate([[0, 0, 0], attitude, nu, *parts]).astype(float)


def load(component, nu=(0,) * 6, attitude=(0, 0, 0), **inputs):
    """Return the load (6,) of the parts: that of the craft less that of the same without parts."""
    bare = craft(propulsors="", foils="")
    for name in ("current", "wind"):
        if name in inputs:
            bare.set(name, inputs[name])
    for name, value in inputs.items():
        component.set(name, value)
    x = state(component, nu, attitude)
    difference = component.derivatives(x) - bare.derivatives(x)
    return component.mass_matrix() @ difference[6:12]


def shown(component, nu=(0,) * 6, **inputs):
    """Return a function of an output's name that gives its value, of the first part."""
    component.set("velocity_start", nu[:3])
    component.set("rates_start", nu[3:])
    for name, value in inputs.items():
        component.set(name, value)
    component.initialise()
    return lambda name: component.get(name)[0]
