"""Speed controllers of a quadrotor: pulse widths in, rotor speeds out."""

from __future__ import annotations

from typing import ClassVar

from seatrial.errors import InputError
from seatrial.model.component import Component, Input, Output, Parameter

_ROTORS = ("r1", "r2", "r3", "r4")


class RotorEscs(Component):
    """Speed controllers ahead of the four rotors of `Multirotor`, which turn one way.

        speed_i = max_speed min(max((pulse_i - pulse_min) / (pulse_max - pulse_min), 0), 1)

    rad/s; a pulse of 0 is no signal, and stops the rotor. Pulses in s; static. The thrust is
    quadratic in the speed: a flight controller that makes up for its curve takes it as such
    (ArduCopter: MOT_THST_EXPO 1).

    Not modelled: lag, which the rotors have, time to arm, failures.

    Raises InputError at the start if the pulses do not rise.
    """

    exercised: ClassVar = {"pulse": [1.2e-3, 1.4e-3, 1.6e-3, 1.8e-3]}

    pulse_min = Parameter(1.0e-3, "s", "pulse of a rotor at rest", min=0.0)
    pulse_max = Parameter(2.0e-3, "s", "pulse of the highest speed", min=0.0)
    max_speed = Parameter(785.7987745754486, "rad/s", "highest speed of a rotor", min=0.0)

    pulse = Input("s", "widths of the pulses, 0 for none", axes=_ROTORS, role="command")
    speed = Output("rad/s", "speed wanted of each rotor", axes=_ROTORS)

    def start(self, t: float) -> None:
        """Raise InputError if the pulses do not rise."""
        if not self.pulse_min < self.pulse_max:
            raise InputError(
                f"{self.name}: pulse_min must be less than pulse_max, got {self.pulse_min!r} and "
                f"{self.pulse_max!r} s"
            )

    def outputs(self, t: float) -> None:
        """Publish the speeds of the pulses as they are."""
        span = self.pulse_max - self.pulse_min
        self.speed = [
            self.max_speed * min(max((width - self.pulse_min) / span, 0.0), 1.0)
            for width in self.pulse
        ]
