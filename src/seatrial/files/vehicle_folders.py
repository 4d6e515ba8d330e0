"""Folders of vehicles: ``harness/vehicles/NAME`` with ``vehicle.toml`` and ``pilot.toml``.

``vehicle.toml`` has the numbers, in the table ``rig`` the vehicle's rig, and in ``rigs.GROUP.PART``
further ones; ``pilot.toml`` is the pilot's rig, with such tables, too. What they have is found by
the names that files of their own would have::

    vehicles/NAME       the table rig of vehicle.toml
    pilots/NAME         pilot.toml
    GROUP/NAME-PART     the table rigs.GROUP.PART of either

A vehicle NAME-PART, of rigs.vehicles.PART and rigs.pilots.PART, has the numbers of NAME.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import reduce
from pathlib import Path
from typing import Any

from ..errors import InputError
from .reading import toml_content

FOLDERS = "harness/vehicles"
VEHICLE, PILOT = "vehicle.toml", "pilot.toml"
_RIGS = "harness/rigs"


@dataclass(frozen=True)
class Place:
    """A file, and the table in it that is meant; none is the whole file."""

    path: Path
    table: tuple[str, ...] = ()

    def __str__(self) -> str:
        return f"{self.path} [{'.'.join(self.table)}]" if self.table else str(self.path)

    def content(self, file: Mapping[str, Any]) -> Any:
        """Return what the file's content has here; None if it has no such table."""
        return reduce(_inside, self.table, file)


def place_in(folder: Path, kind: str, name: str) -> Place | None:
    """Return the place of a name of ``kind`` in a folder of vehicles; None if there is none.

    Raises InputError for a file there that cannot be read.
    """
    for place in _meant(folder, kind, name):
        if place.path.is_file() and (not place.table or has(place)):
            return place
    return None


def places_in(folder: Path, kind: str) -> dict[str, Place]:
    """Return all that a folder of vehicles has of ``kind``, by name, in files that can be read."""
    found: dict[str, Place] = {}
    for path in sorted(folder.glob("*/*.toml")):
        for name in _names(path, kind):
            try:
                place = place_in(folder, *_asked(kind, name))
            except InputError:
                continue
            if place is not None:
                found[name] = place
    return found


def owner(path: Path) -> str:
    """Return the vehicle in whose folder a file lies; empty if it is in none."""
    return path.parent.name if path.name in (VEHICLE, PILOT) else ""


def stem(place: Place) -> str:
    """Return the name of what is at a place: of a file of its own, that of the file."""
    name = owner(place.path)
    if not name:
        return place.path.stem
    return f"{name}-{place.table[-1]}" if len(place.table) > 1 else name


def _meant(folder: Path, kind: str, name: str) -> Iterator[Place]:
    """Yield the places that a name may mean."""
    group, slash, last = name.rpartition("/")
    ends = [i for i, letter in enumerate(last) if letter == "-"]
    if kind == "vehicles" and not slash:
        yield Place(folder / name / VEHICLE)
        for end in ends:
            rig = Place(folder / name[:end] / VEHICLE, ("rigs", kind, name[end + 1 :]))
            if rig.path.is_file() and has(rig):
                yield Place(rig.path)
    elif kind == _RIGS and group:
        if group == "vehicles":
            yield Place(folder / last / VEHICLE, ("rig",))
        elif group == "pilots":
            yield Place(folder / last / PILOT)
        for end in ends:
            for file in (VEHICLE, PILOT):
                yield Place(folder / last[:end] / file, ("rigs", group, last[end + 1 :]))


def _asked(kind: str, name: str) -> tuple[str, str]:
    """Return kind and name as rigs ask: a group's rigs are of the kind ``harness/rigs``."""
    group = kind.removeprefix(f"{_RIGS}/")
    return (kind, name) if group == kind else (_RIGS, f"{group}/{name}")


def _names(path: Path, kind: str) -> Iterator[str]:
    """Yield the names of a kind that a vehicle's file may have."""
    vehicle, group = path.parent.name, kind.removeprefix(f"{_RIGS}/")
    if kind in ("vehicles", f"{_RIGS}/vehicles", f"{_RIGS}/pilots"):
        yield vehicle
    parts = Place(path, ("rigs", group)).content(_read(path)) if group != kind else None
    if isinstance(parts, dict):
        yield from (f"{vehicle}-{part}" for part in parts)


def has(place: Place) -> bool:
    """Return whether a file has the table of a place. Raises InputError for one that is no TOML."""
    return place.content(_read(place.path, strict=True)) is not None


def _read(path: Path, *, strict: bool = False) -> dict[str, Any]:
    try:
        return toml_content(path.read_bytes(), str(path))
    except OSError as error:
        if strict:
            raise InputError(f"{path}: {error.strerror}") from None
    except InputError:
        if strict:
            raise
    return {}


def _inside(content: Any, key: str) -> Any:
    return content.get(key) if isinstance(content, Mapping) else None
