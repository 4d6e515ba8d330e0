"""Base of PID control of one axis of a vehicle, with limits."""

from __future__ import annotations

import math

from ..model.component import Input, Parameter
from ..model.sampled import Sampled


class AxisHold(Sampled):
    """Base of PID control of one axis of mass m, from a measured position y alone.

    A target goes from y at the start to the position wanted, at no more than ``rate_limit``, so
    that a long way fills no integral. With g its rate and f that of y, by differences and
    low-passed:

        demand = clip(Kp (target - y) + Kd (g - f) + D g + I),   I' = Ki (target - y)
        f_k = a f_(k-1) + (1 - a) (y_k - y_(k-1)) / period,   a = exp(-period / rate_filter)

    clip(x) = x held within +-capacity; back-calculation at the rate Ki / Kp removes from I what
    that cuts off. Without lags the loop has the poles of (s + sigma) (s^2 + 2 zeta w s + w^2),
    w = ``natural_frequency``, zeta = ``damping_ratio``, sigma = ``integral_pole`` (0 for no
    integral action):

        Kd = m (2 zeta w + sigma)
        Kp = m (w^2 + 2 zeta w sigma) + a D
        Ki = m w^2 sigma + a sigma D

    D is what the vehicle itself damps the axis with, which grows with its speed ahead or astern:

        D = D0 + D1 |U_k|,   U_k = b U_(k-1) + (1 - b) U(X_k),   b = exp(-period / speed_lag)
        U(X) = full_speed sgn(X) sqrt(|X| / full_surge), clipped to full_speed

    D0 = ``damping``, D1 = ``damping_per_speed``, a = ``damping_rate``; U is estimated from the
    surge force X that is asked of the thrusters. A moving target needs D g, and a position gain
    that grows with D lets an error go as quickly at speed as at rest. All are 0 by default.

    What is steady (weight that buoyancy does not balance, a tether's pull, a current) ends up in
    I. Not modelled: lags of thrusters and sensors; keep w well below their inverse.

    It waits for the first measurement that is valid, with no demand. One that is lost later
    leaves the last one.

    Gains may change at any step: I is kept as a demand, so that what it holds stays.

    A subclass declares mass, capacity, ``damping``, ``damping_per_speed``, inputs and the demand,
    and defines in `_axis` and `_places` what they are.
    """

    damping: float
    damping_per_speed: float

    period = Parameter(0.1, "s", "sample period", min=1e-6)
    natural_frequency = Parameter(1.0, "rad/s", "w", min=1e-9, tunable=True)
    damping_ratio = Parameter(1.0, "1", "zeta", min=0.0, tunable=True)
    integral_pole = Parameter(0.1, "rad/s", "sigma", min=0.0, tunable=True)
    rate_filter = Parameter(0.2, "s", "time constant of the filtered rate", min=0.0, tunable=True)
    damping_rate = Parameter(0.0, "rad/s", "a, position gain per damping", min=0.0, tunable=True)
    full_surge = Parameter(93.4, "N", "surge force at full speed", min=1e-9)
    full_speed = Parameter(2.16, "m/s", "speed that the full surge force gives", min=0.0)
    speed_lag = Parameter(0.45, "s", "time constant of the estimated speed", min=0.0)

    surge = Input("N", "surge force asked of the thrusters, positive ahead", optional=True)

    def _axis(self) -> tuple[float, float, float]:
        """Return mass, capacity and the limit of the target's rate."""
        raise TypeError(f"{type(self).__name__} does not define which axis it holds")

    def _places(self) -> tuple[float, float]:
        """Return the position wanted and the one measured."""
        raise TypeError(f"{type(self).__name__} does not define what it holds")

    def _is_valid(self) -> bool:
        """Return whether the position measured is one."""
        return True

    def _apart(self, a: float, b: float) -> float:
        """Return position a less position b."""
        return a - b

    def reset(self, t: float) -> None:
        """Start with no integral, at rest."""
        self._integral = self._rate = self._speed = 0.0
        # Nothing has been measured yet.
        self._before: float | None = None
        self._target: float | None = None

    def update(self, t: float, k: int) -> None:
        """Advance integral, filtered rate and target."""
        if self._waits():
            return
        wanted, rate, error = self._demanded(), self._filtered_rate(), self._error()
        kp, _, ki = self._gains()
        cut_off = (self._limited(wanted) - wanted) / kp
        self._integral += self.period * ki * (error + cut_off)
        target = self._at() + self.period * self._target_rate()
        self._speed = self._estimated_speed()
        self._rate, self._before, self._target = rate, self._places()[1], target

    def _demanded(self) -> float:
        """Return the demand before it is limited."""
        if self._waits():
            return 0.0
        kp, kd, _ = self._gains()
        g = self._target_rate()
        damping = kd * (g - self._filtered_rate()) + self._damping() * g
        demanded: float = kp * self._error() + damping + self._integral
        return demanded

    def _waits(self) -> bool:
        """Return whether nothing has been measured yet."""
        return self._before is None and not self._is_valid()

    def _gains(self) -> tuple[float, float, float]:
        """Return Kp, Kd and Ki."""
        w, zeta, sigma = self.natural_frequency, self.damping_ratio, self.integral_pole
        m, _, _ = self._axis()
        own = self.damping_rate * self._damping()
        kp = m * (w * w + 2.0 * zeta * w * sigma) + own
        return kp, m * (2.0 * zeta * w + sigma), m * w * w * sigma + own * sigma

    def _damping(self) -> float:
        """Return D, the vehicle's own damping at its speed."""
        return self.damping + self.damping_per_speed * abs(self._estimated_speed())

    def _estimated_speed(self) -> float:
        """Return the speed ahead as estimated from the surge force."""
        share = min(max(self.surge / self.full_surge, -1.0), 1.0)
        goal = self.full_speed * math.copysign(math.sqrt(abs(share)), share)
        kept = math.exp(-self.period / self.speed_lag) if self.speed_lag else 0.0
        estimated: float = goal + (self._speed - goal) * kept
        return estimated

    def _limited(self, demand: float) -> float:
        _, most, _ = self._axis()
        return min(max(demand, -most), most)

    def _at(self) -> float:
        """Return the target as it is now."""
        target: float = self._places()[1] if self._target is None else self._target
        return target

    def _error(self) -> float:
        return self._apart(self._at(), self._places()[1])

    def _target_rate(self) -> float:
        """Return the rate of the target until the next instant."""
        _, _, fastest = self._axis()
        needed: float = self._apart(self._places()[0], self._at()) / self.period
        return min(max(needed, -fastest), fastest)

    def _filtered_rate(self) -> float:
        if self._before is None:
            return 0.0
        rate = self._apart(self._places()[1], self._before) / self.period
        kept = math.exp(-self.period / self.rate_filter) if self.rate_filter else 0.0
        filtered: float = rate + (self._rate - rate) * kept
        return filtered
