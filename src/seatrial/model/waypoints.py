"""A list of waypoints: one for those who follow it, upload it and check a track against it."""

from __future__ import annotations

from typing import ClassVar

from ..errors import InputError
from .component import Component, Parameter

MOST = 8
NED = ("north", "east", "down")
Place = tuple[float, float, float]
"""North, east and down in {n}, m."""


class Waypoints(Component):
    """Mix-in for what has a list of waypoints. Positions in {n}, m, down positive."""

    structural: ClassVar = ("count",)

    count = Parameter(1.0, "1", "number of waypoints", min=1.0, max=float(MOST))
    waypoint_1 = Parameter(0.0, "m", "first waypoint", axes=NED)
    waypoint_2 = Parameter(0.0, "m", "second waypoint", axes=NED)
    waypoint_3 = Parameter(0.0, "m", "third waypoint", axes=NED)
    waypoint_4 = Parameter(0.0, "m", "fourth waypoint", axes=NED)
    waypoint_5 = Parameter(0.0, "m", "fifth waypoint", axes=NED)
    waypoint_6 = Parameter(0.0, "m", "sixth waypoint", axes=NED)
    waypoint_7 = Parameter(0.0, "m", "seventh waypoint", axes=NED)
    waypoint_8 = Parameter(0.0, "m", "eighth waypoint", axes=NED)
    radius = Parameter(
        0.0,
        "m",
        "distance at which a waypoint is reached, 0 for that of the guidance",
        min=0.0,
        tunable=True,
    )

    def waypoints(self) -> list[Place]:
        """Return them. Raises InputError for a number of waypoints that is not whole."""
        if self.count % 1.0:
            raise InputError(f"{self.name}.count is {self.count!r}, a whole number is needed")
        return [getattr(self, f"waypoint_{n + 1}") for n in range(int(self.count))]
