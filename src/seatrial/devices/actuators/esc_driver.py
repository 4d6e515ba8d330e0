"""Driver of a speed controller: share of full thrust in, pulse width out."""

from __future__ import annotations

from typing import ClassVar

from ...model.component import Input, Output
from .pulse_range import PulseRange


class EscDriver(PulseRange):
    """Pulse that asks an `Esc` of the same calibration for a share: inverse of its static map.

        pulse = pulse_neutral + share (pulse_max - pulse_neutral)    share > 0
        pulse = pulse_neutral + share (pulse_neutral - pulse_min)    otherwise

    shares beyond -1 and 1 give the ends; ``reversed`` = 1 turns the sign of the share. The
    controller's dead band is not made up for: a share within it stops. Pulses in s; static: the
    pulse follows the share at the same instant.

    Raises InputError at the start if the pulses do not rise.
    """

    exercised: ClassVar = {"share": 0.5}

    share = Input("1", "share of full thrust wanted, -1 to 1, positive ahead")
    pulse = Output("s", "width of the servo pulse", start=1.5e-3)

    def start(self, t: float) -> None:
        """Raise InputError if the pulses do not rise."""
        self.check_pulses()

    def outputs(self, t: float) -> None:
        """Publish the pulse of the share as it is."""
        self.pulse = self.pulse_of(self.share)
