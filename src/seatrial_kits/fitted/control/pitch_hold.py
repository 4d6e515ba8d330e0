"""Base of depth control by the pitch of an underwater vehicle."""

from __future__ import annotations

from typing import ClassVar

from seatrial.control.axis_hold import AxisHold
from seatrial.control.guidance_orders import MANUAL_AXES
from seatrial.model.component import Input, Output, Parameter, terminal


class PitchHold(AxisHold):
    """Base that holds a pitch with the law of `AxisHold`; a subclass orders it in `_for_depth`.

    While the depth is not engaged but the heading is, the pitch ordered is that of manual heave,
    -direct.heave ``pitch_limit``: bow down to dive. With neither the moment itself is
    -direct.heave ``capacity``; integrals are 0, and the target is where the vehicle is.
    """

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
    pitch_limit = Parameter(0.5, "rad", "largest pitch ordered", min=0.0, max=1.5, tunable=True)

    engaged = Input("1", "which autopilots act", type=bool, axes=("speed", "heading", "depth"))
    direct = Input("1", "manual control, -1 to 1", axes=MANUAL_AXES)
    depth_wanted = Input("m", "depth wanted, positive down")
    depth = Input("m", "measured depth, positive down")
    depth_valid = Input("1", "whether the depth is one", type=bool, start=True, optional=True)
    pitch = Input("rad", "measured pitch, bow up")

    pitch_moment = Output("N.m", "pitch moment asked for, positive bow up")
    pitch_ordered = Output("rad", "pitch that is to be held, bow up")

    terminals: ClassVar = {
        "wanted": terminal("engaged", "direct", "depth_wanted"),
        "sensors": terminal("depth", "depth_valid", "pitch"),
        "demanded": terminal("surge"),
        "held": terminal("pitch_moment"),
    }

    def _for_depth(self) -> float:
        """Return the pitch that leads to the depth wanted."""
        raise TypeError(f"{type(self).__name__} does not define how it comes to a depth")

    def sample(self, t: float, k: int) -> None:
        """Command the pitch moment."""
        held = self._limited(self._demanded())
        self.pitch_moment = held if self._acts() else -self.capacity * self._manual()
        self.pitch_ordered = self._ordered()

    def update(self, t: float, k: int) -> None:
        """Advance integral, filtered rate and target; forget them while nothing is engaged."""
        if self._waits():
            return
        super().update(t, k)
        if not self._acts():
            self._integral, self._target = 0.0, None

    def _acts(self) -> bool:
        """Return whether the pitch is held."""
        _, heading, depth = self.engaged
        return bool(heading or depth)

    def _manual(self) -> float:
        return clip(self.direct[3], 1.0)

    def _ordered(self) -> float:
        """Return the pitch that is to be held."""
        if self._waits():
            return 0.0
        if not self.engaged[2]:
            manual: float = -self.pitch_limit * self._manual()
            return manual
        return clip(self._for_depth(), self.pitch_limit)

    def _axis(self) -> tuple[float, float, float]:
        return self.inertia, self.capacity, self.rate_limit

    def _is_valid(self) -> bool:
        valid: bool = self.depth_valid
        return valid

    def _places(self) -> tuple[float, float]:
        return self._ordered(), self.pitch


def clip(x: float, most: float) -> float:
    """Return ``x`` held within +-``most``."""
    return min(max(x, -most), most)
