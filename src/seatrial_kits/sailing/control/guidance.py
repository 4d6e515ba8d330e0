"""Guidance of a sailing boat that cannot tack."""

from __future__ import annotations

import math
from typing import ClassVar, NamedTuple

from seatrial.control.guidance_motion import BEAT, FOLLOW, MANUAL, NEUTRAL, Command
from seatrial.control.guidance_orders import TASKS, Decision, GuidanceOrders
from seatrial.control.guidance_path import Point, bearing
from seatrial.model.component import Input, Output, Parameter, terminal

from .course import Laid, laid, side, turn, turned
from .lookout import OBSTACLE, Track, clear_heading, placed, watched

MODES = ("manual", *TASKS)
"""Values of the input ``mode``."""

SLOTS = tuple(f"d{number}" for number in range(1, 7))
"""Detections of a camera's frame."""
_ANY_SPEED = 1.0  # m/s; the wind decides how fast it goes, 0 is to stop


class _Sailed(NamedTuple):
    """A decision, and what the wind makes of it. SI, angles in rad."""

    decision: Decision
    heading: float
    """Heading wanted now."""
    course: float
    """Course to be on in the end."""
    tack: int
    wearing: bool = False
    held: tuple[bool, bool] = (False, False)
    """Whether the autopilots for heading and sail act."""
    avoided: float = 0.0
    """By how much the course was turned for an obstacle."""


