"""The lists of items that a vehicle keeps: mission, fence, rally points."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from pathlib import Path

from pymavlink.dialects.v20 import all as mavlink

from seatrial.errors import InputError
from seatrial.files.whole_file import write_whole

from ..vehicle import Vehicle
from .fence_zones import check_fence
from .plan_checks import Check, Refusal, check_mission, check_rally
from .plan_items import Item, as_integer, home_item

MOST_ITEMS = 1000
_PARAMETERS = range(mavlink.MAV_MISSION_INVALID_PARAM1, mavlink.MAV_MISSION_INVALID_PARAM7 + 1)


class Plan:
    """One list of items, which is replaced as a whole, or stays.

    ``path`` is where it outlives the run; None keeps it in memory. Raises InputError for a file
    that cannot be read, or whose items the vehicle does not take.
    """

    def __init__(
        self, kind: int, name: str, check: Check, vehicle: Vehicle, path: Path | None
    ) -> None:
        self.kind, self.name = kind, name
        """MAV_MISSION_TYPE, and what a person calls it."""
        self._check, self._vehicle, self._path = check, vehicle, path
        self._items: tuple[Item, ...] = ()
        if path is not None:
            self._items = read_items(path)
            refusal = self._refusal(self._items)
            if refusal is not None:
                raise InputError(f"plan file {path}: {refusal.text}")

    @property
    def items(self) -> tuple[Item, ...]:
        """The items; another tuple whenever they were replaced."""
        return self._items

    def as_sent(self) -> tuple[Item, ...]:
        """Return the items as they are sent: item 0 of ArduPilot's missions is home as it is."""
        home_first = self.kind == mavlink.MAV_MISSION_TYPE_MISSION
        if self._items and home_first and self._is_ardupilots:
            return (home_item(self._vehicle), *self._items[1:])
        return self._items

    def replace(self, items: Sequence[Item]) -> Refusal | None:
        """Take other items, in the file first; return why not, None if they are taken."""
        refusal = self._refusal(items)
        if refusal is None and self._path is not None:
            try:
                write_items(self._path, items)
            except OSError as error:
                text = f"it cannot be written to {self._path}: {error.strerror}"
                return Refusal(mavlink.MAV_MISSION_ERROR, text)
        if refusal is None:
            self._items = tuple(items)
        return refusal

    def _refusal(self, items: Sequence[Item]) -> Refusal | None:
        if len(items) > MOST_ITEMS:
            return Refusal(
                mavlink.MAV_MISSION_NO_SPACE, f"{len(items)} items, at most {MOST_ITEMS} fit"
            )
        refusal = self._check(items, self._vehicle)
        is_fence = self.kind == mavlink.MAV_MISSION_TYPE_FENCE
        if refusal and refusal.result in _PARAMETERS and is_fence and self._is_ardupilots:
            return Refusal(mavlink.MAV_MISSION_ERROR, refusal.text)  # it checks a fence as a whole
        return refusal

    def is_wrong(self, sequence: int, item: Item) -> bool:
        """Return whether an item is bad whatever the others are; home is not looked at.

        Jumps and polygons are ERRORs of the whole list.
        """
        if sequence == 0 and self.kind == mavlink.MAV_MISSION_TYPE_MISSION and self._is_ardupilots:
            return False
        alone = (item, item) if self.kind == mavlink.MAV_MISSION_TYPE_MISSION else (item,)
        refusal = self._refusal(alone)
        return refusal is not None and refusal.result != mavlink.MAV_MISSION_ERROR

    @property
    def _is_ardupilots(self) -> bool:
        return self._vehicle.dialect.home_is_item_0


