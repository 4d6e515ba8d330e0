"""Shapes of vehicles: parts of their bodies in their files, some of which move with a port."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any, Self

from pydantic import AfterValidator, BaseModel, Field, StringConstraints, model_validator
from pydantic_core import PydanticCustomError

from ..errors import InputError, unknown
from .files import FileModel

FORMATS = (".glb", ".stl")
_MOST_BYTES = 20_000_000
_LARGEST = 10_000.0
"""Of a length, m."""
_STRONGEST = 1e8
"""Of the value that a length follows, in SI: the thrust of a ship, N."""

_Number = Annotated[float, Field(ge=-_LARGEST, le=_LARGEST, allow_inf_nan=False)]
_Length = Annotated[float, Field(gt=0.0, le=_LARGEST, allow_inf_nan=False)]
_Depth = Annotated[float, Field(ge=0.0, le=_LARGEST, allow_inf_nan=False)]
_Vector = Annotated[list[_Number], Field(min_length=3, max_length=3)]
_Size = Annotated[list[_Length], Field(min_length=3, max_length=3)]
_Value = Annotated[float, Field(gt=0.0, le=_STRONGEST, allow_inf_nan=False)]
_Point = Annotated[list[_Number], Field(min_length=2, max_length=2)]
_Colour = Annotated[str, StringConstraints(pattern="^#[0-9a-fA-F]{6}$")]
_Name = Annotated[str, StringConstraints(pattern=r"^[A-Za-z][\w-]*$")]


def _direction(vector: list[float]) -> list[float]:
    if not any(vector):
        raise PydanticCustomError("direction", "A direction is needed, not zeros")
    return vector


class Round(FileModel):
    """A cylinder or a capsule along the part's x axis, about its middle, m."""

    radius: _Length
    length: _Length
    """Of a capsule: between the middles of its ends."""


class Hull(FileModel):
    """A hull by its sections, evenly spaced from stern to bow, m.

    Its origin is amidships in the water line; every section is half an ellipse below water and
    goes straight up above it, flared by ``flare``.
    """

    length: _Length
    beam: list[_Depth] = Field(min_length=2, max_length=101)
    draught: list[_Depth] = Field(min_length=2, max_length=101)
    freeboard: _Depth
    flare: float = Field(default=1.0, gt=0.0, le=3.0, allow_inf_nan=False)
    """Beam of the deck over that of the water line."""

    @model_validator(mode="after")
    def _has_as_many(self) -> Hull:
        if len(self.beam) != len(self.draught):
            raise PydanticCustomError("sections", "beam and draught need as many sections")
        return self


class Plate(FileModel):
    """A convex outline in the part's x and z, ``thickness`` across, m: sails, fins, frames."""

    outline: list[_Point] = Field(min_length=3, max_length=100)
    thickness: _Length


class Turn(FileModel):
    """An angle that a part is turned by about its origin, in its own axes."""

    port: str
    about: Annotated[_Vector, AfterValidator(_direction)] = Field(
        default_factory=lambda: [0.0, 0.0, 1.0]
    )
    factor: float = Field(default=1.0, allow_inf_nan=False)
    """Angle, rad, over the port's value in SI."""


class Stretch(FileModel):
    """A length along the part's x, from its origin on, that follows a port: a jet of water."""

    port: str
    full: _Value
    """Value, in SI, at which the part has the length that is written; negative ones mirror it."""


class Slide(FileModel):
    """A distance that a part is moved by, in the axes that ``at`` is in."""

    port: str
    along: Annotated[_Vector, AfterValidator(_direction)]
    """Way, m, of one unit of the port's value in SI."""


_KINDS = ("box", "cylinder", "capsule", "hull", "plate", "file")


class Drawn(BaseModel):
    """One part of a shape: one of the kinds, and where it is."""

    model_config = FileModel.model_config

    box: _Size | None = None
    cylinder: Round | None = None
    capsule: Round | None = None
    hull: Hull | None = None
    plate: Plate | None = None
    file: str | None = None
    at: _Vector = Field(default_factory=lambda: [0.0, 0.0, 0.0])
    """Of its origin, in body axes (ahead, starboard, down), or in those of the part it is on, m."""
    turned: _Vector = Field(default_factory=lambda: [0.0, 0.0, 0.0])
    """Roll, pitch and yaw of its axes, deg."""
    scale: float = Field(default=1.0, gt=0.0, le=1000.0, allow_inf_nan=False)
    """Of a file: metres of one of its units."""
    colour: _Colour = "#8795a1"
    opacity: float = Field(default=1.0, gt=0.0, le=1.0, allow_inf_nan=False)
    name: _Name | None = None
    on: str | None = None
    """Name of a part before it that carries it along."""

    @model_validator(mode="after")
    def _is_one_thing(self) -> Self:
        given = [kind for kind in _KINDS if getattr(self, kind) is not None]
        if len(given) != 1:
            raise PydanticCustomError(
                "kind", "One of {kinds} is needed", {"kinds": ", ".join(_KINDS)}
            )
        if self.scale != 1.0 and self.file is None:
            raise PydanticCustomError("scale", "scale is of a part with a file")
        return self


class ShapePart(Drawn, FileModel):
    """One part of a shape as a vehicle's file has it: what moves it are ports."""

    turn: Turn | None = None
    stretch: Stretch | None = None
    slide: Slide | None = None


def carried(parts: list[Any]) -> list[Any]:
    """Check that parts are on parts before them, and that no name is there twice."""
    names: list[str] = []
    for part in parts:
        if part.on is not None and part.on not in names:
            raise PydanticCustomError(
                "on", "on: {what}", {"what": unknown("part before it", part.on, names)}
            )
        if part.name is not None and part.name in names:
            raise PydanticCustomError("name", "name: {name} is there twice", {"name": part.name})
        if part.name is not None:
            names.append(part.name)
    return parts


Shape = Annotated[list[ShapePart], Field(min_length=1, max_length=200), AfterValidator(carried)]


def mesh_file(name: str, folder: Path, where: str) -> tuple[Path, str]:
    """Return path and SHA-256 of a mesh that a part names, relative to its vehicle's file.

    Raises InputError for another format, and for one that is not there or too large.
    """
    path = (folder / name).resolve()
    if path.suffix.lower() not in FORMATS:
        raise InputError(
            f"{where}: {name!r} is no {' or '.join(FORMATS)} file: a glTF needs all in one file"
        )
    try:
        size, data = path.stat().st_size, b""
        if size <= _MOST_BYTES:
            data = path.read_bytes()
    except OSError as error:
        raise InputError(f"{where}: {path}: {error.strerror}") from None
    if size > _MOST_BYTES:
        raise InputError(
            f"{where}: {path} has {size / 1e6:.0f} MB, at most {_MOST_BYTES / 1e6:.0f} are drawn"
        )
    return path, hashlib.sha256(data).hexdigest()


def written(parts: Sequence[ShapePart]) -> list[dict[str, Any]]:
    """Return parts as manifests have them: what is not given is left out."""
    return [part.model_dump(exclude_none=True) for part in parts]
