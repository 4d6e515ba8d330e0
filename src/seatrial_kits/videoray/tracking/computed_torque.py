"""Computed-torque control of a vessel's velocities, with integral action."""

from __future__ import annotations

from typing import ClassVar

from seatrial.model.component import Parameter

from .vessel_tracking import VesselTracking


class ComputedTorque(VesselTracking):
    """Computed torque in surge and yaw: each error decays with the poles of s^2 + kp s + ki.

    With e_u = u - U and e_r = r - R, and I_u, I_r their integrals:

        a_u = U' - kp e_u - ki I_u,            a_r = R' - kp e_r - ki I_r
        X = m11 a_u + d11 u - m22 v r,         N = m33 a_r + d33 r - s (m11 - m22) u v
        t1 = (X + N / l) / (2 E1),             t2 = (X - N / l) / (2 E2)

    The thrusts act on u' and r' directly, so that this linearises both exactly, whatever U
    and R; sway follows, damped by d22. The integrals grow by e ``period`` after each instant at
    which no thruster is at its limit, and a constant force ahead or moment leaves no error.
    Ours: [Paulino2015] has the law of `FlatTracking`, which this one replaces.

    A force abeam cannot be balanced, and v stays off by Y / d22. A sensor of v or r that errs
    is believed: v enters the product m22 v r, and an error of 1 m/s in it makes a light
    vehicle run away.
    """

    exercised: ClassVar = {"mass": [8.44, 12.55, 0.133], "command_limit": 1e9}
    # The plan does not follow from what is measured, whatever the law compares it with.
    feedthrough: ClassVar = dict.fromkeys(("nominal", "nominal_command"), ())

    kp = Parameter(2.0, "1/s", "rate against the error", min=0.0)
    ki = Parameter(1.0, "1/s2", "rate against its integral, 0 for none", min=0.0)

    def reset(self, t: float) -> None:
        """Start with no integrals."""
        super().reset(t)
        self._integral = [0.0, 0.0]

    def demand(self, k: int) -> tuple[float, float]:
        """Return the commands of the law."""
        model, row = self.vessel(), self._row(k)
        accelerations = (row.acceleration[0], row.acceleration[2])
        surge, yaw = (
            wanted - self.kp * error - self.ki * learnt
            for wanted, error, learnt in zip(
                accelerations, self._errors(k), self._integral, strict=True
            )
        )
        return model.commands(*model.loads(self._measured(), surge, yaw))

    def update(self, t: float, k: int) -> None:
        """Advance the integrals."""
        if not self._saturated(k):
            pairs = zip(self._integral, self._errors(k), strict=True)
            self._integral = [learnt + self.period * error for learnt, error in pairs]

    def _errors(self, k: int) -> tuple[float, float]:
        """Return u - U, m/s, and r - R, rad/s."""
        (u, _v, r), (U, _V, R) = self._measured(), self._row(k).velocity
        return u - U, r - R