class SailingGuidance(GuidanceOrders):
    """Guidance in six modes of a boat that wears round where others tack.

    ======= ===============================================================================
    manual  ``direct`` is manual control: yaw for the rudder, surge for the sheet
    hold    stay where the mode was set
    guided  position: go there and stay; velocity: sail its direction; heading: sail
            ``target_heading``. Without ``target_valid`` as hold
    auto    follow leg number ``leg``, then stay there until another number comes
            (`Course`, or a mission service); as hold while it is 0
    return  go to ``home`` and stay
    loiter  circle, with ``loiter_radius``, about where the mode was set
    ======= ===============================================================================

    The wind decides how fast it goes: of speeds only 0 and less are obeyed, which is to lie to.

    **Neutral.** Not ``armed``, or without a heading or (but in manual) a position for longer than
    ``timeout``, no autopilot acts and ``direct`` is 0: rudder amidships, sail streaming.

    **Course.** Legs, lines to a position and circles are followed by line of sight as in
    `Guidance`. What is wanted goes through `laid`: no course is closer to the wind than
    ``closest``; a direction closer than that is beaten to, until it lies ``margin`` more than
    ``closest`` on the other tack, and ``closest`` still when the boat has worn round and lost
    ``wearing_loss`` of ground. While the end of a leg lies so, the boat beats for the end and
    not along the line; the line then begins where the end could be laid.

    **Bearing away.** A keel needs speed: below ``steerage`` ahead the boat makes leeway, loses
    more speed and ends in irons. Then ``closest`` is ``away`` instead, until it makes
    ``steerage`` times ``recovered``.

    **Turns.** The heading wanted goes to the course at ``turn_rate``, the shorter way, unless
    that leads through the eye of the wind: then the longer way, through dead downwind, which is
    wearing round (`turn`). It waits while it is more than ``lead`` away from the heading.

    **Staying.** Within ``drift_limit`` the boat lies to: the sail streams, and it rounds up to
    ``lying`` off the wind; without way (below ``steerage``) nobody steers. Beyond, it sails for
    the point, until within ``capture_radius``, from where its way takes it some lengths on.
    A circle is sailed as far as the wind allows: upwind it becomes boards.

    **Lookout.** With a ``clearance`` it keeps clear of obstacles that a camera detects
    (``detected`` in ``frame``, each with ``sight_bearing``, ``sight_size``, ``sight_kind``). One is
    taken for a sphere of ``obstacle_diameter``, which gives its distance and so its place; seen
    ``confirmations`` times and within ``lookout_range``, it is kept clear of until it was not seen
    for ``forget`` (`watched`, `clear_heading`). The course turns to the nearest that passes, no
    closer to the wind than ``closest``. ``avoiding`` and ``obstacles`` are as of the last sample.

    ``wind`` is the true wind: where it blows to. Positions in {n}, m; headings clockwise from
    north, rad; ``heading_wanted`` is the heading while no autopilot holds it.

    Not modelled: the motion of obstacles, laylines that allow for leeway and current.

    Raises InputError at the start for capture_radius not less than drift_limit, and in a run for
    a mode or kind of target that is none.
    """

    exercised: ClassVar = {
        "armed": True,
        "position_valid": True,
        "heading_valid": True,
        "target_valid": True,
        "leg_wait": 0.0,
        "leg_radius": 4.0,
        "leg_circle": 0.0,
        "lookahead": 2.0,
        "acceptance_radius": 2.0,
        "drift_limit": 3.0,
        "capture_radius": 2.0,
        "loiter_radius": 4.0,
        "steerage": 0.1,
        "turn_rate": 1e3,
        "lead": 3.0,
        "wearing_loss": 0.0,
    }

    modes = MODES

    lookahead = Parameter(20.0, "m", "lookahead distance", min=1e-3, tunable=True)
    integral_gain = Parameter(
        0.0, "m/s", "gain of the integral of the cross-track error", min=0.0, tunable=True
    )
    acceptance_radius = Parameter(
        8.0, "m", "distance at which a position is reached", min=0.0, tunable=True
    )
    drift_limit = Parameter(40.0, "m", "drift from which it goes back", min=0.0, tunable=True)
    capture_radius = Parameter(
        20.0, "m", "distance at which it is back, up to drift_limit", min=0.0, tunable=True
    )
    loiter_radius = Parameter(
        60.0, "m", "radius of circles, negative for anticlockwise", tunable=True
    )
    closest = Parameter(
        math.radians(60.0),
        "rad",
        "least angle off the wind",
        min=0.0,
        max=math.pi / 2,
        tunable=True,
    )
    margin = Parameter(
        math.radians(5.0), "rad", "more than that before the other tack", min=0.0, tunable=True
    )
    away = Parameter(
        math.radians(110.0),
        "rad",
        "least angle off the wind without way",
        min=0.0,
        max=math.pi,
        tunable=True,
    )
    wearing_loss = Parameter(
        40.0, "m", "ground lost to leeward in wearing round", min=0.0, tunable=True
    )
    lying = Parameter(
        math.radians(70.0),
        "rad",
        "angle off the wind at which it lies to",
        min=0.0,
        max=math.pi,
        tunable=True,
    )
    steerage = Parameter(0.5, "m/s", "speed ahead below which it bears away", min=0.0, tunable=True)
    recovered = Parameter(
        2.0, "1", "times steerage at which it luffs up again", min=1.0, tunable=True
    )
    turn_rate = Parameter(
        math.radians(6.0), "rad/s", "rate of the heading wanted", min=1e-9, tunable=True
    )
    lead = Parameter(
        math.radians(45.0),
        "rad",
        "lead at which the heading wanted waits",
        min=1e-9,
        max=math.pi,
        tunable=True,
    )

    clearance = Parameter(
        0.0, "m", "distance kept from obstacles, 0: it looks for none", min=0.0, tunable=True
    )
    obstacle_diameter = Parameter(
        1.0, "m", "what an obstacle is taken to measure", min=1e-3, tunable=True
    )
    lookout_range = Parameter(60.0, "m", "distance at which one matters", min=0.0, tunable=True)
    confirmations = Parameter(3.0, "1", "sightings that make an obstacle", min=1.0, tunable=True)
    forget = Parameter(20.0, "s", "without a sighting, after which it is gone", min=0.0)

    mode = Input("1", f"one of {', '.join(MODES)}", type=str, start="hold", choices=MODES)
    wind = Input("m/s", "true wind over ground: where it blows to, {n}", axes=("north", "east"))
    sight_bearing = Input(
        "rad", "bearing of each detection, to starboard", axes=SLOTS, optional=True
    )
    sight_size = Input("rad", "apparent diameter of each", axes=SLOTS, optional=True)
    sight_kind = Input("1", "kind of each: 2 obstacle", type=int, axes=SLOTS, optional=True)
    detected = Input("1", "number of detections in the frame", type=int, optional=True)
    frame = Input("1", "number of the frame", type=int, optional=True)

    engaged = Output("1", "which autopilots act", type=bool, axes=("heading", "sail"))
    direct = Output("1", "rudder to starboard, -1 to 1, and sheet, 0 to 1", axes=("yaw", "sheet"))
    course = Output("rad", "course to be on in the end, clockwise from north")
    wearing = Output("1", "whether it turns the long way, away from the wind", type=bool)
    avoiding = Output("1", "whether it has turned from its course for an obstacle", type=bool)
    obstacles = Output("1", "number of obstacles that matter", type=int)
    state = Output(
        "1", "0 neutral, 1 piloted, 2 stays, 3 follows a leg, 4 steers, 5 beats", type=int
    )

    _ABLE = ("mode", "armed", "position_valid", "heading_valid")
    _GOAL = (
        *("target_kind", "target_valid", "target_position", "leg", "leg_to", "home", "position_n"),
    )
    _STATE = ("target_speed", "leg_speed", "leg_radius")
    _SPEED = (*_GOAL, *_STATE, "target_velocity", "leg_circle")
    _SAILED = (*_ABLE, *_SPEED, "leg_from", "target_heading", "heading", "velocity_n", "wind")
    feedthrough: ClassVar = {
        "engaged": (*_ABLE, *_SPEED, "heading", "velocity_n"),
        "direct": ("mode", "armed", "manual"),
        "avoiding": (),
        "state": (*_ABLE, *_GOAL, *_STATE, "heading", "velocity_n", "wind"),
        "cross_track": (*_ABLE, *_SPEED, "leg_from", "heading", "velocity_n", "wind"),
        "distance": (*_ABLE, *_GOAL),
        "reached": (*_ABLE, "leg", "leg_to", "leg_radius", "leg_wait", "position_n"),
    }
    terminals: ClassVar = {
        **GuidanceOrders.terminals,
        "estimate": terminal("wind"),
        "sightings": terminal(
            "detected", "frame", bearing="sight_bearing", size="sight_size", kind="sight_kind"
        ),
        "wanted": terminal(
            "heading_wanted",
            heading_engaged="engaged__heading",
            sail_engaged="engaged__sail",
            direct_yaw="direct__yaw",
            direct_sheet="direct__sheet",
        ),
    }

    # ------------------------------------------------------------------ running

    def reset(self, t: float) -> None:
        """Start with nothing wanted; raises InputError for radii that do not go together."""
        super().reset(t)
        self._tack, self._slow = 0, False
        self._before: float | None = None
        self._tracks: list[Track] = []
        self._avoided, self._frame, self._seen = 0.0, 0, 0

    def sample(self, t: float, k: int) -> None:
        """Publish the heading wanted, and which autopilots act."""
        sailed = self._decide()
        self._publish(sailed.decision)
        self.engaged = sailed.held
        piloted = sailed.decision.command.motion == MANUAL
        surge, _, yaw, _ = self.manual if piloted else (0.0,) * 4
        self.direct = min(max(yaw, -1.0), 1.0), min(max(surge, 0.0), 1.0)
        self.heading_wanted = math.remainder(sailed.heading, math.tau)
        self.course = math.remainder(sailed.course, math.tau)
        self.wearing = sailed.wearing
        self.avoiding, self.obstacles = bool(self._avoided), self._seen

    def update(self, t: float, k: int) -> None:
        """Remember task, tack and heading wanted."""
        sailed = self._decide()
        self._remember(sailed.decision)
        self._tack, self._before, self._slow = sailed.tack, sailed.heading, self._is_slow()
        self._avoided, self._seen = sailed.avoided, len(self._near())
        self._look_out(t)

    # ------------------------------------------------------------------ deciding

    def _decide(self) -> _Sailed:
        here, manual = self._here(), self._checked_mode() == "manual"
        before = self.heading if self._before is None else self._before
        if not (self.armed and self._known(not manual, not manual)):
            return self._unsteered(NEUTRAL, here)
        if manual:
            return self._unsteered(MANUAL, here)
        decision = self._ordered(before, here[2])
        if decision.command.speed <= 0.0:
            return self._lying(decision, before)
        return self._sailing(decision, before)

    def _unsteered(self, motion: int, here: Point) -> _Sailed:
        decision = Decision(Command(motion, self.heading, 0.0, here[2]))
        return _Sailed(decision, self.heading, self.heading, 0)

    def _lying(self, decision: Decision, before: float) -> _Sailed:
        """Lie to: steered while there is way, the sail streaming."""
        tack = side(math.remainder(before - self._eye(), math.tau))
        lying = self._towards(decision, self._eye() + tack * self.lying, tack, before)
        if self._is_slow():
            return lying._replace(heading=self.heading, held=(False, False))
        return lying._replace(held=(True, False))

    def _sailing(self, decision: Decision, before: float) -> _Sailed:
        """Sail the course that is wanted, or the nearest to it."""
        wanted, here, eye = decision.command, self._here(), self._eye()
        tack = self._tack or side(math.remainder(before - eye, math.tau))
        closest = self.away if self._is_slow() else self.closest
        if wanted.motion == FOLLOW:
            to_end = self._laid_to(decision.end, tack, closest)
            tack = to_end.tack
            if to_end.beats:
                # A new line begins where the end can be laid.
                wanted = wanted._replace(motion=BEAT, across=0.0, integral_rate=0.0)
                past = decision.past._replace(integral=0.0)
                decision = decision._replace(command=wanted, start=here, past=past)
                return self._clear_of_obstacles(decision, to_end.course, tack, before)
        along = laid(wanted.heading, eye, tack, closest, self.margin)
        if along.beats:
            decision = decision._replace(command=wanted._replace(integral_rate=0.0))
        return self._clear_of_obstacles(decision, along.course, along.tack, before)

    def _clear_of_obstacles(
        self, decision: Decision, course: float, tack: int, before: float
    ) -> _Sailed:
        """Turn towards a course, or the nearest to it that keeps clear of obstacles."""
        near = self._near()
        if not near:
            return self._towards(decision, course, tack, before)
        here, closest = self._here(), self.closest
        clear = clear_heading(
            course, near, here, self.clearance, self._eye(), closest, self._avoided
        )
        avoided = math.remainder(clear - course, math.tau)
        return self._towards(decision, clear, tack, before)._replace(avoided=avoided)

    def _laid_to(self, end: Point, tack: int, closest: float) -> Laid:
        """Return the course to the end of a leg; on the other tack only if wearing pays."""
        here, eye = self._here(), self._eye()
        to_end = laid(bearing(here, end), eye, tack, closest, self.margin)
        upwind = math.cos(to_end.course - eye) > 0.0
        if to_end.tack == tack or not upwind:
            return to_end
        lost = self.wearing_loss
        after = here[0] - lost * math.cos(eye), here[1] - lost * math.sin(eye), here[2]
        off = math.remainder(bearing(after, end) - eye, math.tau)
        if abs(off) >= closest:
            return to_end
        return Laid(eye + tack * closest, tack, True)

    def _towards(self, decision: Decision, course: float, tack: int, before: float) -> _Sailed:
        """Turn the heading wanted on towards a course."""
        to_turn = turn(before, course, self._eye())
        most = self.turn_rate * self.period
        wanted = turned(before, to_turn, most, self.heading, self.lead)
        wearing = abs(to_turn) > math.pi
        return _Sailed(decision, wanted, course, tack, wearing, (True, True))

    # ------------------------------------------------------------------ what the boat can do

    def _cruise(self) -> float:
        return _ANY_SPEED

    # ------------------------------------------------------------------ what is measured

    def _near(self) -> list[Track]:
        """Return the obstacles that matter."""
        here = self._here()[:2]
        return [
            track
            for track in self._tracks
            if track[3] >= self.confirmations and math.dist(track[:2], here) <= self.lookout_range
        ]

    def _look_out(self, t: float) -> None:
        """Take in a new frame."""
        if not self.clearance:
            return
        here, count = self._here(), max(0, self.detected) if self.frame != self._frame else 0
        self._frame = self.frame
        rows = zip(self.sight_bearing, self.sight_size, self.sight_kind, strict=True)
        seen = [
            placed(bearing, size, self.obstacle_diameter, here, self.heading)
            for bearing, size, kind in list(rows)[:count]
            if kind == OBSTACLE
        ]
        there = [each for each in seen if each is not None]
        self._tracks = watched(self._tracks, there, t, self.forget)

    def _eye(self) -> float:
        """Return where the wind comes from, rad clockwise from north."""
        north, east = self.wind
        return math.atan2(-east, -north)

    def _is_slow(self) -> bool:
        enough: float = self.steerage * (self.recovered if self._slow else 1.0)
        return self._speed() < enough
