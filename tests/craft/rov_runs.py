"""Runs of the ROV that several files of tests look at."""

import numpy as np


def ran(component, stop, count):
    """Return the states after each of ``count`` Runge-Kutta steps up to ``stop``."""
    component.set("max_step", 1.0)
    component.initialise()
    component.begin()
    rows = [component.get("eta") + component.get("nu")]
    for k in range(count):
        component.advance(stop * k / count, stop / count)
        rows.append(component.get("eta") + component.get("nu"))
    return np.array(rows)
