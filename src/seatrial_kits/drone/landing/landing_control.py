"""Autopilot of a multirotor that lands on a moving deck."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, ClassVar

from seatrial.model.component import Input, Output, Parameter, terminal
from seatrial.model.sampled import Sampled
from seatrial.model.waypoints import NED
from seatrial.physics.craft.kinematics import to_ned

from . import laws
from .deck_estimate import DeckEstimate
from .tracking import Rows
from .windows import Windows

_EULER = ("phi", "theta", "psi")
_AHEAD = 0.2
"""How far ahead the deck's acceleration is fed forward, s."""
OFF, TAKE_OFF, TRANSIT, TRACK, WAIT, DESCEND, LANDED, GO_AROUND, ABORT = range(9)
MODES = (
    "off", "take-off", "transit", "track", "wait", "descend", "landed", "go-around", "abort"
)  # fmt: skip


class DeckLandingControl(Windows, DeckEstimate, Sampled):
    """Thrust and attitude for a landing on a deck that a camera sees and a craft reports.

    **States** (``mode``): 1 take-off, where ``starts_from`` is "deck"; 2 transit,
    to ``waypoint`` (north, east from the start) and back, where it is not 0; 3 track: over the
    pad, ``hover_height`` of the feet over its mean, for ``settle`` s and until it is within 0.3 m;
    4 wait for a window (predictive alone); 5 descend; 6 landed, motors off, ``legs_time`` after
    the legs carry a tenth of the weight; 7 go around: up to ``hover_height``, then 3; 8 abort:
    after ``attempts`` of these it holds ``hover_height`` where it is. 0 is before the start.

    **Horizontal** (`laws.below`): a = 3.0 e + 3.4 (v_deck - v) + 1.5 int e + a_deck 0.2 s ahead.
    **Vertical**, by ``control``: "naive" sinks at 0.4 m/s over ground; "relative" at that and 0.3
    per m above 0.5 m, at most 0.8, towards the deck, whose acceleration is fed forward by 0.7;
    "predictive" (`Windows`) waits for a predicted window, meets the predicted deck there by the
    law of least energy, and goes on as "relative" for the last 0.15 peak periods, or as soon as
    the deck is nearer than the way in which that law brakes (`laws.braking`).

    **Go around**: the mark is not seen for 1 s while above 0.5 m; the error is above 0.5 m while
    above 0.3 m, or above ``astray`` below; the predicted tilt at touch-down exceeds 9 degrees
    (predictive).

    What is known of the deck is in `DeckEstimate`. Positions {n}, north-east-down.
    """

    period = Parameter(0.01, "s", "sample period", min=1e-6)
    control = Parameter(
        "relative", "1", "vertical law", choices=("naive", "relative", "predictive")
    )
    mass = Parameter(10.0, "kg", "mass of the drone", min=1e-3)
    feet = Parameter((0.2, 0.2, 0.25), "m", "feet from the CG", axes="xyz", min=0.0)
    starts_from = Parameter("hover", "1", "where it starts", choices=("hover", "deck"))
    hover_height = Parameter(2.0, "m", "height of the feet over the pad's mean", min=0.0)
    waypoint = Parameter(0.0, "m", "where to fly before landing, from the start", axes=NED[:2])
    settle = Parameter(4.0, "s", "time over the pad before the descent", min=0.0)
    attempts = Parameter(20.0, "1", "go-arounds after which it gives up", min=0.0)
    astray = Parameter(0.5, "m", "error from which it does not land: feet beside the deck", min=0.0)
    legs_time = Parameter(0.05, "s", "from load on the legs to motors off", min=0.0)

    legs_load = Input("N", "force on the legs, as their switches have it", optional=True)

    thrust = Output("N", "thrust wanted")
    attitude_wanted = Output("rad", "Euler angles wanted, ZYX", axes=_EULER)
    motors = Output("1", "whether the motors turn", type=bool)
    mode = Output("1", "state of the autopilot: 3 track, 5 descend, 6 landed ...")
    go_arounds = Output("1", "how often it went around")
    height = Output("m", "estimated height of the feet over the pad, 0 before it is seen")
    error = Output("m", "estimated horizontal error, 0 before the pad is seen")
    window = Output("s", "time of the touch-down that it has committed to, 0 for none")
    pad = Output(
        "m", "estimated place of the pad, {n}; 0 before it is seen and once landed", axes=NED
    )
    pad_ahead = Output("m", "expected place of the pad at time_ahead, {n}", axes=NED)
    deck_ahead = Output("rad", "expected Euler angles of the deck at time_ahead", axes=_EULER)
    time_ahead = Output("s", "time of pad_ahead: the window, or without one 0.2 s on; 0 as pad")

    terminals: ClassVar = {
        **DeckEstimate.terminals,
        "wanted": terminal("thrust", "attitude_wanted", "motors"),
    }
    views: ClassVar = {
        "foreseen": {
            "attitude": "attitude",
            "now": "pad",
            "place": "pad_ahead",
            "turn": "deck_ahead",
            "time": "time_ahead",
            "aim": "window",
        },
        "state": {
            "attitude": "attitude",
            "value": "mode",
            "first": "0",
            "words": ", ".join(MODES),
        },
    }
    exercised: ClassVar = {
        **DeckEstimate.exercised,
        "control": "predictive",
        "settle": 0.1,
    }

    def reset(self, t: float) -> None:
        """Start in the air, or with the motors off on the deck."""
        self._mode = OFF
        self._since = t
        self._home = self._hold = [0.0] * 4
        self._integral = (0.0, 0.0)
        self._loaded = -1.0
        self._around = 0.0
        self._out = 0
        self._held: list[Any] = [0.0, [0.0] * 3, False, 0.0, 0.0]
        self._expected: list[Any] = [[0.0] * 3, [0.0] * 3, [0.0] * 3, 0.0]
        self.reset_estimate(t)
        self.reset_windows(t)

    def sample(self, t: float, k: int) -> None:
        """Publish the orders of the instant before: what an autopilot computes takes a period."""
        thrust, attitude, motors, height, error = self._held
        if self._mode == OFF:
            attitude = [0.0, 0.0, self.attitude[2]]
        self.thrust, self.attitude_wanted, self.motors = thrust, attitude, motors
        self.mode, self.go_arounds = float(self._mode), self._around
        self.height, self.error, self.window = height, error, max(self._target, 0.0)
        pad, ahead, turned, when = self._expected
        self.pad, self.pad_ahead, self.deck_ahead, self.time_ahead = pad, ahead, turned, when

    def update(self, t: float, k: int) -> None:
        """Take in what sensors have, go on to the state that follows, compute the orders."""
        self.observe(t)
        deck = self.deck_at(t)
        own = to_ned(self.attitude, self.velocity)
        if self._mode == OFF:
            self._home = self._hold = [*self.position, self.attitude[2]]
            self._change(TAKE_OFF if self.starts_from == "deck" else self._after_start(), t)
        height = deck[0][2] - self.position[2] - self.feet[2]
        error = [deck[0][i] - self.position[i] for i in range(2)]
        off = math.hypot(*error)
        self._next_mode(t, height, off)
        shown = [height, off] if self._known else [0.0, 0.0]
        self._expect(t, deck[0])
        if self._mode == LANDED:
            self._held = [0.0, [0.0, 0.0, self._heading()], False, *shown]
            return
        aside = self._aside(t, deck, own, error, height)
        down = self._down(t, deck, own, height)
        thrust, attitude = laws.thrust_for((*aside, down), self.mass, self._heading())
        self._held = [thrust, [*attitude], True, *shown]

    # ------------------------------------------------------------------ states

    def _change(self, mode: int, t: float) -> None:
        self._mode, self._since = mode, t
        if mode not in (WAIT, DESCEND):
            self.forget_window()

    def _after_start(self) -> int:
        return TRANSIT if any(self.waypoint) else TRACK

    def _next_mode(self, t: float, height: float, off: float) -> None:
        """Change the state where it is over."""
        mode, lost = self._mode, self.lost_for(t)
        if mode in (DESCEND, GO_AROUND) and self._stands(t):
            self._change(LANDED, t)
        elif mode == TAKE_OFF and self._home[2] - self.position[2] > self.hover_height - 0.3:
            self._change(self._after_start(), t)
        elif mode == TRANSIT and self._arrived():
            self._out += 1
            if self._out > 1:
                self._change(TRACK, t)
        elif mode == TRACK:
            if t - self._since >= self.settle and off < 0.3 and lost < 0.5:
                self._change(WAIT if self.control == "predictive" else DESCEND, t)
        elif mode == WAIT and lost > 1.0:
            self._change(TRACK, t)
        elif (
            self.control == "predictive"
            and mode == WAIT
            and self.finds_window(t, t - self._since, height)
        ):
            self._change(DESCEND, t)
        elif mode == DESCEND and self._must_go_around(t, height, off, lost):
            self._around += 1.0
            self._change(ABORT if self._around >= self.attempts else GO_AROUND, t)
        elif mode == GO_AROUND and height > self.hover_height - 0.3 and lost < 0.5:
            self._change(TRACK, t)

    def _stands(self, t: float) -> bool:
        """Return whether the legs have carried a tenth of the weight for long enough."""
        if self.legs_load <= 0.1 * self.mass * laws.GRAVITY:
            # A first touch of a moment counts on: the legs bounce.
            self._loaded = -1.0 if self._loaded < 0.0 or t - self._loaded > 0.5 else self._loaded
        elif self._loaded < 0.0:
            self._loaded = t
        return self._loaded >= 0.0 and t - self._loaded >= self.legs_time - 1e-9

    def _must_go_around(self, t: float, height: float, off: float, lost: float) -> bool:
        if self._loaded >= 0.0:
            return False
        unseen = lost >= 1.0 and height > 0.5
        astray = off > (0.5 if height > 0.3 else self.astray)
        return unseen or astray or (self.control == "predictive" and self.tilts_too_far(t))

    def _arrived(self) -> bool:
        north, east = self._goal()
        return math.hypot(north - self.position[0], east - self.position[1]) < 1.0

    def _goal(self) -> Sequence[float]:
        """Return where the transit goes: out to the waypoint, then back to the start."""
        out = self.waypoint if self._out == 0 else (0.0, 0.0)
        return self._home[0] + out[0], self._home[1] + out[1]

    def _expect(self, t: float, pad: Sequence[float]) -> None:
        """Note the pad now, and pad and deck at the window, or without one a moment ahead."""
        if not self._known or self._mode == LANDED:
            self._expected = [[0.0] * 3, [0.0] * 3, [0.0] * 3, 0.0]
            return
        when, slopes = t + _AHEAD, self.slopes_at(t + _AHEAD)
        place = self.deck_at(when)[0]
        if self._target > t:
            when, slopes = self._target, (self._foreseen[1], self._foreseen[2])
            place = [pad[0], pad[1], -self._foreseen[0]]
        psi = self.deck_heading()
        c, s = math.cos(psi), math.sin(psi)
        theta = math.atan(c * slopes[0] + s * slopes[1])
        phi = -math.atan(c * slopes[1] - s * slopes[0])
        self._expected = [[*pad], [*place], [phi, theta, psi], when]

    # ------------------------------------------------------------------ laws

    def _heading(self) -> float:
        """Return the heading to hold: the craft's as last reported, before that its own."""
        return self.deck_heading() if self._reports else self._home[3]

    def _aside(
        self, t: float, deck: Rows, own: Sequence[float], error: Sequence[float], height: float
    ) -> Sequence[float]:
        follows = self._mode in (TRACK, WAIT, DESCEND) or (
            self._mode == GO_AROUND and self.lost_for(t) < 1.0
        )
        if follows and self.lost_for(t) < 1.0:
            self._integral = laws.integrated(self._integral, error, self.period)
            slower = [deck[1][i] - own[i] for i in range(2)]
            ahead = self.deck_at(t + _AHEAD)[2]
            self._hold = [*self.position, self._home[3]]
            return laws.below(error, slower, self._integral, ahead[:2], height)
        goal = self._goal() if self._mode == TRANSIT else self._hold[:2]
        away = [g - p for g, p in zip(goal, self.position, strict=False)]
        length = math.hypot(*away)
        error = [a * min(1.0, 2.0 / length) if length else 0.0 for a in away]
        if length < 2.0:
            self._integral = laws.integrated(self._integral, error, self.period)
        return laws.below(error, [-v for v in own[:2]], self._integral, (0.0, 0.0), 1e3)

    def _down(self, t: float, deck: Rows, own: Sequence[float], height: float) -> float:
        if self._mode != DESCEND:
            mean = self.mean_down()
            over = self._home[2] + self.feet[2] if self.starts_from == "deck" else None
            level = mean if mean is not None else over
            if level is None:
                return laws.rising(self._home[2] - self.position[2], own[2])
            wanted = level - self.hover_height - self.feet[2]
            return laws.rising(wanted - self.position[2], own[2])
        if self.control == "naive":
            return laws.down(0.4, own[2], 0.0)
        left = self._target - t
        braked = height > laws.braking(own[2] - deck[1][2])
        if self.control == "predictive" and left > 0.15 * self.wave_period and braked:
            return self.meets(t, self.position[2] + self.feet[2], own[2], left)
        wanted = deck[1][2] + laws.sinking(height)
        return laws.down(wanted, own[2], deck[2][2])
