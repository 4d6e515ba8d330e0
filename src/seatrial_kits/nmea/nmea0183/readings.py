"""Instrument readings at an instant."""

from __future__ import annotations

import datetime
import math
from dataclasses import dataclass

from ..leg import LegStatus
from ..satellites import Sky

Pair = tuple[float, float]


@dataclass(frozen=True)
class Readings:
    """Readings in SI units and radians; None for what is not valid."""

    time: datetime.datetime
    """UTC."""
    variation: float = 0.0
    """Magnetic variation, positive east: true = magnetic + variation."""
    transducer_offset: float = 0.0
    """From the transducer up to the waterline or, negative, down to the keel, m."""
    position: tuple[float, float, float] | None = None
    """Latitude and longitude in degrees, altitude in m."""
    velocity: Pair | None = None
    """Over ground, north and east."""
    heading: float | None = None
    """True, clockwise from north."""
    rate_of_turn: float | None = None
    """Positive to starboard."""
    roll_pitch: Pair | None = None
    """Starboard side down and bow up positive."""
    apparent_wind: Pair | None = None
    """Speed, and where it comes from, clockwise from the bow."""
    true_wind: Pair | None = None
    """The same of the wind over ground, clockwise from the bow too."""
    water_speed: float | None = None
    """Through the water, along the bow."""
    depth: float | None = None
    """Below the transducer."""
    water_temperature: float | None = None
    """K."""
    rudder: float | None = None
    """Positive to turn to starboard."""
    sky: Sky | None = None
    """Satellites of the position."""
    leg: LegStatus | None = None
    """Leg that the vessel is on."""
    waypoints: tuple[tuple[float, float], tuple[float, float]] | None = None
    """Latitude and longitude of its ends, degrees."""

    water_distance: float | None = None
    """Through the water since the start of the run, m."""
    engine_speeds: tuple[float | None, ...] = ()
    """rad/s."""

    @property
    def current(self) -> Pair | None:
        """Set, clockwise from north, and drift of the current, m/s."""
        if self.velocity is None or self.heading is None or self.water_speed is None:
            return None
        north = self.velocity[0] - self.water_speed * math.cos(self.heading)
        east = self.velocity[1] - self.water_speed * math.sin(self.heading)
        return math.atan2(east, north), math.hypot(north, east)

    @property
    def course(self) -> float | None:
        """Course over ground, clockwise from north."""
        return None if self.velocity is None else math.atan2(self.velocity[1], self.velocity[0])

    @property
    def speed(self) -> float | None:
        """Speed over ground."""
        return None if self.velocity is None else math.hypot(*self.velocity)

    def magnetic(self, direction: float | None) -> float | None:
        """Return a true direction as a magnetic compass would show it."""
        return None if direction is None else direction - self.variation
