"""Parameter sets of vehicles: ``vehicles/*.toml``, every value with unit, source and mark."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any, Literal

from pydantic import Field

from ..errors import InputError, unknown
from .files import FileModel, Source, file_bytes, find_file, parsed_toml, validated
from .shape import Shape, ShapePart

Mark = Literal["stated", "corrected", "assumed", "identified"]


class Entry(FileModel):
    """One value: a number, a list of numbers for a port with axes, or a text.

    ``unit`` is that of all numbers, or a list with one for each.
    """

    value: float | int | str | list[float | int]
    unit: str | list[str] = "1"
    source: str
    mark: Mark


class Outline(FileModel):
    """A vehicle seen from above, about its body origin: overall length and beam, m."""

    length: float = Field(gt=0.0, allow_inf_nan=False)
    beam: float = Field(gt=0.0, allow_inf_nan=False)
    source: str


class VehicleFile(FileModel):
    """A vehicle's parameter file; its other tables are one per component."""

    title: str
    source: str
    default: str | None = None
    outline: Outline | None = None
    """Drawn by reports; the components have no such parameters."""
    shape: dict[str, Shape] = Field(default_factory=dict)
    """What is drawn in three dimensions of the component with a table, by table."""
    variants: dict[str, dict[str, dict[str, Entry]]] = Field(default_factory=dict)
    presets: dict[str, dict[str, dict[str, Entry]]] = Field(default_factory=dict)
    components: dict[str, dict[str, Entry]] = Field(default_factory=dict)


@dataclass(frozen=True)
class Body:
    """What is drawn of a component: its parts, and where they are written."""

    parts: list[ShapePart]
    path: Path
    table: str
    tables: tuple[str, ...]
    """All tables of the file."""


@dataclass(frozen=True)
class ParameterSet:
    """Values for one component, by port name, and presets for whole ports."""

    values: dict[str, Entry] = field(default_factory=dict)
    presets: dict[str, dict[str, Entry]] = field(default_factory=dict)
    origin: str = ""
    outline: Outline | None = None
    body: Body | None = None
    vehicle: tuple[Path, str] | None = None
    """The file and the table in it."""
    folder: Path | None = None
    """Of the file, which names of files in it are relative to."""


@dataclass(frozen=True)
class Vehicle:
    """A vehicle's parameter file."""

    file: VehicleFile
    read_from: Source

    def parameter_set(self, table: str, variant: str | None) -> ParameterSet:
        """Return the values for the component ``table`` in ``variant`` (None: the default).

        Raises InputError if the file has no such table or variant.
        """
        file, path = self.file, self.read_from.path
        chosen = variant or file.default
        if chosen is not None and chosen not in file.variants:
            raise InputError(f"{path}: {unknown('variant', chosen, file.variants)}")
        changes = file.variants[chosen].get(table, {}) if chosen else {}
        if table not in file.components and not changes:
            raise InputError(f"{path}: {unknown('component table', table, file.components)}")
        values = {**file.components.get(table, {}), **changes}
        suffix = f", variant {chosen}" if chosen else ""
        origin = f"vehicles/{path.name} [{table}]{suffix}"
        body = Body(file.shape[table], path, table, self.tables) if table in file.shape else None
        return ParameterSet(
            values,
            file.presets.get(table, {}),
            origin,
            file.outline,
            body,
            (path, table),
            path.parent,
        )

    @property
    def tables(self) -> tuple[str, ...]:
        """The tables of components, of some variants alone too."""
        of_variants = (table for changes in self.file.variants.values() for table in changes)
        return tuple(dict.fromkeys([*self.file.components, *of_variants]))


def split_reference(written: str, fmu: str) -> tuple[str, str]:
    """Return (vehicle, table) of ``hydrone``, ``hydrone.TABLE``, ``x.toml`` or ``x.toml.TABLE``.

    The table is by default the name of the FMU, or the class of ``my_boat.py:Class``. A question
    mark at the end, of a table that the file may lack, belongs to neither.
    """
    written = written.removesuffix("?")
    table = fmu.rpartition(":")[2] if ".py:" in fmu else fmu
    path, toml, rest = written.partition(".toml")
    if toml and (not rest or rest.startswith(".")):
        return path + toml, rest[1:] or table
    name, _, named = written.partition(".")
    return name, named or table


def load_vehicle(name: str, relative_to: Path | None = None) -> Vehicle:
    """Read the vehicle file ``name`` (shipped, or a path). Raises InputError."""
    path = find_file("vehicles", name, relative_to)
    return _vehicle(path, file_bytes(path))


@lru_cache(maxsize=32)  # each component asks for it, in each of thousands of cases
def _vehicle(path: Path, data: bytes) -> Vehicle:
    content, read_from = parsed_toml(path, data)
    known = {"title", "source", "default", "outline", "shape", "variants", "presets"}
    components = {key: value for key, value in content.items() if key not in known}
    top: dict[str, Any] = {key: value for key, value in content.items() if key in known}
    for key, value in components.items():
        if not isinstance(value, dict):
            raise InputError(f"{path}: {key}: {unknown('key', key, known)}")
    components = {name: _numbered(table, f"{path}: {name}") for name, table in components.items()}
    content = {**top, "components": components}
    vehicle = Vehicle(validated(VehicleFile, content, path, ours="components"), read_from)
    for table in vehicle.file.shape:
        if table not in vehicle.tables:
            raise InputError(f"{path}: shape: {unknown('component table', table, vehicle.tables)}")
    return vehicle


def _numbered(table: dict[str, Any], where: str) -> dict[str, Any]:
    """Return a component's table with each list of like parts written out, part by part.

    The entries of part 2 have its number, ``position_2``, and the part's source and mark unless
    they have their own. Where parts have a ``kind``, their names begin with the singular of the
    list, ``foil_position_2`` of ``foils``, which itself becomes the text of the kinds in order.
    Raises InputError for an entry that is there twice, and for a kind that some parts lack.
    """
    entries: dict[str, Any] = {}
    for key, value in table.items():
        parts = value if isinstance(value, list) else []
        if not parts or not all(isinstance(part, dict) for part in parts):
            entries[key] = value
            continue
        kinds = [str(part["kind"]) for part in parts if "kind" in part]
        if kinds and len(kinds) < len(parts):
            lacking = next(n for n, part in enumerate(parts, 1) if "kind" not in part)
            raise InputError(f"{where}: {key}: part {lacking} has no kind, and others have one")
        prefix = f"{key.removesuffix('s')}_" if kinds else ""
        for number, part in enumerate(parts, 1):
            shared = {k: part[k] for k in ("source", "mark") if k in part}
            for name in (k for k in part if k not in shared and k != "kind"):
                entry, own = part[name], f"{prefix}{name}_{number}"
                if own in table or own in entries:
                    raise InputError(f"{where}: {key}: {own} is there twice")
                entries[own] = {**shared, **entry} if isinstance(entry, dict) else entry
        if kinds:
            first = {k: parts[0].get(k, "") for k in ("source", "mark")}
            entries[key] = {
                "value": " ".join(kinds),
                "source": first["source"],
                "mark": first["mark"] or "stated",
            }
    return entries
