"""The Hydrone, built from its parameter file, and runs of it that several tests look at."""

from functools import cache

import numpy as np
import pytest

from seatrial.physics.craft.marine_craft import MarineCraft
from seatrial.physics.environment.downwash import Downwash
from seatrial.system.parameters import load_vehicle

VEHICLE = load_vehicle("hydrone")
DAMPING = (
    *("linear_damping_force", "linear_damping_moment"),
    *("quadratic_damping_force", "quadratic_damping_moment"),
)


class Hydrone:
    """Builds and runs the Hydrone with its HUAUV."""

    def __init__(self):
        pads = VEHICLE.parameter_set("downwash", None).presets["pad"]
        self.pads = {name: entry.value for name, entry in pads.items()}

    def craft(self, variant, **changes):
        return self._set(MarineCraft("craft"), "marine-craft", variant, changes)

    def undamped(self, variant, **changes):
        return self.craft(variant, **dict.fromkeys(DAMPING, 0.0), **changes)

    def downwash(self, variant, phase="landing", pad="nominal", **changes):
        scenario = {"phase": phase, "pad": self.pads[pad]}
        return self._set(Downwash("downwash"), "downwash", variant, {**scenario, **changes})

    def _set(self, component, table, variant, changes):
        for name, entry in VEHICLE.parameter_set(table, variant).values.items():
            component.set(name, entry.value)
        for name, value in changes.items():
            component.set(name, value)
        return component

    def follow(self, craft, downwash, t, **options):
        """Integrate the craft under the load, which feels its attitude at every instant."""

        def load(time, x):
            force, moment = downwash.wrench(time, x.attitude.tolist())
            return {"force_2": force, "moment_2": moment}

        return craft.reference(t, load, downwash.breaks(), **options)

    @cache  # noqa: B019 (the fixture lives as long as the tests run)
    def run(self, variant, phase, pad, scaled="", factor=1.0):
        """20 s every 10 ms, one parameter of the craft scaled."""
        craft = self.craft(variant)
        if scaled:
            craft.set(scaled, factor * craft.get(scaled))
        grid = np.arange(2001) / 100
        return self.follow(craft, self.downwash(variant, phase, pad), grid)


@pytest.fixture(scope="session")
def hydrone():
    return Hydrone()
