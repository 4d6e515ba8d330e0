"""Hobby servo: pulse width in, shaft angle out."""

from __future__ import annotations

import math

from ...errors import InputError
from ...model.component import NS, Input, Output, Parameter
from ...model.sampled import Sampled
from ..fault import SHARE_WRONG
from .actuator import Actuator
from .pulse_range import AngleRange, PulseRange


class Servo(AngleRange, PulseRange, Actuator, Sampled):
    """Position servo driven by a pulse every ``period`` (50 Hz frames).

    At each frame (counted in whole nanoseconds from the start of the run, whatever the
    communication step) the servo takes the pulse then present. Its angle wanted is linear in
    the pulse on either side of neutral: ``pulse_min`` -> ``angle_min``, ``pulse_neutral`` ->
    half-way, ``pulse_max`` -> ``angle_max``, held at the ends beyond; ``reversed`` = 1
    turns the other way about the middle. If it is further away than the dead band, the shaft turns
    at constant ``rate`` until it is within the dead band, where the motor rests:

        angle(t) = angle_k + sign(e) min(rate (t - t_k), |e| - band),  e = wanted - angle_k

    with band = ``dead_band`` as an angle, at the mean slope of the whole range. So it stops
    short by ``dead_band``, from either side. A pulse width of 0 (no pulse) holds the shaft
    where it is. Defaults: a standard analogue servo, as HS-422 class data sheets give it at
    4.8 V: 1500 +- 400 us for +- 45 degrees, 0.21 s per 60 degrees, dead band 8 us.

    Angles rad, rate rad/s, pulses s. The angle never reacts to the pulse at the same instant.
    Failures are those of `Actuator`, from the next frame on; the shaft of a wrong one, within its
    range, is a tenth of the range further than it should be.
    Not modelled: acceleration, load torque, backlash.

    Raises InputError at the start if pulses or angles do not rise, or ``angle_start`` lies
    outside the range.
    """

    period = Parameter(0.02, "s", "period of the pulse frames", min=1e-6)
    angle_start = Parameter(0.0, "rad", "angle at the start of the run")
    rate = Parameter(math.radians(60.0) / 0.21, "rad/s", "speed of the shaft", min=1e-9)
    dead_band = Parameter(8e-6, "s", "error of the pulse at which the motor rests", min=0.0)

    pulse = Input("s", "width of the servo pulse, 0 for none", start=1.5e-3, role="command")
    angle = Output("rad", "angle of the shaft")

    def reset(self, t: float) -> None:
        """Start at rest; raises InputError for pulses or angles out of order."""
        self.check_pulses()
        self.check_angles()
        if not self.angle_min <= self.angle_start <= self.angle_max:
            raise InputError(
                f"{self.name}.angle_start is {self.angle_start!r} rad, allowed "
                f"{self.angle_min!r} to {self.angle_max!r} rad"
            )
        self._from: float = self.angle_start
        self._to: float = self.angle_start
        self._since_ns = self.now_ns
        self._pace: float = self.rate
        self.begin_at(self.pulse_neutral)

    def update(self, t: float, k: int) -> None:
        """Take the pulse of this frame."""
        self._from, self._since_ns = self._angle_at(round(t * NS)), round(t * NS)
        self._pace = self.rate / self.slowness
        received = self.take(t, [self.pulse], [self.pulse_min], [self.pulse_max])
        if received is None or self.fault == "stuck":
            self._to = self._from
        else:
            self._to = self._resting_angle(self._from, received[0])

    def hold(self, t: float) -> None:
        """Publish the angle reached."""
        self.angle = self._angle_at(round(t * NS))

    def _angle_at(self, time_ns: int) -> float:
        turned: float = self._pace * (time_ns - self._since_ns) / NS
        if turned >= abs(self._to - self._from):
            return self._to
        return self._from + math.copysign(turned, self._to - self._from)

    def _resting_angle(self, angle: float, pulse: float) -> float:
        """Return where the shaft, now at ``angle``, comes to rest if the pulse stays."""
        if pulse <= 0.0:
            return angle
        slope = (self.angle_max - self.angle_min) / (self.pulse_max - self.pulse_min)
        band = slope * self.dead_band
        error = self._wanted(pulse) - angle
        if abs(error) <= band:
            return angle
        return angle + math.copysign(abs(error) - band, error)

    def _wanted(self, pulse: float) -> float:
        """Return the angle that the pulse asks for."""
        wanted: float = self.middle + self.share_of(pulse) * self.half_range
        if self.fault == "wrong":
            wanted = min(wanted + SHARE_WRONG * 2.0 * self.half_range, self.angle_max)
        return wanted
