"""Guidance of surface craft and underwater vehicles: heading, speed and depth wanted."""

from __future__ import annotations

import math
from types import MappingProxyType
from typing import ClassVar, NamedTuple

from ..errors import InputError
from ..model.component import Input, Output, Parameter, Terminal, terminal
from .guidance_motion import MANUAL, NEUTRAL, STEER, Command, Goal, Law
from .guidance_orders import MANUAL_AXES, ORDERS, SENSED, TASKS, Decision, GuidanceOrders, Task
from .guidance_path import Point

PILOTED = MappingProxyType(
    {
        "manual": (False, False),
        "manual-depth": (False, True),
        "stabilize": (True, False),
        "depth-hold": (True, True),
    }
)
"""Modes under manual control, and whether heading and depth are held in them."""
MODES = (*PILOTED, *TASKS, "surface")
"""Values of the input ``mode``."""
STAYING = ("rest", "weather-vane", "circle", "proceed")
"""Ways to stay at a point."""
RESTING = STAYING[:2]
"""Those of a craft that can stop."""


class _Guided(NamedTuple):
    """A decision, and what goes with it: speed in m/s."""

    decision: Decision
    speed: float = 0.0
    held: tuple[bool, bool, bool] = (False, False, False)
    """Whether the autopilots for speed, heading and depth act."""
    sway: float = 0.0
    """Speed to starboard, m/s."""


