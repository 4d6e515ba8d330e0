"""Vehicle file of a box-shaped ROV: added mass and drag of a box, eight thrusters."""

from __future__ import annotations

import math
from dataclasses import dataclass

from seatrial.errors import InputError

from . import box
from .particulars import AREAS, Particulars, option
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
    "box: DNV-RP-H103 section 4.6.3, table A-2; projected areas: [Eidsvik2015]",
    "longer / shorter side of a face",
    *box.PLATES,
)
_TURNED = Formula(
    "box: strips of DNV-RP-H103 table A-1, [Eidsvik2015]; 30 to 100 % off",
    "longer / shorter side of a face",
    *box.PLATES,
)
_DRAG = Formula("box: DNV-RP-C205 table E-1", "longest / shortest side", *box.DRAGS)
_DRAG_TURNED = Formula("box: the same, by strips of its four sides")
_BELOW = Formula("0.05 of the height below the centre of buoyancy, as BlueROV2's 0.01 to 0.02 m")
_LAYOUT = Formula("layout of BlueROV2 Heavy ([Benzon2022]), scaled")
_SPEED = 1.0
_NONE = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class _Box:
    """A body in its box."""

    length: float
    beam: float
    height: float
    covers: tuple[float, float, float]
    """Shares of the faces across x, y, z that are filled."""
    density: float

    @property
    def ratio(self) -> float:
        """Longest side over shortest."""
        size = self.length, self.beam, self.height
        return max(size) / min(size)

    @property
    def drag(self) -> tuple[float, float, float]:
        """Quadratic drag along x, y, z, kg/m."""
        size, covers = (self.length, self.beam, self.height), self.covers
        return (
            covers[0] * box.drag(size[0], size[1], size[2], self.density),
            covers[1] * box.drag(size[1], size[0], size[2], self.density),
            covers[2] * box.drag(size[2], size[0], size[1], self.density),
        )

    @property
    def added_mass(self) -> tuple[float, float, float]:
        """Along x, y, z, kg."""
        size, factors = (self.length, self.beam, self.height), box.projected(self.covers)
        return (
            factors[0] * box.added_mass(size[0], size[1], size[2], self.density),
            factors[1] * box.added_mass(size[1], size[0], size[2], self.density),
            factors[2] * box.added_mass(size[2], size[0], size[1], self.density),
        )

    @property
    def added_inertia(self) -> tuple[float, float, float]:
        """About x, y, z, kg.m2."""
        solid = box.added_inertia(self.length, self.beam, self.height, self.density)
        factor = math.prod(self.covers)
        return factor * solid[0], factor * solid[1], factor * solid[2]


def rov_proposal(particulars: Particulars) -> Proposal:
    """Return the file. Raises InputError for a projected area greater than that of its face."""
    body = _box(particulars)
    speed = particulars.get("speed", _SPEED)
    values = (
        *heading("restoring coriolis damping", "submerged", particulars),
        *_mass(body, particulars),
        *_damping(body),
    )
    solid = not set(AREAS) & set(particulars.given)
    remarks = (
        ("the box is solid: of an open frame give --frontal-area, --side-area and --top-area",)
        if solid
        else ()
    )
    return Proposal(
        particulars.kind,
        body.length,
        body.beam,
        values,
        _thrusters(body, speed),
        ({"box": [body.length, body.beam, body.height], "colour": "#1f6fb2"},),
        remarks,
    )


def _box(particulars: Particulars) -> _Box:
    length, beam, height = particulars["length"], particulars["beam"], particulars["height"]
    faces = dict(zip(AREAS, (beam * height, length * height, length * beam), strict=True))
    for name, face in faces.items():
        if particulars.get(name, 0.0) > face:
            raise InputError(
                f"{option(name)} {particulars[name]:g} m2: up to {face:.4g} m2, the face of the "
                "box, is possible"
            )
    x, y, z = (particulars.get(name, face) / face for name, face in faces.items())
    return _Box(length, beam, height, (x, y, z), particulars.density)


def _mass(body: _Box, particulars: Particulars) -> list[Value]:
    mass = particulars["mass"]
    own = box.inertia(mass, body.length, body.beam, body.height)
    low = (0.0, 0.0, 0.05 * body.height)
    return [
        given_or(particulars, "mass", mass, "kg", Formula("given")),
        neutral(),
        estimated("inertia", (*own, *_NONE), "kg.m2", Formula("even box"), WEIGHING),
        estimated("center_of_gravity", low, "m", _BELOW, INCLINING),
        estimated("center_of_buoyancy", _NONE, "m", Formula("middle of the box")),
        estimated("added_mass", (*body.added_mass, *_NONE), "kg", _PLATE, DECAY, body.ratio),
        estimated("added_inertia", (*body.added_inertia, *_NONE), "kg.m2", _TURNED, DECAY),
    ]


def _damping(body: _Box) -> list[Value]:
    size = body.length, body.beam, body.height
    moment = box.turning_drag(size[0], size[1], size[2], body.density, body.covers)
    return [
        estimated("quadratic_damping_force", body.drag, "N.s2/m2", _DRAG, TOWING, body.ratio),
        estimated("quadratic_damping_moment", moment, "N.m.s2/rad2", _DRAG_TURNED, DECAY),
    ]


def _thrusters(body: _Box, speed: float) -> tuple[Part, ...]:
    """Return four thrusters at 45 degrees that hold the drag ahead, and four that push up."""
    c = math.sqrt(0.5)
    corners = [(x, y) for x in (1.0, -1.0) for y in (1.0, -1.0)]
    flat = [((0.341 * x, 0.193 * y), (c * x, -c * y, 0.0)) for x, y in corners]
    upward = [((0.263 * x, 0.379 * y), (0.0, 0.0, -1.0)) for x, y in corners]
    thrust = body.drag[0] * speed**2 / (4.0 * c)
    push = Formula(f"four hold the drag at {speed:g} m/s")
    return tuple(
        Part(
            "propulsors",
            "thruster",
            (
                estimated("position", (x * body.length, y * body.beam, 0.0), "m", _LAYOUT),
                Value("axis", axis, "1", _LAYOUT.text),
                estimated("thrust", (thrust, thrust), "N", push, BOLLARD),
            ),
        )
        for (x, y), axis in (*flat, *upward)
    )
