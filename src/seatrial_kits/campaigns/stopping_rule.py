"""End of a campaign: once an interval is narrow enough, or its criteria are decided."""

from __future__ import annotations

import math
from typing import Literal

from pydantic import Field, model_validator

from seatrial.system.files import FileModel

_LOOKED_EVERY = 50
"""Cases between two looks, in case order: where it ends does not depend on who runs them."""


class StoppingRule(FileModel):
    """Until when a campaign draws cases, at most those of its design."""

    half_width: float | None = Field(default=None, gt=0.0, lt=0.5)
    """Of the interval of the probability of failure."""
    decided: bool = False
    """Whether it ends where all criteria of the campaign are decided, instead."""
    confidence: float = Field(default=0.95, gt=0.0, lt=1.0)
    interval: Literal["wilson", "clopper-pearson"] = "wilson"
    least: int = Field(default=100, gt=0)
    """Cases before the first look."""

    @model_validator(mode="after")
    def _one(self) -> StoppingRule:
        if (self.half_width is None) != self.decided:
            raise ValueError("either half_width = NUMBER or decided = true is needed")
        return self

    def met(self, failed: int, count: int) -> bool:
        """Say if the first ``count`` cases, of which some have ``failed``, are narrow enough."""
        assert self.half_width is not None
        if count < self.least or count % _LOOKED_EVERY:
            return False
        low, high = failure_interval(failed, count, self.confidence, self.interval)
        return (high - low) / 2.0 <= self.half_width


def failure_interval(
    failed: int, count: int, confidence: float = 0.95, interval: str = "wilson"
) -> tuple[float, float]:
    """Return a confidence interval of the probability of failure.

    Wilson's score interval, or the exact one of Clopper and Pearson, which covers at least as often
    as it says.
    """
    if interval == "clopper-pearson":
        from scipy.stats import binomtest  # half a second, of every command if it stood above

        found = binomtest(failed, count).proportion_ci(confidence, method="exact")
        return float(found.low), float(found.high)
    from scipy.special import ndtri  # dear to import, and no other command needs it

    z = float(ndtri(0.5 + 0.5 * confidence))  # Wilson 1927
    middle = (failed + z * z / 2.0) / (count + z * z)
    half = z / (count + z * z) * math.sqrt(failed * (count - failed) / count + z * z / 4.0)
    return (middle - half if failed else 0.0), (middle + half if failed < count else 1.0)
