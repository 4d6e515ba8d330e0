"""Marks that a vehicle is to pass, and its true track."""

from __future__ import annotations

import math
from typing import ClassVar

import numpy as np

from ..errors import InputError
from ..model.component import Input, Output, Parameter, terminal
from ..model.sampled import Sampled
from ..model.waypoints import NED, Waypoints

_REMEMBERED_S = 10.0


class Marks(Waypoints, Sampled):
    """Whether a vehicle's true track passes a list of waypoints, in their order.

    A waypoint is passed at the first instant, after the one before it was, at which

        |position - waypoint| <= margin radius.

    A pilot takes one for reached at ``radius``, as its sensors say, and turns: the margin is
    what they may be off by. So what the vehicle itself believes decides nothing here. Positions
    in {n}, m, down positive.

    ``error`` is how far the newest estimate that whoever talks to the autopilot received lies from
    the truth of its time, horizontally, and ``home_error`` how far what the autopilot takes for
    its home lies from the origin of {n}; both are 0 while nothing is ``estimated``. Whose fault a
    missed mark is, the steering's or the estimate's, is so part of the record. An estimate that
    is more than 10 s old is compared no more.

    ``reported`` is a failsafe that whoever talks to the autopilot received; ``failsafe`` says
    whether there has been one.

    Raises InputError at the start for a number of waypoints that is not whole, and for a radius
    of 0.
    """

    exercised: ClassVar = {"count": 2.0, "waypoint_1": [1.0, 2.0, 3.0], "radius": 4.0}

    period = Parameter(0.1, "s", "sample period", min=1e-6)
    margin = Parameter(1.5, "1", "true distance at which one is passed, over the radius", min=1.0)

    position = Input("m", "true position, north-east-down", axes="xyz", frame="n")
    reported = Input("1", "whether a failsafe is reported", type=bool, optional=True)

    estimated = Input("1", "whether there is an estimate", type=bool, optional=True)
    estimate = Input("m", "where the autopilot takes itself to be, {n}", axes=NED, optional=True)
    estimate_time = Input("s", "simulated time of the estimate", optional=True)
    home = Input("m", "what the autopilot takes for its home, {n}", axes=NED, optional=True)

    passed = Output("1", "number of waypoints passed", type=int)
    left = Output("1", "number of waypoints that are left", type=int)
    distance = Output("m", "to the next waypoint; after the last one, to that")
    failsafe = Output("1", "whether a failsafe has been reported", type=bool)

    error = Output("m", "horizontal distance of the estimate from the truth")
    home_error = Output("m", "horizontal distance of the autopilot's home from the origin of {n}")

    believed = Output("m", "where the autopilot takes itself to be, {n}", axes=NED)
    believed_home = Output("m", "what the autopilot takes for its home, {n}", axes=NED)

    views: ClassVar = {
        "waypoints": {"count": "count", "place": "waypoint"},
        "estimate": {
            "place": "believed",
            "home": "believed_home",
            "error": "error",
            "passed": "passed",
        },
    }
    terminals: ClassVar = {
        "motion": terminal("position"),
        "report": terminal("estimated", "estimate", "estimate_time", "home", failsafe="reported"),
    }

    def reset(self, t: float) -> None:
        """Begin with the first waypoint."""
        self._places = self.waypoints()
        if self.radius == 0.0:
            raise InputError(f"{self.name}.radius is 0, a distance is needed")
        self._passed, self._failsafe = 0, False
        self._track: list[tuple[float, float, float]] = []
        self._error = 0.0

    def sample(self, t: float, k: int) -> None:
        """Publish what was passed until now."""
        self.passed, self.left = self._passed, len(self._places) - self._passed
        self.distance, self.failsafe = self._distance(), self._failsafe
        self.error = self._error
        self.believed, self.believed_home = self.estimate, self.home
        self.home_error = math.hypot(self.home[0], self.home[1]) if self.estimated else 0.0

    def update(self, t: float, k: int) -> None:
        """Go on to the next waypoint if this one is passed."""
        if self._passed < len(self._places) and self._distance() <= self.margin * self.radius:
            self._passed += 1
        self._failsafe = self._failsafe or self.reported
        self._track = [*self._track[-round(_REMEMBERED_S / self.period) :], (t, *self.position[:2])]
        if self.estimated:
            self._error = self._off(*self.estimate[:2])

    def _off(self, north: float, east: float) -> float:
        """Return how far a place is from where the vehicle was at the estimate's time."""
        times, norths, easts = zip(*self._track, strict=True)
        if not times[0] <= self.estimate_time <= times[-1]:
            return self._error
        at = self.estimate_time
        return math.hypot(
            north - float(np.interp(at, times, norths)), east - float(np.interp(at, times, easts))
        )

    def _distance(self) -> float:
        place = self._places[min(self._passed, len(self._places) - 1)]
        return math.dist(self.position, place)
