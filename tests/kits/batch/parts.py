"""A cork in a stream, a log of its speed and a pilot that holds its place."""

from __future__ import annotations

import casadi as ca
import numpy as np

from seatrial.model.component import Component, Input, Output, Parameter
from seatrial.model.mixins import Noise
from seatrial.model.plant import State
from seatrial.model.sampled import Sampled
from seatrial.physics.craft.surrounded import SurroundedPlant, surrounding


class Cork(SurroundedPlant):
    """Mass that a stream drags along: m v' = push - drag (v - stream)."""

    surrounding_ports = (surrounding("stream", "m/s", "velocity of the stream", ("n",)),)
    current_speed = Parameter(0.0, "m/s", "speed of the stream", role="current")
    mass = Parameter(2.0, "kg", "mass", min=0.1)
    drag = Parameter(1.0, "N.s/m", "drag", min=0.0)
    form = Parameter("linear", "1", "of the drag", choices=("linear", "square"))
    push = Input("N", "force of the pilot")
    x = State("m", "place")
    v = State("m/s", "speed over ground")
    nu_r = Output(
        ("m/s",) * 3 + ("rad/s",) * 3, "through the water", axes=("u", "v", "w", "p", "q", "r")
    )

    def equations(self, x, u, p):
        stream = getattr(u, "stream", None)
        slip = x.v if stream is None else x.v - stream[0]
        pull = slip if p.form == "linear" else slip * ca.fabs(slip)
        through = ca.vertcat(slip, 0, 0, 0, 0, 0)
        return {"x": x.v, "v": (u.push - p.drag * pull) / p.mass}, {"nu_r": through}

    def met(self):
        speed = self.current_speed
        return (lambda _t, _x: np.array([speed])) if speed else None


class Walker(Noise, Sampled):
    """A random walk: x_k+1 = x_k + n_k."""

    x = Output("m", "place")

    def reset(self, t):
        self._x = 0.0

    def sample(self, t, k):
        self.x = self._x

    def update(self, t, k):
        drawn: list[float] = self.generator(k).standard_normal(1).tolist()
        self._x += drawn[0]


class Pilot(Component):
    """Pulls to where it shall be; too far off it gives up."""

    gain = Parameter(4.0, "N/m", "force per distance", tunable=True)
    reach = Parameter(1e9, "m", "distance at which it has no answer")
    place = Input("m", "where it is")
    speed = Input("m/s", "how fast it goes through the water, as the log says")
    wanted = Input("m", "where it shall be")
    idle = Input("1", "whether it lets go", type=bool)
    force = Output("N", "force")

    def outputs(self, t):
        off = self.wanted - self.place
        far = 0.0 if abs(off) < self.reach else 1e200
        self.force = 0.0 if self.idle else self.gain * off - 2.0 * self.speed + far * far
