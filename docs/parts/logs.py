"""Formats of logs that are read, and the channels that serve each quantity."""

from __future__ import annotations

from parts import part
from parts.markdown import table
from seatrial.trial.logs.formats import FORMATS
from seatrial.trial.logs.quantities import QUANTITIES


@part("log-quantities")
def quantities() -> str:
    """Return the quantities, with their sense and their units."""
    rows = (
        (f"`{name}`", "rad, or a share" if each.share else each.unit, each.sense)
        for name, each in QUANTITIES.items()
    )
    return table(("quantity", "unit", "sense"), rows)


@part("log-channels")
def channels() -> str:
    """Return the channels that serve quantities by default, format by format."""
    loaded = {name: FORMATS.load(name) for name in FORMATS.names()}
    formats = {name: each for name, each in loaded.items() if each.defaults}
    rows = []
    for what in QUANTITIES:
        names = [each.defaults.get(what, ()) for each in formats.values()]
        if any(names):
            cells = (", ".join(f"`{name}`" for name in each) or "–" for each in names)
            rows.append((f"`{what}`", *cells))
    return table(("quantity", *(f"`{name}`" for name in formats)), rows)
