"""Landing points on a deck, as the manifests of runs have them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from ..records.run_folder import viewed
from .plots import Deck, PadPoint


@dataclass(frozen=True)
class Pad:
    """A component's landing point: forward and starboard of the body origin, m."""

    component: str
    forward: float
    starboard: float
    phase: str
    """Manoeuvre there, if the component has one."""
    outline: tuple[float, float] | None
    """Overall length and beam of the vehicle, m, if its file has them."""


def pads(manifest: dict[str, Any]) -> list[Pad]:
    """Return the landing points of a run, of the components with such a view."""
    found = []
    for name, component, ports in viewed(manifest, "landing-point"):
        parameters = component["parameters"]
        x, y = (float(parameters[f"{ports['place']}.{axis}"]["value"]) for axis in "xy")
        phase = parameters.get(ports["phase"], {}).get("value", "")
        outline = component.get("outline")
        size = None if outline is None else (outline["length"], outline["beam"])
        found.append(Pad(name, x, y, str(phase), size))
    return found


def deck(title: str, runs: Iterable[tuple[str, Pad, bool | None]]) -> Deck:
    """Return a deck with the points of runs (label, pad, passed); one point for each place."""
    places: dict[tuple[float, float], list[tuple[str, bool | None]]] = {}
    size = None
    for label, pad, passed in runs:
        places.setdefault((pad.forward, pad.starboard), []).append((label, passed))
        size = pad.outline or size
    points = []
    for (forward, starboard), cases in places.items():
        evaluated = [passed for _, passed in cases if passed is not None]
        labels = tuple(label for label, _ in cases)
        points.append(PadPoint(forward, starboard, labels, sum(evaluated), len(evaluated)))
    return Deck(title, points, size)
