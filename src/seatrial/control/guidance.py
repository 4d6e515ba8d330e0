"""Guidance of surface craft and underwater vehicles: where to head, how fast, how deep."""

from __future__ import annotations

import math
from typing import ClassVar, NamedTuple

from ..component import Input, Output, Parameter
from ..errors import InputError, unknown
from ..sampled import Sampled
from .estimates import is_lost
from .guidance_motion import FOLLOW, MANUAL, NEUTRAL, STAY, STEER, Command, Goal, Law, Past, command
from .guidance_path import Point

PILOTED = {"manual": (False, False), "stabilize": (True, False), "depth-hold": (True, True)}
"""Modes of a person at the sticks, and whether heading and depth are held in them."""
MODES = (*PILOTED, "hold", "guided", "auto", "return", "loiter", "surface")
"""Values of the input ``mode``."""
TARGETS = ("position", "velocity", "heading")
"""Values of the input ``target_kind``."""

_NED = ("north", "east", "down")
_STICKS = ("surge", "sway", "yaw", "heave")
_SLOWEST = 1e-3  # m/s; a velocity below has no direction


class _Decision(NamedTuple):
    """What follows from the inputs and the memory at one instant. SI, angles in rad."""

    command: Command
    speed: float = 0.0
    task: tuple[str | float, ...] = ()
    start: Point = (0.0, 0.0, 0.0)
    past: Past = Past(0.0)
    waited: int = 0
    """Instants since the end of the leg was reached."""

    held: tuple[bool, bool, bool] = (False, False, False)
    """Whether the autopilots for speed, heading and depth act."""


