"""Sensors that their profile places outside of the hull: a digit or a unit that is wrong."""

from __future__ import annotations

from collections.abc import Iterator

from .parameters import Outline
from .part import Part
from .system import System

_PLACES = ("antenna", "place")
"""Parameters of sensors: from the body origin, body axes, m."""


def far_off(system: System) -> list[str]:
    """Return notes on sensors further from the hull beside them than its length.

    The hull is the outline about the body origin. A sensor may stand that far above or below it.
    """
    outlines = {_scope(n): part.outline for n, part in system.parts.items() if part.outline}
    notes = []
    for name, part in system.parts.items():
        outline = outlines.get(_scope(name))
        if outline is None or part.outline is not None:
            continue
        for port, place in _places(part):
            if _distance(place, outline) > outline.length:
                x, y, z = place
                notes.append(
                    f"{part.given[f'{port}.x'].origin}: {port} is at ({x:g}, {y:g}, {z:g}) m, "
                    f"outside of the hull of {outline.length:g} m by {outline.beam:g} m by more "
                    "than its length"
                )
    return notes


def _places(part: Part) -> Iterator[tuple[str, tuple[float, float, float]]]:
    for port in _PLACES:
        given = [part.given.get(f"{port}.{axis}") for axis in "xyz"]
        if all(given):
            x, y, z = (float(one.value) for one in given if one is not None)
            yield port, (x, y, z)


def _distance(place: tuple[float, float, float], outline: Outline) -> float:
    """Return how far a place is outside of the outline, along the axis where it is most."""
    x, y, z = place
    return max(abs(x) - outline.length / 2.0, abs(y) - outline.beam / 2.0, abs(z))


def _scope(name: str) -> str:
    return name.rpartition(".")[0]
