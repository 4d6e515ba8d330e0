"""Rudder machine with lag and rate limit."""

from __future__ import annotations

from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any, ClassVar

import casadi as ca

from ..component import Input, Parameter, terminal
from ..errors import InputError
from ..plant import Plant, State
from .actuator import Actuator
from .fault import SHARE_WRONG


class RudderMachine(Actuator, Plant):
    """Rudder that follows its command with a lag and a limited rate.

        d(angle)/dt = clip((clip(command, limit) - angle) / time_constant, rate)

    with clip(x, a) = x held between -a and a. ``angle`` is the blade's, trailing edge to port
    positive, rad: a positive angle turns the ship to port. ``positive`` is the way a
    positive *command* asks the ship to turn; "starboard" is the sense of most autopilots and of
    the MSS toolbox, and this is the one place where it is turned round.

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

    command = Input("rad", "angle asked for, in the sense of positive")
    angle = State("rad", "angle of the rudder, trailing edge to port positive: turns to port")

    terminals: ClassVar = {"reading": terminal(rudder="angle")}

    def start(self, t: float) -> None:
        """Start at ``angle_start``; raises InputError if it is beyond the limit."""
        (angle,) = self._start_state().tolist()
        if abs(angle) > self.limit:
            raise InputError(
                f"{self.name}.angle_start is {angle!r} rad, allowed "
                f"{-self.limit!r} to {self.limit!r} rad"
            )
        super().start(t)
        self.begin_at(self.command)

    def step(self, t: float, h: float) -> None:
        """Integrate over ``h`` with the command that arrives, if the blade is free."""
        limit: float = self.limit
        received = self.take(t, [self.command], [-limit], [limit])
        if received is None or self.fault == "stuck":
            return
        (self._acting,) = received
        if self.fault == "wrong":
            self._acting += SHARE_WRONG * 2.0 * limit
        # The equations do not depend on time: slower is the same in less of it.
        super().step(t, h / self.slowness)

    def _load(self) -> None:
        super()._load()
        self._u[0] = self._acting

    def equations(
        self, x: SimpleNamespace, u: SimpleNamespace, p: SimpleNamespace
    ) -> tuple[Mapping[str, Any], Mapping[str, Any]]:
        """Return the rate of the angle."""
        command = u.command if p.positive == "port" else -u.command
        lag = (_clip(command, p.limit) - x.angle) / p.time_constant
        return {"angle": _clip(lag, p.rate)}, {}


def _clip(value: Any, limit: Any) -> Any:
    return ca.fmin(ca.fmax(value, -limit), limit)
