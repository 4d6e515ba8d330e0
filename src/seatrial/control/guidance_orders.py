"""Base of guidance: orders to a craft, and the memory of their execution."""

from __future__ import annotations

import math
from typing import ClassVar, NamedTuple

from ..errors import InputError, unknown
from ..model.component import Input, Output, Parameter, terminal
from ..model.sampled import Sampled
from ..model.terminals import ORDERED
from .estimates import is_lost
from .guidance_motion import FOLLOW, STAY, STEER, Command, Goal, Law, Past, command
from .guidance_path import Point

TASKS = ("hold", "guided", "auto", "return", "loiter")
"""Modes that every guidance has."""
TARGETS = ("position", "velocity", "heading", "body")
"""Values of the input ``target_kind``."""

MANUAL_AXES = ("surge", "sway", "yaw", "heave")
"""Axes of manual control."""

NED = ("north", "east", "down")

SENSED = ("position_n", "velocity_n", "position_valid", "heading", "heading_valid")
"""Members of the terminal ``sensors``."""

ORDERS = terminal(
    *ORDERED,
    leg_reached="reached",
    nav_state="state",
    nav_heading="heading_wanted",
    nav_cross_track="cross_track",
    nav_distance="distance",
)
"""What commands guidance, and what it answers."""

Task = tuple[str | float, ...]
"""Identity of a task: a new one begins anew, where the craft is."""

_SLOWEST = 1e-3  # m/s; a velocity below has no direction


class Decision(NamedTuple):
    """What follows from orders, estimates and memory at one instant. SI, angles in rad."""

    command: Command
    task: Task = ()
    start: Point = (0.0, 0.0, 0.0)
    """Where the line that is followed begins."""
    end: Point = (0.0, 0.0, 0.0)
    past: Past = Past(0.0)
    waited: int = 0
    """Instants since the end of the leg was reached."""


