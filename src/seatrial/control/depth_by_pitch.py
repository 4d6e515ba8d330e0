"""Depth of an underwater vehicle under way, held by its pitch."""

from __future__ import annotations

from typing import ClassVar

from ..model.component import Input, Output, Parameter, terminal
from .axis_hold import AxisHold
from .guidance_orders import MANUAL_AXES


class DepthByPitch(AxisHold):
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

    natural_frequency = Parameter(1.2, "rad/s", "w of the pitch", min=1e-9, tunable=True)
    damping_ratio = Parameter(0.9, "1", "zeta of the pitch", min=0.0, tunable=True)
    integral_pole = Parameter(0.2, "rad/s", "sigma of the pitch", min=0.0, tunable=True)
    inertia = Parameter(8.0, "kg.m2", "inertia in pitch with added inertia", min=1e-9)
    capacity = Parameter(3.0, "N.m", "largest moment", min=0.0, tunable=True)
    rate_limit = Parameter(0.3, "rad/s", "largest rate of the pitch wanted", min=1e-9, tunable=True)
    damping = Parameter(0.0, "N.m.s/rad", "damping in pitch at rest", min=0.0, tunable=True)
    damping_per_speed = Parameter(
        0.0, "N.m.s2/(rad.m)", "damping in pitch per speed ahead", min=0.0, tunable=True
    )
    depth_frequency = Parameter(0.2, "rad/s", "w of the depth", min=1e-9, tunable=True)
    depth_integral_pole = Parameter(0.02, "rad/s", "sigma of the depth", min=0.0, tunable=True)
    pitch_limit = Parameter(0.5, "rad", "largest pitch ordered", min=0.0, max=1.5, tunable=True)
    least_speed = Parameter(0.5, "m/s", "least speed that the gains are for", min=1e-3)

    engaged = Input("1", "which autopilots act", type=bool, axes=("speed", "heading", "depth"))
    direct = Input("1", "manual control, -1 to 1", axes=MANUAL_AXES)
    depth_wanted = Input("m", "depth to hold, positive down")
    speed = Input("m/s", "speed ahead")
    depth = Input("m", "measured depth, positive down")
    depth_valid = Input("1", "whether the depth is one", type=bool, start=True, optional=True)
    pitch = Input("rad", "measured pitch, bow up")

    pitch_moment = Output("N.m", "pitch moment asked of fins and thrusters, positive bow up")
    pitch_ordered = Output("rad", "pitch that is to be held, bow up")

    terminals: ClassVar = {
        "wanted": terminal("engaged", "direct", "depth_wanted", "speed"),
        "sensors": terminal("depth", "depth_valid", "pitch"),
        "demanded": terminal("surge"),
        "held": terminal("pitch_moment"),
    }

    def reset(self, t: float) -> None:
        """Start with no integral, at rest."""
        super().reset(t)
        self._learnt = 0.0

    def sample(self, t: float, k: int) -> None:
        """Command the pitch moment."""
        held = self._limited(self._demanded())
        self.pitch_moment = held if self._acts() else -self.capacity * self._manual()
        self.pitch_ordered = self._ordered()

    def update(self, t: float, k: int) -> None:
        """Advance integrals, filtered rate and target; forget them while nothing is engaged."""
        if self._waits():
            return
        learnt = self._learnt + self.period * self._learning()
        super().update(t, k)
        self._learnt = learnt if self.engaged[2] else 0.0
        if not self._acts():
            self._integral, self._target = 0.0, None

    def _acts(self) -> bool:
        """Return whether the pitch is held."""
        _, heading, depth = self.engaged
        return bool(heading or depth)

    def _manual(self) -> float:
        return _clip(self.direct[3], 1.0)

    def _ordered(self) -> float:
        """Return the pitch that is to be held."""
        most: float = self.pitch_limit
        if self._waits():
            return 0.0
        if not self.engaged[2]:
            return -most * self._manual()
        return _clip(_clip(self._stiff(), most) + self._learnt, most)

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
        clipped = _clip(stiff, most)
        cut_off = self._ordered() - clipped - self._learnt
        return float(rate * ((stiff if stiff == clipped else 0.0) + cut_off))

    def _axis(self) -> tuple[float, float, float]:
        return self.inertia, self.capacity, self.rate_limit

    def _is_valid(self) -> bool:
        valid: bool = self.depth_valid
        return valid

    def _places(self) -> tuple[float, float]:
        return self._ordered(), self.pitch


def _clip(x: float, most: float) -> float:
    return min(max(x, -most), most)
