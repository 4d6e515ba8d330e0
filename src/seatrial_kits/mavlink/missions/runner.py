"""Mission execution: item by item, as legs that guidance follows."""

from __future__ import annotations

import math
from collections import Counter, deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

from pymavlink.dialects.v20 import all as mavlink

from seatrial.links.geodesy import Ned

from ..service import INFO, WARNING
from ..settings import FASTEST, Settings
from ..vehicle import Vehicle
from .plan import Plan
from .plan_checks import JUMPS, NAVIGATION, first_item
from .plan_items import Item

_MOST_AT_ONCE = 2000
"""Items that take no time, one after the other: more are jumps without an end."""
OWN_SPEED = -2.0
"""What stands for the vehicle's own speed."""

_NOT_STARTED: int = mavlink.MISSION_STATE_NOT_STARTED
_ACTIVE: int = mavlink.MISSION_STATE_ACTIVE
_PAUSED: int = mavlink.MISSION_STATE_PAUSED
_COMPLETE: int = mavlink.MISSION_STATE_COMPLETE


@dataclass(frozen=True)
class Leg:
    """Leg that guidance is to follow. SI, positions in {n}."""

    number: int = 0
    """Another one for each leg; 0 for none: the vehicle stays where it is."""
    start: Ned = (0.0, 0.0, 0.0)
    end: Ned = (0.0, 0.0, 0.0)
    speed: float = 0.0
    radius: float = 0.0
    """Distance at which its end is reached."""
    wait: float = 0.0
    """Time to stay at its end."""
    circle: float = 0.0
    """Radius of the circle to stay on at its end, negative for anticlockwise, 0 for none."""


