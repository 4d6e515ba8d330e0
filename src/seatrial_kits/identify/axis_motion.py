"""Motion along, or about, one axis of a vehicle: the model that is fitted to a log."""

from __future__ import annotations

from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any

from seatrial.model.component import Input, Output, Parameter
from seatrial.model.plant import Plant, State


class AxisMotion(Plant):
    """One degree of freedom in still water, divided by its mass or moment of inertia A.

        place' = nu
        nu'    = (B/A) nu + (C/A) |nu| nu + D/A + (E/A) tau

    [Paulino2015], eqs 5.9 and 5.10, with the beta^2 of the latter, which cannot reverse, corrected
    to beta |beta|: ``thrust_law`` "linear" is f = beta, "quadratic" f = beta |beta|. ``linear``,
    ``quadratic``, ``offset`` and ``thrust`` are B/A, C/A (drag: not positive), D/A and E/A: a log
    of commands and motion determines these four ratios alone. beta is the command, -1 to 1; nu the
    velocity along the body axis, m/s, or about it, rad/s; place its integral.

    tau is the share of full thrust: f(beta) with ``lag`` "none", as in [Paulino2015]; with
    "thruster" T tau' = f(beta) - tau, T the ``time_constant``, which is ours: a mass that is
    identified from the motion of a vehicle whose thrusters need 0.15 s is 30 to 40 % too large
    without it.

    This class is surge, sway or heave, with A in kg; `AxisRotation` is yaw.

    Not modelled: the other axes and what couples them, current, tether. A delay of the command
    is the business of who gives it.
    """

    thrust_law = Parameter(
        "linear", "1", "thrust over the command", choices=("linear", "quadratic")
    )
    lag = Parameter("none", "1", "what delays the thrust", choices=("none", "thruster"))
    linear = Parameter(0.0, "1/s", "B/A: linear drag over mass", max=0.0)
    quadratic = Parameter(0.0, "1/m", "C/A: quadratic drag over mass", max=0.0)
    offset = Parameter(0.0, "m/s2", "D/A: constant force over mass")
    thrust = Parameter(1.0, "m/s2", "E/A: thrust of the command 1 over mass")
    time_constant = Parameter(0.15, "s", "time constant of the thrust, with a lag", min=1e-6)
    command = Input("1", "command of the thrust, -1 to 1", role="command")
    place = State("m", "distance along the axis")
    velocity = State("m/s", "velocity along the axis")
    share = State("1", "share of full thrust, with a lag")
    acceleration = Output("m/s2", "its rate of change")

    def equations(
        self, x: SimpleNamespace, u: SimpleNamespace, p: SimpleNamespace
    ) -> tuple[Mapping[str, Any], Mapping[str, Any]]:
        """Return the derivatives of place and velocity, and the acceleration."""
        goal = u.command * abs(u.command) if p.thrust_law == "quadratic" else u.command
        has_lag = p.lag == "thruster"
        drag = p.linear * x.velocity + p.quadratic * abs(x.velocity) * x.velocity
        acceleration = drag + p.offset + p.thrust * (x.share if has_lag else goal)
        slopes = {
            "place": x.velocity,
            "velocity": acceleration,
            "share": (goal - x.share) / p.time_constant if has_lag else 0.0,
        }
        return slopes, {"acceleration": acceleration}


class AxisRotation(AxisMotion):
    """Yaw: `AxisMotion` about an axis, with A in kg.m2; place is the angle, not wrapped."""

    linear = Parameter(0.0, "1/s", "B/A: linear drag over inertia", max=0.0)
    quadratic = Parameter(0.0, "1/rad", "C/A: quadratic drag over inertia", max=0.0)
    offset = Parameter(0.0, "rad/s2", "D/A: constant moment over inertia")
    thrust = Parameter(1.0, "rad/s2", "E/A: moment of the command 1 over inertia")
    place = State("rad", "angle about the axis, not wrapped")
    velocity = State("rad/s", "angular velocity")
    acceleration = Output("rad/s2", "its rate of change")
