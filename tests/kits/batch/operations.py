"""A plant with every operation that equations may have, and a signal that drives it."""

from __future__ import annotations

import math

import casadi as ca

from seatrial.model.component import Component, Input, Output, Parameter
from seatrial.model.plant import Plant, State


class Wide(Plant):
    """x' and y' as odd functions of x, y, the push and two parameters."""

    gain = Parameter(1.5, "1", "scale")
    bend = Parameter(-0.7, "1", "offset")
    push = Input("1", "what drives it")
    x = State("1", "first")
    y = State("1", "second")
    seen = Output(("1",) * 3, "what follows at once", axes=("a", "b", "c"))

    def equations(self, x, u, p):
        a, b, c = x.x, x.y, u.push
        scale = ca.sqrt(p.gain**2 + ca.fabs(p.bend)) / ca.cosh(p.bend)
        smooth = ca.sin(a) * ca.cos(b) + ca.tan(0.3 * a) - ca.atan2(b, 1.0 + a * a)
        steep = ca.if_else(a > b, ca.exp(-a * a), ca.if_else(c <= 0.1, -b, ca.tanh(b)))
        edges = ca.fmin(a, b) - ca.fmax(c, p.bend) + ca.sign(a - 0.2) + ca.floor(3 * b)
        more = ca.if_else(ca.logic_and(a != c, ca.logic_not(b == 0)), ca.asin(0.9 * ca.sin(a)), 0)
        either = ca.if_else(ca.logic_or(b > 1, c > 0.5), ca.log(2 + c * c), ca.atan(b))
        powers = ca.constpow(ca.fabs(a) + 0.1, 1.3) + ca.ceil(c) + ca.sinh(0.1 * b) / (1 + c * c)
        dx = scale * smooth - a + 0.1 * (edges + powers)
        dy = p.gain * steep - b + more - either + 1 / (1.5 + ca.sin(c)) + 2 * p.bend
        return {"x": dx, "y": dy}, {"seen": ca.vertcat(dx, ca.acos(0.5 * ca.cos(b)), 3.0)}


class Drive(Component):
    """push = sin(7 t) + back / 2, and no number once its time is over."""

    until = Parameter(1e9, "s", "its time")
    back = Input("1", "from the plant")
    push = Output("1", "drives the plant")

    def outputs(self, t):
        far = 0.0 if t < self.until else 1e200
        self.push = math.sin(7.0 * t) + self.back / 2.0 + far * far
