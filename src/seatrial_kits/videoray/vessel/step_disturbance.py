"""Step disturbance between two times."""

from __future__ import annotations

from typing import ClassVar

from seatrial.errors import InputError
from seatrial.model.component import Component, Output, Parameter, terminal

_LOAD = ("N", "N", "N.m")
_UVR = ("m/s", "m/s", "rad/s")


class StepDisturbance(Component):
    """Constant load on a vessel, or error of its sensors, between two times.

    ``step_size`` is surge force X, sway force Y, N, yaw moment N, N.m, positive to starboard, in
    body axes, and the errors of the measured u, v, m/s, and r, rad/s. They act from
    ``begin_time`` to before ``end_time``, simulated time, s; before and afterwards all are 0.

    Raises InputError at the start if ``end_time`` is not after ``begin_time``.
    """

    exercised: ClassVar = {"step_size": 1.0, "begin_time": 0.2, "end_time": 0.7}

    discrete = True

    step_size = Parameter(
        0.0, (*_LOAD, *_UVR), "load, body axes, and errors of sensors", axes="XYNuvr"
    )
    begin_time = Parameter(112.0, "s", "time at which it comes")
    end_time = Parameter(187.0, "s", "time at which it goes")

    force = Output("N", "force on the vessel, body axes", axes="xy", frame="b")
    moment = Output("N.m", "yaw moment on the vessel, positive to starboard")
    nu_bias = Output(_UVR, "error of the measured velocity and yaw rate, body axes", axes="uvr")

    terminals: ClassVar = {"wrench": terminal("force", "moment")}

    def start(self, t: float) -> None:
        """Raise InputError for a disturbance that never comes."""
        if not self.begin_time < self.end_time:
            raise InputError(
                f"{self.name}: end_time ({self.end_time!r} s) must be after begin_time "
                f"({self.begin_time!r} s)"
            )

    def outputs(self, t: float) -> None:
        """Publish the disturbance as it is at ``t``."""
        acts = self.begin_time <= t < self.end_time
        X, Y, N, u, v, r = self.step_size if acts else (0.0,) * 6
        self.force, self.moment, self.nu_bias = (X, Y), N, (u, v, r)
