"""Vehicle file of a torpedo-shaped body: spheroid, body lift, two pairs of fins, one thruster."""

from __future__ import annotations

import math

from seatrial.errors import InputError
from seatrial.physics.craft.terms import spheroid

from ..damping import friction_line
from . import torpedo
from .particulars import Particulars
from .surroundings import VISCOSITY, heading, neutral
from .value import (
    BOLLARD,
    DECAY,
    INCLINING,
    TOWING,
    TURNING,
    WEIGHING,
    Formula,
    Part,
    Proposal,
    Value,
    estimated,
    given_or,
)

_REMUS = "as REMUS 100 has it"
_SPHEROID = Formula("even spheroid", "length / diameter", 1.0)
_LAMB = Formula("Lamb's factors of the spheroid, of the mass", "length / diameter", 1.0)
_LIFT = Formula("Hoerner's lift of a body", "length / diameter", *torpedo.SLENDER)
_STRIPS = Formula("strips of a cylinder, C_d 1.1 (Hoerner; [Prestero2001])", "length / diameter", 5)
_SPEED = 1.5
"""m/s: about the 3 knots at which such vehicles survey."""
_CG = 0.1
"""CG below the axis, in diameters."""
_FINS = 0.0133 / (1.6 * 0.19)
"""Area of a pair of fins over length times diameter."""
_PLACE = 0.43
"""Fins and thruster abaft the middle, in lengths."""


def torpedo_proposal(particulars: Particulars) -> Proposal:
    """Return the file. Raises InputError for a length below the diameter or too slow a flow."""
    length, diameter = particulars["length"], particulars["diameter"]
    if length < diameter:
        raise InputError(f"--length {length:g} m is below --diameter {diameter:g} m")
    speed = particulars.get("speed", _SPEED)
    drag, bare = _drag_ahead(particulars, speed)
    values = (
        *heading("restoring coriolis damping crossflow-drag hull-lift", "submerged", particulars),
        *_mass(particulars),
        *_damping(particulars, drag, bare),
    )
    capsule = {"radius": diameter / 2.0, "length": round(length - diameter, 9)}
    return Proposal(
        particulars.kind,
        length,
        diameter,
        values,
        _parts(particulars, drag * speed**2, speed),
        ({"capsule": capsule, "colour": "#f2c32e"},),
        _heavy(particulars),
    )


def _displaced(particulars: Particulars) -> float:
    size = particulars["length"], particulars["diameter"]
    return spheroid.displaced_mass(size[0], size[1], particulars.density)


def _heavy(particulars: Particulars) -> tuple[str, ...]:
    share = particulars.get("mass", 0.0) / (1.5 * _displaced(particulars))
    if share <= 1.0:
        return ()
    return (f"the mass is {share:.3g} times that of the water that its cylinder displaces",)


def _mass(particulars: Particulars) -> list[Value]:
    length, diameter = particulars["length"], particulars["diameter"]
    mass = particulars.get("mass", _displaced(particulars))
    lamb, (along, across) = (
        spheroid.lamb(length, diameter),
        spheroid.inertia(mass, length, diameter),
    )
    ratio, low = length / diameter, _CG * diameter
    about = Formula(f"{_REMUS}: 0.02 m of 0.19 m")
    turned = (0.0, lamb.k_prime * across, lamb.k_prime * across, 0.0, 0.0, 0.0)
    return [
        given_or(particulars, "mass", mass, "kg", Formula("displaced mass of the spheroid")),
        neutral(),
        estimated("inertia", (along, across, across, 0.0, 0.0, 0.0), "kg.m2", _SPHEROID, WEIGHING),
        estimated("center_of_gravity", (0.0, 0.0, low), "m", about, INCLINING),
        estimated("center_of_buoyancy", (0.0, 0.0, 0.0), "m", Formula("middle of the body")),
        estimated(
            "added_mass",
            (lamb.k1 * mass, lamb.k2 * mass, lamb.k2 * mass, 0.0, 0.0, 0.0),
            "kg", _LAMB, DECAY, ratio,
        ),
        estimated("added_inertia", turned, "kg.m2", _LAMB, DECAY, ratio),
    ]  # fmt: skip


