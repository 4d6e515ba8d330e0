"""Base of actuators: failures."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ...model.component import NS, Noise
from ..delays import last_due
from ..fault import SLOWER, Fallible

INTERVAL_NS = 200_000_000
"""A contact that is loose holds, or does not, for so long; and so long does garbage last."""
LATE_NS = 500_000_000
"""By how much a delayed command is late."""
SHARE_LEFT = 0.5
"""What is left of the effect of a damaged thruster."""


class Actuator(Noise, Fallible):
    """Base of the actuators, with the failures of ``fault``.

    ============ ===================================================================
    off          no command arrives: a thruster stops, a shaft stays where it is
    stuck        a thruster keeps the command that it had; a shaft stays where it is
    garbage      random commands, uniform over the range, a new one every 0.2 s
    wrong        half of the thrust; a shaft is off by a tenth of its range
    slow         its lag is ten times as long, or its rate a tenth
    delayed      it follows the command of 0.5 s ago, until then the last one it had
    intermittent in every 0.2 s no command arrives with probability 1/2
    ============ ===================================================================

    Intervals are counted from the start of the run, and looked at where the actuator takes a
    command: at its frames, or at communication points. The numbers of interval i come from
    `Noise.generator` (i).

    Whoever writes one calls `begin_at` at the start, `take` once for every command, in time
    order, and `received` where it must know before what would be taken.
    """

    def begin_at(self, *command: float) -> None:
        """Start with a command that is taken for the one before the first."""
        self._begun_ns = self.now_ns
        self._taken: list[float] | None = list(command)
        self._late: list[list[Any]] = []

    def received(
        self, t: float, command: Sequence[float], low: Sequence[float], high: Sequence[float]
    ) -> list[float] | None:
        """Return what arrives of ``command`` at ``t``, None if nothing; changes nothing.

        ``low`` and ``high`` are the ends of its range.
        """
        now_ns = round(t * NS)
        match self.failure():
            case "off":
                return None
            case "stuck":
                return self._taken
            case "delayed":
                due = last_due(self._late, now_ns)
                return self._taken if due is None else due[1]
            case "garbage":
                drawn: list[float] = self._drawn(now_ns).uniform(low, high).tolist()
                return drawn
            case "intermittent" if self._drawn(now_ns).random() < 0.5:
                return None
        return list(command)

    def take(
        self, t: float, command: Sequence[float], low: Sequence[float], high: Sequence[float]
    ) -> list[float] | None:
        """Return what `received` does, and remember it."""
        self._taken = self.received(t, command, low, high)
        if self.fault == "delayed":
            now_ns = round(t * NS)
            while self._late and self._late[0][0] <= now_ns:
                self._late.pop(0)
            self._late.append([now_ns + LATE_NS, list(command)])
        else:
            self._late = []
        return self._taken

    @property
    def slowness(self) -> float:
        """How many times slower it is than it should be."""
        return float(SLOWER) if self.fault == "slow" else 1.0

    @property
    def effect(self) -> float:
        """What is left of a thruster's effect."""
        return SHARE_LEFT if self.fault == "wrong" else 1.0

    def _drawn(self, now_ns: int) -> Any:
        return self.generator((now_ns - self._begun_ns) // INTERVAL_NS)
