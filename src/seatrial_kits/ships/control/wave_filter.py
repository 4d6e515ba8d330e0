"""Filter of what waves do to measured motion, so that actuators do not answer it: a notch."""

from __future__ import annotations

import math
from collections.abc import Sequence

from seatrial.model.component import Component, Parameter


class WaveFiltered(Component):
    """Mix-in: a notch at the waves' frequency for measured motion.

        N(s) = (s^2 + 2 z w s + w^2) / (s + w)^2

    w = ``wave_frequency``, z = ``wave_damping`` (Fossen, Handbook of Marine Craft Hydrodynamics
    and Motion Control, 2nd ed., 2021, 13.1). It takes z of a motion at w and all of a steady one,
    and delays slow motion by 2 (1 - z)/w. In samples by the bilinear rule with w in its place, so
    that the gain at w is z exactly. With w = 0 nothing is filtered.

    Each signal has a state of three numbers, made by `settled`.
    """

    period: float

    wave_frequency = Parameter(
        0.0, "rad/s", "frequency of waves that the control does not answer, 0 for none", min=0.0
    )
    wave_damping = Parameter(
        0.1, "1", "share of a motion at that frequency that is left", min=0.0, max=1.0
    )

    def prepare_filter(self) -> None:
        """Compute the coefficients, at the start.

        At half of the sample rate and above there is nothing that a filter could see.
        """
        w, T = self.wave_frequency, self.period
        if not 0.0 < w * T < math.pi:
            self._notch = [1.0, 0.0, 0.0, 0.0, 0.0]
            return
        c = 1.0 / math.tan(0.5 * w * T)  # s/w is c (1 - q)/(1 + q), q the delay of a sample
        below = (c + 1.0) ** 2
        damped = 2.0 * self.wave_damping * c
        above = [c * c + damped + 1.0, 2.0 * (1.0 - c * c), c * c - damped + 1.0]
        after = [2.0 * (1.0 - c * c), (c - 1.0) ** 2]
        self._notch = [part / below for part in (*above, *after)]

    def settled(self, value: float) -> list[float]:
        """Return the state of a signal that has been at ``value`` for long, and that value."""
        b0, _b1, b2, _a1, a2 = self._notch
        return [(1.0 - b0) * value, (b2 - a2) * value, value]

    def filtered(self, state: Sequence[float], value: float) -> float:
        """Return what is left of ``value``, the newest sample."""
        return self._notch[0] * value + state[0]

    def advanced(self, state: Sequence[float], value: float) -> list[float]:
        """Return the state after the sample ``value``."""
        _b0, b1, b2, a1, a2 = self._notch
        left = self.filtered(state, value)
        return [b1 * value - a1 * left + state[1], b2 * value - a2 * left, value]


def unwrapped(angle: float, near: float) -> float:
    """Return ``angle``, rad, with as many turns as bring it nearest to ``near``."""
    return near + math.remainder(angle - near, math.tau)
