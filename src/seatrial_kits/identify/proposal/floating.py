"""Hulls of a body at the surface from its main particulars: draught, displacement, stability."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from seatrial.errors import InputError

from .particulars import Particulars
from .ship import FloatingHull, Hydrostatics, hydrostatics, waterplane_coefficient
from .surroundings import GRAVITY

_BLOCK = {"monohull": 0.6, "catamaran": 0.45, "trimaran": 0.45, "barge": 0.95}
"""C_B where mass and draught are not both given."""
_WATERPLANE = {"catamaran": 0.75, "trimaran": 0.75}
"""C_W at least, of slender hulls with transoms (Fossen, otter)."""
_FROUDE = 0.25


@dataclass(frozen=True)
class Floating:
    """A body at the surface: the main hull, or the two of a catamaran, then side hulls."""

    particulars: Particulars
    hulls: tuple[FloatingHull, ...]
    mass: float
    block: float
    remarks: tuple[str, ...]

    @property
    def density(self) -> float:
        """Of the water, kg/m3."""
        return self.particulars.density

    @property
    def is_box(self) -> bool:
        """Whether it is a barge."""
        return self.particulars.kind == "barge"

    @property
    def main_draught(self) -> float:
        """Of the main hull, m."""
        return self.hulls[0].draught

    @property
    def said_draught(self) -> float:
        """The main hull's as it is given, or to four digits."""
        return self.particulars.get("draught", float(f"{self.main_draught:.4g}"))

    @property
    def height(self) -> float:
        """From keel to deck, m: twice the draught where it is not given."""
        return self.particulars.get("height", 2.0 * self.main_draught)

    @property
    def speed(self) -> float:
        """Design speed, m/s: of a Froude number of 0.25 where it is not given."""
        natural = _FROUDE * math.sqrt(GRAVITY * self.particulars["length"])
        return self.particulars.get("speed", natural)

    @property
    def z_G(self) -> float:
        """CG below the water line, m: in it where its height is not given."""
        return self.main_draught - self.particulars.get("cg_height", self.main_draught)

    @property
    def hydrostatics(self) -> Hydrostatics:
        """Of all hulls."""
        return hydrostatics(self.hulls)

    @property
    def GM_T(self) -> float:
        """BM_T - (z_B - z_G), m."""
        return self.hydrostatics.BM_T - self.hydrostatics.z_B + self.z_G

    @property
    def GM_L(self) -> float:
        """BM_L - (z_B - z_G), m."""
        return self.hydrostatics.BM_L - self.hydrostatics.z_B + self.z_G


def floating(particulars: Particulars) -> Floating:
    """Return the hulls.

    Of mass and draught one follows from the other by the block coefficient of the kind; given both,
    they give the block coefficient. Raises InputError for neither, for a block coefficient above
    1, a spacing that does not fit the beam, a height below the draught, a GM_T not above 0.
    """
    places = _PLACES[particulars.kind](particulars)
    block, draught, mass = _afloat(particulars, sum(p.volume for p in places))
    waterplane = max(waterplane_coefficient(block), _WATERPLANE.get(particulars.kind, 0.0))
    hulls = tuple(
        FloatingHull(p.length, p.beam, p.depth * draught, block, waterplane, p.across)
        for p in places
    )
    found = Floating(particulars, hulls, mass, block, _remarks(particulars, places, block))
    if "height" in particulars.given and particulars["height"] < draught:
        raise InputError(
            f"--height {particulars['height']:g} m is below the draught {draught:.4g} m"
        )
    if not found.GM_T > 0.0:
        raise InputError(
            f"GM_T is {found.GM_T:.3g} m: it does not float upright; a greater --beam or a lower "
            f"--cg-height (now {found.main_draught - found.z_G:.3g} m above the keel) is needed"
        )
    return found


@dataclass(frozen=True)
class _Place:
    """A hull before its draught is known: ``depth`` is its draught over that of the main hull."""

    length: float
    beam: float
    depth: float = 1.0
    across: float = 0.0

    @property
    def volume(self) -> float:
        """Of its box, by draught of the main hull, m2."""
        return self.length * self.beam * self.depth


def _afloat(particulars: Particulars, area: float) -> tuple[float, float, float]:
    """Return block coefficient, draught and mass; ``area`` is that of the boxes by draught."""
    given, rho = particulars.given, particulars.density
    if "mass" not in given and "draught" not in given:
        raise InputError(f"--kind {particulars.kind}: --mass or --draught is needed")
    block = _BLOCK[particulars.kind]
    if "mass" not in given:
        return block, given["draught"], block * rho * area * given["draught"]
    if "draught" not in given:
        return block, given["mass"] / (block * rho * area), given["mass"]
    block = given["mass"] / (rho * area * given["draught"])
    if block > 1.0:
        raise InputError(
            f"--mass {given['mass']:g} kg at --draught {given['draught']:g} m is a block "
            f"coefficient of {block:.3g}; up to 1 is possible: less mass or more draught"
        )
    return block, given["draught"], given["mass"]


def _remarks(particulars: Particulars, places: list[_Place], block: float) -> tuple[str, ...]:
    found = []
    if not {"mass", "draught"} <= set(particulars.given):
        found.append(f"C_B {block:g} is assumed: give both --mass and --draught to fix it")
    if "cg_height" not in particulars.given:
        found.append("the CG is assumed in the water line: give --cg-height")
    if len(places) == 3:
        found.append("side hulls lie amidships, with half of the main hull's draught")
    return tuple(found)


def _one(particulars: Particulars) -> list[_Place]:
    return [_Place(particulars["length"], particulars["beam"])]


def _two(particulars: Particulars) -> list[_Place]:
    beam, width = particulars["beam"], particulars["hull_beam"]
    apart = _spacing(particulars, width)
    length = particulars["length"]
    if apart < width:
        raise InputError(f"--hull-beam {width:g} m: two do not fit into --beam {beam:g} m")
    return [_Place(length, width, across=side * apart / 2.0) for side in (-1, 1)]


def _three(particulars: Particulars) -> list[_Place]:
    width = particulars["side_beam"]
    apart = _spacing(particulars, width)
    if apart < width + particulars["hull_beam"]:
        raise InputError(f"--side-beam {width:g} m: the hulls overlap, {apart:g} m apart")
    main = _Place(particulars["length"], particulars["hull_beam"])
    length = particulars["side_length"]
    return [main, *(_Place(length, width, 0.5, side * apart / 2.0) for side in (-1, 1))]


def _spacing(particulars: Particulars, width: float) -> float:
    """Return the distance of the centre lines of the outer hulls."""
    beam = particulars["beam"]
    apart = particulars.get("spacing", beam - width)
    if not 0.0 < apart <= beam - width + 1e-9:
        raise InputError(
            f"the outer hulls are {apart:g} m apart, centre to centre, and {width:g} m wide: up to "
            f"--beam {beam:g} m less {width:g} m is allowed"
        )
    return apart


_PLACES: dict[str, Callable[[Particulars], list[_Place]]] = {
    "monohull": _one,
    "barge": _one,
    "catamaran": _two,
    "trimaran": _three,
}
