"""Parameter sets of vehicles: ``vehicles/*.toml``, every value with unit, source and mark."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

from pydantic import Field

from ..errors import InputError, unknown
from ..files.vehicle_folders import owner
from ..fmi.instance import Variables
from .files import FileModel, Source, file_bytes, find_file, parsed_toml, validated
from .references.derived import Entries
from .references.entries import Resolved, WrittenEntry, written_out
from .references.values import port_scalars
from .shape import Shape, ShapePart

OWN = ":own"
"""Ends a reference of which a component takes only what it has a parameter for."""

_OF_FOLDERS = ("rig", "rigs")
"""Tables of rigs, which the vehicle's file of a folder has beside the numbers."""


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
    variants: dict[str, dict[str, dict[str, WrittenEntry]]] = Field(default_factory=dict)
    presets: dict[str, dict[str, dict[str, WrittenEntry]]] = Field(default_factory=dict)
    components: dict[str, dict[str, WrittenEntry]] = Field(default_factory=dict)


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

    values: dict[str, Resolved] = field(default_factory=dict)
    presets: dict[str, dict[str, Resolved]] = field(default_factory=dict)
    origin: str = ""
    outline: Outline | None = None
    body: Body | None = None
    vehicle: tuple[Path, str] | None = None
    """The file and the table in it."""
    folder: Path | None = None
    """Of the file, which names of files in it are relative to."""

    def own(self, variables: Variables, fmu: str, where: str) -> ParameterSet:
        """Return those that a component has, of a table of another one: without its body.

        Raises InputError, saying ``where``, if it has none of them.
        """
        ports = {port: port_scalars(variables, port) for port in self.values}
        own = {
            port: self.values[port]
            for port, scalars in ports.items()
            if scalars and scalars[0].causality == "parameter"
        }
        if not own:
            raise InputError(f"{where}: nothing in {self.origin} is a parameter of {fmu}")
        return replace(self, values=own, outline=None, body=None, vehicle=None)


@dataclass(frozen=True)
class Vehicle:
    """A vehicle's parameter file."""

    file: VehicleFile
    read_from: Source
    idle: tuple[str, ...] = ()
    """Rigs in the file that have no effect there: it is not in a vehicle's folder."""

    def parameter_set(self, table: str, variant: str | None) -> ParameterSet:
        """Return the values for the component ``table`` in ``variant`` (None: the default).

        Raises InputError if the file has no such table or variant.
        """
        file, path = self.file, self.read_from.path
        chosen = variant or file.default
        entries = self.entries(chosen)
        values = entries.table(table)
        if table not in file.components and not values:
            raise InputError(f"{path}: {unknown('component table', table, file.components)}")
        suffix = f", variant {chosen}" if chosen else ""
        shown = f"{path.parent.name}/{path.name}" if owner(path) else path.name
        origin = f"vehicles/{shown} [{table}]{suffix}"
        body = Body(file.shape[table], path, table, self.tables) if table in file.shape else None
        return ParameterSet(
            values, entries.presets(table), origin, file.outline, body, (path, table), path.parent
        )

    def entries(self, variant: str | None) -> Entries:
        """Return the entries of all tables in ``variant`` (None: the default)."""
        file, path = self.file, self.read_from.path
        chosen = variant or file.default
        if chosen is not None and chosen not in file.variants:
            raise InputError(f"{path}: {unknown('variant', chosen, file.variants)}")
        changes = file.variants[chosen] if chosen else {}
        tables = {
            name: {**file.components.get(name, {}), **changes.get(name, {})}
            for name in {**file.components, **changes}
        }
        presets = {
            f"{t}.{port}": p for t, ports in file.presets.items() for port, p in ports.items()
        }
        return Entries(tables, presets, str(path))

    @property
    def tables(self) -> tuple[str, ...]:
        """The tables of components, of some variants alone too."""
        of_variants = (table for changes in self.file.variants.values() for table in changes)
        return tuple(dict.fromkeys([*self.file.components, *of_variants]))


def split_reference(written: str, fmu: str) -> tuple[str, str]:
    """Return (vehicle, table) of ``hydrone``, ``hydrone.TABLE``, ``x.toml`` or ``x.toml.TABLE``.

    The table is by default the name of the FMU, or the class of ``my_boat.py:Class``. What ends a
    reference belongs to neither: a question mark, of a table that the file may lack, and `OWN`.
    """
    written = written.removesuffix("?").removesuffix(OWN)
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
    idle = () if owner(path) else tuple(key for key in _OF_FOLDERS if key in content)
    content = {key: value for key, value in content.items() if key not in _OF_FOLDERS}
    tables = {key: value for key, value in content.items() if key not in known}
    for key, value in tables.items():
        if not isinstance(value, dict):
            raise InputError(f"{path}: {key}: {unknown('key', key, known)}")
    top: dict[str, Any] = {key: value for key, value in content.items() if key in known}
    for key in ("variants", "presets"):
        if key in top:
            top[key] = _written_out(top[key], 2, f"{path}: {key}")
    content = {
        **top,
        "components": {n: written_out(table, f"{path}: {n}") for n, table in tables.items()},
    }
    vehicle = Vehicle(validated(VehicleFile, content, path, ours="components"), read_from, idle)
    for table in vehicle.file.shape:
        if table not in vehicle.tables:
            raise InputError(f"{path}: shape: {unknown('component table', table, vehicle.tables)}")
    return vehicle


def _written_out(value: Any, depth: int, where: str) -> Any:
    """Return the tables of entries so deep inside ``value`` as they are meant."""
    if not isinstance(value, dict):
        return value
    if depth == 0:
        return written_out(value, where)
    return {key: _written_out(each, depth - 1, f"{where}.{key}") for key, each in value.items()}
