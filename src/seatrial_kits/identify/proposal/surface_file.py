"""Vehicle files of hulls that float: monohull, catamaran, trimaran, barge."""

from __future__ import annotations

import math
from typing import Any

from ..damping import friction_line
from . import box, ship
from .floating import Floating, floating
from .particulars import Particulars
from .surroundings import GRAVITY, VISCOSITY, heading
from .value import (
    BOLLARD,
    DECAY,
    INCLINING,
    TOWING,
    TURNING,
    ZIGZAG,
    Formula,
    Part,
    Proposal,
    Value,
    estimated,
    given_or,
)

_TERMS = "restoring coriolis damping crossflow-drag hull-lift wave-loads wind-loads"
_STRIPS = "surge: Soeding; heave, roll, pitch: strips, Lewis forms at high frequency; sway, yaw: "
_SHIP = Formula(_STRIPS + "[Clarke1983]", "length / beam of a hull", ship.CLARKE_FROM)
_BROAD = Formula(_STRIPS + "strips at low frequency", "length / beam of a hull", 4.0, 20.0)
_RADII = Formula("radii of gyration 0.4 B, 0.25 L, 0.25 L about the CG (Fossen, otter; ITTC)")
_BOX = Formula("even box of length, beam and height")
_WATERPLANE = Formula(
    "C_W = (1 + 2 C_B) / 3, 0.75 at least of hulls with transoms; water line 1 - |2 x / L|^n",
    "C_B",
    0.35,
    1.0,
)
_GM = Formula("BM of the waterplane, Morrish's centre of buoyancy")
_LIFT = Formula("wing of low aspect ratio (Jones; [Clarke1983])", "draught / length", 0.0, 0.1)
_HOERNER = Formula("Hoerner's curve, one hull", "beam / (2 draught)", *ship.HOERNER_RANGE)
_FRICTION = "ITTC 1957 with Watanabe's form factor, no wave resistance"
_RATIOS = Formula("damping ratios 0.3 in heave, 0.2 in roll, 0.4 in pitch (Fossen, otter)")
_COLOUR = "#e8edf0"
_STATIONS = [i / 5.0 - 1.0 for i in range(11)]


def surface_proposal(particulars: Particulars) -> Proposal:
    """Return the file.

    Raises InputError if mass and draught contradict each other, the hull does not float upright, or
    the flow is too slow for the friction line.
    """
    body = floating(particulars)
    drag = _drag_ahead(body)
    propulsion = surface_parts(body, drag)
    values = (
        *heading(_TERMS, "surface-conservative", particulars),
        *_mass(body),
        *_restoring(body),
        *_damping(body, drag),
    )
    shape = tuple(_drawn(body, hull) for hull in body.hulls)
    return Proposal(
        particulars.kind, particulars["length"], particulars["beam"], values, propulsion, shape,
        body.remarks,
    )  # fmt: skip


def _added(body: Floating) -> ship.AddedMass:
    return ship.together(
        [ship.added_mass(hull, body.density, box=body.is_box) for hull in body.hulls]
    )


def _added_by(body: Floating) -> Formula:
    main = body.hulls[0]
    return _BROAD if body.is_box or main.length < ship.CLARKE_FROM * main.beam else _SHIP


def _inertia(body: Floating) -> tuple[float, float, float]:
    p = body.particulars
    if body.is_box:
        return box.inertia(body.mass, p["length"], p["beam"], body.height)
    roll, yaw = (0.4 * p["beam"]) ** 2, (0.25 * p["length"]) ** 2
    return body.mass * roll, body.mass * yaw, body.mass * yaw


def _mass(body: Floating) -> list[Value]:
    p, a, none = body.particulars, _added(body), (0.0, 0.0, 0.0)
    main, by = body.hulls[0], _added_by(body)
    ratio = main.length / main.beam
    by_block = Formula(f"C_B {body.block:.3g} of this kind")
    radii = _BOX if body.is_box else _RADII
    at_line = Formula("given: --cg-height" if "cg_height" in p.given else "in the water line")
    return [
        given_or(p, "mass", body.mass, "kg", by_block),
        estimated("inertia", (*_inertia(body), *none), "kg.m2", radii, DECAY),
        estimated("center_of_gravity", (0.0, 0.0, body.z_G), "m", at_line, INCLINING),
        estimated("added_mass", (a.surge, a.sway, a.heave, *none), "kg", by, DECAY, ratio),
        estimated("added_inertia", (a.roll, a.pitch, a.yaw, *none), "kg.m2", by, DECAY, ratio),
    ]


