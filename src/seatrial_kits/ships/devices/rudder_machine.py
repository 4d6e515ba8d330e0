"""Rudder machine with lag and rate limit."""

from __future__ import annotations

import math
from typing import ClassVar

from seatrial.devices.actuators.actuator import Actuator
from seatrial.devices.fault import SHARE_WRONG
from seatrial.errors import InputError
from seatrial.model.component import Input, Output, Parameter, terminal


class RudderMachine(Actuator):
    """Rudder that follows its command with a lag and a limited rate.

        d(angle)/dt = clip((clip(command, limit) - angle) / time_constant, rate)

    with clip(x, a) = x held between -a and a. ``angle`` is the blade's, trailing edge to port
    positive, rad: a positive angle turns the ship to port. ``positive`` is the way a
    positive *command* asks the ship to turn; "starboard" is the sense of most autopilots and of
    the MSS toolbox, and this is the one place where it is turned round. Steps use the classical
    Runge-Kutta method of order 4 with the command held, in equal parts up to ``max_step``.

    Defaults: 5 deg/s and 1 s as in the MSS toolbox's model of the Mariner; 35 degrees, the
    limit that classification societies ask for (the toolbox has 40).

    Failures are those of `Actuator`: without a command, or stuck, the blade is locked where it is;
    to a wrong one the command is a tenth of the whole range too much; in a slow one lag and
    rate are ten times slower.

    Not modelled: dead band and pumps that start and stop, load of the water on the blade.

    Raises InputError at the start if ``angle_start`` is beyond the limit.
    """

    max_step = Parameter(0.1, "s", "longest integration sub-step", min=1e-6)
    limit = Parameter(0.6108652381980153, "rad", "largest angle, to either side", min=1e-9)
    rate = Parameter(0.08726646259971647, "rad/s", "largest rate", min=1e-9)
    time_constant = Parameter(1.0, "s", "lag of the angle behind the command", min=1e-3)
    positive = Parameter(
        "port", "1", "the way a positive command turns the ship", choices=("port", "starboard")
    )

    command = Input("rad", "angle asked for, in the sense of positive", role="command")
    angle_start = Parameter(0.0, "rad", "start value of angle")
    angle = Output("rad", "angle of the rudder, trailing edge to port positive: turns to port")

    terminals: ClassVar = {"reading": terminal(rudder="angle")}

    def start(self, t: float) -> None:
        """Start at ``angle_start``; raises InputError if it is beyond the limit."""
        self._angle: float = self.angle_start
        if abs(self._angle) > self.limit:
            raise InputError(
                f"{self.name}.angle_start is {self._angle!r} rad, allowed "
                f"{-self.limit!r} to {self.limit!r} rad"
            )
        self.begin_at(self.command)

    def step(self, t: float, h: float) -> None:
        """Integrate over ``h`` with the command that arrives, if the blade is free."""
        limit: float = self.limit
        received = self.take(t, [self.command], [-limit], [limit])
        if received is None or self.fault == "stuck":
            return
        command = received[0]
        if self.fault == "wrong":
            command += SHARE_WRONG * 2.0 * limit
        # The law does not depend on time: slower is the same in less of it.
        duration = h / self.slowness
        count = max(1, math.ceil(duration / self.max_step - 1e-9))
        for _ in range(count):
            self._angle = self._after(duration / count, self._angle, command)

    def outputs(self, t: float) -> None:
        """Publish the angle."""
        self.angle = self._angle

    def slope(self, angle: float, command: float) -> float:
        """Return the rate of the blade at ``angle``, rad, with a ``command``, rad."""
        wanted = command if self.positive == "port" else -command
        return _clip((_clip(wanted, self.limit) - angle) / self.time_constant, self.rate)

    def _after(self, h: float, angle: float, command: float) -> float:
        k1 = self.slope(angle, command)
        k2 = self.slope(angle + h / 2.0 * k1, command)
        k3 = self.slope(angle + h / 2.0 * k2, command)
        k4 = self.slope(angle + h * k3, command)
        return angle + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)


def _clip(value: float, limit: float) -> float:
    return min(max(value, -limit), limit)
