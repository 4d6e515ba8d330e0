"""Electric thruster with thrust linear in its command."""

from __future__ import annotations

import math
from typing import ClassVar

from seatrial.devices.actuators.actuator import Actuator
from seatrial.model.component import NS, Input, Output, Parameter


class LinearThruster(Actuator):
    """Thruster whose thrust is linear in a command beta from -1 to 1, late and with a lag.

        T y' = F(beta(t - delay)) - y
        F(beta) = full_thrust clip(beta, 1),   0 while |beta| <= dead_band

    clip(x, a) is x held between -a and a. Exact for a command that is held from one
    communication point to the next, whatever delay and step: the times at which a command takes
    effect are counted in whole nanoseconds and need not be communication points. Before the
    start of the run the command was 0. ``thrust`` y is along the thruster's axis, N, positive
    ahead; it never reacts to the command at the same instant.

    Outside the dead band F is on the line through the origin, so that it jumps at the edge.
    Linear in beta as [Paulino2015] has it (5.18), which tried a quadratic law too and found that
    one worse; the delay is that of its eq. 5.15.

    Failures are those of `Actuator`. Where no command arrives it is the motor that stands still:
    commands go on their way and act again when it is repaired.

    Not modelled: loss of thrust with the speed of the water through the propeller, thrust that
    differs between ahead and astern, supply voltage, a limit on how fast the command may change.
    """

    exercised: ClassVar = {"delay": 0.013, "dead_band": 0.1}

    full_thrust = Parameter(1.0, "N", "thrust at command 1", min=0.0)
    dead_band = Parameter(0.0, "1", "largest command without thrust", min=0.0, max=1.0)
    delay = Parameter(0.0, "s", "time from a command to its effect", min=0.0)
    time_constant = Parameter(0.15, "s", "time constant of the thrust", min=1e-6)

    command = Input("1", "share of full thrust, -1 to 1, positive ahead", role="command")
    thrust = Output("N", "thrust along the axis, positive ahead")

    def start(self, t: float) -> None:
        """Start at rest, with no command on its way."""
        self._delay_ns = round(self.delay * NS)
        self._thrust = self._goal = 0.0
        self._coming: list[list[float]] = []
        self.begin_at(0.0)

    def step(self, t: float, h: float) -> None:
        """Send the command on its way, and follow those that take effect until ``t + h``."""
        at_ns = round(t * NS)
        end_ns = at_ns + round(h * NS)
        received = self.take(t, [self.command], [-1.0], [1.0])
        self._left = 0.0 if received is None else self.effect
        goal = self._goal_of(self.command if received is None else received[0])
        if goal != (self._coming[-1][1] if self._coming else self._goal):
            self._coming.append([at_ns + self._delay_ns, goal])
        while self._coming and self._coming[0][0] < end_ns:
            due_ns, goal = self._coming.pop(0)
            self._follow((due_ns - at_ns) / NS)
            at_ns, self._goal = int(due_ns), goal
        self._follow((end_ns - at_ns) / NS)

    def outputs(self, t: float) -> None:
        """Publish the thrust."""
        self.thrust = self._thrust

    def _goal_of(self, command: float) -> float:
        """Return the thrust that ``command`` leads to in the end, N."""
        if abs(command) <= self.dead_band:
            return 0.0
        return float(self.full_thrust * min(max(command, -1.0), 1.0))

    def _follow(self, duration: float) -> None:
        kept = math.exp(-duration / (self.slowness * self.time_constant))
        goal = self._left * self._goal
        self._thrust = goal + (self._thrust - goal) * kept