class GuidanceOrders(Sampled):
    """Base of guidance: from orders to a goal, and the course that leads there.

    A subclass defines in ``modes`` which modes it has, and in `sample` and `update` what comes
    of the `Decision` of `_ordered`; in `_here`, `_placed` and `_cruise` how deep and how fast.
    """

    modes: ClassVar[tuple[str, ...]] = ()

    period = Parameter(0.1, "s", "sample period", min=1e-6)
    lookahead = Parameter(5.0, "m", "lookahead distance", min=1e-3, tunable=True)
    integral_gain = Parameter(
        0.15, "m/s", "gain of the integral of the cross-track error", min=0.0, tunable=True
    )
    acceptance_radius = Parameter(
        3.0, "m", "distance at which a position is reached", min=0.0, tunable=True
    )
    drift_limit = Parameter(2.0, "m", "drift from which it goes back", min=0.0, tunable=True)
    capture_radius = Parameter(
        0.5, "m", "distance at which it is back, up to drift_limit", min=0.0, tunable=True
    )
    loiter_radius = Parameter(
        10.0, "m", "radius of circles, negative for anticlockwise", tunable=True
    )
    timeout = Parameter(1.0, "s", "longest time without a valid estimate", min=0.0)

    mode = Input("1", "what to do: one of its modes", type=str, start="hold")
    armed = Input("1", "whether to act", type=bool)
    manual = Input(
        "1",
        "manual control, -1 to 1: ahead, to starboard, turn to starboard, down",
        axes=MANUAL_AXES,
        optional=True,
    )
    target_kind = Input(
        "1",
        f"guided: one of {', '.join(TARGETS)}",
        type=str,
        start="position",
        choices=TARGETS,
        optional=True,
    )
    target_valid = Input(
        "1", "guided: whether there is a set-point", type=bool, start=True, optional=True
    )
    target_position = Input("m", "guided: position to go to", axes=NED, optional=True)
    target_velocity = Input("m/s", "guided: velocity over ground", axes=NED, optional=True)
    target_heading = Input("rad", "guided: heading, clockwise from north", optional=True)
    target_speed = Input(
        "m/s", "guided: speed along the bow, to a position 0 for cruise_speed", optional=True
    )
    leg = Input("1", "auto: number of the leg, another for each new one; 0 for none", type=int)
    leg_from = Input("m", "auto: where the leg begins", axes=NED)
    leg_to = Input("m", "auto: where the leg ends", axes=NED)
    leg_speed = Input("m/s", "auto: speed on the leg, negative for cruise_speed", start=1.0)
    leg_radius = Input(
        "m", "auto: distance at which its end is reached, 0 for acceptance_radius", start=3.0
    )
    leg_wait = Input("s", "auto: time to stay at its end")
    leg_circle = Input("m", "auto: radius of the circle to stay on, 0 for none", optional=True)
    home = Input("m", "position to return to", axes=NED, optional=True)
    position_n = Input("m", "position, north-east-down", axes=NED)
    velocity_n = Input("m/s", "velocity over ground, north-east-down", axes=NED)
    position_valid = Input("1", "whether position and velocity are valid", type=bool, start=True)
    heading = Input("rad", "heading, clockwise from north")
    heading_valid = Input("1", "whether the heading is valid", type=bool, start=True)

    heading_wanted = Output("rad", "heading wanted, clockwise from north, -pi to pi")
    state = Output("1", "0 neutral, 1 piloted, 2 stays, 3 follows a leg, 4 steers", type=int)
    cross_track = Output("m", "cross-track error of leg or circle, positive to starboard of it")
    cross_track_rms = Output("m", "root mean square of cross_track on legs before now")
    distance = Output("m", "horizontal distance to the end of the leg or the point to stay at")
    reached = Output("1", "the leg's number if it is done, else 0", type=int)

    terminals: ClassVar = {"orders": ORDERS, "sensors": terminal(*SENSED)}

    # ------------------------------------------------------------------ memory

    def reset(self, t: float) -> None:
        """Start with nothing ordered; raises InputError for radii that do not go together."""
        if not self.capture_radius < self.drift_limit:
            raise InputError(
                f"{self.name}: capture_radius ({self.capture_radius!r} m) must be less than "
                f"drift_limit ({self.drift_limit!r} m)"
            )
        # Nothing has been received yet: lost until first valid.
        self._missed = [math.inf] * len(self._valid())
        self._task: Task = ()
        self._start: Point = (0.0, 0.0, 0.0)
        self._arrived, self._away, self._integral, self._waited = False, False, 0.0, 0
        self._squares, self._instants = 0.0, 0

    def _remember(self, decision: Decision) -> None:
        """Remember the task, how far it is met, and the age of what was received."""
        wanted = decision.command
        if wanted.motion == FOLLOW:
            self._squares += wanted.across**2
            self._instants += 1
        self._waited = decision.waited + 1 if wanted.arrived else 0
        self._integral = decision.past.integral + self.period * wanted.integral_rate
        self._task, self._start = decision.task, decision.start
        self._arrived, self._away = wanted.arrived, wanted.away
        self._missed = [
            0.0 if valid else missed + 1.0
            for valid, missed in zip(self._valid(), self._missed, strict=True)
        ]

    def _publish(self, decision: Decision) -> None:
        """Set the outputs that report the progress of the task."""
        wanted, instants = decision.command, self._instants
        self.state = wanted.motion
        self.cross_track, self.distance = wanted.across, wanted.distance
        self.cross_track_rms = math.sqrt(self._squares / instants) if instants else 0.0
        self.reached = self._reached(decision)

    # ------------------------------------------------------------------ deciding

    def _known(self, *needed: bool) -> bool:
        """Return whether no estimate that is needed is lost, in the order of `_valid`."""
        return not any(
            need and is_lost(valid, missed, self.period, self.timeout)
            for need, valid, missed in zip(needed, self._valid(), self._missed, strict=True)
        )

    def _ordered(self, heading: float, depth: float) -> Decision:
        """Return what leads on with the task; ``heading`` and ``depth`` were wanted before."""
        task, here, waited = self._wanted_task(), self._here(), 0
        start = self._placed(self.leg_from) if task[0] == "leg" else here
        past = Past(heading)
        if task == self._task:
            start, waited = self._start, self._waited
            past = Past(heading, self._arrived, self._away, self._integral)
        goal = self._goal(task, start, depth)
        return Decision(command(goal, self._law(), here, past), task, start, goal.end, past, waited)

    def _checked_mode(self) -> str:
        mode: str = self.mode
        if mode not in self.modes:
            raise InputError(f"{self.name}: {unknown('mode', mode, self.modes)}")
        return mode

    def _wanted_task(self) -> Task:
        mode = self.mode
        if mode == "auto" and self.leg:
            return "leg", float(self.leg)
        if mode == "return":
            return "return", *self.home
        if mode == "guided" and self.target_valid:
            kind = self.target_kind
            if kind not in TARGETS:
                raise InputError(f"{self.name}: {unknown('target', kind, TARGETS)}")
            return (kind, *self.target_position) if kind == "position" else (kind,)
        return (mode if mode in ("loiter", "surface") else "hold",)

    def _goal(self, task: Task, start: Point, depth: float) -> Goal:
        circle, cruise = self._circle(), self._cruise()
        match task[0]:
            case "leg":
                end, circle = self._placed(self.leg_to), self.leg_circle or circle
                speed = cruise if self.leg_speed < 0.0 else self.leg_speed
                radius = self.leg_radius or self.acceptance_radius
                return Goal(FOLLOW, end, start, speed, radius, circle)
            case "return":
                end = self._placed(self.home)
                return Goal(FOLLOW, end, start, cruise, self.acceptance_radius, circle)
            case "position":
                end, speed = self._placed(self.target_position), self.target_speed or cruise
                return Goal(FOLLOW, end, start, speed, self.acceptance_radius, circle)
            case "velocity":
                north, east, _ = self.target_velocity
                speed = math.hypot(north, east)
                heading = math.atan2(east, north) if speed > _SLOWEST else None
                end = self._placed((0.0, 0.0, depth))
                return Goal(STEER, end, speed=speed, heading=heading)
            case "heading" | "body":
                end = self._placed(self.target_position)
                return Goal(STEER, end, speed=self.target_speed, heading=self.target_heading)
            case "loiter":
                circle = self.loiter_radius
        return Goal(STAY, self._placed(start), speed=cruise, circle=circle)

    def _reached(self, decision: Decision) -> int:
        """Return the number of the leg at whose end the craft has stayed long enough, or 0."""
        stayed = decision.waited * self.period * (1.0 + 1e-9) >= self.leg_wait
        done = decision.command.arrived and decision.task[0] == "leg" and stayed
        return self.leg if done else 0

    def _law(self) -> Law:
        capture = min(self.capture_radius, self.drift_limit)
        return Law(self.lookahead, self.integral_gain, self.drift_limit, capture)

    # ------------------------------------------------------------------ what the craft can do

    def _circle(self) -> float:
        """Return the radius of the circle on which it stays, 0 for a craft that comes to rest."""
        return 0.0

    def _cruise(self) -> float:
        """Return the speed of tasks that name none, m/s."""
        raise TypeError(f"{type(self).__name__} does not define how fast it goes")

    def _placed(self, place: Point) -> Point:
        """Return a place as the craft can be there, or just there."""
        return place[0], place[1], 0.0

    # ------------------------------------------------------------------ what is measured

    def _valid(self) -> tuple[bool, ...]:
        return self.position_valid, self.heading_valid

    def _here(self) -> Point:
        return self._placed(self.position_n)

    def _speed(self) -> float:
        north, east, _ = self.velocity_n
        speed: float = north * math.cos(self.heading) + east * math.sin(self.heading)
        return speed
