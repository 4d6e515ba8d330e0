"""Course over waypoints, leg by leg."""

from __future__ import annotations

from typing import ClassVar

from ..errors import InputError
from ..model.component import Input, Output, Parameter, terminal
from ..model.sampled import Sampled
from ..model.waypoints import NED, Place, Waypoints
from .rounding import read_sides, rounded


class Course(Waypoints, Sampled):
    """Sequence of legs for `Guidance`: a mission without a mission service.

    Leg n leads from waypoint n - 1 (``start`` for the first) to waypoint n. When guidance
    reports ``reached`` = n, leg n + 1 begins at the next instant. After the last one
    ``leg`` stays, and guidance at its end; ``passed`` is the number of legs done.

    With ``sides`` it is a course round marks: of the waypoints each is left to port, to starboard,
    or on any side, the latter where no word is left for it. The legs lead to points at
    ``clearance`` from a mark with a side (`rounded`), and ``rounded`` is the number of waypoints
    that are passed. Without it every waypoint is the end of a leg.

    Nothing depends on an input at the same instant, so that the loop with guidance is none.
    Positions in {n}, m, down positive. Every leg has the same speed and radius: those of the
    guidance, if the course says none (a negative speed, a radius of 0).

    Raises InputError at the start for a number of waypoints that is not whole, and for more sides
    than waypoints.
    """

    exercised: ClassVar = {"count": 3.0, "waypoint_1": [1.0, 2.0, 3.0]}

    period = Parameter(0.1, "s", "sample period", min=1e-6)
    start_point = Parameter(0.0, "m", "where the first leg begins", axes=NED)
    speed = Parameter(
        -1.0, "m/s", "speed on every leg, negative for that of the guidance", tunable=True
    )
    sides = Parameter(
        "", "1", "side on which each waypoint is left: port, starboard or any", check=read_sides
    )
    clearance = Parameter(15.0, "m", "distance from a mark with a side", min=0.0)
    wait = Parameter(0.0, "s", "time to stay at every waypoint", min=0.0, tunable=True)

    reached = Input("1", "number of the leg that is done, 0 while none is", type=int)

    leg = Output("1", "number of the leg", type=int, start=1)
    leg_from = Output("m", "where the leg begins", axes=NED)
    leg_to = Output("m", "where the leg ends", axes=NED)
    leg_speed = Output("m/s", "speed on the leg")
    leg_radius = Output("m", "distance at which its end is reached")
    leg_wait = Output("s", "time to stay at its end")
    passed = Output("1", "number of legs done", type=int)
    rounded = Output("1", "number of waypoints passed, whatever the legs", type=int)

    views: ClassVar = {"waypoints": {"count": "count", "place": "waypoint"}}
    terminals: ClassVar = {
        "orders": terminal(
            "leg",
            "leg_from",
            "leg_to",
            "leg_speed",
            "leg_radius",
            "leg_wait",
            leg_reached="reached",
        )
    }

    def reset(self, t: float) -> None:
        """Start on the first leg; raises InputError for a broken number of waypoints."""
        marks, sides = self.waypoints(), read_sides(self.sides)
        if len(sides) > len(marks):
            raise InputError(
                f"{self.name}.sides has {len(sides)} words, there are {len(marks)} waypoints"
            )
        sides = [*sides, *[0] * (len(marks) - len(sides))]
        points = rounded(self.start_point, marks, sides, self.clearance)
        self._places: list[Place] = [self.start_point, *(point for point, _ in points)]
        self._marks = [0, *(number for _, number in points)]
        self._leg, self._passed = 1, 0

    def sample(self, t: float, k: int) -> None:
        """Publish the leg."""
        self.leg, self.passed = self._leg, self._passed
        self.rounded = self._marks[self._passed]
        self.leg_from, self.leg_to = self._places[self._leg - 1], self._places[self._leg]
        self.leg_speed, self.leg_radius, self.leg_wait = self.speed, self.radius, self.wait

    def update(self, t: float, k: int) -> None:
        """Go on to the next leg if this one is done."""
        if self.reached == self._leg:
            self._passed = self._leg
            self._leg = min(self._leg + 1, len(self._places) - 1)
