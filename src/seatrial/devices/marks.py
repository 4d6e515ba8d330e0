"""Marks that a vehicle is to pass, and its true track."""

from __future__ import annotations

import math
from typing import ClassVar

from ..component import Input, Output, Parameter, terminal
from ..errors import InputError
from ..sampled import Sampled
from ..waypoints import Waypoints


class Marks(Waypoints, Sampled):
    """Whether a vehicle's true track passes a list of waypoints, in their order.

    A waypoint is passed at the first instant, after the one before it was, at which

        |position - waypoint| <= margin radius.

    A pilot takes one for reached at ``radius``, as its sensors say, and turns: the margin is
    what they may be off by. So what the vehicle itself believes decides nothing here. Positions
    in {n}, m, down positive.

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

    passed = Output("1", "number of waypoints passed", type=int)
    left = Output("1", "number of waypoints that are left", type=int)
    distance = Output("m", "to the next waypoint; after the last one, to that")
    failsafe = Output("1", "whether a failsafe has been reported", type=bool)

    views: ClassVar = {"waypoints": {"count": "count", "place": "waypoint"}}
    terminals: ClassVar = {"motion": terminal("position"), "report": terminal(failsafe="reported")}

    def reset(self, t: float) -> None:
        """Begin with the first waypoint."""
        self._places = self.waypoints()
        if self.radius == 0.0:
            raise InputError(f"{self.name}.radius is 0, a distance is needed")
        self._passed, self._failsafe = 0, False

    def sample(self, t: float, k: int) -> None:
        """Publish what was passed until now."""
        self.passed, self.left = self._passed, len(self._places) - self._passed
        self.distance, self.failsafe = self._distance(), self._failsafe

    def update(self, t: float, k: int) -> None:
        """Go on to the next waypoint if this one is passed."""
        if self._passed < len(self._places) and self._distance() <= self.margin * self.radius:
            self._passed += 1
        self._failsafe = self._failsafe or self.reported

    def _distance(self) -> float:
        place = self._places[min(self._passed, len(self._places) - 1)]
        return math.dist(self.position, place)
