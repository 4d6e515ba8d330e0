"""Buoys on their moorings, and obstacles that move."""

from __future__ import annotations

import math
from typing import ClassVar

from seatrial.errors import InputError
from seatrial.model.component import Component, Input, Output, Parameter, terminal
from seatrial.model.waypoints import NED, Waypoints
from seatrial.physics.sea.currents import CurrentState
from seatrial.physics.sea.parameters import MeetsCurrent

_HORIZONTAL = ("north", "east")


class Floating(MeetsCurrent, Component):
    """Base of what floats: a sphere, half of it in the water, where cameras see it.

    ``position`` is its middle, in {n}, m, on the surface.
    """

    diameter = Parameter(0.5, "m", "diameter", min=1e-3)
    leeway = Parameter(0.03, "1", "drift with the wind, share of its speed", min=0.0)

    current = Input(
        "m/s", "velocity of the water over ground, {n}", axes=_HORIZONTAL, optional=True
    )
    wind = Input(
        "m/s", "velocity of the air over ground: where it blows to", axes=_HORIZONTAL, optional=True
    )

    position = Output("m", "middle", axes=NED)
    velocity = Output("m/s", "velocity over ground, mean of the last step", axes=_HORIZONTAL)
    size = Output("m", "its diameter, as cameras take it")
    kind = Output("1", "what cameras take it for: 1 buoy, 2 obstacle", type=int)

    terminals: ClassVar = {"sight": terminal("position", "kind", diameter="size")}

    transient = Component.transient | {"_stream"}
    shown_as: ClassVar[int] = 1
    _stream: CurrentState | None = None

    def begin_at(self, north: float, east: float) -> None:
        """Be there, at rest."""
        self._stream = None
        self._place, self._velocity = [north, east], [0.0, 0.0]

    def drift(self, t: float) -> tuple[float, float]:
        """Return its velocity if nothing holds or drives it, m/s north and east."""
        stream = self.current_state().velocity(t, 0.0)
        north, east = (
            c + s + self.leeway * w
            for c, s, w in zip(self.current, stream, self.wind, strict=False)
        )
        return north, east

    def outputs(self, t: float) -> None:
        """Publish where it is."""
        north, east = self._place
        self.position = [north, east, 0.0]
        self.velocity = self._velocity
        self.size, self.kind = self.diameter, self.shown_as


class Buoy(Floating):
    """Buoy on a mooring, or adrift.

        p' = current + leeway wind,    |p - anchor| <= swing

    It drifts with the water and a share of the wind until its mooring is taut, then along the
    circle about its anchor, to where p - anchor has the direction of the drift.
    A ``swing`` of 0 holds it where it is, a negative one is a buoy adrift. In the sea of a trial
    its current at the surface is added. m, m/s, {n}.

    Not modelled: inertia, the mooring's elasticity and catenary, waves, collisions.
    """

    exercised: ClassVar = {"swing": 4.0}

    anchor = Parameter(0.0, "m", "where its mooring lies", axes=_HORIZONTAL)
    swing = Parameter(0.0, "m", "radius in which its mooring lets it drift, negative: adrift")
    offset = Parameter(0.0, "m", "from its anchor at the start", axes=_HORIZONTAL)

    def start(self, t: float) -> None:
        """Begin at ``offset``; raises InputError if that is beyond the swing."""
        away = math.hypot(*self.offset)
        if 0.0 <= self.swing < away:
            raise InputError(
                f"{self.name}.offset is {away:.6g} m from the anchor, swing allows {self.swing:g} m"
            )
        self.begin_at(*(a + o for a, o in zip(self.anchor, self.offset, strict=True)))

    def step(self, t: float, h: float) -> None:
        """Drift, as far as the mooring lets it."""
        drift = self.drift(t + 0.5 * h)
        moved = [p + h * v for p, v in zip(self._place, drift, strict=True)]
        if self.swing >= 0.0:
            moved = self._moored(moved)
        self._velocity = [(b - a) / h for a, b in zip(self._place, moved, strict=True)]
        self._place = moved

    def _moored(self, place: list[float]) -> list[float]:
        """Return the place, or the nearest that the mooring allows."""
        away = [p - a for p, a in zip(place, self.anchor, strict=True)]
        distance = math.hypot(*away)
        if distance <= self.swing:
            return place
        return [a + self.swing * d / distance for a, d in zip(self.anchor, away, strict=True)]


class MovingObstacle(Waypoints, Floating):
    """Obstacle that goes along waypoints at a steady speed over ground, or drifts.

    From ``begins_at`` on straight to waypoint 1, 2, ... at ``cruise``; at the last it stays. At a
    cruise of 0 it drifts as a `Buoy` without a mooring. m, m/s, {n}; the depth of the waypoints
    does not matter.

    Raises InputError at the start for a number of waypoints that is not whole.
    """

    exercised: ClassVar = {"cruise": 1.0, "count": 2.0, "waypoint_1": [1.0, 2.0, 0.0]}
    shown_as = 2

    begins_at = Parameter(0.0, "m", "where it is at the start", axes=_HORIZONTAL)
    cruise = Parameter(0.0, "m/s", "speed along the waypoints, 0: it drifts", min=0.0)

    views: ClassVar = {"waypoints": {"count": "count", "place": "waypoint"}}

    def start(self, t: float) -> None:
        """Begin at its place; raises InputError for a broken number of waypoints."""
        self._goals = [list(place[:2]) for place in self.waypoints()]
        self._next = 0
        self.begin_at(*self.begins_at)

    def step(self, t: float, h: float) -> None:
        """Go on."""
        before = self._place
        if self.cruise:
            self._place = self._along(self.cruise * h)
        else:
            self._place = [p + h * v for p, v in zip(before, self.drift(t + 0.5 * h), strict=True)]
        self._velocity = [(b - a) / h for a, b in zip(before, self._place, strict=True)]

    def _along(self, left: float) -> list[float]:
        """Return the place ``left`` metres on, round corners too."""
        place = self._place
        while self._next < len(self._goals):
            goal = self._goals[self._next]
            distance = math.dist(place, goal)
            if distance > left:
                return [p + left * (g - p) / distance for p, g in zip(place, goal, strict=True)]
            place, left, self._next = goal, left - distance, self._next + 1
        return list(place)
