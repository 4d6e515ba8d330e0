"""The surface vessel of the VideoRay under a law that holds its velocities."""

from pathlib import Path

import numpy as np

from seatrial.system.parameters import load_vehicle
from seatrial_kits.videoray.vessel.surface_vessel import SurfaceVessel

REFERENCE = Path(__file__).parents[2] / "reference"
CASES = {
    1: {"surge": 0.05, "yaw_rate": 0.2},
    2: {"surge": 0.02, "surge_profile": "polynomial", "yaw_rate": 0.04},
    3: {"surge": -0.01, "yaw_rate": 0.02, "yaw_profile": "polynomial"},
}
GAINS = {1: [2.0, 4.0, 4.0], 2: [0.5, 1.0, 0.25], 3: [0.5, 1.0, 0.25]}
# The reference's plants step so long.
STEPS = {"physical": 0.01, "table75": 0.02, "table81_fit": 0.02}


def profile(variant):
    entries = load_vehicle("videoray-surface").parameter_set("surface-vessel", variant).values
    return {name: entry.value for name, entry in entries.items()}


def table(name):
    return np.genfromtxt(REFERENCE / f"videoray_{name}.csv", delimiter=",", names=True)


def build(cls, variant, **values):
    component = cls(cls.__name__)
    for name, value in {**profile(variant), **values}.items():
        component.set(name, value)
    return component


def started(cls, variant, **values):
    component = build(cls, variant, **values)
    component.initialise()
    return component


def follow(law, stop, variant, error=(0.0, 0.0, 0.0), inputs=lambda _t: {}, **vessel):
    """Return per instant of the law, started, t, u, v, r, t1, t2 and the nominal u, v, r.

    ``error`` is that of nu at the start; ``inputs(t)`` sets inputs of law and vessel, by name.
    """
    start = np.add(law.get("nominal"), error).tolist()
    craft = started(SurfaceVessel, variant, nu_start=start, max_step=STEPS[variant], **vessel)
    craft.begin()
    law.set("nu", start)
    law.begin()
    period, rows = law.period, []
    for k in range(round(stop / period) + 1):
        t = round(k * period, 9)
        for name, value in inputs(t).items():
            (law if name in law.ports else craft).set(name, value)
        law.set("nu", craft.get("nu"))
        command = law.get("command")
        craft.set("command", command)
        rows.append([t, *craft.get("nu"), *command, *law.get("nominal")])
        law.advance(t, period)
        craft.advance(t, period)
    return np.array(rows)


def assert_columns(rows, names, expected, bound):
    """Compare columns 1, 2, ... with those of a reference, each to ``bound`` of its maximum."""
    for column, name in enumerate(names, start=1):
        error = np.abs(rows[:, column] - expected[name]).max()
        assert error < bound * np.abs(expected[name]).max(), name