class Guidance(Sampled):
    """Guidance in nine modes, above autopilots for heading, speed and depth.

    ========== ============================================================================
    manual     the sticks ``manual`` go to ``direct``; no autopilot acts
    stabilize  as manual, with the heading held: the yaw stick turns it at ``turn_rate``
    depth-hold as stabilize, with the depth held: the heave stick changes it at ``dive_rate``
    hold       stay where the mode was set
    guided     position: go there at ``target_speed`` (0: ``cruise_speed``) and stay; velocity:
               steer its direction at its size, depth changing at its down; heading: steer
               ``target_heading`` at ``target_speed`` at the depth of ``target_position``.
               Without ``target_valid`` as hold
    auto       follow leg number ``leg`` from ``leg_from`` to ``leg_to``, then stay there until
               another number comes (`Course`, or a mission service); as hold while it is 0
    return     go to ``home`` and stay
    loiter     circle, with ``loiter_radius``, about where the mode was set (0: as hold)
    surface    as hold, at ``surface_depth``
    ========== ============================================================================

    ``engaged`` says of each autopilot whether it acts; ``direct`` has the sticks where none does.

    **Neutral.** Not ``armed``, or with an estimate that the mode needs not valid for longer than
    ``timeout`` or never yet, no autopilot acts, ``direct`` is 0, and what is wanted is what is
    measured, at speed 0. Manual needs none, stabilize a heading, depth-hold a heading and a
    depth, the others a position too; depth counts with ``depth_control`` only.

    **Legs** (and the straight lines to a position or home, which begin where the craft was
    when they were ordered) are followed by line of sight (Fossen 2011, section 10.3), e the
    cross-track error, positive to starboard, chi the direction of the leg:

        heading_wanted = chi - atan((e + integral_gain I) / lookahead)
        I' = lookahead e / ((e + integral_gain I)^2 + lookahead^2)

    (I: Børhaug, Pavlov and Pettersen 2008, 0 at the start of each leg). So a craft of speed U
    without sway comes in as e' = -U e / sqrt(lookahead^2 + e^2) once I is small, and a current
    V_c across the leg leaves no error but a crab angle of asin(V_c / U). Linearised, e has the
    damping ratio sqrt(U / integral_gain) / 2. Depth goes along the leg in proportion. Past its
    end the craft heads for it. The end is reached within ``leg_radius`` (guided and return:
    ``acceptance_radius``) and ``depth_tolerance``; take a radius above that of your turns.
    ``reached`` is the number of a leg at whose end the craft has stayed for ``leg_wait``.

    **Staying.** With ``staying`` = rest the craft, which may have no sway control, does nothing
    within ``drift_limit``; beyond, it heads for the point at ``approach_gain`` times the
    distance, until within ``capture_radius``. With ``circle``, for a craft that cannot stop,
    it circles as in loiter, also by line of sight: clockwise for a positive radius. A leg's
    ``leg_circle`` asks for a circle at its end.

    **Speed.** What is wanted times max(turning_speed, cos(heading error)): a craft that turns on
    the spot slows down to turn (turning_speed = 0), one that needs steerage does not (1).
    ``speed_wanted`` changes at ``acceleration``, from the measured speed when the autopilots
    are engaged. ``speed`` is what GNSS tells along the bow, V_n cos(psi) + V_e sin(psi).

    Positions in {n}, m, down positive; headings clockwise from north, rad, ``heading_wanted``
    in [-pi, pi]; speeds over ground along the bow. Depths do not count in distances, and
    are 0 without ``depth_control``.

    Not modelled: the curvature of turns (legs meet at a corner), obstacles, fences, wind: a
    sailing boat needs `SailingGuidance`. Steering a velocity does not allow for the current.

    Raises InputError at the start for capture_radius not less than drift_limit or a circle of
    radius 0, and in a run for a mode or kind of target that is none.
    """

    period = Parameter(0.1, "s", "sample period", min=1e-6)
    lookahead = Parameter(5.0, "m", "lookahead distance", min=1e-3, tunable=True)
    integral_gain = Parameter(
        0.15, "m/s", "gain of the integral of the cross-track error", min=0.0, tunable=True
    )
    cruise_speed = Parameter(1.0, "m/s", "speed but for legs and set-points", min=0.0, tunable=True)
    acceleration = Parameter(0.3, "m/s2", "rate of the speed wanted", min=1e-6, tunable=True)
    turning_speed = Parameter(
        0.0, "1", "least share of the speed while turning", min=0.0, max=1.0, tunable=True
    )
    acceptance_radius = Parameter(
        3.0, "m", "distance at which a position is reached", min=0.0, tunable=True
    )
    drift_limit = Parameter(2.0, "m", "drift from which it goes back", min=0.0)
    capture_radius = Parameter(0.5, "m", "distance at which it is back", min=0.0)
    approach_gain = Parameter(0.3, "1/s", "speed per distance when it goes back", min=0.0)
    staying = Parameter("rest", "1", "how it stays at a point", choices=("rest", "circle"))
    loiter_radius = Parameter(
        10.0, "m", "radius of circles, negative for anticlockwise", tunable=True
    )
    turn_rate = Parameter(0.4, "rad/s", "turn of a heading held at full stick", tunable=True)
    dive_rate = Parameter(0.2, "m/s", "change of a depth held at full stick", tunable=True)
    depth_control = Parameter("off", "1", "whether it dives", choices=("off", "on"))
    surface_depth = Parameter(0.0, "m", "depth at the surface, the least one wanted", min=0.0)
    depth_tolerance = Parameter(0.3, "m", "depth error at which a position is reached", min=0.0)
    timeout = Parameter(1.0, "s", "longest time without a valid estimate", min=0.0)

    mode = Input("1", f"one of {', '.join(MODES)}", type=str, start="hold")
    armed = Input("1", "whether to act", type=bool)
    manual = Input(
        "1", "sticks, -1 to 1: ahead, to starboard, turn to starboard, down", axes=_STICKS
    )
    target_kind = Input("1", f"guided: one of {', '.join(TARGETS)}", type=str, start="position")
    target_valid = Input("1", "guided: whether there is a set-point", type=bool, start=True)
    target_position = Input("m", "guided: position to go to", axes=_NED)
    target_velocity = Input("m/s", "guided: velocity over ground", axes=_NED)
    target_heading = Input("rad", "guided: heading, clockwise from north")
    target_speed = Input("m/s", "guided: speed along the bow, to a position 0 for cruise_speed")
    leg = Input("1", "auto: number of the leg, another for each new one; 0 for none", type=int)
    leg_from = Input("m", "auto: where the leg begins", axes=_NED)
    leg_to = Input("m", "auto: where the leg ends", axes=_NED)
    leg_speed = Input("m/s", "auto: speed on the leg", start=1.0)
    leg_radius = Input("m", "auto: distance at which its end is reached", start=3.0)
    leg_wait = Input("s", "auto: time to stay at its end")
    leg_circle = Input("m", "auto: radius of the circle to stay on, 0 as `staying` says")
    home = Input("m", "position to return to", axes=_NED)
    position_n = Input("m", "position, north-east-down", axes=_NED)
    velocity_n = Input("m/s", "velocity over ground, north-east-down", axes=_NED)
    position_valid = Input("1", "whether position and velocity are valid", type=bool, start=True)
    heading = Input("rad", "heading, clockwise from north")
    heading_valid = Input("1", "whether the heading is valid", type=bool, start=True)
    depth = Input("m", "depth, positive down")
    depth_valid = Input("1", "whether the depth is valid", type=bool, start=True)

    engaged = Output("1", "which autopilots act", type=bool, axes=("speed", "heading", "depth"))
    direct = Output("1", "sticks where none acts, -1 to 1", axes=_STICKS)
    heading_wanted = Output("rad", "heading wanted, clockwise from north, -pi to pi")
    speed_wanted = Output("m/s", "speed wanted over ground along the bow")
    depth_wanted = Output("m", "depth wanted, positive down")
    speed = Output("m/s", "measured speed over ground along the bow")
    state = Output("1", "0 neutral, 1 piloted, 2 stays, 3 follows a leg, 4 steers", type=int)
    cross_track = Output("m", "cross-track error of leg or circle, positive to starboard of it")
    cross_track_rms = Output("m", "root mean square of cross_track on legs before now")
    distance = Output("m", "horizontal distance to the end of the leg or the point to stay at")
    reached = Output("1", "the leg's number if it is done, else 0", type=int)

    _ABLE = ("mode", "armed", "position_valid", "heading_valid", "depth_valid")
    _GOAL = (
        *("target_kind", "target_valid", "target_position", "leg", "leg_to", "home", "position_n"),
    )
    _STATE = (*_ABLE, *_GOAL, "leg_radius")
    _PATH = (*_STATE, "leg_from", "leg_circle")
    _HEADING = (*_PATH, "target_velocity", "target_heading", "heading")
    feedthrough: ClassVar = {
        "engaged": _ABLE,
        "direct": ("mode", "armed", "heading_valid", "depth_valid", "manual"),
        "heading_wanted": _HEADING,
        "speed_wanted": (*_HEADING, "target_speed", "leg_speed", "velocity_n"),
        "depth_wanted": (*_STATE, "leg_from", "depth"),
        "speed": ("velocity_n", "heading"),
        "state": _STATE,
        "cross_track": _PATH,
        "distance": (*_ABLE, *_GOAL),
        "reached": (*_ABLE, "leg", "leg_to", "leg_radius", "leg_wait", "position_n", "depth"),
    }

    # ------------------------------------------------------------------ running

    def reset(self, t: float) -> None:
        """Start with nothing wanted; raises InputError for radii that do not go together."""
        if not self.capture_radius < self.drift_limit:
            raise InputError(
                f"{self.name}: capture_radius ({self.capture_radius!r} m) must be less than "
                f"drift_limit ({self.drift_limit!r} m)"
            )
        if self.staying == "circle" and self.loiter_radius == 0.0:
            raise InputError(f"{self.name}: loiter_radius is 0.0 m, staying = circle needs another")
        # Nothing has been heard yet: lost until first valid.
        self._missed = [math.inf] * 3
        self._task: tuple[str | float, ...] = ()
        self._start: Point = (0.0, 0.0, 0.0)
        self._before: list[float] = []
        self._arrived, self._away, self._integral, self._waited = False, False, 0.0, 0
        self._squares, self._instants = 0.0, 0

    def sample(self, t: float, k: int) -> None:
        """Say where to head, how fast and how deep."""
        decision = self._decide()
        wanted = decision.command
        self.state, self.engaged = wanted.motion, decision.held
        self.direct = self._direct(decision)
        self.heading_wanted = math.remainder(wanted.heading, math.tau)
        self.speed_wanted, self.depth_wanted = decision.speed, wanted.depth
        self.speed = self._speed()
        self.cross_track, self.distance = wanted.across, wanted.distance
        instants = self._instants
        self.cross_track_rms = math.sqrt(self._squares / instants) if instants else 0.0
        self.reached = self._reached(decision)

    def update(self, t: float, k: int) -> None:
        """Remember the goal, how far it is met, and the age of what was heard."""
        decision = self._decide()
        wanted = decision.command
        if wanted.motion == FOLLOW:
            self._squares += wanted.across**2
            self._instants += 1
        self._waited = decision.waited + 1 if wanted.arrived else 0
        self._integral = decision.past.integral + self.period * wanted.integral_rate
        self._task, self._start = decision.task, decision.start
        self._arrived, self._away = wanted.arrived, wanted.away
        turning, sinking = self._rates(decision)
        self._before = [
            wanted.heading + self.period * turning,
            decision.speed if decision.held[0] else self._speed(),
            wanted.depth + self.period * sinking,
        ]
        self._missed = [
            0.0 if valid else missed + 1.0
            for valid, missed in zip(self._valid(), self._missed, strict=True)
        ]

    # ------------------------------------------------------------------ deciding

    def _decide(self) -> _Decision:
        here = self._here()
        heading, speed, depth = self._before or (self.heading, self._speed(), here[2])
        if not self._able():
            return _Decision(Command(NEUTRAL, self.heading, 0.0, here[2]))
        if self.mode in PILOTED:
            heading_held, depth_held = PILOTED[self.mode]
            heading = heading if heading_held else self.heading
            depth = self._deep((0.0, 0.0, depth))[2] if depth_held else here[2]
            held = (False, heading_held, depth_held)
            return _Decision(Command(MANUAL, heading, 0.0, depth), held=held)
        task, start, past, waited = self._wanted_task(), here, Past(heading), 0
        if task == self._task:
            start, waited = self._start, self._waited
            past = Past(heading, self._arrived, self._away, self._integral)
        goal = self._goal(task, start, depth)
        wanted = command(goal, self._law(), here, past)
        speed = self._ramped(speed, wanted)
        return _Decision(wanted, speed, task, start, past, waited, (True, True, True))

    def _able(self) -> bool:
        """Say if the craft is armed and has the estimates that the mode needs."""
        if self.mode not in MODES:
            raise InputError(f"{self.name}: {unknown('mode', self.mode, MODES)}")
        heading, depth = PILOTED.get(self.mode, (True, True))
        needed = (self.mode not in PILOTED, heading, depth and self.depth_control == "on")
        return self.armed and not any(
            need and is_lost(valid, missed, self.period, self.timeout)
            for need, valid, missed in zip(needed, self._valid(), self._missed, strict=True)
        )

    def _wanted_task(self) -> tuple[str | float, ...]:
        """Return what tells one task from the next; a new one begins anew, where the craft is."""
        mode = self.mode
        if mode == "auto" and self.leg:
            return "leg", float(self.leg)
        if mode == "return":
            return "return", *self.home
        if mode == "guided" and self.target_valid:
            if self.target_kind not in TARGETS:
                raise InputError(f"{self.name}: {unknown('target', self.target_kind, TARGETS)}")
            position = self.target_position if self.target_kind == "position" else ()
            return self.target_kind, *position
        return (mode if mode in ("loiter", "surface") else "hold",)

    def _goal(self, task: tuple[str | float, ...], start: Point, depth: float) -> Goal:
        circle: float = self.loiter_radius if self.staying == "circle" else 0.0
        cruise: float = self.cruise_speed
        match task[0]:
            case "leg":
                return Goal(
                    FOLLOW,
                    self._deep(self.leg_to),
                    start=self._deep(self.leg_from),
                    speed=self.leg_speed,
                    radius=self.leg_radius,
                    circle=self.leg_circle or circle,
                )
            case "return" | "position":
                homewards = task[0] == "return"
                end = self._deep(self.home if homewards else self.target_position)
                speed = cruise if homewards else self.target_speed or cruise
                return Goal(FOLLOW, end, start, speed, self.acceptance_radius, circle)
            case "velocity":
                north, east, _ = self.target_velocity
                speed = math.hypot(north, east)
                heading = math.atan2(east, north) if speed > _SLOWEST else None
                end = self._deep((0.0, 0.0, depth))
                return Goal(STEER, end, speed=speed, heading=heading)
            case "heading":
                end = self._deep(self.target_position)
                return Goal(STEER, end, speed=self.target_speed, heading=self.target_heading)
        circle = self.loiter_radius if task[0] == "loiter" else circle
        depth = self.surface_depth if task[0] == "surface" else start[2]
        end = self._deep((start[0], start[1], depth))
        return Goal(STAY, end, speed=cruise, circle=circle)

    def _ramped(self, before: float, wanted: Command) -> float:
        """Return the speed wanted now, less while the heading is not what is wanted."""
        aligned = math.cos(wanted.heading - self.heading)
        goal = wanted.speed * max(self.turning_speed, aligned)
        most = self.acceleration * self.period
        ramped: float = before + min(max(goal - before, -most), most)
        return ramped

    def _direct(self, decision: _Decision) -> list[float]:
        """Return the sticks where no autopilot acts."""
        speed, heading, depth = decision.held
        piloted = decision.command.motion == MANUAL
        return [
            min(max(stick, -1.0), 1.0) if piloted and not held else 0.0
            for stick, held in zip(self.manual, (speed, speed, heading, depth), strict=True)
        ]

    def _rates(self, decision: _Decision) -> tuple[float, float]:
        """Return the rates at which heading and depth wanted go on, rad/s and m/s."""
        if decision.command.motion == MANUAL:
            _, heading, depth = decision.held
            yaw, heave = (min(max(stick, -1.0), 1.0) for stick in self.manual[2:])
            return self.turn_rate * yaw * heading, self.dive_rate * heave * depth
        return 0.0, self.target_velocity[2] if decision.task == ("velocity",) else 0.0

    def _reached(self, decision: _Decision) -> int:
        """Return the number of the leg at whose end the craft has stayed long enough, or 0."""
        stayed = decision.waited * self.period * (1.0 + 1e-9) >= self.leg_wait
        done = decision.command.arrived and decision.task[0] == "leg" and stayed
        return self.leg if done else 0

    # ------------------------------------------------------------------ what is measured

    def _valid(self) -> tuple[bool, bool, bool]:
        return self.position_valid, self.heading_valid, self.depth_valid

    def _here(self) -> Point:
        north, east, _ = self.position_n
        return north, east, self.depth if self.depth_control == "on" else 0.0

    def _deep(self, place: Point) -> Point:
        """Return a place as the craft can be there: not above the surface, or just there."""
        deepest = place[2] if self.depth_control == "on" else 0.0
        return place[0], place[1], max(self.surface_depth, deepest)

    def _speed(self) -> float:
        north, east, _ = self.velocity_n
        speed: float = north * math.cos(self.heading) + east * math.sin(self.heading)
        return speed

    def _law(self) -> Law:
        return Law(
            self.lookahead,
            self.integral_gain,
            self.drift_limit,
            self.capture_radius,
            self.approach_gain,
            self.depth_tolerance,
        )
