"""Criteria of IMO MSC.137(76) for the manoeuvrability of ships."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from seatrial.errors import InputError

from .result import Figures

SHIP = 100.0
"""Length from which on the criteria are for all ships, m."""
_FASTEST, _SLOWEST = 10.0, 30.0
"""L/V in s between which the limits of the overshoots rise."""


@dataclass(frozen=True)
class Verdict:
    """A figure against its limit; distances in ship lengths, angles in degrees."""

    ability: str
    value: float
    limit: float
    unit: str

    @property
    def margin(self) -> float:
        """Limit less value."""
        return self.limit - self.value

    @property
    def passed(self) -> bool:
        """Whether the value is within the limit, which it may reach."""
        return self.value <= self.limit


def first_overshoot_limit(length: float, speed: float) -> float:
    """Return the limit of the first overshoot of a 10/10 zig-zag, deg: 10 to 20.

    Between them it is 5 + L/(2V).
    """
    return 5.0 + _bounded(length, speed) / 2.0


def second_overshoot_limit(length: float, speed: float) -> float:
    """Return the limit of the second overshoot of a 10/10 zig-zag, deg: 25 to 40.

    Between them it is 17.5 + 0.75 L/V.
    """
    return 17.5 + 0.75 * _bounded(length, speed)


def _bounded(length: float, speed: float) -> float:
    if not (length > 0.0 and speed > 0.0):
        raise InputError(
            f"criteria: a length and a speed above 0 are needed, found {length:g} m, {speed:g} m/s"
        )
    return min(max(length / speed, _FASTEST), _SLOWEST)


def imo(trials: Mapping[str, Figures], length: float, speed: float) -> list[Verdict]:
    """Return the verdicts of IMO MSC.137(76) on figures of trials, by the trial's name.

    ``trials`` holds any of ``turning-circle`` (full helm), ``initial-turning``, ``zig-zag-10``,
    ``zig-zag-20`` and ``crash-stop``; figures that cannot be had have no verdict. ``length``
    between perpendiculars, m; ``speed`` V of the approach, m/s. The limits are for ships of 100 m
    and more and for gas and chemical tankers, at full load in deep, calm, unrestricted water, at
    90 % of the speed of 85 % of the engine's output. The criteria apply to each side by itself.
    Raises InputError for a length or speed that is not above 0.
    """
    first, second = first_overshoot_limit(length, speed), second_overshoot_limit(length, speed)
    limits = (
        ("turning-circle", "advance", "turning: advance", 4.5, "L"),
        ("turning-circle", "tactical_diameter", "turning: tactical diameter", 5.0, "L"),
        ("initial-turning", "initial_turning_track", "initial turning: track", 2.5, "L"),
        ("zig-zag-10", "overshoot_1", "10/10 zig-zag: first overshoot", first, "deg"),
        ("zig-zag-10", "overshoot_2", "10/10 zig-zag: second overshoot", second, "deg"),
        ("zig-zag-20", "overshoot_1", "20/20 zig-zag: first overshoot", 25.0, "deg"),
        ("crash-stop", "track_reach", "stopping: track reach", 15.0, "L"),
    )
    verdicts = []
    for trial, figure, ability, limit, unit in limits:
        if trial in trials and figure in trials[trial].found:
            value = trials[trial][figure]
            value = value / length if unit == "L" else math.degrees(value)
            verdicts.append(Verdict(ability, value, limit, unit))
    return verdicts
