"""The lists of items that a vehicle keeps: mission, fence, rally points."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from pymavlink.dialects.v20 import all as mavlink

from seatrial.errors import InputError

from ..vehicle import Vehicle
from .fence_zones import check_fence
from .plan_checks import Check, Refusal, check_mission, check_rally
from .plan_file import read_items, write_items
from .plan_items import Item, home_item

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
    the format of `plan_file`; None keeps them in memory. Raises InputError as `Plan`, and for a
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
