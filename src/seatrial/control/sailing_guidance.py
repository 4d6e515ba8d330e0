"""Guidance of a sailing boat that cannot tack."""

from __future__ import annotations

import math
from typing import ClassVar, NamedTuple

from ..component import Input, Output, Parameter
from ..errors import InputError
from ..sampled import Sampled

_MARKS = 6
_NE = ("north", "east")


class _Decision(NamedTuple):
    """What follows from the inputs and the memory at one instant. SI, angles in rad."""

    course: float
    command: float
    tack: int
    wearing: bool
    passed: int


class SailingGuidance(Sampled):
    """Takes a boat round up to six marks, wearing round where others tack.

    The boat heads for the first mark not yet passed; a mark is passed within ``radius``. After
    the last one it keeps its course.

    **Course.** off is the bearing of the mark from where the wind comes from, in +-180 deg,
    positive to starboard of it. If |off| is at least ``closest``, the course is the bearing.
    Else it is ``closest`` off the wind on the present tack, the sign of off when a course
    was last laid, until the mark bears ``closest`` + ``margin`` on the other one. So the boat
    beats in long boards.

    **Bearing away.** A keel needs speed: below ``steerage`` ahead the boat makes leeway, loses
    more speed and ends in irons. Then ``closest`` is ``away`` instead, until it makes
    ``steerage`` times ``recovered``.

    **Turns.** The heading wanted goes to the course at ``turn_rate``, the shorter way, unless
    that leads through the eye of the wind: then the longer way, through dead downwind, which is
    wearing round. It waits while it is more than ``lead`` away from the heading. It starts at
    the heading.

    ``wind`` is the true wind: where it blows to. Positions in {n}, m; headings clockwise from
    north, rad. Without a valid position the last heading wanted stays, at first the heading.

    Not modelled: leeway and current (the boat aims at the mark all the time and is set off a
    straight line), other boats, laylines that allow for the ground lost in wearing.

    Raises InputError at the start for a number of marks that is not whole.
    """

    period = Parameter(0.1, "s", "sample period", min=1e-6)
    count = Parameter(1.0, "1", "number of marks", min=1.0, max=float(_MARKS))
    mark_1 = Parameter(0.0, "m", "first mark", axes=_NE)
    mark_2 = Parameter(0.0, "m", "second mark", axes=_NE)
    mark_3 = Parameter(0.0, "m", "third mark", axes=_NE)
    mark_4 = Parameter(0.0, "m", "fourth mark", axes=_NE)
    mark_5 = Parameter(0.0, "m", "fifth mark", axes=_NE)
    mark_6 = Parameter(0.0, "m", "sixth mark", axes=_NE)
    radius = Parameter(8.0, "m", "distance at which a mark is passed", min=0.0)
    closest = Parameter(
        math.radians(60.0), "rad", "least angle off the wind", min=0.0, max=math.pi / 2
    )
    margin = Parameter(math.radians(5.0), "rad", "more than that before the other tack", min=0.0)
    away = Parameter(
        math.radians(110.0), "rad", "least angle off the wind without way", min=0.0, max=math.pi
    )
    steerage = Parameter(0.5, "m/s", "speed ahead below which it bears away", min=0.0)
    recovered = Parameter(2.0, "1", "times steerage at which it luffs up again", min=1.0)
    turn_rate = Parameter(math.radians(6.0), "rad/s", "rate of the heading wanted", min=1e-9)
    lead = Parameter(
        math.radians(45.0), "rad", "lead at which the heading wanted waits", min=1e-9, max=math.pi
    )

    position_n = Input("m", "position, north-east-down", axes=(*_NE, "down"))
    position_valid = Input("1", "whether the position is valid", type=bool, start=True)
    heading = Input("rad", "heading, clockwise from north")
    speed = Input("m/s", "velocity ahead")
    wind = Input("m/s", "true wind over ground: where it blows to, {n}", axes=_NE)

    heading_wanted = Output("rad", "heading wanted, clockwise from north")
    course = Output("rad", "course to be on in the end, clockwise from north")
    distance = Output("m", "distance to the mark headed for")
    passed = Output("1", "number of marks passed", type=int)
    wearing = Output("1", "whether it turns the long way, away from the wind", type=bool)

    _ACTING = ("position_n", "position_valid", "heading", "speed", "wind")
    feedthrough: ClassVar = {
        "heading_wanted": _ACTING,
        "course": _ACTING,
        "distance": ("position_n", "position_valid"),
        "passed": ("position_n", "position_valid"),
        "wearing": _ACTING,
    }

    def reset(self, t: float) -> None:
        """Start before the first mark; raises InputError for a broken number of marks."""
        if self.count % 1.0:
            raise InputError(f"{self.name}.count is {self.count!r}, a whole number is needed")
        self._marks = [getattr(self, f"mark_{n + 1}") for n in range(int(self.count))]
        self._passed, self._tack, self._slow = 0, 0, False
        self._kept: list[float] = []

    def sample(self, t: float, k: int) -> None:
        """Say which way to go."""
        decision = self._decide()
        self.heading_wanted, self.course = decision.command, decision.course
        self.wearing, self.passed = decision.wearing, decision.passed
        self.distance = math.hypot(*self._way_to_mark(min(decision.passed, len(self._marks) - 1)))

    def update(self, t: float, k: int) -> None:
        """Remember marks passed, tack and heading wanted."""
        decision = self._decide()
        self._passed, self._tack, self._slow = decision.passed, decision.tack, self._is_slow()
        self._kept = [decision.command, decision.course]

    def _decide(self) -> _Decision:
        before, course = self._kept or (self.heading, self.heading)
        if not self.position_valid:
            return _Decision(course, before, self._tack, False, self._passed)
        passed = self._passed
        if passed < len(self._marks) and math.hypot(*self._way_to_mark(passed)) < self.radius:
            passed += 1
        course, tack = self._laid(passed)
        turn = self._turn(before, course)
        most = self.turn_rate * self.period
        command = before + min(max(turn, -most), most)
        lead = math.remainder(command - self.heading, math.tau)
        if abs(lead) > self.lead and lead * turn > 0.0:
            command = before
        return _Decision(course, command, tack, abs(turn) > math.pi, passed)

    def _way_to_mark(self, number: int) -> tuple[float, float]:
        mark, here = self._marks[number], self.position_n
        return mark[0] - here[0], mark[1] - here[1]

    def _laid(self, passed: int) -> tuple[float, int]:
        """Return the course and the tack it is on: 1 if it lies to starboard of the wind's eye."""
        eye = math.atan2(-self.wind[1], -self.wind[0])
        if passed == len(self._marks):
            return (self._kept[1] if self._kept else self.heading), self._tack
        north, east = self._way_to_mark(passed)
        bearing = math.atan2(east, north)
        off = math.remainder(bearing - eye, math.tau)
        own = self._tack or (1 if math.remainder(self.heading - eye, math.tau) >= 0.0 else -1)
        other_side = off * own < 0.0
        closest = self.away if self._is_slow() else self.closest
        if abs(off) >= closest + (self.margin if other_side else 0.0):
            return bearing, 1 if off >= 0.0 else -1
        return eye + own * closest, own

    def _is_slow(self) -> bool:
        enough = self.steerage * (self.recovered if self._slow else 1.0)
        return bool(self.speed < enough)

    def _turn(self, before: float, course: float) -> float:
        """Return the turn from ``before`` to ``course`` that keeps out of the wind's eye, rad."""
        eye = math.atan2(-self.wind[1], -self.wind[0])
        turn = math.remainder(course - before, math.tau)
        off = math.remainder(before - eye, math.tau)
        # Where the turn ends, counted on through the eye: a change of sign has passed it.
        if off * (off + turn) < 0.0:
            turn -= math.copysign(math.tau, turn)
        return turn
