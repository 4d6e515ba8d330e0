"""Parameters of the simulation itself: its speed, and whether failures may be injected."""

from __future__ import annotations

from ..settings import Settings
from .definition import INT32, REAL32, Definition, choice

SPEEDUP = "SIM_SPEEDUP"
SLOWEST, FASTEST = 0.1, 1000.0
"""Limits of a speed-up. Slower, links would be served less than ten times a second."""

_SWITCH = {1: True, 0: False}


def simulation_parameters(settings: Settings, *, is_px4: bool) -> list[Definition]:
    """Return ArduPilot's SIM_SPEEDUP, 0 for a pause; and in a PX4 its SYS_FAILURE_EN.

    A speed-up ends with the run: no file keeps it.
    """
    speedup = Definition(
        SPEEDUP,
        REAL32,
        settings.speedup,
        SLOWEST,
        FASTEST,
        or_zero=True,
        apply=_speed_up,
        passing="it ends with the run, which starts at the speed-up that the rig sets",
    )
    if not is_px4:
        return [speedup]
    return [speedup, choice("SYS_FAILURE_EN", "failures_allowed", settings, _SWITCH, INT32)]


def _speed_up(settings: Settings, value: float) -> None:
    settings.paused = value == 0.0
    if not settings.paused:
        settings.speedup = value
