"""Sections, hydrostatics and windage of a vehicle that its file does not give: from its shape.

Of a craft at the surface with hulls in ``[shape]``, marked ``assumed``, each by its formula:

- sections: 11 of each hull's own, half ellipses, S = pi b T / 4; beams times one factor so that
  the waterplane is that of the restoring, draughts times one so that the hulls displace the mass;
- without ``waterplane_area``, ``GM_T`` and ``GM_L``: of these sections, GM = I / V - (z_B - z_G);
- freeboard: of the first hull;
- windage: the outline above the water line, seen from ahead and from abeam;
- ``terms``, if the file gives none: those of the component, wave-loads and wind-loads.

Good to about 10 % for slender hulls that float upright; a hull's lines or a panel code say more.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..part import Part
from ..references.values import Given
from ..shape import Hull, ShapePart
from ..silhouette import silhouettes

_STATIONS = 11
_AT_SEA = ("wave-loads", "wind-loads")
_ALIKE = 1e-6
_ELLIPSE = math.pi / 4.0


def give_assumed(part: Part) -> None:
    """Give a craft at the surface what follows from its shape and is not given."""
    body, variables = part.shape, part.instance.variables
    if body is None or "section_beam.s0" not in variables or not is_at_surface(part):
        return
    file = f"{body.path.name} [shape] {body.table}"
    hulls = _hulls(body.parts)
    found: dict[str, Any] = {}
    if hulls is not None and not _has_any(part, ("hull_", "section_", "side_")):
        found |= _sections(part, hulls)
    if not _has_any(part, ("windage_",)):
        found |= _windage(body.parts, hulls[0].waterline if hulls else 0.0)
    if "terms" in variables and "terms" not in part.given and found:
        own = str(variables["terms"].start).split()
        found["terms"] = " ".join([*own, *(term for term in _AT_SEA if term not in own)])
    if hulls is not None:
        found["hull_freeboard"] = hulls[0].hull.freeboard
    for name, value in found.items():
        if name in variables and name not in part.given:
            part.given[name] = Given(value, file, f"{_FORMULAS[_kind(name)]}", "assumed")


_FORMULAS = {
    "sections": "the shape's hulls: half ellipses, scaled to waterplane and displacement",
    "hydrostatics": "of the shape's hulls: GM = I / V - (z_B - z_G)",
    "freeboard": "of the shape's first hull",
    "windage": "the shape's outline above the water line",
    "terms": "of the component, with waves and wind as the shape has them",
}


def _kind(name: str) -> str:
    if name.startswith("windage"):
        return "windage"
    if name == "terms":
        return "terms"
    if name == "hull_freeboard":
        return "freeboard"
    return "hydrostatics" if name in ("waterplane_area", "GM_T", "GM_L") else "sections"


@dataclass(frozen=True)
class _Hulls:
    """One hull of a shape, or two alike, ``apart``."""

    hull: Hull
    ahead: float
    waterline: float
    apart: float

    def stations(self, values: Sequence[float]) -> Any:
        """Return values by section at the 11 stations."""
        places = np.linspace(0.0, 1.0, len(values))
        return np.interp(np.linspace(0.0, 1.0, _STATIONS), places, values)

    @property
    def count(self) -> int:
        return 2 if self.apart else 1

    def total(self, by_station: Any) -> float:
        """Return the integral over the length of all of them, by the trapezoidal rule."""
        return float(np.trapezoid(by_station, dx=self.hull.length / (_STATIONS - 1))) * self.count


def _hulls(parts: Sequence[ShapePart]) -> list[_Hulls] | None:
    """Return the hulls: one or two alike, then a pair of side hulls; None for any other."""
    drawn = [p for p in parts if p.hull is not None and not any(p.turned) and p.on is None]
    centre = [p for p in drawn if abs(p.at[1]) < _ALIKE]
    aside = sorted((p for p in drawn if abs(p.at[1]) >= _ALIKE), key=lambda p: p.at[1])
    if len(centre) > 1 or len(aside) not in (0, 2) or not drawn:
        return None
    if aside:
        port, starboard = aside
        mirrored = [port.at[0], -port.at[1], port.at[2]]
        if port.hull != starboard.hull or not np.allclose(starboard.at, mirrored, atol=_ALIKE):
            return None
    first = [_Hulls(p.hull, p.at[0], p.at[2], 0.0) for p in centre if p.hull]
    pair = [_Hulls(p.hull, p.at[0], p.at[2], -2.0 * p.at[1]) for p in aside[:1] if p.hull]
    return [*first, *pair]


def _sections(part: Part, hulls: list[_Hulls]) -> dict[str, Any]:
    """Return sections by scalar, and waterplane and metacentric heights."""
    density = _number(part, "density", _number(part, "water_density", 1025.0))
    beams = [h.stations(h.hull.beam) for h in hulls]
    draughts = [h.stations(h.hull.draught) for h in hulls]
    plane = sum(h.total(b) for h, b in zip(hulls, beams, strict=True))
    wanted = _number(part, "waterplane_area", 0.0) or plane
    beams = [b * (wanted / plane) for b in beams]
    areas = [_ELLIPSE * b * t for b, t in zip(beams, draughts, strict=True)]
    volume = sum(h.total(a) for h, a in zip(hulls, areas, strict=True))
    displaced = _displaced(part, density) or volume
    draughts = [t * (displaced / volume) for t in draughts]
    areas = [a * (displaced / volume) for a in areas]
    found: dict[str, Any] = {"hull_waterline": -hulls[0].waterline}
    for prefix, name, h, b, t, a in zip(
        ("hull", "side"), ("section", "side"), hulls, beams, draughts, areas, strict=False
    ):
        found |= {f"{prefix}_length": h.hull.length, f"{prefix}_middle": h.ahead}
        found[f"{prefix}_spacing"] = h.apart
        for what, values in (("beam", b), ("draught", t), ("area", a)):
            found |= {f"{name}_{what}.s{i}": value for i, value in enumerate(values.tolist())}
    return found | _hydrostatics(part, hulls, beams, draughts, areas, wanted)


def _displaced(part: Part, density: float) -> float:
    """Return the volume of the mass, m3; 0 where a ship's mass is dimensionless."""
    unit = part.instance.variables["mass"].unit if "mass" in part.instance.variables else ""
    return _number(part, "mass", 0.0) / density if unit == "kg" else 0.0


