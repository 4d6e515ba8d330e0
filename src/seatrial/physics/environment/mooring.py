"""Mooring line that holds a vehicle in its place until its autopilot is armed."""

from __future__ import annotations

from typing import ClassVar

from ...model.component import Component, Input, Output, Parameter, terminal
from ...model.waypoints import NED


class Mooring(Component):
    """Line that holds a craft's attachment where it is at the start, until ``armed`` is true.

    With the attachment's place x and velocity v in {n}, x_0 its place at the start, k the
    ``stiffness``, and c the ``damping``, its horizontal force on the craft is

        f = -k (x - x_0) - c v                                                        N

    Heave, roll, pitch, and yaw are free. The first instant at which ``armed`` is true casts the
    line off for good. A current, wind, and waves that push with F then find the craft F / k from
    its start, and not where they carried it while the autopilot's estimator started.

    A stiffness of 0 is no line. The force is held over a communication step h: of a craft of mass
    m (with added mass) the step is short enough below 0.3 sqrt(m / k) and 0.3 m / c.
    """

    exercised: ClassVar = {"stiffness": 50.0, "damping": 5.0, "armed": False}

    stiffness = Parameter(0.0, "N/m", "stiffness k of the line; 0: there is none", min=0.0)
    damping = Parameter(0.0, "N.s/m", "damping c of the line", min=0.0)

    point = Input("m", "attachment of the line, {n}", axes=NED)
    velocity = Input("m/s", "velocity of the attachment over ground, {n}", axes=NED)
    armed = Input("1", "whether the autopilot is armed", type=bool, start=True, optional=True)

    force = Output("N", "force on the craft at the attachment, {n}", axes=NED)
    holds = Output("1", "whether the line holds the craft", type=bool)

    terminals: ClassVar = {"attachment": terminal("point", "velocity", "force")}
    feedthrough: ClassVar = {"force": ("point", "velocity"), "holds": ()}

    def start(self, t: float) -> None:
        """Start with a slack line: its place is not known yet."""
        super().start(t)
        self._holds, self._ashore = False, False
        self._north = self._east = 0.0

    def step(self, t: float, h: float) -> None:
        """Make fast at the first step, and cast off when the autopilot is armed."""
        if not self._ashore and not self._holds:
            self._north, self._east = self.point[0], self.point[1]
            self._holds = self.stiffness > 0.0
        if self.armed:
            self._holds, self._ashore = False, True

    def outputs(self, t: float) -> None:
        """Publish the force of the line."""
        north = east = 0.0
        if self._holds:
            north = -self.stiffness * (self.point[0] - self._north)
            north -= self.damping * self.velocity[0]
            east = -self.stiffness * (self.point[1] - self._east)
            east -= self.damping * self.velocity[1]
        self.force, self.holds = (north, east, 0.0), self._holds
