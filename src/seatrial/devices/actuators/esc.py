"""Electronic speed controller: pulse width in, share of full thrust out."""

from __future__ import annotations

from typing import ClassVar

from ...model.component import Input, Output, Parameter
from .pulse_range import PulseRange


class Esc(PulseRange):
    """Speed controller ahead of a thruster that takes shares, such as `LinearThruster`.

        share = (pulse - pulse_neutral) / (pulse_max - pulse_neutral)    pulse > pulse_neutral
        share = (pulse - pulse_neutral) / (pulse_neutral - pulse_min)    otherwise

    held at -1 and 1 beyond the range, positive ahead, with the other sign if ``reversed`` = 1;
    0 while the pulse is no further than ``dead_band`` from neutral. Outside the dead band it
    is on that line, so that it jumps at the edge. A pulse of 0 is no signal and acts as
    neutral: a board that has not attached its outputs yet stops the thruster. Pulses in s;
    static: the share follows the pulse at the same instant.

    Defaults: 1500 +- 400 us, no dead band.

    Not modelled: time to arm, loss of the signal after a while, current; failures are the
    thruster's.

    Raises InputError at the start if the pulses do not rise.
    """

    exercised: ClassVar = {"pulse": 1.7e-3}

    dead_band = Parameter(0.0, "s", "distance from neutral up to which it stops", min=0.0)

    pulse = Input("s", "width of the servo pulse, 0 for none", role="command")
    share = Output("1", "share of full thrust, -1 to 1, positive ahead")

    def start(self, t: float) -> None:
        """Raise InputError if the pulses do not rise."""
        self.check_pulses()

    def outputs(self, t: float) -> None:
        """Publish the share of the pulse as it is."""
        pulse: float = self.pulse
        stopped = pulse <= 0.0 or abs(pulse - self.pulse_neutral) <= self.dead_band
        self.share = 0.0 if stopped else self.share_of(pulse)
