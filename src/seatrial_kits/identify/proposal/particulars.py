"""Main particulars of a vehicle, as a user gives them to ``seatrial estimate --kind``."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from seatrial.errors import InputError, unknown
from seatrial.model.units import quantity

UNITS = {
    "length": "m",
    "diameter": "m",
    "beam": "m",
    "hull_beam": "m",
    "side_length": "m",
    "side_beam": "m",
    "draught": "m",
    "height": "m",
    "cg_height": "m",
    "spacing": "m",
    "frontal_area": "m2",
    "side_area": "m2",
    "top_area": "m2",
    "mass": "kg",
    "speed": "m/s",
    "density": "kg/m3",
}
"""Unit of each particular."""
AREAS = ("frontal_area", "side_area", "top_area")
"""Of what is seen from ahead, abeam and above."""
_SURFACE = ("mass", "draught", "height", "cg_height", "speed", "density")


@dataclass(frozen=True)
class Kind:
    """The particulars that a kind of body needs, and those that it may have."""

    needed: tuple[str, ...]
    optional: tuple[str, ...]


KINDS = {
    "torpedo": Kind(("length", "diameter"), ("mass", "speed", "density")),
    "rov": Kind(("length", "beam", "height", "mass"), (*AREAS, "speed", "density")),
    "monohull": Kind(("length", "beam"), _SURFACE),
    "catamaran": Kind(("length", "beam", "hull_beam"), (*_SURFACE, "spacing")),
    "trimaran": Kind(
        ("length", "beam", "hull_beam", "side_length", "side_beam"), (*_SURFACE, "spacing")
    ),
    "barge": Kind(("length", "beam"), _SURFACE),
}


@dataclass(frozen=True)
class Particulars:
    """Particulars of a body of a kind, SI."""

    kind: str
    given: Mapping[str, float]

    def __getitem__(self, name: str) -> float:
        return self.given[name]

    def get(self, name: str, otherwise: float) -> float:
        """Return a particular, or ``otherwise`` where it is not given."""
        return self.given.get(name, otherwise)

    @property
    def density(self) -> float:
        """Density of the water, kg/m3: of sea water at 15 degrees unless it is given."""
        return self.get("density", 1025.0)


def option(name: str) -> str:
    """Return the option of the command that gives a particular."""
    return "--" + name.replace("_", "-")


def read_particulars(kind: str, written: Mapping[str, str | None]) -> Particulars:
    """Return the particulars of ``written`` quantities; a bare number is in SI.

    Raises InputError for an unknown kind, a particular that the kind lacks or does not have, and a
    value that is no quantity of its unit or not above 0.
    """
    if kind not in KINDS:
        raise InputError(f"--kind: {unknown('kind', kind, KINDS)}")
    needed, allowed = KINDS[kind].needed, (*KINDS[kind].needed, *KINDS[kind].optional)
    said = {name: text for name, text in written.items() if text is not None}
    for name in said:
        if name not in allowed:
            names = ", ".join(map(option, allowed))
            raise InputError(f"{option(name)}: of a {kind} the particulars are {names}")
    if missing := [option(name) for name in needed if name not in said]:
        names = ", ".join(map(option, needed))
        raise InputError(f"--kind {kind}: {', '.join(missing)} missing; {names} are needed")
    return Particulars(kind, {name: _positive(name, text) for name, text in said.items()})


def _positive(name: str, text: str) -> float:
    try:
        value = quantity(_number(text), UNITS[name])
    except InputError as error:
        raise InputError(f"{option(name)}: {error}") from None
    if not 0.0 < value < float("inf"):
        raise InputError(f"{option(name)}: above 0 is needed, found {text!r}")
    return value


def _number(text: str) -> float | str:
    try:
        return float(text)
    except ValueError:
        return text
