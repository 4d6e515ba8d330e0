"""Experiment files of turns: sway and each thruster, with surge and yaw known."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, get_args

from pydantic import Field, model_validator

from seatrial.errors import InputError, unknown
from seatrial.model.units import quantity
from seatrial.system.files import FileModel, Source, find_file, read_toml, validated

from .experiment import (
    AccelerationEntry,
    Axis,
    ColumnEntry,
    Experiment,
    Named,
    ResultEntry,
    axis_experiment,
)

PLANAR = "planar"


class PlanarColumnsEntry(FileModel):
    """The columns of a log of turns that are used."""

    time: ColumnEntry | None = None
    port: ColumnEntry
    starboard: ColumnEntry
    acceleration_x: AccelerationEntry
    acceleration_y: AccelerationEntry
    roll: ColumnEntry | None = None
    pitch: ColumnEntry | None = None
    heading: ColumnEntry


class PlanarKnownEntry(FileModel):
    """Known values that neither the log nor the vehicle's file has."""

    arm: str
    source: str


class PlanarResultEntry(ResultEntry):
    """Whose parameters are read, surge and yaw, and written, sway."""

    vehicle: str
    thruster: str


class PlanarFile(FileModel):
    """An experiment's file with the axis ``planar``."""

    title: str = ""
    axis: Literal["planar"]
    log: str | None = None
    held_out: float = Field(default=0.3, gt=0.0, lt=0.9)
    columns: PlanarColumnsEntry
    known: PlanarKnownEntry
    result: PlanarResultEntry

    @model_validator(mode="after")
    def _gravity_can_be_taken_off(self) -> PlanarFile:
        """Raise for an accelerometer that reads gravity, without the attitude."""
        c = self.columns
        reads = {c.acceleration_x.reads, c.acceleration_y.reads}
        missing = [name for name in ("roll", "pitch") if getattr(c, name) is None]
        if reads != {"acceleration"} and missing:
            raise ValueError(
                f"an accelerometer reads gravity: {' and '.join(missing)} "
                f'{"is" if len(missing) == 1 else "are"} needed too, or reads = "acceleration"'
            )
        return self


@dataclass(frozen=True)
class PlanarExperiment(Named[PlanarFile]):
    """An experiment of turns as it was read, with its numbers in SI."""

    arm: float
    """Thrusters from the centre line, m."""


def read_experiment(name: str) -> Experiment | PlanarExperiment:
    """Read the experiment ``name``, below ``harness/identification`` or a path. InputError."""
    content, read_from = read_toml(find_file("harness/identification", name))
    axes = (*get_args(Axis), PLANAR)
    axis = content.get("axis")
    if "axis" in content and axis not in axes:
        raise InputError(f"{read_from.path}: axis: {unknown('axis', str(axis), axes)}")
    return (planar_experiment if axis == PLANAR else axis_experiment)(content, read_from)


def planar_experiment(content: dict[str, Any], read_from: Source) -> PlanarExperiment:
    """Return the experiment of a file's content; raises InputError."""
    path = read_from.path
    file = validated(PlanarFile, content, path)
    try:
        arm = quantity(file.known.arm, "m")
    except InputError as error:
        raise InputError(f"{path}: known.arm: {error}") from None
    if arm <= 0.0:
        raise InputError(f"{path}: known.arm: above 0 is needed, found {file.known.arm!r}")
    return PlanarExperiment(file, read_from, arm)
