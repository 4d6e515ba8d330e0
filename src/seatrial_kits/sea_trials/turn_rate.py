"""Controller of the rate of turn that finds the helm, for Bech's reverse spiral."""

from __future__ import annotations

_ANGLE = 0.2
"""Heading change over which the rate is measured while a turn is at its largest, rad."""
_PROPORTIONAL, _INTEGRAL = 2.0, 2.0
_LEAST_RATE = 1e-4
"""rad/s."""


class HelmForRate:
    """Mix-in: helm by proportional and integral action on the rate of turn.

    With R the rate of the steady turn at the helm of the manoeuvre, r the rate measured over a
    heading change of up to 0.2 rad, and e the wanted share less r / R,

        helm_found = clip(I + 2 e),   I' = 2 |R| e

    clip(x) = x held within +-1; I stays within that too. Time constants go by 1 / R, as do those
    of a vessel that turns. The helm begins at 1, where the turn left it. Shares are positive to the
    side of that turn. [Bech1968]: the branch of the r-helm curve that is not stable is steady with
    the rate controlled.
    """

    _rate: float
    _integral: float
    _headings: list[float]
    _found: float
    """Share of the helm of the manoeuvre."""

    def _begin_search(self, rate: float) -> None:
        """Start from the steady rate at full helm, rad/s, of either sign."""
        self._rate = rate if abs(rate) > _LEAST_RATE else _LEAST_RATE
        self._integral = self._found = 1.0
        self._headings = []

    def _search(self, wanted: float, heading: float, period: float) -> None:
        """Take the share of the rate wanted, and the unwrapped heading, rad, once a period."""
        count = max(1, round(_ANGLE / abs(self._rate) / period))
        self._headings = [*self._headings[-count:], heading]
        if len(self._headings) <= count:
            return
        rate = (heading - self._headings[0]) / (count * period)
        error = wanted - rate / self._rate
        self._integral = _clip(self._integral + _INTEGRAL * period * abs(self._rate) * error)
        self._found = _clip(self._integral + _PROPORTIONAL * error)


def _clip(share: float) -> float:
    return min(max(share, -1.0), 1.0)
