"""Experiment files: the columns of a log, and what is to be identified from it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Generic, Literal, Protocol, TypeVar

from pydantic import Field, model_validator

from seatrial.errors import InputError
from seatrial.model.units import quantity
from seatrial.system.files import FileModel, Source, find_file, read_toml, validated

from ..gravity import Reads

Axis = Literal["surge", "sway", "heave", "yaw"]


class ColumnEntry(FileModel):
    """A column or channel of the log, ``-NAME`` for one of opposite sign.

    The unit may be left out where the log says it.
    """

    name: str
    unit: str | None = None


class AccelerationEntry(ColumnEntry):
    """The column of an accelerometer, and what it reads."""

    reads: Reads = "specific-force"


class ColumnsEntry(FileModel):
    """The columns of a log that are used."""

    time: ColumnEntry | None = None
    command: ColumnEntry
    acceleration: AccelerationEntry | None = None
    roll: ColumnEntry | None = None
    pitch: ColumnEntry | None = None
    depth: ColumnEntry | None = None
    heading: ColumnEntry | None = None


class KnownEntry(FileModel):
    """Known values that a log lacks: it determines ratios to the mass alone."""

    mass: str
    thrust: str
    source: str


class ResultEntry(FileModel):
    """Whose parameters are written."""

    component: str = "rov"
    thruster: str | None = None
    vehicle: str | None = None
    variant: str | None = None


class ExperimentFile(FileModel):
    """An experiment's file."""

    title: str = ""
    axis: Axis
    log: str | None = None
    test_log: str | None = None
    held_out: float = Field(default=0.3, gt=0.0, lt=0.9)
    thrust_law: Literal["linear", "quadratic"] = "linear"
    offset: bool | None = None
    longest_delay: str = "1 s"
    columns: ColumnsEntry
    known: KnownEntry
    result: ResultEntry = Field(default_factory=ResultEntry)

    @model_validator(mode="after")
    def _columns_fit_the_axis(self) -> ExperimentFile:
        """Raise for columns that are missing, or one sensor too many."""
        c, axis = self.columns, self.axis
        sensors = {"acceleration": c.acceleration, "depth": c.depth, "heading": c.heading}
        given = [name for name, column in sensors.items() if column is not None]
        usable = {"yaw": ["heading"], "heave": ["acceleration", "depth"]}
        allowed = usable.get(axis, ["acceleration"])
        if len(given) != 1 or given[0] not in allowed:
            raise ValueError(
                f"{axis} is identified from the column {' or '.join(allowed)}, "
                f"found {' and '.join(given) or 'neither'}"
            )
        needed = c.acceleration is not None and c.acceleration.reads != "acceleration"
        missing = [n for n in ("roll", "pitch") if getattr(c, n) is None]
        if needed and missing:
            raise ValueError(
                f"an accelerometer reads gravity: {' and '.join(missing)} "
                f'{"is" if len(missing) == 1 else "are"} needed too, or reads = "acceleration"'
            )
        return self


class _Logged(Protocol):
    log: str | None


_File = TypeVar("_File", bound=_Logged)


@dataclass(frozen=True)
class Named(Generic[_File]):
    """An experiment's file, and where it was read."""

    file: _File
    read_from: Source

    @property
    def name(self) -> str:
        """Name of the file."""
        return self.read_from.name

    def log_path(self, log: Path | None) -> Path:
        """Return the log: ``log``, of the command line, or the file's. Raises InputError."""
        if log is not None:
            return log
        if self.file.log is None:
            raise InputError(f"{self.read_from.path}: log: no log is named; name one with --log")
        return self.read_from.path.parent / self.file.log


@dataclass(frozen=True)
class Experiment(Named[ExperimentFile]):
    """An experiment of one axis as it was read, with its numbers in SI."""

    mass: float
    """kg, or kg.m2 for yaw: without added mass."""
    thrust: float
    """N, or N.m for yaw, of the command 1."""
    longest_delay: float
    """s."""

    @property
    def rotation(self) -> bool:
        """Whether the axis is turned about."""
        return self.file.axis == "yaw"

    @property
    def offset(self) -> bool:
        """Whether a constant force is looked for; by default in heave alone."""
        return self.file.axis == "heave" if self.file.offset is None else self.file.offset


def load_experiment(name: str) -> Experiment:
    """Read the experiment ``name``, below ``harness/identification`` or a path. InputError."""
    return axis_experiment(*read_toml(find_file("harness/identification", name)))


def axis_experiment(content: dict[str, Any], read_from: Source) -> Experiment:
    """Return the experiment of a file's content; raises InputError."""
    path = read_from.path
    file = validated(ExperimentFile, content, path)
    yaw = file.axis == "yaw"

    def positive(key: str, written: str, unit: str) -> float:
        try:
            value = quantity(written, unit)
        except InputError as error:
            raise InputError(f"{path}: {key}: {error}") from None
        if value <= 0.0:
            raise InputError(f"{path}: {key}: above 0 is needed, found {written!r}")
        return value

    return Experiment(
        file=file,
        read_from=read_from,
        mass=positive("known.mass", file.known.mass, "kg.m2" if yaw else "kg"),
        thrust=positive("known.thrust", file.known.thrust, "N.m" if yaw else "N"),
        longest_delay=positive("longest_delay", file.longest_delay, "s"),
    )
