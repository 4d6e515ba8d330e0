"""Entries that every proposed body has: terms, restoring, water, gravity, buoyancy."""

from __future__ import annotations

from .particulars import Particulars
from .value import Formula, Value, estimated, given_or

VISCOSITY = 1.19e-6
"""Kinematic, of sea water at 15 degrees, m2/s."""
GRAVITY = 9.81


def heading(terms: str, restoring: str, particulars: Particulars) -> list[Value]:
    """Return terms, form of restoring, density of the water and gravity."""
    by_kind = Formula(f"of a {particulars.kind}")
    sea = Formula("sea water at 15 degrees")
    return [
        estimated("terms", terms, "1", by_kind),
        estimated("restoring", restoring, "1", by_kind),
        given_or(particulars, "density", particulars.density, "kg/m3", sea),
        estimated("gravity", GRAVITY, "m/s2", Formula("standard, rounded")),
    ]


def neutral() -> Value:
    """Return the buoyancy of a submerged body that is trimmed."""
    return Value("buoyancy", "= mass * gravity", "N", "trimmed to be neutral", "weighing")
