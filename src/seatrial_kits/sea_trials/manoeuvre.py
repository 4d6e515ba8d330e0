"""Standard manoeuvres, as orders to the pilot of any vehicle."""

from __future__ import annotations

import math
from typing import ClassVar

import numpy as np

from seatrial.control.guidance_orders import MANUAL_AXES, NED
from seatrial.model.component import Input, Output, Parameter, Terminal, terminal
from seatrial.model.sampled import Sampled

from .orders import (
    AT_REST,
    DEEP,
    HEADING,
    KINDS,
    LASTED,
    LASTING,
    MODES,
    PLANES,
    RATE,
    SETTLED,
    SLOW,
    Numbers,
    Order,
    is_turned,
)
from .steadiness import halves, noise
from .turn_rate import HelmForRate

_SLOWEST = 0.02
"""m/s; a change of speed within which a craft is steady, whatever its speed."""
_RATE = math.radians(0.02)
"""rad/s; the most that a change of the rate of turn may be, if 2 % are less."""
_RATE_LEAST = math.radians(0.0005)
"""rad/s; the change within which a rate without noise is steady: a thousandth of a big ship's."""
_HEADING = math.radians(1.0)
"""Change of the mean heading within which the approach is straight, rad."""
_DEPTH = 0.05
"""Change of the mean depth within which it is steady, m."""
_FOUND = 0.005
"""Change of the mean helm, and error of the mean rate, shares, within which a helm is found."""
_SPEED_SHARE, _RATE_SHARE = 0.01, 0.02
_PATIENCE = 20
"""Windows after which an order ends though nothing has become steady."""
_LINE = 2.0
"""Over which a speed is taken to fall evenly, s."""
_ASTERN = -0.5
"""Speed order before a manoeuvre that begins at rest, while the craft still moves ahead."""
_WATCHED = ("speed", "heading", "rate", "depth", "pitch", "helm")
_PROPULSORS = tuple(f"p{number}" for number in range(1, 9))


