"""Report by radio of the motion of a craft's landing pad."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import ClassVar

from seatrial.devices.sensor import Derived, Measured, Sensor, Value
from seatrial.model.component import Input, Parameter, terminal
from seatrial.model.waypoints import NED
from seatrial.physics.craft.kinematics import cross, to_ned

_DEG = math.pi / 180.0


class DeckReport(Sensor):
    """Attitude and rates of a craft, and the velocity of its pad, as received by a drone.

        deck_attitude, deck_rates                     rad, rad/s
        pad_velocity = R (velocity + rates x pad)     m/s, {n}

    with the errors of `Sensor` on each; ``delay`` is the time from measurement to reception,
    ``dropout`` the share of messages lost. ``reported`` is the time of measurement.
    Singular at a pitch of 90 degrees. The pad's position is not reported: it takes two receivers.
    """

    exercised: ClassVar = {"attitude": [0.1, 0.2, 0.3], "rates": [0.1, 0.2, 0.3]}

    period = Parameter(0.05, "s", "time between two messages", min=1e-6)
    delay = Parameter(0.06, "s", "time from measurement to reception", min=0.0)
    dropout = Parameter(0.02, "1", "probability that a message is lost", min=0.0, max=1.0)
    pad = Parameter((0.0, 0.0, -0.2), "m", "landing point from the craft's origin", axes="xyz")

    attitude = Input("rad", "Euler angles of the craft", axes=("phi", "theta", "psi"))
    velocity = Input("m/s", "velocity of the craft's origin, its body axes", axes="uvw")
    rates = Input("rad/s", "angular velocity of the craft, its body axes", axes="pqr")

    deck_attitude = Measured(
        "rad",
        "Euler angles of the craft",
        axes=("phi", "theta", "psi"),
        span=(-math.pi, math.pi),
        noise=0.3 * _DEG,
    )
    deck_rates = Measured(
        "rad/s", "angular velocity, body axes", axes="pqr", span=(-2.0, 2.0), noise=0.2 * _DEG
    )
    pad_velocity = Measured(
        "m/s", "velocity of the pad, {n}", axes=NED, span=(-5.0, 5.0), noise=0.02
    )
    reported = Derived("s", "time of the measurement")

    terminals: ClassVar = {
        "motion": terminal("attitude", "velocity", "rates"),
        "report": terminal(
            "deck_attitude",
            "deck_rates",
            "pad_velocity",
            "reported",
            report_valid="valid",
            report_count="count",
        ),
    }

    feedthrough: ClassVar = {
        "valid": ("fault",),
        "count": ("fault",),
        "deck_attitude": ("attitude", "fault"),
        "deck_rates": ("rates", "fault"),
        "pad_velocity": ("attitude", "velocity", "rates", "fault"),
        "reported": (),
    }

    def measure(self) -> Sequence[Value]:
        """Return attitude, rates and the pad's velocity."""
        swing = cross(self.rates, self.pad)
        own = [v + s for v, s in zip(self.velocity, swing, strict=True)]
        return [*self.attitude, *self.rates, *to_ned(self.attitude, own)]

    def derive(self, values: Sequence[Value]) -> Sequence[Value]:
        """Return the time of the measurement."""
        return [self._instant_ns() * 1e-9]