class Plans:
    """Mission, fence and rally points of one vehicle.

    In ``folder`` they are ``mission.waypoints``, ``fence.waypoints`` and ``rally.waypoints``, in
    the format "QGC WPL 110"; None keeps them in memory. Raises InputError as `Plan`, and for a
    folder that is none.
    """

    def __init__(self, vehicle: Vehicle, folder: Path | None) -> None:
        if folder is not None and not folder.is_dir():
            raise InputError(f"plan folder {folder}: there is no such folder")

        def plan(kind: int, name: str, file: str, check: Check) -> Plan:
            return Plan(kind, name, check, vehicle, folder and folder / f"{file}.waypoints")

        self.mission = plan(mavlink.MAV_MISSION_TYPE_MISSION, "Mission", "mission", check_mission)
        self.fence = plan(mavlink.MAV_MISSION_TYPE_FENCE, "Fence", "fence", check_fence)
        self.rally = plan(mavlink.MAV_MISSION_TYPE_RALLY, "Rally points", "rally", check_rally)

    def of_kind(self, kind: int) -> Plan | None:
        """Return the list of a MAV_MISSION_TYPE, None if there is none."""
        return next((plan for plan in self.all if plan.kind == kind), None)

    @property
    def all(self) -> tuple[Plan, Plan, Plan]:
        """All three lists."""
        return self.mission, self.fence, self.rally


_HEAD = "QGC WPL 110"
_COLUMNS = 12
_FLOAT32 = struct.Struct("<f")


def read_items(path: Path) -> tuple[Item, ...]:
    """Return the items of a file, none if there is no file.

    After the line ``QGC WPL 110`` there is a line per item, of 12 columns: sequence, whether it
    is the current one, frame, command, parameters 1 to 7 with latitude and longitude in degrees,
    autocontinue. Lines that begin with ``#`` are comments. Items count in the order of their
    lines. Raises InputError, with the line, for anything else, and for a file that cannot be
    read.
    """
    try:
        lines = path.read_text("utf-8").splitlines()
    except FileNotFoundError:
        return ()
    except (OSError, UnicodeDecodeError) as error:
        cause = error.strerror if isinstance(error, OSError) else "not UTF-8"
        raise InputError(f"plan file {path}: {cause}") from None
    if not lines or lines[0].strip() != _HEAD:
        raise InputError(f"plan file {path}: its first line must be {_HEAD!r}")
    items = []
    for number, line in enumerate(lines[1:], 2):
        columns = line.split()
        if columns and not columns[0].startswith("#"):
            try:
                items.append(_item(columns))
            except (ValueError, OverflowError, struct.error):
                found = line.strip()[:60]
                raise InputError(
                    f"plan file {path}, line {number}: {found!r} is no item of {_COLUMNS} columns"
                ) from None
    return tuple(items)


def write_items(path: Path, items: Sequence[Item]) -> None:
    """Write a file whole, or leave it as it was. Raises OSError."""
    lines = [_line(sequence, item) for sequence, item in enumerate(items)]
    write_whole(path, "\n".join([_HEAD, *lines, ""]))


def _item(columns: Sequence[str]) -> Item:
    if len(columns) != _COLUMNS:
        raise ValueError
    frame, command = _whole(columns[2], 0xFF), _whole(columns[3], 0xFFFF)
    p1, p2, p3, p4, _, _, z = (_float32(column) for column in columns[4:11])
    x, y = (as_integer(float(column), frame) for column in columns[8:10])
    return Item(command, frame, (p1, p2, p3, p4), x, y, z, _whole(columns[11], 0xFF))


def _line(sequence: int, item: Item) -> str:
    # Seven decimals of a degree and nine digits of a float are what a message can tell apart.
    x, y = (f"{value:.7f}" for value in item.coordinates())
    parameters = [f"{value:.9g}" for value in item.parameters]
    columns = (*parameters, x, y, f"{item.z:.9g}")
    head = (sequence, int(sequence == 0), item.frame, item.command)
    return "\t".join(map(str, (*head, *columns, item.autocontinue)))


def _whole(text: str, most: int) -> int:
    value = int(text)
    if not 0 <= value <= most:
        raise ValueError
    return value


def _float32(text: str) -> float:
    """Return the number nearest to ``text`` that a message can carry."""
    value: float = _FLOAT32.unpack(_FLOAT32.pack(float(text)))[0]
    return value