def _drag_ahead(particulars: Particulars, speed: float) -> tuple[float, float]:
    """Return X_u|u| with fins and sensors, and that of the bare hull."""
    length, diameter, rho = particulars["length"], particulars["diameter"], particulars.density
    friction = friction_line(speed * length / VISCOSITY)
    bare = torpedo.bare_hull_drag(friction, length, diameter, rho)
    return torpedo.frontal_drag(0.42, diameter, rho), bare


def _damping(particulars: Particulars, ahead: float, bare: float) -> list[Value]:
    length, diameter, rho = particulars["length"], particulars["diameter"], particulars.density
    force, turning = torpedo.cylinder_drag(length, diameter, rho, 1.1)
    mass, low = particulars.get("mass", _displaced(particulars)), _CG * diameter
    roll = spheroid.inertia(mass, length, diameter)[0] + mass * low**2
    rolled = torpedo.ratio_damping(0.3, mass * 9.81 * low, roll)
    lift = torpedo.body_lift(length, diameter, rho)
    frontal = Formula(
        f"ahead C_D 0.42 on the frontal area ([Allen2000]), the bare hull by Hoerner "
        f"{bare:.3g}; heave: {_STRIPS.text}"
    )
    ratio = length / diameter
    across = Formula("a cylinder (Hoerner; [Prestero2001])")
    roll_by = Formula("damping ratio 0.3 (Fossen, remus100)")
    center = Formula("0.65 of the length from the nose ([Prestero2001])")
    return [
        estimated("quadratic_damping_force", (ahead, 0.0, force), "N.s2/m2", frontal, TOWING),
        estimated(
            "quadratic_damping_moment", (0.0, turning, 0.0), "N.m.s2/rad2", _STRIPS, DECAY, ratio
        ),
        estimated("linear_damping_moment", (rolled, 0.0, 0.0), "N.m.s/rad", roll_by, DECAY),
        Value("crossflow_length", length, "m", _STRIPS.text, TURNING),
        Value("crossflow_draught", diameter, "m", _STRIPS.text, TURNING),
        estimated("crossflow_coefficient", 1.1, "1", across, TURNING),
        estimated("lift", (lift, lift), "kg/m", _LIFT, TURNING, ratio),
        estimated("lift_arm", 0.15 * length, "m", center, TURNING),
    ]


def _parts(particulars: Particulars, thrust: float, speed: float) -> tuple[Part, ...]:
    length, diameter = particulars["length"], particulars["diameter"]
    aft = (-_PLACE * length, 0.0, 0.0)
    push = Formula(f"the drag at {speed:g} m/s")
    screw = Formula(f"{_REMUS}: 0.14 m of 0.19 m")
    area = Formula(f"{_REMUS}: 0.0133 m2 a pair at 1.6 m by 0.19 m")
    tail = Formula("at the tail")
    fins = [
        Part(
            "foils",
            "fin",
            (
                estimated("position", aft, "m", tail, TURNING),
                Value("roll", roll, "rad", name),
                estimated("area", _FINS * length * diameter, "m2", area, TURNING),
                estimated("aspect_ratio", 2.2, "1", Formula(_REMUS), TURNING),
                estimated("angle_limit", 0.2618, "rad", Formula(f"{_REMUS}: 15 deg")),
            ),
        )
        for name, roll in (("rudder", 0.0), ("stern planes", math.pi / 2.0))
    ]
    thruster = Part(
        "propulsors",
        "thruster",
        (
            estimated("position", aft, "m", tail),
            estimated("thrust", (thrust, thrust), "N", push, BOLLARD),
            estimated("diameter", 0.14 / 0.19 * diameter, "m", screw),
        ),
    )
    return (thruster, *fins)
