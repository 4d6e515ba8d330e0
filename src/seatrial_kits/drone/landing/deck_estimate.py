"""Estimate of a landing pad's motion from a drone's camera and the craft's reports."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import ClassVar

from seatrial.model.component import Component, Input, Parameter, terminal
from seatrial.model.waypoints import NED

from . import prediction, tracking
from .prediction import PER_PERIOD, WINDOW

_EULER = ("phi", "theta", "psi")
_SIGHT = 0.02
"""Noise of a sight, m, 1 sigma."""
_SPEED = 0.02
"""Noise of a reported velocity, m/s."""
_SWING = 0.4
"""Acceleration of the pad that an oscillation at one frequency leaves out, m/s2, 1 sigma."""
_KEPT = 0.6
"""How long the drone's own positions are kept, s."""
_FARTHEST = 0.5
"""No extrapolation goes farther than this, s."""


class DeckEstimate(Component):
    """Mix-in: the pad's motion by a Kalman filter, and samples of heave and slopes.

    A sight gives the pad from where the drone was at the exposure, a report its velocity, both at
    the time that they are of; nothing newer is used. Between them, and from there to now and beyond
    for at most 0.5 s, the pad moves as an oscillation, a' = -omega^2 v, with 1.15 times the
    frequency of ``wave_period``, the peak period as the craft reports it. The filter adds white
    jerk of the density 2 omega s^2: an acceleration of s = 0.4 m/s2 that lasts for 1 / omega.
    """

    position = Input("m", "CG of the drone in north-east-down", axes="xyz", frame="n")
    velocity = Input("m/s", "velocity of the CG over ground, body axes", axes="uvw")
    attitude = Input("rad", "Euler angles of the drone, ZYX", axes=_EULER)
    rates = Input("rad/s", "angular velocity of the drone, body axes", axes="pqr")
    offset = Input("m", "pad from the CG of the drone, {n}", axes=NED)
    exposed = Input("s", "time of the exposure of the last sight")
    sight_valid = Input("1", "whether the last sight due came", type=bool)
    sight_count = Input("1", "number of sights so far", type=int)
    deck_attitude = Input("rad", "Euler angles of the craft, reported", axes=_EULER, optional=True)
    deck_rates = Input("rad/s", "its angular velocity, reported", axes="pqr", optional=True)
    pad_velocity = Input("m/s", "velocity of the pad, reported, {n}", axes=NED, optional=True)
    reported = Input("s", "time of the last report", optional=True)
    report_valid = Input("1", "whether the last report due came", type=bool, optional=True)
    report_count = Input("1", "number of reports so far", type=int, optional=True)
    wave_period = Input("s", "peak period of the sea", start=2.0, optional=True)

    reading_period = Parameter(0.05, "s", "how often sights and reports are read", min=1e-6)

    terminals: ClassVar = {
        "motion": terminal("position", "velocity", "attitude", "rates"),
        "sight": terminal("offset", "exposed", "sight_valid", "sight_count"),
        "report": terminal(
            "deck_attitude",
            "deck_rates",
            "pad_velocity",
            "reported",
            "report_valid",
            "report_count",
        ),
    }
    exercised: ClassVar = {"sight_valid": True, "sight_count": 1, "offset": [0.1, 0.0, 2.0]}

    def reset_estimate(self, t: float) -> None:
        """Know nothing of the deck."""
        self._known = False
        self._x, self._P = tracking.first([0.0, 0.0, 0.0])
        self._at = t
        self._seen, self._sights, self._reports = -math.inf, 0, 0
        self._own: list[list[float]] = []
        self._read = t
        self._slopes = [0.0] * 6
        self._slopes_at = -math.inf
        self._samples: list[list[float]] = []
        self._grid = 0

    def observe(self, t: float) -> None:
        """Keep the drone's own place, and take in what is new, the older first."""
        self._own.append([t, *self.position])
        while self._own[0][0] < t - _KEPT:
            self._own.pop(0)
        if t < self._read - 1e-9:
            return
        self._read += self.reading_period
        sighted = self.sight_valid and self.sight_count != self._sights
        told = self.report_valid and self.report_count != self._reports
        if told:
            self._reports = self.report_count
            self._slopes, self._slopes_at = [*self.deck_attitude, *self.deck_rates], self.reported
        earlier = told and self.reported < self.exposed
        if earlier:
            self._take(self.reported, 1, self.pad_velocity)
        if sighted:
            self._sights = self.sight_count
            self._seen = max(self._seen, self.exposed)
            own = self._was(self.exposed)
            self._take(self.exposed, 0, [p + o for p, o in zip(own, self.offset, strict=True)])
        if told and not earlier:
            self._take(self.reported, 1, self.pad_velocity)

    def lost_for(self, t: float) -> float:
        """Return how long the mark has not been seen, s; infinite before it was."""
        return t - self._seen

    def deck_at(self, t: float) -> tracking.Rows:
        """Return position, velocity, and acceleration of the pad at ``t``, (3, 3)."""
        if not self._known:
            below = [self.position[0], self.position[1], self.position[2] + 1e3]
            return [below, [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]
        return tracking.ahead(self._x, min(max(t - self._at, 0.0), _FARTHEST), self._omega())

    def deck_heading(self) -> float:
        """Return the craft's heading as last reported, rad."""
        return self._slopes[2]

    def mean_down(self) -> float | None:
        """Return the pad's mean place down, m, None before there is one."""
        if not self._known:
            return None
        if len(self._samples) < PER_PERIOD:
            return self._x[0][2]
        return -prediction.mean(self._samples, 0)

    # ------------------------------------------------------------------ inside

    def _omega(self) -> float:
        """Return the frequency with which the pad is taken to swing, rad/s."""
        return float(1.15 * 2.0 * math.pi / max(self.wave_period, 0.1))

    def _was(self, at: float) -> list[float]:
        """Return where the drone was, linear between two instants."""
        later = 0
        while later < len(self._own) - 1 and self._own[later][0] < at:
            later += 1
        b, a = self._own[later], self._own[max(later - 1, 0)]
        share = (at - a[0]) / (b[0] - a[0]) if b[0] > a[0] else 1.0
        return [p + share * (q - p) for p, q in zip(a[1:], b[1:], strict=True)]

    def _take(self, at: float, row: int, value: Sequence[float]) -> None:
        if not self._known:
            if row == 0:
                self._x, self._P = tracking.first(value)
                self._at, self._known = at, True
                self._grid = math.ceil(at / self.sample_step())
            return
        if at < self._at - 1e-6:
            return
        omega, later = self._omega(), max(at - self._at, 0.0)
        x, P = tracking.moved_on(self._x, self._P, later, omega, 2.0 * omega * _SWING**2)
        self._at = max(at, self._at)
        self._x, self._P = tracking.corrected(x, P, row, value, _SPEED if row else _SIGHT)
        self._sample()

    def _sample(self) -> None:
        """Keep heave and slopes at multiples of a share of the peak period."""
        step = self.sample_step()
        while self._grid * step <= self._at + 1e-9:
            back = self._grid * step - self._at
            down = self._x[0][2] + self._x[1][2] * back + self._x[2][2] * back * back / 2.0
            north, east = self.slopes_at(self._grid * step)
            self._samples.append([-down, north, east])
            self._grid += 1
            if len(self._samples) > WINDOW:
                self._samples.pop(0)

    def sample_step(self) -> float:
        """Return the time between two samples, s."""
        return float(max(self.wave_period, 0.1)) / PER_PERIOD

    def slopes_at(self, t: float) -> tuple[float, float]:
        """Return the slopes to north and east at ``t``, by the last report and its rates."""
        phi, theta, psi, p, q, r = self._slopes
        back = min(max(t - self._slopes_at, -_FARTHEST), _FARTHEST)
        s, c = math.sin(phi), math.cos(phi)
        phi += (p + math.tan(theta) * (s * q + c * r)) * back
        theta += (c * q - s * r) * back
        ahead, aside = math.tan(theta), -math.tan(phi)
        return (
            math.cos(psi) * ahead - math.sin(psi) * aside,
            math.sin(psi) * ahead + math.cos(psi) * aside,
        )