class MissionRunner:
    """Carries out the items of ``plan`` while the vehicle is armed and in the mode auto.

    ======================= =============================================================
    NAV_WAYPOINT            a leg; parameter 1 is the time to stay, 2 the radius of
                            acceptance, 0 for the vehicle's own
    NAV_LOITER_UNLIM        a leg, and to stay there for good, on a circle whose radius is
                            parameter 3 unless that is 0; negative is anticlockwise
    NAV_LOITER_TURNS        the same for the turns about the place in parameter 1, on a
                            circle in any case
    NAV_LOITER_TIME         the same for the time in parameter 1
    NAV_RETURN_TO_LAUNCH    a leg to where the vehicle returns to
    NAV_DELAY               stays for the time in parameter 1
    DO_JUMP                 goes on at the item in parameter 1, parameter 2 times
                            since the mission began; always if that is negative
    DO_JUMP_TAG             the same at the JUMP_TAG of that number; without one it is the end
    DO_CHANGE_SPEED         parameter 2 is the speed of the legs from here on; -2 is the
                            vehicle's own, others below 0 change nothing
    NAV_SPLINE_WAYPOINT     a leg; parameter 1 is the time to stay
    CONDITION_DELAY         what follows up to the next item that leads somewhere waits for the
                            time in parameter 1, while the vehicle goes on (`DelayedItems`)
    others                  are carried out as the command of that number (``carry_out``)
    ======================= =============================================================

    A leg begins where the last one ended, or where the vehicle is if there was none, or it was
    interrupted: by another mode, by disarming or by ``paused``. The current item then begins anew;
    after a mode that the mission set it is the next one. After the last item the vehicle stays;
    when it is free to act again after an interruption, it begins from the first.

    Not obeyed: headings, radii to pass by, kinds of speed, throttles, and autocontinue.

    ``carry_out`` carries an item out as a command at a time, s; ``refuge`` is where the vehicle
    returns to.
    """

    def __init__(
        self,
        vehicle: Vehicle,
        plan: Plan,
        settings: Settings,
        carry_out: Callable[[Item, float], None],
        refuge: Callable[[], Ned],
    ) -> None:
        self._vehicle, self._plan, self._settings = vehicle, plan, settings
        self._carry_out, self._refuge = carry_out, refuge
        self._delayed = DelayedItems()
        self.paused = False
        """Whether a pause was requested; other modes end it."""
        self.passed: list[int] = []
        """Items that are done; the reporting service empties it."""
        self._legs = 0
        self._acted = False
        self._until, self._turned = 0.0, 0.0
        self._bearing: float | None = None
        self.restart()

    # ------------------------------------------------------------------ control

    @property
    def first(self) -> int:
        """Number of the first item."""
        return first_item(self._vehicle)

    @property
    def is_empty(self) -> bool:
        """Whether there is nothing to do."""
        return len(self._plan.items) <= self.first

    def restart(self) -> None:
        """Go back to the first item, as if nothing had been done."""
        self._items = self._plan.items
        self.current, self.state = self.first, _NOT_STARTED
        """Number of the item that is carried out, and MISSION_STATE."""
        self.is_chosen = False
        """Whether a station chose the item; else a mission that has not begun is at none."""
        self.leg = Leg()
        self._speed: float | None = None
        self._jumps: Counter[int] = Counter()
        self._skipped: set[int] = set()
        self._delayed.drop()
        self._at_end = False  # of the list, while something still waits

    def set_current(self, sequence: int) -> bool:
        """Go on at an item, 0 for the first one; return whether there is one of that number."""
        sequence = sequence or self.first
        if not self.first <= sequence < len(self._plan.items):
            return False
        self.current, self.leg, self.is_chosen = sequence, Leg(), True
        self._delayed.drop()
        self._at_end = False  # of the list, while something still waits
        self.state = _NOT_STARTED if self.state == _NOT_STARTED else _PAUSED
        return True

    def forget_jumps(self) -> None:
        """Count jumps anew, and go on after the end if the vehicle is in auto."""
        self._jumps.clear()
        if self.state == _COMPLETE:
            self.state = _PAUSED

    def change_speed(self, speed: float) -> None:
        """Change the speed of this leg and of those to come, m/s; -2 is the vehicle's own."""
        if speed == OWN_SPEED:
            self._speed = None
        elif 0.0 < speed <= FASTEST:
            self._speed = speed
        self.leg = replace(self.leg, speed=self._leg_speed())

    # ------------------------------------------------------------------ running

    def tick(self, now: float, reached: int) -> None:
        """Go on at simulated time ``now``, s; ``reached`` is the number of the leg that is done."""
        if self._plan.items is not self._items:
            self.restart()
            self._vehicle.ordered("mission of items", len(self._items))
        in_auto = self._vehicle.mode.name == "auto"
        self.paused = self.paused and in_auto
        acts = in_auto and self._vehicle.armed and not self.paused and not self.is_empty
        if not acts:
            self.leg = Leg()
            self.state = _PAUSED if self.state == _ACTIVE else self.state
        elif self.state == _ACTIVE:
            self._go_on(now, reached)
        elif self.state != _COMPLETE or not self._acted:
            if self.state == _COMPLETE:
                self.restart()
            self.state = _ACTIVE
            if not self._at_end:
                self._begin(self.current, now)
        self._acted = acts

    def _go_on(self, now: float, reached: int) -> None:
        """Carry out what has waited, and begin the next item if this one is over."""
        for sequence, item in self._delayed.due(now):
            self._act(item, now)
            self.passed.append(sequence)
        if self._at_end:
            if not self._delayed:
                self._finish("Mission complete")
        elif self._is_over(now, reached):
            self.passed.append(self.current)
            for sequence in self._delayed.drop():
                text = f"Mission: item {sequence} dropped: its condition came too late"
                self._vehicle.report(WARNING, text)
            self._begin(self.current + 1, now)

    def _begin(self, sequence: int, now: float) -> None:
        """Carry items out from ``sequence`` on, up to one that takes time, or the end."""
        for _ in range(_MOST_AT_ONCE):
            if sequence >= len(self._items):
                self._at_end = bool(self._delayed)
                if not self._at_end:
                    self._finish("Mission complete")
                return
            self.current = sequence
            item = self._items[sequence]
            if item.command in JUMPS:
                sequence = self._after_jump(item)
                continue
            if item.command == mavlink.MAV_CMD_CONDITION_DELAY:
                sequence = self._delayed.gather(self._items, sequence)
                continue
            if self._starts(item, now):
                self._vehicle.report(INFO, f"Mission: item {sequence}, {item.name}")
                return
            self.passed.append(sequence)
            sequence += 1
            if self._vehicle.mode.name != "auto" and sequence < len(self._items):
                self.current, self.leg, self.state = sequence, Leg(), _PAUSED
                return
        self._finish("Mission ended: its jumps have no end")

    def _finish(self, news: str) -> None:
        self.state, self._at_end = _COMPLETE, False
        self._rest()
        self._vehicle.report(INFO, news)

    def _rest(self) -> None:
        """Stay at the end of the leg; on a circle, where the vehicle is."""
        if self.leg.circle:
            self.leg = Leg()

    def _after_jump(self, item: Item) -> int:
        """Return the number of the item after a jump, which is the current one."""
        times = item.number(2)
        if 0.0 <= times <= self._jumps[self.current]:
            return self.current + 1
        self._jumps[self.current] += 1
        target = round(item.number(1))
        if item.command == mavlink.MAV_CMD_DO_JUMP:
            return target
        tags = (n for n, other in enumerate(self._items) if _is_tag(other, target))
        return next(tags, len(self._items))

    def _starts(self, item: Item, now: float) -> bool:
        """Start an item; return whether it takes time."""
        match item.command:
            case mavlink.MAV_CMD_NAV_WAYPOINT:
                return self._leads(item, radius=item.number(2), wait=item.number(1))
            case mavlink.MAV_CMD_NAV_SPLINE_WAYPOINT:
                return self._leads(item, wait=item.number(1))
            case mavlink.MAV_CMD_NAV_LOITER_UNLIM:
                return self._leads(item, circle=item.number(3))
            case mavlink.MAV_CMD_NAV_LOITER_TURNS:
                self._turned, self._bearing = 0.0, None
                return self._leads(item, circle=item.number(3) or self._settings.loiter_radius)
            case mavlink.MAV_CMD_NAV_LOITER_TIME:
                return self._leads(item, wait=item.number(1), circle=item.number(3))
            case mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH:
                self._follow(self._refuge())
                return True
            case mavlink.MAV_CMD_NAV_DELAY:
                self._rest()
                self._until = now + item.number(1)
                return True
        self._act(item, now)
        return False

    def _act(self, item: Item, now: float) -> None:
        """Carry out an item that takes no time."""
        match item.command:
            case mavlink.MAV_CMD_DO_CHANGE_SPEED:
                self.change_speed(item.number(2))
            case mavlink.MAV_CMD_CONDITION_DELAY | mavlink.MAV_CMD_JUMP_TAG:
                pass  # what it waits for begins; a place to jump to
            case _:
                self._carry_out(item, now)

    def _leads(
        self, item: Item, radius: float = 0.0, wait: float = 0.0, circle: float = 0.0
    ) -> bool:
        """Begin the leg to an item's place, if it still is one."""
        end = item.destination(self._vehicle)
        if end is None:
            self._skip(item, "is no place now, or too far away")
            return False
        self._follow(end, radius, wait, circle)
        return True

    def _follow(
        self, end: Ned, radius: float = 0.0, wait: float = 0.0, circle: float = 0.0
    ) -> None:
        straight = self.leg.number and not self.leg.circle
        start = self.leg.end if straight else self._vehicle.estimates.position_n
        radius = radius if radius > 0.0 else self._settings.waypoint_radius
        self._legs += 1
        self.leg = Leg(
            self._legs,
            start,
            end,
            self._leg_speed(),
            radius + abs(circle),  # on the circle, its centre is reached
            max(wait, 0.0),
            circle,
        )

    def _skip(self, item: Item, why: str) -> None:
        if self.current not in self._skipped:
            self._skipped.add(self.current)
            text = f"Mission: item {self.current}, {item.name}, {why}: skipped"
            self._vehicle.report(WARNING, text)

    def _is_over(self, now: float, reached: int) -> bool:
        item = self._items[self.current]
        if item.command == mavlink.MAV_CMD_NAV_DELAY:
            return now >= self._until
        if reached != self.leg.number or item.command == mavlink.MAV_CMD_NAV_LOITER_UNLIM:
            return False
        if item.command == mavlink.MAV_CMD_NAV_LOITER_TURNS:
            return self._has_turned(item.number(1))
        return True

    def _has_turned(self, turns: float) -> bool:
        """Return whether the vehicle has been round its circle often enough since it came to it."""
        (north, east, _), (to_north, to_east, _) = self._vehicle.estimates.position_n, self.leg.end
        bearing = math.atan2(east - to_east, north - to_north)
        if self._bearing is not None:
            self._turned += math.remainder(bearing - self._bearing, math.tau)
        self._bearing = bearing
        return math.copysign(1.0, self.leg.circle) * self._turned >= math.tau * turns

    def _leg_speed(self) -> float:
        return self._settings.leg_speed if self._speed is None else self._speed


