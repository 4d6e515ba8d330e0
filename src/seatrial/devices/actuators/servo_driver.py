"""Driver of a servo: angle in, pulse width out."""

from __future__ import annotations

from ...model.component import Input, Output
from .pulse_range import AngleRange, PulseRange


class ServoDriver(AngleRange, PulseRange):
    """Pulse that turns a `Servo` of the same calibration to an angle: inverse of its static map.

        share = (angle - middle) / half_range,    middle, half_range of angle_min ... angle_max
        pulse = pulse_neutral + share (pulse_max - pulse_neutral)    share > 0
        pulse = pulse_neutral + share (pulse_neutral - pulse_min)    otherwise

    angles beyond the range give its ends; ``reversed`` = 1 turns the sign of the share. The
    servo's dead band is not made up for. Angles rad, pulses s; static: the pulse follows the
    angle at the same instant.

    Raises InputError at the start if pulses or angles do not rise.
    """

    angle = Input("rad", "angle wanted")
    pulse = Output("s", "width of the servo pulse")

    def start(self, t: float) -> None:
        """Raise InputError for pulses or angles out of order."""
        self.check_pulses()
        self.check_angles()

    def outputs(self, t: float) -> None:
        """Publish the pulse of the angle as it is."""
        self.pulse = self.pulse_of((self.angle - self.middle) / self.half_range)