def _hydrostatics(
    part: Part, hulls: list[_Hulls], beams: Any, draughts: Any, areas: Any, plane: float
) -> dict[str, float]:
    """Return waterplane, m2, and metacentric heights, m, of the sections."""
    volume = sum(h.total(a) for h, a in zip(hulls, areas, strict=True))
    across = along = first = below = 0.0
    for h, b, t, a in zip(hulls, beams, draughts, areas, strict=True):
        x = h.ahead + np.linspace(-0.5, 0.5, _STATIONS) * h.hull.length
        across += h.total(b**3 / 12.0 + b * (0.5 * h.apart) ** 2)
        along, first = along + h.total(b * x**2), first + h.total(b * x)
        below += h.total(a * t) * 4.0 / (3.0 * math.pi)
    z_B = hulls[0].waterline + below / volume
    lowered = z_B - _number(part, "center_of_gravity.z", 0.0)
    return {
        "waterplane_area": plane,
        "GM_T": across / volume - lowered,
        "GM_L": (along - first**2 / plane) / volume - lowered,
    }


def _windage(parts: Sequence[ShapePart], waterline: float) -> dict[str, float]:
    """Return the areas that the wind meets, m2, and the centroid of the lateral one, m."""
    frontal, lateral = silhouettes(parts, waterline)
    if not (frontal.area and lateral.area):
        return {}
    return {
        "windage_frontal": frontal.area,
        "windage_lateral": lateral.area,
        "windage_ahead": lateral.along,
        "windage_height": max(lateral.up, 0.0),
    }


def is_at_surface(part: Part) -> bool:
    """Return whether a component has no form of restoring, or one of a craft at the surface."""
    if "restoring" not in part.instance.variables:
        return True
    return str(_value(part, "restoring")).startswith("surface")


def _has_any(part: Part, beginnings: tuple[str, ...]) -> bool:
    return any(name.startswith(beginnings) for name in part.given)


def _number(part: Part, name: str, otherwise: float) -> float:
    if name not in part.instance.variables:
        return otherwise
    return float(_value(part, name))


def _value(part: Part, name: str) -> Any:
    given: Mapping[str, Given] = part.given
    return given[name].value if name in given else part.instance.variables[name].start
