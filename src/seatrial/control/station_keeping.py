"""Station keeping of a craft with surge force and yaw moment, but no sway force."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from ..errors import InputError
from ..model.component import Input, Output, Parameter, terminal
from ..model.sampled import Sampled
from .allocation.twin_thrusters import TwinThrusters
from .estimates import is_lost
from .guidance_orders import SENSED

IDLE, HOLD, RETURN, HEADING_ONLY = range(4)
"""Values of the output ``mode``."""

_NED = ("north", "east", "down")


@dataclass(frozen=True)
class _Decision:
    """What follows from the inputs and the memory at one instant. SI, angles in rad."""

    mode: int
    backwards: bool
    surge_error: float
    heading_error: float
    wanted_surge: float
    wanted_moment: float
    surge: float
    moment: float


class StationKeeping(Sampled, TwinThrusters):
    """Autopilot holding position and heading with two fixed thrusters, port and starboard.

    The pair makes a surge force X and a yaw moment N; no sway force. Hence two modes:

    - **hold**, within ``hold_radius`` of the station: keep ``station_heading``; correct the
      position error along the bow only. An error abeam stays until it reaches the radius.
    - **return**, from ``hold_radius`` outwards until within ``capture_radius``: point the bow
      or the stern, whichever is nearer on entry, at the station and drive there, less hard
      the further off it points.

    Against a steady force abeam the craft therefore works in a cycle of drift and return.
    Choose the radii above the noise of the position and, if you can, a heading into the weather.

    With e_x the position error along the bow, limited to +-``reach``, e_psi the heading error
    wrapped to +-pi, u the speed along the bow (from ``velocity_n``), r the yaw rate:

        X = surge_gain e_x a + X_I - surge_damping u,   a = max(0, cos(e_psi)) in return, else 1
        N = yaw_gain e_psi + N_I - yaw_damping r

    limited to ``surge_limit`` and ``moment_limit`` and to what the thrusters can give, moment
    first. The integral terms grow at surge_integral e_x a (within ``hold_radius`` only) and
    yaw_integral e_psi, and back-calculation at the rate integral / gain removes what was cut
    off. X_I is kept in north and east, so that the integral of wind and current stays valid
    when the craft turns.

    Allocation and thrust to pulse as in `TwinThrusters`.

    **Safety**: starts idle; ``enabled`` false gives neutral pulses and clears the integrals, as
    does a heading not valid for longer than ``timeout``. A position not valid for that long
    leaves the heading held and the surge at 0 (mode 3). Both are lost until first valid.

    Frames: positions and velocities north-east-down, m and m/s; headings rad clockwise from
    north, any number of turns; ``yaw_rate`` rad/s positive to starboard; pulses s. Gains are
    tuned for a 22 kg catamaran (added mass 1.1 kg, yaw inertia 5.8 kg m2, nearly no yaw
    damping): about 0.6 rad/s in surge, 1.2 rad/s in yaw, near-critical damping.

    Raises InputError at the start if capture_radius is not less than hold_radius, or the
    pulses do not rise.
    """

    exercised: ClassVar = {
        "enabled": True,
        "hold_radius": 2.0,
        "surge_gain": 40.0,
        "surge_limit": 200.0,
        "moment_limit": 100.0,
    }

    period = Parameter(0.05, "s", "sample period", min=1e-6)
    hold_radius = Parameter(1.0, "m", "distance at which it starts to return", tunable=True)
    capture_radius = Parameter(0.3, "m", "distance at which it has returned", tunable=True)
    reach = Parameter(3.0, "m", "position error beyond which X grows no more", tunable=True)
    surge_gain = Parameter(8.0, "N/m", "X per position error", min=1e-9, tunable=True)
    surge_integral = Parameter(1.0, "N/(m.s)", "rate of X_I per position error", tunable=True)
    surge_damping = Parameter(25.0, "N.s/m", "X against speed along the bow", tunable=True)
    yaw_gain = Parameter(9.0, "N.m/rad", "N per heading error", min=1e-9, tunable=True)
    yaw_integral = Parameter(2.0, "N.m/(rad.s)", "rate of N_I per heading error", tunable=True)
    yaw_damping = Parameter(12.0, "N.m.s/rad", "N against yaw rate", tunable=True)
    surge_limit = Parameter(30.0, "N", "largest surge force", min=0.0, tunable=True)
    moment_limit = Parameter(12.0, "N.m", "largest yaw moment", min=0.0, tunable=True)
    timeout = Parameter(1.0, "s", "longest time without valid heading or position", min=0.0)

    enabled = Input("1", "whether to act (armed)", type=bool)
    station = Input("m", "position to hold", axes=("north", "east"))
    station_heading = Input("rad", "heading to hold, clockwise from north")
    position_n = Input("m", "position, north-east-down", axes=_NED)
    velocity_n = Input("m/s", "velocity over ground, north-east-down", axes=_NED)
    position_valid = Input("1", "whether position and velocity are valid", type=bool, start=True)
    heading = Input("rad", "heading, clockwise from north")
    heading_valid = Input("1", "whether the heading is valid", type=bool, start=True)
    yaw_rate = Input("rad/s", "yaw rate, positive to starboard")

    surge_force = Output("N", "surge force asked of the thrusters, positive ahead")
    yaw_moment = Output("N.m", "yaw moment asked of the thrusters, positive to starboard")
    distance = Output("m", "horizontal distance from the station")
    mode = Output("1", "0 idle, 1 hold, 2 return, 3 heading only", type=int)

    feedthrough: ClassVar = {
        "distance": ("station", "position_n"),
        "mode": ("enabled", "station", "position_n", "position_valid", "heading_valid"),
    }
    terminals: ClassVar = {
        **TwinThrusters.terminals,
        "orders": terminal(armed="enabled"),
        "sensors": terminal(*SENSED, "yaw_rate"),
        "held": terminal("yaw_moment", surge="surge_force"),
    }

    # ------------------------------------------------------------------ running

    def reset(self, t: float) -> None:
        """Start idle; raises InputError for radii or pulses out of order."""
        if not self.capture_radius < self.hold_radius:
            raise InputError(
                f"{self.name}: capture_radius ({self.capture_radius!r} m) must be less than "
                f"hold_radius ({self.hold_radius!r} m)"
            )
        self.check_pulses()
        self._mode, self._backwards = IDLE, False
        self._integral_ne, self._integral_yaw = [0.0, 0.0], 0.0
        # Nothing has been received yet: lost until first valid.
        self._position_missed = self._heading_missed = math.inf
        self._command(0.0, 0.0)
        self.distance, self.mode = 0.0, IDLE

    def sample(self, t: float, k: int) -> None:
        """Command the thrusters."""
        decision = self._decide()
        self._command(decision.surge, decision.moment)
        self.distance, self.mode = self._distance(), decision.mode

    def update(self, t: float, k: int) -> None:
        """Remember mode, integrals and the age of what was received."""
        decision = self._decide()
        self._integrate(decision)
        self._mode, self._backwards = decision.mode, decision.backwards
        self._position_missed = 0.0 if self.position_valid else self._position_missed + 1.0
        self._heading_missed = 0.0 if self.heading_valid else self._heading_missed + 1.0

    # ------------------------------------------------------------------ guidance

    def _decide(self) -> _Decision:
        mode = self._next_mode()
        if mode == IDLE:
            return _Decision(IDLE, False, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        heading, error_ne = self.heading, self._error_ne()
        backwards, target = False, self.station_heading
        if mode == RETURN:
            target = math.atan2(error_ne[1], error_ne[0])
            off_the_bow = abs(math.remainder(target - heading, math.tau))
            entering = self._mode != RETURN
            backwards = off_the_bow > math.pi / 2 if entering else self._backwards
            target += math.pi if backwards else 0.0
        heading_error = math.remainder(target - heading, math.tau)
        moment = self._wanted_moment(heading_error)
        surge_error = surge = 0.0
        if mode != HEADING_ONLY:
            alignment = max(0.0, math.cos(heading_error)) if mode == RETURN else 1.0
            ahead = _along(heading, error_ne)
            surge_error = alignment * min(max(ahead, -self.reach), self.reach)
            surge = self._wanted_surge(surge_error)
        given = self._possible(surge, moment, self.surge_limit, self.moment_limit)
        return _Decision(mode, backwards, surge_error, heading_error, surge, moment, *given)

    def _next_mode(self) -> int:
        if not self.enabled or self._lost(self.heading_valid, self._heading_missed):
            return IDLE
        if self._lost(self.position_valid, self._position_missed):
            return HEADING_ONLY
        radius = self.capture_radius if self._mode == RETURN else self.hold_radius
        return RETURN if self._distance() > radius else HOLD

    def _lost(self, valid: bool, missed: float) -> bool:
        return is_lost(valid, missed, self.period, self.timeout)

    def _error_ne(self) -> list[float]:
        return [s - p for s, p in zip(self.station, self.position_n[:2], strict=True)]

    def _distance(self) -> float:
        return math.hypot(*self._error_ne())

    # ------------------------------------------------------------------ control

    def _wanted_surge(self, error: float) -> float:
        heading = self.heading
        speed = _along(heading, self.velocity_n[:2])
        learnt = _along(heading, self._integral_ne)
        wanted: float = self.surge_gain * error + learnt - self.surge_damping * speed
        return wanted

    def _wanted_moment(self, error: float) -> float:
        wanted: float = (
            self.yaw_gain * error + self._integral_yaw - self.yaw_damping * self.yaw_rate
        )
        return wanted

    def _integrate(self, decision: _Decision) -> None:
        if decision.mode == IDLE:
            self._integral_ne, self._integral_yaw = [0.0, 0.0], 0.0
            return
        rate = self.yaw_integral * (
            decision.heading_error + (decision.moment - decision.wanted_moment) / self.yaw_gain
        )
        self._integral_yaw += self.period * rate
        if decision.mode != HEADING_ONLY and self._distance() < self.hold_radius:
            rate = self.surge_integral * (
                decision.surge_error + (decision.surge - decision.wanted_surge) / self.surge_gain
            )
            north, east = math.cos(self.heading), math.sin(self.heading)
            before_n, before_e = self._integral_ne
            self._integral_ne = [
                before_n + self.period * rate * north,
                before_e + self.period * rate * east,
            ]

    def _command(self, surge: float, moment: float) -> None:
        self.surge_force, self.yaw_moment = surge, moment
        self._drive(surge, moment)


def _along(heading: float, ne: list[float]) -> float:
    """Return the component of a north-east vector along the bow."""
    return math.cos(heading) * ne[0] + math.sin(heading) * ne[1]
