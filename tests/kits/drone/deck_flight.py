"""A drone that is where a test puts it, over a deck that moves as a test says, and its autopilot."""

from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from seatrial_kits.drone.landing.landing_control import DeckLandingControl
from tests.devices.running import started

H = 0.01
Motion = Callable[[float], Any]


def at_rest(*value: float) -> Motion:
    return lambda t: np.array(value, dtype=float)


class Swing:
    """A pad that swings with 1.15 times the frequency of a peak period, in closed form.

    Its place, velocity and acceleration at 0 s are given, {n}.
    """

    def __init__(self, place: Any, velocity: Any, acceleration: Any, period: float) -> None:
        self.omega = 1.15 * 2.0 * np.pi / period
        self._place, self._v, self._a = map(np.array, (place, velocity, acceleration))

    def place(self, t: float) -> Any:
        c, s, w = np.cos(self.omega * t), np.sin(self.omega * t), self.omega
        return self._place + self._v * s / w + self._a * (1.0 - c) / w**2

    def velocity(self, t: float) -> Any:
        return self.derivatives(t)[0]

    def derivatives(self, t: float) -> tuple[Any, Any, Any]:
        """Return velocity, acceleration and jerk."""
        c, s, w = np.cos(self.omega * t), np.sin(self.omega * t), self.omega
        v = self._v * c + self._a * s / w
        return v, self._a * c - self._v * w * s, -(w**2) * v


class Flight:
    """Exact sights and reports every 0.05 s, ``delay`` s late; motions are functions of time, {n}.

    ``step`` is the autopilot's period, s.
    """

    def __init__(self, delay: float = 0.0, step: float = H, **values: Any) -> None:
        self.control = started(DeckLandingControl, period=step, **values)
        self.step = step
        self.delay, self.sees, self.reports, self.count = delay, True, True, 0
        self.position, self.velocity = at_rest(0, 0, -2.45), at_rest(0, 0, 0)
        self.attitude = at_rest(0, 0, 0)
        self.pad, self.pad_velocity = at_rest(0, 0, -0.2), at_rest(0, 0, 0)
        self.deck, self.rates = at_rest(0, 0, 0), at_rest(0, 0, 0)
        self.load = 0.0

    def to(self, until: float) -> DeckLandingControl:
        """Go on to ``until``, s; orders of the instant before are then to be read."""
        c = self.control
        while c.now < until - 1e-9:
            t = c.now
            at, attitude = t - self.delay, self.attitude(t)
            c.set("position", self.position(t).tolist())
            own = Rotation.from_euler("ZYX", attitude[::-1])
            c.set("velocity", own.inv().apply(self.velocity(t)).tolist())
            c.set("attitude", attitude.tolist())
            c.set("legs_load", self.load)
            due = at >= 0.0 and abs(t - 0.05 * round(t / 0.05)) < 1e-9
            self.count += due
            c.set("sight_valid", self.sees)
            c.set("report_valid", self.reports)
            if due and self.sees:
                c.set("offset", (self.pad(at) - self.position(at)).tolist())
                c.set("exposed", at)
                c.set("sight_count", self.count)
            if due and self.reports:
                c.set("pad_velocity", self.pad_velocity(at).tolist())
                c.set("deck_attitude", self.deck(at).tolist())
                c.set("deck_rates", self.rates(at).tolist())
                c.set("reported", at)
                c.set("report_count", self.count)
            c.advance(t, self.step)
        return c

    def acceleration(self) -> Any:
        """Return that which thrust and attitude wanted give with gravity, m/s2, {n}."""
        own = Rotation.from_euler("ZYX", self.control.get("attitude_wanted")[::-1])
        thrust = self.control.get("thrust") / self.control.get("mass")
        return own.apply([0.0, 0.0, -thrust]) + np.array([0.0, 0.0, 9.81])
