"""Saw-tooth and turns of an underwater glider by its buoyancy engine and its moving mass."""

from __future__ import annotations

from typing import ClassVar

from seatrial.errors import InputError
from seatrial.model.component import Input, Output, Parameter, terminal

from .pitch_hold import PitchHold, clip

_SURFACE = 0.5
"""m: a depth wanted that is less is the surface."""


class GlideControl(PitchHold):
    """Dives and climbs between two depths, the pitch held by a moving mass: a glider's yo.

    It dives until ``depth`` reaches the deeper of ``depth_wanted`` and ``dive_to``, then climbs
    until it is back at ``climb_to``, and so on; a ``depth_wanted`` of less than 0.5 m is the
    surface, where it floats. Speed and glide path follow:

        ========  =========================  ====================
        state     buoyancy_order             pitch_ordered
        ========  =========================  ====================
        dives     -``buoyancy``              -``glide_pitch``
        climbs    +``buoyancy``              +``glide_pitch``
        ========  =========================  ====================

    **Pitch.** The law of `AxisHold` for ``inertia`` holds the pitch ordered by a moment, which a
    mass m ahead of its middle by x gives on an even keel as -m g x:

        mass_order = -pitch_moment / ``capacity``,   capacity = m g times the largest x

    **Turns.** The mass to starboard banks it to starboard, and a bank turns it: in a dive, bow down
    and lift upwards, the same way, in a climb the other way. Level it does not turn:

        roll_order = clip(yaw_moment / ``yaw_capacity``) clip(-pitch / ``glide_pitch``)

    clip(x) = x held within +-1.

    While the depth is not engaged the buoyancy ordered is -direct.heave, and the pitch as
    `PitchHold` says: of a glider that is not armed all rest in the middle.

    Depths m, positive down; pitch rad, bow up; yaw moment N.m, positive to starboard.
    ``buoyancy_order`` 1 is the most volume, ``mass_order`` 1 the mass furthest ahead,
    ``roll_order`` 1 furthest to starboard. ``engaged``, ``direct`` and ``depth_wanted`` are those
    of `Guidance`; its speeds are not followed.

    Raises InputError at the start for a ``climb_to`` that is not above ``dive_to``.

    Not modelled: a turn ahead of the depth, by as much as the pump takes; trim of the ballast by
    the rate of change of the depth.

    Defaults: a glider of 50 kg and 1.5 m, as Slocum.
    """

    exercised: ClassVar = {
        "capacity": 1e12,
        "rate_limit": 1e9,
        "damping_per_speed": 0.7,
        "climb_to": 0.1,
        "dive_to": 0.2,
        "pitch": 0.2,
        "depth_wanted": 0.6,
    }

    natural_frequency = Parameter(0.5, "rad/s", "w of the pitch", min=1e-9, tunable=True)
    integral_pole = Parameter(0.3, "rad/s", "sigma of the pitch", min=0.0, tunable=True)
    rate_filter = Parameter(1.0, "s", "time constant of the filtered rate", min=0.0, tunable=True)
    inertia = Parameter(12.0, "kg.m2", "inertia in pitch with added inertia", min=1e-9)
    capacity = Parameter(4.4, "N.m", "moment of the mass at its largest travel", min=1e-9)
    rate_limit = Parameter(
        0.02, "rad/s", "largest rate of the pitch wanted", min=1e-9, tunable=True
    )
    climb_to = Parameter(3.0, "m", "depth from which on it dives again", min=0.0, tunable=True)
    dive_to = Parameter(20.0, "m", "least depth to which it dives", min=0.0, tunable=True)
    glide_pitch = Parameter(0.4, "rad", "pitch of a glide", min=0.05, max=1.5, tunable=True)
    buoyancy = Parameter(
        0.5, "1", "share of the buoyancy engine in a glide", min=0.0, max=1.0, tunable=True
    )
    yaw_capacity = Parameter(
        0.66, "N.m", "yaw moment of the bank at the mass's largest sideways travel", min=1e-9
    )

    yaw_moment = Input("N.m", "yaw moment wanted, positive to starboard", optional=True)

    buoyancy_order = Output("1", "share of the buoyancy engine, -1 to 1, 1 the most volume")
    mass_order = Output("1", "share of the moving mass's travel, -1 to 1, 1 furthest ahead")
    roll_order = Output("1", "share of its sideways travel, -1 to 1, 1 furthest to starboard")
    dives = Output("1", "whether it dives", type=bool)

    terminals: ClassVar = {**PitchHold.terminals, "demand": terminal("yaw_moment")}

    def reset(self, t: float) -> None:
        """Start with a dive, at rest; raises InputError for depths that do not go together."""
        if not self.climb_to < self.dive_to:
            raise InputError(
                f"{self.name}.climb_to is {self.climb_to!r} m, "
                f"not above dive_to, {self.dive_to!r} m"
            )
        super().reset(t)
        self._dived = True

    def sample(self, t: float, k: int) -> None:
        """Command buoyancy engine and moving mass."""
        super().sample(t, k)
        self.dives = self._dives()
        self.buoyancy_order = self._buoyancy()
        self.mass_order = -clip(self.pitch_moment / self.capacity, 1.0)
        banked = clip(self.yaw_moment / self.yaw_capacity, 1.0)
        self.roll_order = -banked * clip(self.pitch / self.glide_pitch, 1.0)

    def update(self, t: float, k: int) -> None:
        """Advance the pitch, and remember whether it dives."""
        dives = self._dives()
        super().update(t, k)
        self._dived = dives

    def _buoyancy(self) -> float:
        """Return the order to the buoyancy engine."""
        if not self.engaged[2]:
            return -self._manual()
        if self._waits():
            return 0.0
        share: float = self.buoyancy
        return -share if self._dives() else share

    def _dives(self) -> bool:
        """Return whether it is to dive: as before between the two depths."""
        surfaces = self.depth_wanted < _SURFACE
        if surfaces or self.depth >= max(self.depth_wanted, self.dive_to):
            return False
        return bool(self._dived or self.depth <= self.climb_to)

    def _for_depth(self) -> float:
        pitch: float = self.glide_pitch
        return -pitch if self._dives() else pitch
