"""Propulsors and rudder of a proposed body at the surface."""

from __future__ import annotations

from .floating import Floating
from .value import BOLLARD, TURNING, Formula, Part, Value, estimated

_RUDDER_SHARE = 0.015
_HELM = 0.6109
"""35 deg."""


def surface_parts(body: Floating, drag: float) -> tuple[Part, ...]:
    """Return what pushes and steers the body at its speed, of a ``drag`` X_u|u|, kg/m.

    A propeller and a rudder of a monohull, a thruster in each hull of a catamaran, an azimuth
    thruster of a trimaran; a barge is towed.
    """
    thrust, kind = drag * body.speed**2, body.particulars.kind
    if kind == "barge":
        return ()
    if kind == "catamaran":
        return tuple(_thruster(body, "thruster", thrust / 2.0, h.across) for h in body.hulls)
    if kind == "trimaran":
        turning = (Value("angle_limit", (-_HELM, _HELM), "rad", "35 deg"),)
        return (_thruster(body, "azimuth", thrust, 0.0, turning),)
    return (_thruster(body, "thruster", thrust, 0.0), _rudder(body))


def _thruster(
    body: Floating, kind: str, thrust: float, across: float, more: tuple[Value, ...] = ()
) -> Part:
    length, draught = body.particulars["length"], body.main_draught
    place = (-0.48 * length, across, 0.6 * draught)
    push = Formula(f"the drag at {body.speed:.4g} m/s")
    return Part(
        "propulsors",
        kind,
        (
            estimated("position", place, "m", Formula("at the stern")),
            estimated("thrust", (thrust, thrust), "N", push, BOLLARD),
            estimated("diameter", 0.5 * draught, "m", Formula("half of the draught")),
            *more,
        ),
    )


def _rudder(body: Floating) -> Part:
    length, draught = body.particulars["length"], body.main_draught
    area = Formula("1.5 % of length times draught (Wärtsilä Encyclopedia of Marine Technology)")
    return Part(
        "foils",
        "rudder",
        (
            estimated(
                "position", (-0.5 * length, 0.0, 0.5 * draught), "m", Formula("at the stern")
            ),
            estimated("area", _RUDDER_SHARE * length * draught, "m2", area, TURNING),
            estimated("aspect_ratio", 1.5, "1", Formula("of usual rudders"), TURNING),
            estimated("angle_limit", _HELM, "rad", Formula("35 deg")),
            Value("behind", 1.0, "1", "in the race of the propeller"),
        ),
    )