def _is_tag(item: Item, number: int) -> bool:
    return item.command == mavlink.MAV_CMD_JUMP_TAG and item.number(1) == number


class DelayedItems:
    """What follows a CONDITION_DELAY up to the next item that leads somewhere, or a jump.

    As in an ArduPilot: the vehicle goes on, and what still waits when the leg ends is dropped.
    """

    def __init__(self) -> None:
        self._waiting: deque[tuple[int, Item]] = deque()
        self._until = -math.inf

    def gather(self, items: Sequence[Item], sequence: int) -> int:
        """Take the items from a CONDITION_DELAY on; return the number of the one after them."""
        while sequence < len(items) and not _ends(items[sequence]):
            self._waiting.append((sequence, items[sequence]))
            sequence += 1
        return sequence

    def due(self, now: float) -> Iterator[tuple[int, Item]]:
        """Yield what need not wait any longer at a simulated time, s, with its number."""
        while self._waiting and now >= self._until:
            sequence, item = self._waiting.popleft()
            if item.command == mavlink.MAV_CMD_CONDITION_DELAY:
                self._until = now + item.number(1)
            yield sequence, item

    def drop(self) -> list[int]:
        """Forget what waits; return the numbers."""
        dropped = [sequence for sequence, _ in self._waiting]
        self._waiting.clear()
        self._until = -math.inf
        return dropped

    def __bool__(self) -> bool:
        return bool(self._waiting)


def _ends(item: Item) -> bool:
    return item.command in NAVIGATION or item.command in JUMPS
