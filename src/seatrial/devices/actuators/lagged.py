"""Actuators that follow their commands with a first-order lag, or at once."""

from __future__ import annotations

import math
from collections.abc import Sequence

from ...model.component import Parameter
from .actuator import Actuator

_SLOW_LAG = 1.0
"""Least lag of one that is slow, s: an ideal one has none that could be longer."""


class LaggedActuator(Actuator):
    """Base of actuators whose outputs y follow goals g, of the limited commands: T y' = g - y.

    y(t + h) = g + (y - g) exp(-h / T), exact for commands held over the step; with
    ``time_constant`` T = 0 the outputs are the goals at the same instant. One that is ``slow`` has
    ten times its lag, and at least 1 s; of a ``wrong`` one half is left.

    A subclass calls `begin_lagged` at the start, `follow` in `step`, and `lagged` in `outputs`;
    it gives the commands of its channels and their largest sizes.
    """

    time_constant = Parameter(0.0, "s", "lag behind the command, 0 for none", min=0.0)

    def begin_lagged(self, channels: int) -> None:
        """Start with all channels at 0."""
        self._reached = [0.0] * channels
        self._resting = [0.0] * channels
        self.begin_at(*self._resting)

    def follow(self, t: float, h: float, commands: Sequence[float], most: Sequence[float]) -> None:
        """Take the commands of ``t`` and follow them for ``h`` seconds."""
        goals = self._goals(self.take(t, commands, [-x for x in most], most), most)
        lag = self._lag()
        kept = math.exp(-h / lag) if lag > 0.0 else 0.0
        self._reached = [
            goal + (y - goal) * kept for goal, y in zip(goals, self._reached, strict=True)
        ]

    def lagged(self, t: float, commands: Sequence[float], most: Sequence[float]) -> list[float]:
        """Return the outputs of the channels at ``t``."""
        if self._lag() > 0.0:
            return self._reached
        return self._goals(self.received(t, commands, [-x for x in most], most), most)

    def _goals(self, received: list[float] | None, most: Sequence[float]) -> list[float]:
        pairs = zip(received or self._resting, most, strict=True)
        return [self.effect * min(max(command, -x), x) for command, x in pairs]

    def _lag(self) -> float:
        lag: float = self.slowness * self.time_constant
        return max(lag, _SLOW_LAG) if self.fault == "slow" else lag
