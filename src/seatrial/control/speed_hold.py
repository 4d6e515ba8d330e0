"""Speed hold of a craft by its propulsion."""

from __future__ import annotations

from typing import ClassVar

from ..model.component import Input, Output, Parameter, terminal
from ..model.sampled import Sampled


class SpeedHold(Sampled):
    """PI control of the speed along the bow: surge force, with the drag fed forward.

        X = clip(2 zeta w m e + I + d1 U + d2 |U| U),   I' = w^2 m e,   e = U - u

    U is ``speed_wanted``, u ``speed``; clip(x) = x held within +-capacity; back-calculation at
    the rate w / (2 zeta) removes from I what that cuts off. Where m, d1 and d2 are the craft's,
    the poles about a steady U are those of s^2 + (2 zeta w + (d1 + 2 d2 |U|) / m) s + w^2.
    A steady force (a current, wind) ends up in I. Not ``enabled``: X = 0 and I = 0.

    The same holds a speed to starboard: with mass and drag of sway, ``wanted_abeam`` of `Guidance`
    and X as sway force.

    Speeds m/s over ground, so that a current is taken for a drag that is wrong; X N, positive
    ahead. Not modelled: lags of thrusters and sensors; keep w well below their inverse.

    Defaults: the Hydrone catamaran with surge's added mass, variant ``physical``, and a third
    of its thrust.
    """

    exercised: ClassVar = {"capacity": 1e12}

    period = Parameter(0.1, "s", "sample period", min=1e-6)
    natural_frequency = Parameter(0.4, "rad/s", "w", min=1e-9, tunable=True)
    damping_ratio = Parameter(1.0, "1", "zeta", min=1e-9, tunable=True)
    mass = Parameter(23.087, "kg", "mass with added mass in surge", min=1e-9)
    linear_drag = Parameter(2.0, "N.s/m", "d1", min=0.0, tunable=True)
    quadratic_drag = Parameter(24.6, "N.s2/m2", "d2", min=0.0, tunable=True)
    capacity = Parameter(35.0, "N", "largest force", min=0.0, tunable=True)

    enabled = Input("1", "whether to act", type=bool)
    speed_wanted = Input("m/s", "speed to hold, along the bow")
    speed = Input("m/s", "measured speed along the bow")

    surge = Output("N", "surge force asked of the thrusters, positive ahead")

    terminals: ClassVar = {
        "wanted": terminal("speed_wanted", "speed", speed_engaged="enabled"),
        "held": terminal("surge"),
    }

    def reset(self, t: float) -> None:
        """Start with no integral."""
        self._integral = 0.0

    def sample(self, t: float, k: int) -> None:
        """Command the surge force."""
        self.surge = self._limited(self._demanded()) if self.enabled else 0.0

    def update(self, t: float, k: int) -> None:
        """Advance the integral."""
        if not self.enabled:
            self._integral = 0.0
            return
        w, demand = self.natural_frequency, self._demanded()
        cut_off = (self._limited(demand) - demand) * w / (2.0 * self.damping_ratio)
        grown = w * w * self.mass * (self.speed_wanted - self.speed) + cut_off
        self._integral += self.period * grown

    def _demanded(self) -> float:
        """Return the force before it is limited."""
        wanted = self.speed_wanted
        gain = 2.0 * self.damping_ratio * self.natural_frequency * self.mass
        drag = (self.linear_drag + self.quadratic_drag * abs(wanted)) * wanted
        demanded: float = gain * (wanted - self.speed) + self._integral + drag
        return demanded

    def _limited(self, force: float) -> float:
        most: float = self.capacity
        return min(max(force, -most), most)
