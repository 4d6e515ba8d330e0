"""A scalar of a rig, described."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Signal:
    """One scalar of a rig: an output, an input or a parameter."""

    name: str
    """``component.port``, with its axis: ``hull.position.x``."""
    unit: str
    """As FMI writes it: ``m/s``, ``rad``, ``1``; empty if it has none."""
    description: str
    type: type
    """float, int, bool, str or bytes."""
    minimum: float | None
    maximum: float | None
    tunable: bool
    """A parameter that may be set during a run, or an input that nothing feeds."""
    feeder: str
    """The output that feeds this input or parameter; empty if none does."""
