"""Landing points on a deck, as the manifests of runs have them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from .plots import Deck, PadPoint

DECK_LENGTH, DECK_BEAM = 1.276, 1.0
"""Overall length and beam of the catamaran, m: no component has them as a parameter."""


@dataclass(frozen=True)
class Pad:
    """A component's landing point: forward and starboard of the body origin, m."""

    component: str
    forward: float
    starboard: float
    phase: str
    """What happens there, if the component says so."""


def pads(manifest: dict[str, Any]) -> list[Pad]:
    """Return the landing points of a run: the pads of its ``downwash`` components."""
    found = []
    for name, component in manifest["components"].items():
        parameters = component["parameters"]
        if component["fmu"] == "downwash":
            x, y = (float(parameters[f"pad.{axis}"]["value"]) for axis in "xy")
            phase = parameters.get("phase", {}).get("value", "")
            found.append(Pad(name, x, y, str(phase)))
    return found


def deck(title: str, runs: Iterable[tuple[str, Pad, bool | None]]) -> Deck:
    """Return a deck with the points of runs (label, pad, passed); one point for each place."""
    places: dict[tuple[float, float], list[tuple[str, bool | None]]] = {}
    for label, pad, passed in runs:
        places.setdefault((pad.forward, pad.starboard), []).append((label, passed))
    points = []
    for (forward, starboard), cases in places.items():
        evaluated = [passed for _, passed in cases if passed is not None]
        labels = tuple(label for label, _ in cases)
        points.append(PadPoint(forward, starboard, labels, sum(evaluated), len(evaluated)))
    return Deck(title, points, DECK_LENGTH, DECK_BEAM)
