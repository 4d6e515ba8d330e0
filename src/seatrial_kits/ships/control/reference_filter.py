"""Reference model of the heading: from a step of the course to a heading that can be followed."""

from __future__ import annotations

import math
from typing import ClassVar

from seatrial.model.component import Input, Output, Parameter, terminal
from seatrial.model.sampled import Sampled

_Motion = tuple[float, float, float]


class HeadingReference(Sampled):
    """Third-order reference model of the heading, with a limit on the rate of turn.

        psi_d''' + (2 zeta + 1) w psi_d'' + (2 zeta + 1) w^2 psi_d' + w^3 psi_d = w^3 target

    (Fossen), poles at -w and at those of s^2 + 2 zeta w s + w^2. The rate is limited by holding
    what the position term asks for, w (target - psi_d) / (2 zeta + 1), to ``rate_limit``; what
    would still overshoot (0.4 % at zeta = 1) is cut off. Without the limit acting the model is
    linear. The difference target - psi_d is wrapped to +-pi: it turns the shorter way.

    Integrated with the classical Runge-Kutta method of order 4, one step per ``period``, the
    target held. ``heading`` and ``rate`` react to the target one period later; ``heading``
    counts any number of turns.

    While it is not ``engaged``, it is where the craft is: at ``measured_heading``, turning at
    ``measured_rate`` (within the limit) without acceleration. So an autopilot that is engaged
    after a person has steered begins where the craft is.

    rad, clockwise from north; rad/s, to starboard positive.
    """

    period = Parameter(0.1, "s", "sample period", min=1e-6)
    natural_frequency = Parameter(0.1, "rad/s", "w", min=1e-9, tunable=True)
    damping_ratio = Parameter(1.0, "1", "zeta", min=1e-9, tunable=True)
    rate_limit = Parameter(0.02, "rad/s", "largest rate of turn", min=1e-9, tunable=True)
    heading_start = Parameter(0.0, "rad", "heading at the start, where the model is at rest")

    target = Input("rad", "course wanted, clockwise from north")
    engaged = Input("1", "whether an autopilot follows it", type=bool, start=True, optional=True)
    measured_heading = Input("rad", "heading of the craft, clockwise from north", optional=True)
    measured_rate = Input("rad/s", "rate of turn of the craft, to starboard", optional=True)

    heading = Output("rad", "heading to follow, clockwise from north, any number of turns")
    rate = Output("rad/s", "its derivative, to starboard positive")

    terminals: ClassVar = {
        "wanted": terminal(heading_wanted="target", heading_engaged="engaged"),
        "sensors": terminal(heading="measured_heading", yaw_rate="measured_rate"),
        "reference": terminal(heading_wanted="heading", yaw_rate_wanted="rate"),
    }

    def reset(self, t: float) -> None:
        """Start at rest."""
        self._motion: _Motion = (self.heading_start, 0.0, 0.0)

    def sample(self, t: float, k: int) -> None:
        """Publish heading and rate."""
        self.heading, self.rate, _ = self._now()

    def update(self, t: float, k: int) -> None:
        """Integrate over a period."""
        h, x = self.period, self._now()
        k1 = self._slope(x)
        k2 = self._slope(_moved(x, k1, 0.5 * h))
        k3 = self._slope(_moved(x, k2, 0.5 * h))
        k4 = self._slope(_moved(x, k3, h))
        mean = [
            (a + 2.0 * b + 2.0 * c + d) / 6.0 for a, b, c, d in zip(k1, k2, k3, k4, strict=True)
        ]
        psi, rate, acceleration = _moved(x, mean, h)
        if abs(rate) > self.rate_limit:
            rate, acceleration = math.copysign(self.rate_limit, rate), 0.0
        self._motion = psi, rate, acceleration

    def _now(self) -> _Motion:
        if self.engaged:
            return self._motion
        rate = min(max(self.measured_rate, -self.rate_limit), self.rate_limit)
        return self.measured_heading, rate, 0.0

    def _slope(self, motion: _Motion) -> _Motion:
        psi, rate, acceleration = motion
        w, spread = self.natural_frequency, 2.0 * self.damping_ratio + 1.0
        wanted = w * math.remainder(self.target - psi, math.tau) / spread
        wanted = min(max(wanted, -self.rate_limit), self.rate_limit)
        return rate, acceleration, spread * w * (w * (wanted - rate) - acceleration)


def _moved(x: _Motion, slope: tuple[float, ...] | list[float], h: float) -> _Motion:
    """Return x + h slope."""
    return x[0] + h * slope[0], x[1] + h * slope[1], x[2] + h * slope[2]
