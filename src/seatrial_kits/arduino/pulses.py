"""Pulses from the edges of a pin, as a servo or a motor controller takes them."""

from __future__ import annotations

from .mcus import CLOCK

_LOST = CLOCK // 10
"""Cycles without an edge after which there are no pulses any more."""


class Pulses:
    """Edges of one pin, by cycle."""

    def __init__(self) -> None:
        self.level = 0
        self._rise = self._fall = -1
        self._width = 0
        self._share = 0.0
        self._given: float | None = None
        self._held = 0.0

    def modulated(self, share: float) -> None:
        """Take in that hardware keeps the pin high for a share of the time, without edges."""
        self._given = share

    def high_for(self, seconds: float) -> None:
        """Take in how long at a time hardware keeps the pin high."""
        self._held = seconds

    def edge(self, level: int, cycle: int) -> None:
        """Take in that the pin has another level."""
        self._given = None
        if level == self.level:
            return
        self.level = level
        if not level:
            if self._rise >= 0:
                self._width = cycle - self._rise
            self._fall = cycle
            return
        if self._rise >= 0 and self._fall > self._rise:
            self._share = (self._fall - self._rise) / (cycle - self._rise)
        self._rise = cycle

    def width(self, now: int) -> float:
        """Return the last whole pulse's width, s; 0 if none came for 0.1 s."""
        if self._given is not None:
            return self._held
        return self._width / CLOCK if self._fall >= 0 and now - self._fall < _LOST else 0.0

    def share(self, now: int) -> float:
        """Return the share of time that the pin is high, over the last whole period."""
        if self._given is not None:
            return self._given
        if now - max(self._rise, self._fall, 0) >= _LOST // 5 or self._rise < 0:
            return float(self.level)
        return self._share
