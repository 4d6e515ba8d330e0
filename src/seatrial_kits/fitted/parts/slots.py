"""Places for parts of a body: the parameters that a craft and its allocation share.

A craft has up to 8 propulsors, 8 foils and 8 ballasts. The texts ``propulsors``, ``foils`` and
``ballasts`` name the kind of each, in order, separated by spaces; parameter NAME of propulsor k is
``propulsor_NAME_k``. Places are in body axes (x bow, y starboard, z down) from the body origin.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from seatrial.errors import InputError, unknown
from seatrial.model.component import Component, Parameter

COUNT = 8
"""Most parts of one sort that a craft has."""

PROPULSORS = (
    "thruster",
    "azimuth",
    "outboard",
    "tunnel",
    "propeller",
    "wageningen-b",
    "four-quadrant",
    "jet",
)
FOILS = ("fin", "linear-fin", "rudder", "sail")
BALLASTS = ("buoyancy-engine", "tank", "moving-mass")


class Each:
    """A parameter of each part of a sort, PART_NAME_1 ... PART_NAME_8; reading gives them all."""

    def __init__(self, part: str, start: Any, unit: Any, description: str, **options: Any) -> None:
        self._part, self._options = part, options
        self._declared = start, unit, description

    def __set_name__(self, owner: type, name: str) -> None:
        start, unit, description = self._declared
        self._name = name
        for number in range(1, COUNT + 1):
            text = f"{description}, {self._part} {number}"
            parameter = Parameter(start, unit, text, **self._options)
            parameter.__set_name__(owner, f"{name}_{number}")
            setattr(owner, parameter.name, parameter)

    def __get__(self, component: Any, owner: type | None = None) -> Any:
        return self if component is None else self.of(component)

    def of(self, values: Any) -> list[Any]:
        """Return those of all parts in ``values``: a component, or a plant's symbols."""
        return [getattr(values, f"{self._name}_{number}") for number in range(1, COUNT + 1)]


def read_kinds(text: str, sort: str, known: tuple[str, ...]) -> list[str]:
    """Return the kinds of parts that ``text`` names. Raises InputError for an unknown one."""
    kinds = text.split()
    for kind in kinds:
        if kind not in known:
            raise InputError(f"{sort}s: {unknown('kind', kind, known)}")
    if len(kinds) > COUNT:
        raise InputError(f"{sort}s: {len(kinds)} are named, at most {COUNT} are allowed")
    return kinds


def _checked(sort: str, known: tuple[str, ...]) -> Callable[[str], object]:
    return partial(read_kinds, sort=sort, known=known)


_p = partial(Each, "propulsor")
_f = partial(Each, "foil")
_b = partial(Each, "ballast")


class PropulsorSlots(Component):
    """Mix-in: parameters of up to 8 propulsors.

    An order is a share of the largest thrust or shaft speed, -1 to 1. A propulsor pushes along its
    ``propulsor_axis``, turned by its angle about z, from x to y, if it can turn. Propulsors on one
    helm have one angle: ``propulsor_turns_with`` is the number of the one whose order, range, rate
    and lag they share.
    """

    propulsors = Parameter(
        "", "1", "kinds of the propulsors, in order", check=_checked("propulsor", PROPULSORS)
    )
    propulsor_position = _p(0.0, "m", "position from the body origin, body axes", axes="xyz")
    propulsor_axis = _p(
        (1.0, 0.0, 0.0), "1", "direction of the thrust ahead, unit vector, body axes", axes="xyz"
    )
    propulsor_thrust = _p(
        (1.0, 1.0),
        "N",
        "largest thrust at rest, ahead and astern",
        axes=("ahead", "astern"),
        min=0.0,
    )
    propulsor_exponent = _p(
        1.0, "1", "thrust by order: sign(s) |s|^exponent of the largest", min=1.0, max=3.0
    )
    propulsor_fading_speed = _p(
        0.0, "m/s", "speed of the flow at which the thrust is gone; 0: it never is", min=0.0
    )
    propulsor_diameter = _p(0.1, "m", "diameter of propeller or nozzle", min=1e-6)
    propulsor_speed = _p(
        (100.0, 100.0),
        "rad/s",
        "shaft speed at orders 1 and -1, both positive",
        axes=("ahead", "astern"),
        min=0.0,
    )
    propulsor_wake = _p(
        0.0, "1", "wake fraction w: the propeller meets (1 - w) of the flow", max=1.0
    )
    propulsor_deduction = _p(0.0, "1", "thrust deduction t: (1 - t) of the thrust acts", max=1.0)
    propulsor_hand = _p(
        1.0, "1", "1: turns clockwise seen from astern, as it drives ahead; -1: the other way"
    )
    propulsor_moment_share = _p(
        1.0, "1", "share of the shaft's moment that acts back on the body", min=0.0
    )
    propulsor_time_constant = _p(0.0, "s", "lag behind the order, 0 for none", min=0.0)
    propulsor_angle_limit = _p(
        (0.0, 0.0), "rad", "range of the angle, from and to; alike: it does not turn",
        axes=("from", "to"),
    )  # fmt: skip
    propulsor_angle_rate = _p(0.0, "rad/s", "largest rate of the angle; 0: no limit", min=0.0)
    propulsor_angle_time_constant = _p(0.0, "s", "lag of the angle, 0 for none", min=0.0)
    propulsor_turns_with = _p(
        0.0, "1", "number of the propulsor whose angle it has, 0 for one of its own", min=0.0
    )


class FoilSlots(Component):
    """Mix-in: parameters of up to 8 foils: fins, stern planes, rudders, sails.

    A foil's span lies along -z of the body, turned by ``foil_roll`` about x; at roll 0 it is a
    vertical rudder, at 90 deg its span points to starboard.
    """

    foils = Parameter("", "1", "kinds of the foils, in order", check=_checked("foil", FOILS))
    foil_position = _f(0.0, "m", "centre of effort from the body origin, body axes", axes="xyz")
    foil_roll = _f(0.0, "rad", "of the span about x, from -z towards y")
    foil_area = _f(0.01, "m2", "area of the planform", min=1e-9)
    foil_aspect_ratio = _f(2.0, "1", "effective aspect ratio: span squared over area", min=1e-3)
    foil_lift = _f(0.0, "1/rad", "lift coefficient by angle (linear-fin)", min=0.0)
    foil_angle_limit = _f(0.6, "rad", "largest angle to either side", min=0.0)
    foil_angle_rate = _f(0.0, "rad/s", "largest rate of the angle; 0: no limit", min=0.0)
    foil_time_constant = _f(0.0, "s", "lag of the angle, 0 for none", min=0.0)


class BallastSlots(Component):
    """Mix-in: parameters of up to 8 ballasts: buoyancy engines, tanks, moving masses.

    An order is a share of the range, -1 to 1, or 0 to 1 of a tank.
    """

    ballasts = Parameter(
        "", "1", "kinds of the ballasts, in order", check=_checked("ballast", BALLASTS)
    )
    ballast_position = _b(0.0, "m", "position from the body origin, body axes", axes="xyz")
    ballast_axis = _b(
        (1.0, 0.0, 0.0), "1", "direction in which a mass moves, unit vector", axes="xyz"
    )
    ballast_mass = _b(0.0, "kg", "of a moving mass; of a full tank", min=0.0)
    ballast_volume = _b(0.0, "m3", "of a buoyancy engine at order 1, beyond the neutral", min=0.0)
    ballast_travel = _b(0.0, "m", "way of a moving mass from the middle, at order 1", min=0.0)
    ballast_rate = _b(0.0, "1/s", "largest rate of the share; 0: no limit", min=0.0)