def _restoring(body: Floating) -> list[Value]:
    at_rest = body.hydrostatics
    return [
        estimated(
            "waterplane_area", at_rest.waterplane_area, "m2", _WATERPLANE, INCLINING, body.block
        ),
        estimated("GM_T", body.GM_T, "m", _GM, INCLINING),
        estimated("GM_L", body.GM_L, "m", _GM, INCLINING),
    ]


def _drag_ahead(body: Floating) -> float:
    """Return X_u|u|, kg/m: friction at the speed, and the blunt ends of a box."""
    total = 0.0
    for hull in body.hulls:
        friction = friction_line(body.speed * hull.length / VISCOSITY)
        if body.is_box:
            depth = 2.0 * hull.draught
            total += box.drag(hull.length, hull.beam, depth, body.density) / 2.0
            wetted = hull.length * (hull.beam + 2.0 * hull.draught)
            total += 0.5 * body.density * friction * wetted
        else:
            form = 1.0 + ship.form_factor(hull)
            total += 0.5 * body.density * friction * form * ship.wetted_surface(hull)
    return total


def _damping(body: Floating, ahead: float) -> list[Value]:
    main, a = body.hulls[0], _added(body)
    froude = body.speed / math.sqrt(GRAVITY * main.length)
    by_line = _FRICTION
    if body.is_box:
        by_line = "ITTC 1957, and half a doubled box of DNV-RP-C205 table E-1; no wave resistance"
    friction = Formula(by_line, "Froude number", 0.0, 0.25)
    lever = body.mass * body.z_G**2
    own = _inertia(body)
    weight = body.mass * GRAVITY
    stiff = body.density * GRAVITY * body.hydrostatics.waterplane_area
    heave = 0.6 * math.sqrt(stiff * (body.mass + a.heave))
    roll = 0.4 * math.sqrt(weight * body.GM_T * (own[0] + lever + a.roll))
    pitch = 0.8 * math.sqrt(weight * body.GM_L * (own[1] + lever + a.pitch))
    C_d = ship.crossflow_coefficient(main.beam, main.draught)
    wide = main.beam / (2.0 * main.draught)
    lift = sum(
        ship.hull_lift(hull.draught, body.density)
        for hull in body.hulls
        if hull.length == main.length
    )
    slim = main.draught / main.length
    return [
        estimated(
            "quadratic_damping_force", (ahead, 0.0, 0.0), "N.s2/m2", friction, TOWING, froude
        ),
        estimated("linear_damping_force", (0.0, 0.0, heave), "N.s/m", _RATIOS, DECAY),
        estimated("linear_damping_moment", (roll, pitch, 0.0), "N.m.s/rad", _RATIOS, DECAY),
        Value("crossflow_length", main.length, "m", "length of a hull", TURNING),
        Value("crossflow_draught", body.said_draught, "m", "draught of a hull", TURNING),
        estimated("crossflow_coefficient", C_d, "1", _HOERNER, TURNING, wide),
        estimated("lift", (lift, 0.0), "kg/m", _LIFT, ZIGZAG, slim),
        estimated("lift_arm", main.length / 2.0, "m", _LIFT, ZIGZAG),
    ]


def _drawn(body: Floating, hull: ship.FloatingHull) -> dict[str, Any]:
    drawn = {
        "length": hull.length,
        "beam": [float(f"{beam:.4g}") for beam in hull.beams(_STATIONS)],
        "draught": [float(f"{hull.draught:.4g}")] * len(_STATIONS),
        "freeboard": float(f"{max(body.height - body.main_draught, 0.0):.4g}"),
    }
    return {"hull": drawn, "at": [0.0, float(f"{hull.across:.4g}"), 0.0], "colour": _COLOUR}


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
