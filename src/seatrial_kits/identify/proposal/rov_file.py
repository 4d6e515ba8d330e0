"""Vehicle file of a box-shaped ROV: added mass and drag of a box, eight thrusters."""

from __future__ import annotations

import math

from . import box
from .particulars import Particulars
from .surroundings import heading, neutral
from .value import (
    BOLLARD,
    DECAY,
    INCLINING,
    TOWING,
    WEIGHING,
    Formula,
    Part,
    Proposal,
    Value,
    estimated,
    given_or,
)

_PLATE = Formula(
    "box: DNV-RP-H103 section 4.6.3 and table A-2", "longest / shortest side", *box.PLATES
)
_TURNED = Formula(
    "box: strips of DNV-RP-H103 table A-1, Eidsvik's share; 30 to 100 % off",
    "longest / shortest side", *box.PLATES,
)  # fmt: skip
_DRAG = Formula("box: DNV-RP-C205 table E-1", "longest / shortest side", *box.DRAGS)
_DRAG_TURNED = Formula("box: the same, by strips of its four sides")
_SPEED = 1.0
_HIGH = 0.05
"""CG below the centre of buoyancy, in heights: 0.01 to 0.02 m of a BlueROV2's 0.254 m."""
_LAYOUT = "layout of BlueROV2 Heavy (von Benzon et al. 2022), scaled"


def rov_proposal(particulars: Particulars) -> Proposal:
    """Return the file."""
    speed = particulars.get("speed", _SPEED)
    size = particulars["length"], particulars["beam"], particulars["height"]
    length, beam, height = size
    ahead = box.drag(length, beam, height, particulars.density)
    values = (
        *heading("restoring coriolis damping", "submerged", particulars),
        *_mass(particulars),
        *_damping(particulars),
    )
    return Proposal(
        particulars.kind, length, beam, values, _thrusters(length, beam, ahead * speed**2, speed),
        ({"box": list(size), "colour": "#1f6fb2"},),
        ("the box is solid: an open frame has less added mass and drag",),
    )  # fmt: skip


def _ratio(particulars: Particulars) -> float:
    size = particulars["length"], particulars["beam"], particulars["height"]
    return max(size) / min(size)


def _mass(particulars: Particulars) -> list[Value]:
    length, beam, height = particulars["length"], particulars["beam"], particulars["height"]
    rho, mass, ratio = particulars.density, particulars["mass"], _ratio(particulars)
    own = box.inertia(mass, length, beam, height)
    moved = (
        box.added_mass(length, beam, height, rho),
        box.added_mass(beam, length, height, rho),
        box.added_mass(height, length, beam, rho),
    )
    turned = box.added_inertia(length, beam, height, rho)
    none = (0.0, 0.0, 0.0)
    below = Formula("0.05 of the height below the centre of buoyancy, as BlueROV2's 0.01 to 0.02 m")
    return [
        given_or(particulars, "mass", mass, "kg", Formula("given")),
        neutral(),
        estimated("inertia", (*own, *none), "kg.m2", Formula("even box"), WEIGHING),
        estimated("center_of_gravity", (0.0, 0.0, _HIGH * height), "m", below, INCLINING),
        estimated("center_of_buoyancy", none, "m", Formula("middle of the box")),
        estimated("added_mass", (*moved, *none), "kg", _PLATE, DECAY, ratio),
        estimated("added_inertia", (*turned, *none), "kg.m2", _TURNED, DECAY, ratio),
    ]


def _damping(particulars: Particulars) -> list[Value]:
    length, beam, height = particulars["length"], particulars["beam"], particulars["height"]
    rho, ratio = particulars.density, _ratio(particulars)
    force = (
        box.drag(length, beam, height, rho),
        box.drag(beam, length, height, rho),
        box.drag(height, length, beam, rho),
    )
    moment = box.turning_drag(length, beam, height, rho)
    return [
        estimated("quadratic_damping_force", force, "N.s2/m2", _DRAG, TOWING, ratio),
        estimated("quadratic_damping_moment", moment, "N.m.s2/rad2", _DRAG_TURNED, DECAY),
    ]


def _thrusters(length: float, beam: float, drag: float, speed: float) -> tuple[Part, ...]:
    c = math.sqrt(0.5)
    flat = [
        ((0.341 * sx, 0.193 * sy), (c * sx, -c * sx * sy, 0.0)) for sx in (1, -1) for sy in (1, -1)
    ]
    upward = [((0.263 * sx, 0.379 * sy), (0.0, 0.0, -1.0)) for sx in (1, -1) for sy in (1, -1)]
    thrust = drag / (4.0 * c)
    push = Formula(f"four hold the drag at {speed:g} m/s")
    layout = Formula(_LAYOUT)
    return tuple(
        Part(
            "propulsors",
            "thruster",
            (
                estimated("position", (x * length, y * beam, 0.0), "m", layout),
                Value("axis", axis, "1", layout.text),
                estimated("thrust", (thrust, thrust), "N", push, BOLLARD),
            ),
        )
        for (x, y), axis in (*flat, *upward)
    )