class Guidance(GuidanceOrders):
    """Guidance in ten modes, above autopilots for heading, speed and depth.

    ========== ============================================================================
    manual     the manual control ``manual`` goes to ``direct``; no autopilot acts
    manual-    as manual, with the depth held: manual heave changes it at ``dive_rate``
    depth
    stabilize  as manual, with the heading held: manual yaw turns it at ``turn_rate``
    depth-hold as stabilize, with the depth held: manual heave changes it at ``dive_rate``
    hold       stay where the mode was set
    guided     position: go there at ``target_speed`` (0: ``cruise_speed``) and stay; velocity:
               steer its direction at its size, depth changing at its down; heading: steer
               ``target_heading`` at ``target_speed`` at the depth of ``target_position``;
               body: the same, and ``target_sway`` to starboard. Without ``target_valid`` as hold
    auto       follow leg number ``leg`` from ``leg_from`` to ``leg_to``, then stay there until
               another number comes (`Course`, or a mission service); as hold while it is 0
    return     go to ``home`` and stay
    loiter     circle, with ``loiter_radius``, about where the mode was set (0: as hold)
    surface    as hold, at ``surface_depth``
    ========== ============================================================================

    ``engaged`` has, per autopilot, whether it acts; ``direct`` the manual control where none does.

    **Neutral.** Not ``armed``, or with an estimate that the mode needs not valid for longer than
    ``timeout`` or never yet, no autopilot acts, ``direct`` is 0, and what is wanted is what is
    measured, at speed 0. Manual needs none, stabilize a heading, manual-depth a depth, depth-hold
    both, the others a position too; depth is needed with ``depth_control`` only.

    **Legs** (and the straight lines to a position or home, which begin where the craft was
    when they were ordered) are followed by line of sight ([Fossen2011], section 10.3), e the
    cross-track error, positive to starboard, chi the direction of the leg:

        heading_wanted = chi - atan((e + integral_gain I) / lookahead)
        I' = lookahead e / ((e + integral_gain I)^2 + lookahead^2)

    (I: [Borhaug2008], 0 at the start of each leg). So a craft of speed U
    without sway comes in as e' = -U e / sqrt(lookahead^2 + e^2) once I is small, and a current
    V_c across the leg leaves no error but a crab angle of asin(V_c / U). Linearised, e has the
    damping ratio sqrt(U / integral_gain) / 2. Depth goes along the leg in proportion. Past its
    end the craft heads for it. The end is reached within ``leg_radius`` (guided and return:
    ``acceptance_radius``) and ``depth_tolerance``; take a radius above that of your turns.
    ``reached`` is the number of a leg at whose end the craft has stayed for ``leg_wait``.

    **Staying.** With ``staying`` = rest the craft, which may have no sway control, does nothing
    within ``drift_limit``; beyond, it heads for the point at ``approach_gain`` times the
    distance, until within ``capture_radius``. With ``weather-vane`` it heads for the point
    from ``drift_limit`` on, at ``approach_gain`` times the distance beyond, and not further in:
    a pendulum that wind and current swing to leeward of the point, where it lies bow up. With
    ``circle``, for a craft that cannot stop, it circles as in loiter, also by line of sight:
    clockwise for a positive radius. A leg's ``leg_circle`` asks for a circle at its end.
    ``proceed`` is for a ship: as circle, but where there is no place to stay at (hold, guided
    without a set-point, auto without a leg) it keeps the heading wanted last, or its own.

    **Speed.** What is wanted times max(turning_speed, cos(heading error)): a craft that turns on
    the spot slows down to turn (turning_speed = 0), one that needs steerage does not (1).
    ``speed_wanted`` changes at ``acceleration``, from the measured speed when the autopilots
    are engaged. ``speed`` is GNSS's along the bow, V_n cos(psi) + V_e sin(psi), ``sway`` that to
    starboard, V_e cos(psi) - V_n sin(psi). Sway is held with the target body alone, whose speeds
    do not wait for the heading.

    Positions in {n}, m, down positive; headings clockwise from north, rad, ``heading_wanted``
    in [-pi, pi]; speeds over ground along the bow. Distances are horizontal; depths
    are 0 without ``depth_control``.

    Not modelled: the curvature of turns (legs meet at a corner), obstacles, fences, wind: a
    sailing boat needs `SailingGuidance`. Steering a velocity does not allow for the current.

    Raises InputError at the start for capture_radius not less than drift_limit or a circle of
    radius 0, and in a run for a mode or kind of target that is none.
    """

    exercised: ClassVar = {
        "armed": True,
        "position_valid": True,
        "heading_valid": True,
        "depth_valid": True,
        "depth_control": "on",
        "depth_tolerance": 1.5,
        "staying": "circle",
        "leg_wait": 0.0,
        "acceleration": 1e9,
        "turning_speed": 0.1,
        "leg_radius": 4.0,
    }

    modes = MODES

    cruise_speed = Parameter(1.0, "m/s", "speed but for legs and set-points", min=0.0, tunable=True)
    acceleration = Parameter(0.3, "m/s2", "rate of the speed wanted", min=1e-6, tunable=True)
    turning_speed = Parameter(
        0.0, "1", "least share of the speed while turning", min=0.0, max=1.0, tunable=True
    )
    approach_gain = Parameter(
        0.3, "1/s", "speed per distance when it goes back", min=0.0, tunable=True
    )
    staying = Parameter("rest", "1", "how it stays at a point", choices=STAYING)
    turn_rate = Parameter(0.4, "rad/s", "turn of a heading held at full deflection", tunable=True)
    dive_rate = Parameter(0.2, "m/s", "change of a depth held at full deflection", tunable=True)
    depth_control = Parameter("off", "1", "whether it dives", choices=("off", "on"))
    surface_depth = Parameter(
        0.0, "m", "depth at the surface, the least one wanted", min=0.0, tunable=True
    )
    depth_tolerance = Parameter(
        0.3, "m", "depth error at which a position is reached", min=0.0, tunable=True
    )

    mode = Input("1", f"one of {', '.join(MODES)}", type=str, start="hold", choices=MODES)
    target_sway = Input("m/s", "guided, body: speed to starboard", optional=True)
    depth = Input("m", "depth, positive down")
    depth_valid = Input("1", "whether the depth is valid", type=bool, start=True)

    engaged = Output("1", "which autopilots act", type=bool, axes=("speed", "heading", "depth"))
    direct = Output("1", "manual control where none acts, -1 to 1", axes=MANUAL_AXES)
    speed_wanted = Output("m/s", "speed wanted over ground along the bow")
    depth_wanted = Output("m", "depth wanted, positive down")
    speed = Output("m/s", "measured speed over ground along the bow")
    sway_engaged = Output("1", "whether an autopilot for sway acts", type=bool)
    sway_wanted = Output("m/s", "speed wanted over ground to starboard")
    sway = Output("m/s", "measured speed over ground to starboard")

    _ABLE = ("mode", "armed", "position_valid", "heading_valid", "depth_valid")
    _TARGET = ("target_kind", "target_valid")
    _GOAL = (
        *("target_kind", "target_valid", "target_position", "leg", "leg_to", "home", "position_n"),
    )
    _STATE = (*_ABLE, *_GOAL, "leg_radius")
    _PATH = (*_STATE, "leg_from", "leg_circle")
    _HEADING = (*_PATH, "target_velocity", "target_heading", "heading")
    feedthrough: ClassVar = {
        "direct": ("mode", "armed", "heading_valid", "depth_valid", "manual"),
        "heading_wanted": _HEADING,
        "speed_wanted": (*_HEADING, "target_speed", "leg_speed", "velocity_n"),
        "sway_engaged": (*_ABLE, *_TARGET),
        "sway_wanted": (*_ABLE, *_TARGET, "target_sway", "velocity_n", "heading"),
        "depth_wanted": (*_STATE, "leg_from", "depth"),
        "state": _STATE,
        "cross_track": _PATH,
        "distance": (*_ABLE, *_GOAL),
        "reached": (*_ABLE, "leg", "leg_to", "leg_radius", "leg_wait", "position_n", "depth"),
    }
    terminals: ClassVar = {
        "orders": Terminal(
            {
                **ORDERS.members,
                "target_sway": "target_sway",
                "nav_speed": "speed_wanted",
                "nav_depth": "depth_wanted",
            }
        ),
        "sensors": terminal(*SENSED, "depth", "depth_valid"),
        "wanted": terminal(
            "engaged",
            "direct",
            "speed_wanted",
            "heading_wanted",
            "depth_wanted",
            "speed",
            speed_engaged="engaged__speed",
            heading_engaged="engaged__heading",
            direct_yaw="direct__yaw",
        ),
        "wanted_abeam": terminal(
            speed_wanted="sway_wanted", speed="sway", speed_engaged="sway_engaged"
        ),
    }

    # ------------------------------------------------------------------ running

    def reset(self, t: float) -> None:
        """Start with nothing wanted; raises InputError for radii that do not go together."""
        super().reset(t)
        if self.staying not in RESTING and self.loiter_radius == 0.0:
            raise InputError(
                f"{self.name}: loiter_radius is 0.0 m, staying = {self.staying} needs another"
            )
        self._before: list[float] = []

    def sample(self, t: float, k: int) -> None:
        """Publish heading, speed and depth wanted."""
        guided = self._decide()
        wanted = guided.decision.command
        self._publish(guided.decision)
        self.engaged, self.direct = guided.held, self._direct(guided)
        self.heading_wanted = math.remainder(wanted.heading, math.tau)
        self.speed_wanted, self.depth_wanted = guided.speed, wanted.depth
        self.speed = self._speed()
        self.sway_engaged, self.sway_wanted = self._sways(guided), guided.sway
        self.sway = self._sway()

    def update(self, t: float, k: int) -> None:
        """Remember the goal, how far it is met, and the age of what was received."""
        guided = self._decide()
        wanted = guided.decision.command
        if wanted.motion == NEUTRAL:  # it begins anew where the craft is by then
            self._before = []
            self._remember(guided.decision)
            return
        turning, sinking = self._rates(guided)
        self._before = [
            wanted.heading + self.period * turning,
            guided.speed if guided.held[0] else self._speed(),
            wanted.depth + self.period * sinking,
            guided.sway if self._sways(guided) else self._sway(),
        ]
        self._remember(guided.decision)

    # ------------------------------------------------------------------ deciding

    def _decide(self) -> _Guided:
        here, mode = self._here(), self._checked_mode()
        heading, speed, depth, sway = self._before or (
            self.heading,
            self._speed(),
            here[2],
            self._sway(),
        )
        if not self._able():
            return _Guided(Decision(Command(NEUTRAL, self.heading, 0.0, here[2])))
        if mode in PILOTED:
            heading_held, depth_held = PILOTED[mode]
            heading = heading if heading_held else self.heading
            depth = self._placed((0.0, 0.0, depth))[2] if depth_held else here[2]
            piloted = Decision(Command(MANUAL, heading, 0.0, depth))
            return _Guided(piloted, held=(False, heading_held, depth_held))
        decision = self._ordered(heading, depth)
        wanted = decision.command
        if decision.task == ("body",):
            surge, sway = wanted.speed, self._ramped(sway, self.target_sway)
        else:
            surge, sway = self._aligned(wanted), 0.0
        return _Guided(decision, self._ramped(speed, surge), (True, True, True), sway)

    def _able(self) -> bool:
        """Return whether the craft is armed and has the estimates that the mode needs."""
        heading, depth = PILOTED.get(self.mode, (True, True))
        diving = depth and self.depth_control == "on"
        return self.armed and self._known(self.mode not in PILOTED, heading, diving)

    def _goal(self, task: Task, start: Point, depth: float) -> Goal:
        if task[0] == "hold" and self.staying == "proceed":
            return Goal(STEER, self._placed(start), speed=self.cruise_speed)
        if task[0] == "surface":
            start = start[0], start[1], self.surface_depth
        return super()._goal(task, start, depth)

    def _aligned(self, wanted: Command) -> float:
        """Return the speed wanted, less while the heading is not what is wanted."""
        aligned = math.cos(wanted.heading - self.heading)
        goal: float = wanted.speed * max(self.turning_speed, aligned)
        return goal

    def _ramped(self, before: float, goal: float) -> float:
        """Return the speed wanted now, on its way to ``goal``."""
        most = self.acceleration * self.period
        ramped: float = before + min(max(goal - before, -most), most)
        return ramped

    def _sways(self, guided: _Guided) -> bool:
        """Return whether a speed to starboard is held."""
        return guided.decision.task == ("body",)

    def _direct(self, guided: _Guided) -> list[float]:
        """Return the manual control where no autopilot acts."""
        speed, heading, depth = guided.held
        piloted = guided.decision.command.motion == MANUAL
        return [
            min(max(deflection, -1.0), 1.0) if piloted and not held else 0.0
            for deflection, held in zip(self.manual, (speed, speed, heading, depth), strict=True)
        ]

    def _rates(self, guided: _Guided) -> tuple[float, float]:
        """Return the rates at which heading and depth wanted go on, rad/s and m/s."""
        if guided.decision.command.motion == MANUAL:
            _, heading, depth = guided.held
            yaw, heave = (min(max(deflection, -1.0), 1.0) for deflection in self.manual[2:])
            return self.turn_rate * yaw * heading, self.dive_rate * heave * depth
        return 0.0, self.target_velocity[2] if guided.decision.task == ("velocity",) else 0.0

    # ------------------------------------------------------------------ what the craft can do

    def _law(self) -> Law:
        return (
            super()
            ._law()
            ._replace(
                approach_gain=self.approach_gain,
                depth_tolerance=self.depth_tolerance,
                vanes=self.staying == "weather-vane",
            )
        )

    def _circle(self) -> float:
        radius: float = 0.0 if self.staying in RESTING else self.loiter_radius
        return radius

    def _cruise(self) -> float:
        speed: float = self.cruise_speed
        return speed

    def _placed(self, place: Point) -> Point:
        """Return a place as the craft can be there: not above the surface, or just there."""
        deepest = place[2] if self.depth_control == "on" else 0.0
        return place[0], place[1], max(self.surface_depth, deepest)

    # ------------------------------------------------------------------ what is measured

    def _valid(self) -> tuple[bool, bool, bool]:
        return self.position_valid, self.heading_valid, self.depth_valid

    def _here(self) -> Point:
        north, east, _ = self.position_n
        return north, east, self.depth if self.depth_control == "on" else 0.0

    def _sway(self) -> float:
        north, east, _ = self.velocity_n
        speed: float = east * math.cos(self.heading) - north * math.sin(self.heading)
        return speed