class Manoeuvre(HelmForRate, Sampled):
    """A standard manoeuvre: an approach until all is steady, then helm and speed by a sequence.

    **Approach.** The pilot holds the heading that it has (its mode ``stabilize``; in
    ``depth-hold``, by ``approach_mode``, at ``depth_start``) with the manual control ``speed``
    ahead, so that the order changes nothing but the helm. It is steady when the means over both
    halves of the last ``window`` differ by no more than 1 % of the speed or 0.02 m/s, and 1 deg of
    the heading; in depth-hold, 0.05 m of the depth too. What begins at rest begins when
    half astern has stopped a craft that moves ahead.

    **Orders.** Then the mode is manual, ``manual-depth`` after an approach in depth-hold: manual
    yaw is the helm order,

        helm_order = side clip(helm / full_helm),

    manual surge the speed order. ``helm`` is the rudder angle where the pilot's full deflection is
    ``full_helm``; with differential thrust or azimuth the same share of their full deflection.

    ================ =====================================================================
    turning-circle   helm until the heading has changed by ``turn``
    zig-zag          helm to alternate sides at changes of +-``heading_change``, five times
    initial-turning  helm until the heading has changed by 10 deg more than ``heading_change``
    pull-out         as turning-circle, then helm amidships until the rate is steady
    spiral           helm to -helm and back in steps of helm / ``steps``, each until the rate
                     is steady
    reverse-spiral   helm, then rates of turn down from its steady one in steps of that / ``steps``
                     to the other side: `HelmForRate` finds the helm of each
    crash-stop       full astern, helm amidships, until the speed along the bow is 0
    stopping         no thrust until the speed is ``slow`` of that of the approach
    acceleration     from rest, full ahead until the speed is steady, the heading held
    speed-trial      with 1, 0.75, 0.5 and 0.25 of ``speed``, a run until it is steady, a turn to
                     the reciprocal course, and a run back
    williamson       helm until ``heading_change``, then opposite until 190 deg the other way
    turn-on-the-spot from rest, helm until the heading has changed by ``turn``
    bollard-pull     from rest, on a line: full ahead until the rate is steady
    station-keeping  the mode hold, for five minutes after a ``window``
    depth-step       guided at ``guided_speed``: the depth of the approach, ``depth_start``,
                     changes by ``depth_change``, until it is steady
    vertical-zig-zag manual dive, the share helm / full_helm, down and up at changes of the pitch
                     of +-``heading_change``, five times
    ================ =====================================================================

    Steady is a rate of turn whose means differ by 2 %, by 0.0005 deg/s, or by what its noise
    explains, up to 0.02 deg/s (`steadiness`): the rest of a big ship's rate, which decays slowly,
    is no loop of a spiral. A depth is steady whose means differ by 0.05 m; an order that waits for
    a steady rate ends after 20 windows at the latest. The last order stays when the manoeuvre is
    ``done``. Orders are given at instants, up to one ``period`` after the heading is reached.
    Heading clockwise from north, rad; ``side`` 1 to starboard, -1 to port. The speed along the bow
    is that over ground. ``power`` is that of up to eight propulsors, ``line_force`` of the line at
    the bollard, {n}.

    Not modelled: a helmsman's lateness.
    """

    exercised: ClassVar = {"window": 1.0, "turn": 0.3, "speed": 0.5}

    period = Parameter(0.1, "s", "sample period", min=1e-6)
    kind = Parameter("turning-circle", "1", "the manoeuvre", choices=tuple(KINDS))
    helm = Parameter(math.radians(35.0), "rad", "helm of the manoeuvre", min=0.0)
    full_helm = Parameter(math.radians(35.0), "rad", "helm of full deflection", min=1e-6)
    side = Parameter("starboard", "1", "side of the first order", choices=("starboard", "port"))
    speed = Parameter(1.0, "1", "speed order of the approach, share of full", min=-1.0, max=1.0)
    heading_change = Parameter(
        math.radians(10.0), "rad", "heading change that ends a leg", min=1e-6, max=math.pi
    )
    turn = Parameter(math.radians(810.0), "rad", "heading change of turns", min=1e-6)
    steps = Parameter(5.0, "1", "steps of a spiral from amidships to helm", min=1.0)
    slow = Parameter(0.2, "1", "share of the approach speed that ends stopping", min=0.0, max=1.0)
    window = Parameter(60.0, "s", "how long all is steady before it goes on", min=1e-3)
    approach_mode = Parameter(
        "stabilize", "1", "the pilot's mode in the approach", choices=("stabilize", "depth-hold")
    )
    criteria = Parameter(
        "length", "1", "criteria for the figures: of ships of 100 m and more, imo, or none",
        choices=("length", "imo", "none"),
    )  # fmt: skip
    depth_start = Parameter(0.0, "m", "depth of the approach, in depth-hold", min=0.0)
    depth_change = Parameter(5.0, "m", "step of the depth, positive down")
    guided_speed = Parameter(0.0, "m/s", "speed of a depth step")

    heading = Input("rad", "heading, clockwise from north")
    velocity_n = Input("m/s", "velocity over ground, north-east-down", axes=NED)
    depth = Input("m", "depth, positive down", optional=True)
    pitch = Input("rad", "pitch, bow up", optional=True)
    power = Input("W", "power of propulsors", axes=_PROPULSORS, optional=True)
    line_force = Input("N", "force of a line on the craft", axes=NED, optional=True)

    mode = Output("1", "the pilot's mode", type=str, start="stabilize")
    armed = Output("1", "whether the pilot acts", type=bool)
    manual = Output("1", "manual control, -1 to 1", axes=MANUAL_AXES)
    target_kind = Output("1", "guided: a heading", type=str, start="heading")
    target_valid = Output("1", "guided: there is a set-point", type=bool)
    target_heading = Output("rad", "guided: heading of the approach")
    target_speed = Output("m/s", "guided: speed along the bow")
    target_position = Output("m", "guided: its down is the depth wanted", axes=NED)
    phase = Output("1", "0 approach, then the number of the order", type=int)
    helm_order = Output("1", "helm ordered, share of full, positive to turn to starboard")
    speed_order = Output("1", "speed ordered, share of full")
    order_time = Output("s", "time of the first order, -1 before", start=-1.0)
    done = Output("1", "whether the manoeuvre is over", type=bool)
    total_power = Output("W", "power of all propulsors")
    pull = Output("N", "horizontal pull of the line")

    terminals: ClassVar = {
        "orders": terminal(
            "mode",
            "armed",
            "manual",
            "target_kind",
            "target_valid",
            "target_heading",
            "target_position",
            "target_speed",
        ),
        "sensors": terminal("heading", "velocity_n", "depth", "pitch"),
        "drawn": Terminal({f"power{p[1:]}": f"power.{p}" for p in _PROPULSORS}),
    }

    # ------------------------------------------------------------------ running

    def reset(self, t: float) -> None:
        """Begin the approach."""
        self._samples = max(2, round(self.window / self.period))
        self._windows: dict[str, list[float]] = {name: [] for name in _WATCHED}
        self._turned = self._before = 0.0
        self._number, self._done, self._begun = 0, False, False
        self._ordered_at, self._course, self._fast = -1.0, 0.0, 0.0
        self._level, self._lasted, self._fixed, self._stopped = 0.0, 0, False, False
        self._begin_search(0.0)

    def sample(self, t: float, k: int) -> None:
        """Give the order that is in force."""
        self.armed, self.phase, self.done = True, self._number, self._done
        self.order_time = self._ordered_at
        self.mode = self._mode()
        share = self._share()
        dive = share if self._steers(PLANES) else self._descent()
        self.helm_order = 0.0 if self._steers(PLANES) else share
        self.speed_order = self._ahead()
        self.manual = [self.speed_order, 0.0, self.helm_order, dive]
        guided = self.mode == "guided"
        self.target_valid, self.target_kind = guided, "heading"
        self.target_heading, self.target_speed = self._course, self.guided_speed
        step = self.depth_change if self._number else 0.0
        self.target_position = [0.0, 0.0, self.depth_start + step]
        self.total_power = float(sum(self.power))
        self.pull = math.hypot(self.line_force[0], self.line_force[1])

    def update(self, t: float, k: int) -> None:
        """Take the measurements, and go on to the next order if this one has come to its end."""
        self._measure()
        if self._done or not self._is_over():
            return
        if self._number == len(self._sequence()):
            self._done = True
            return
        if self._number == 0:
            self._ordered_at = round(t + self.period, 9)
            self._turned -= self._mean("heading")
            self._fast, self._level = self._mean("speed"), self._mean("pitch")
        elif self._number == 1 and self._sequence()[1].by == RATE:
            self._begin_search(self._mean("rate"))
        self._number += 1
        self._lasted = 0
        self._windows = {name: [] for name in _WATCHED}

    # ------------------------------------------------------------------ orders

    def _sequence(self) -> list[Order]:
        numbers = Numbers(self.heading_change, self.turn, round(self.steps), self.slow, self.speed)
        return KINDS[self.kind](numbers)

    def _order(self) -> Order | None:
        return self._sequence()[self._number - 1] if self._number else None

    def _steers(self, by: str) -> bool:
        """Return whether the order in force steers by that."""
        order = self._order()
        return order is not None and order.by == by

    def _mode(self) -> str:
        if self.kind in MODES:
            return MODES[self.kind]
        order, approach = self._order(), str(self.approach_mode)
        if order is None or order.by == HEADING:
            return approach
        return "manual-depth" if self._is_deep() and order.by != PLANES else "manual"

    def _is_deep(self) -> bool:
        return bool(self.approach_mode == "depth-hold")

    def _share(self) -> float:
        """Return the share of full deflection that is ordered."""
        order = self._order()
        if order is None:
            return 0.0
        share = self._found if order.by == RATE else order.share
        most: float = min(self.helm / self.full_helm, 1.0) * self._side()
        return most * share + 0.0

    def _descent(self) -> float:
        """Return the manual dive that leads to the depth of the approach."""
        if self._number or not self._is_deep() or self.kind in MODES:
            return 0.0
        deeper: float = self.depth_start - self.depth
        return min(max(deeper, -1.0), 1.0)

    def _ahead(self) -> float:
        """Return the share of full speed that is ordered."""
        order = self._order()
        if order is not None and order.speed is not None:
            return order.speed
        if self.kind not in AT_REST:
            return float(self.speed)
        return 0.0 if self._stopped or self._speed() <= _SLOWEST else _ASTERN

    def _side(self) -> float:
        return 1.0 if self.side == "starboard" else -1.0

    # ------------------------------------------------------------------ measurements

    def _measure(self) -> None:
        if not self._begun:
            self._begun, self._before, self._course = True, self.heading, self.heading
        change = math.remainder(self.heading - self._before, math.tau)
        self._before = self.heading
        self._turned += change
        speed, rate = self._speed(), change / self.period
        if self._steers(RATE):
            order = self._order()
            assert order is not None
            self._search(order.share, self._turned, self.period)
        latest = (speed, self._turned, rate, self.depth, self.pitch, self._found)
        for name, value in zip(_WATCHED, latest, strict=True):
            self._windows[name] = [*self._windows[name][1 - self._samples :], value]
        # Before the first fix there is no velocity, which is no rest.
        self._fixed = self._fixed or any(self.velocity_n)
        self._stopped = self._stopped or (self._fixed and speed <= _SLOWEST)
        self._lasted += 1

    def _speed(self) -> float:
        north, east, _ = self.velocity_n
        speed: float = north * math.cos(self.heading) + east * math.sin(self.heading)
        return speed

    def _is_over(self) -> bool:
        """Return whether the approach or the order has come to its end."""
        order = self._order()
        if order is None:
            return self._is_ready()
        if order.until == LASTED:
            return self._has_lasted(LASTING)
        if order.until == SLOW:
            slowest: float = self._fast * (self.slow if order.speed == 0.0 else 0.0)
            return self._is_down_to(slowest)
        if order.until == SETTLED:
            found = order.by != RATE or self._is_found(order.share)
            steady = found and self._is_turning_steadily() and self._is_moving_steadily()
            return steady or self._has_lasted(_PATIENCE * self.window)
        if order.until == DEEP:
            return self._is_steady("depth", 0.0, _DEPTH)
        turned = self._level - self.pitch if order.by == PLANES else self._turned
        return is_turned(order, self._side() * turned)

    def _is_ready(self) -> bool:
        """Return whether the approach has come to its end."""
        if self.kind == "station-keeping":
            return self._has_lasted(self.window)
        level = not self._is_deep() and self.kind != "depth-step"
        level = level or self._is_steady("depth", 0.0, _DEPTH)
        straight = self._is_steady("heading", 0.0, _HEADING)
        return level and straight and self._is_moving_steadily()

    def _is_found(self, share: float) -> bool:
        """Return whether the rate is that share of the first one, with a steady helm."""
        if not self._is_steady("helm", 0.0, _FOUND):
            return False
        return abs(self._mean("rate") / self._rate - share) <= _FOUND

    def _is_down_to(self, slowest: float) -> bool:
        """Return whether the speed is no more than that, within four standard errors of its line.

        Of the latest seconds: one noisy measurement does not end an order.
        """
        count = min(max(round(_LINE / self.period), 3), self._samples)
        latest = np.array(self._windows["speed"][-count:])
        if len(latest) < count:
            return False
        since = np.arange(1.0 - count, 1.0)
        slope, now = np.polyfit(since, latest, 1)
        error = np.sqrt(np.square(latest - slope * since - now).sum() / max(count - 2, 1))
        return bool(now + 8.0 * error / np.sqrt(count) <= slowest)

    def _has_lasted(self, longest: float) -> bool:
        """Return whether the order in force has lasted so long, s."""
        return bool(self._lasted * self.period >= longest)

    def _is_turning_steadily(self) -> bool:
        if not self._is_steady("rate", _RATE_SHARE, _RATE):
            return False
        explained = noise(self._windows["rate"], self._samples)
        return self._is_steady("rate", _RATE_SHARE, min(_RATE, max(_RATE_LEAST, explained)))

    def _is_moving_steadily(self) -> bool:
        return self._is_steady("speed", _SPEED_SHARE, _SLOWEST)

    def _is_steady(self, name: str, share: float, least: float) -> bool:
        means = halves(self._windows[name], self._samples)
        return means is not None and means.agree(share, least)

    def _mean(self, name: str) -> float:
        """Return the mean of a measurement over the second half of the window."""
        means = halves(self._windows[name], self._samples)
        assert means is not None
        return means.second
