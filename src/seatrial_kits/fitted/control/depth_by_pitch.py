"""Depth of an underwater vehicle under way, held by its pitch."""

from __future__ import annotations

from typing import ClassVar

from seatrial.model.component import Input, Parameter, terminal

from .pitch_hold import PitchHold, clip


class DepthByPitch(PitchHold):
    """Depth hold by the pitch of a vehicle that dives under way: pitch moment, in two loops.

    **Depth.** With e = depth - depth_wanted and z' = -U sin(pitch), U = ``speed``, at least
    ``least_speed``, the pitch that is ordered is

        pitch_ordered = clip(clip(Kp e) + I),    I' = Ki e where Kp e is not clipped, else 0

    clip(x) = x held within +-``pitch_limit``; back-calculation at the rate Ki / Kp removes from I
    what that cuts off. Where the pitch follows at once the poles are those of (s + w) (s + sigma),
    w = ``depth_frequency``, sigma = ``depth_integral_pole`` (0 for no integral action):

        Kp = (w + sigma) / U,   Ki = w sigma / U

    I finds the pitch that weight, buoyancy and lift need for a level course.

    **Pitch.** The law of `AxisHold` for ``inertia`` holds the pitch ordered, with
    ``natural_frequency``, ``damping_ratio`` and ``integral_pole``; its target turns at no more
    than ``rate_limit``. Take w a fifth of the natural frequency or less.

    While the depth is not engaged but the heading is, the pitch ordered is that of manual heave,
    -direct.heave ``pitch_limit``: nose down to dive. With neither the moment itself is:
    -direct.heave ``capacity``; both integrals are 0, and the target is where the vehicle is.

    Depths m, positive down; pitch rad, bow up; moment N.m, positive bow up. ``engaged``, ``direct``
    and ``speed`` are those of `Guidance`, the speed over ground in place of that through the water.

    Defaults: a torpedo of 1.6 m and 32 kg, such as REMUS-100, at 1.5 m/s.
    """

    exercised: ClassVar = {"capacity": 1e12, "rate_limit": 1e9, "damping_per_speed": 0.7}

    depth_frequency = Parameter(0.2, "rad/s", "w of the depth", min=1e-9, tunable=True)
    depth_integral_pole = Parameter(0.02, "rad/s", "sigma of the depth", min=0.0, tunable=True)
    least_speed = Parameter(0.5, "m/s", "least speed that the gains are for", min=1e-3)

    speed = Input("m/s", "speed ahead")

    terminals: ClassVar = {
        **PitchHold.terminals,
        "wanted": terminal("engaged", "direct", "depth_wanted", "speed"),
    }

    def reset(self, t: float) -> None:
        """Start with no integral, at rest."""
        super().reset(t)
        self._learnt = 0.0

    def update(self, t: float, k: int) -> None:
        """Advance integrals, filtered rate and target; forget them while nothing is engaged."""
        learnt = self._learnt + self.period * self._learning()
        waits = self._waits()
        super().update(t, k)
        if not waits:
            self._learnt = learnt if self.engaged[2] else 0.0

    def _for_depth(self) -> float:
        return clip(self._stiff(), self.pitch_limit) + self._learnt

    def _stiff(self) -> float:
        """Return Kp e."""
        w, sigma = self.depth_frequency, self.depth_integral_pole
        gain = (w + sigma) / max(abs(self.speed), self.least_speed)
        stiff: float = gain * (self.depth - self.depth_wanted)
        return stiff

    def _learning(self) -> float:
        """Return the rate of the depth's integral, rad/s."""
        w, sigma, most = self.depth_frequency, self.depth_integral_pole, self.pitch_limit
        stiff, rate = self._stiff(), w * sigma / (w + sigma)
        clipped = clip(stiff, most)
        cut_off = self._ordered() - clipped - self._learnt
        return float(rate * ((stiff if stiff == clipped else 0.0) + cut_off))
