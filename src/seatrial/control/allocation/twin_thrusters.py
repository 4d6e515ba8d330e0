"""Two fixed thrusters, port and starboard, behind speed controllers: force to pulse."""

from __future__ import annotations

from typing import ClassVar

from ...model.component import Output, Parameter, terminal
from .thruster_pulses import ThrusterPulses


class TwinThrusters(ThrusterPulses):
    """Base of the allocation to a pair of thrusters: surge force X and yaw moment N to pulses.

    What the thrusters cannot give is cut off, moment first. **Allocation**: T_port = X / 2 +
    N / (2 d), T_starboard = X / 2 - N / (2 d), d = ``half_beam``; port ahead turns to starboard
    (N > 0). Thrust to pulse as in `ThrusterPulses`.
    """

    half_beam = Parameter(0.4, "m", "thrusters from the centre line", min=1e-3)

    pulse_port = Output("s", "pulse to the port thruster", start=1.5e-3)
    pulse_starboard = Output("s", "pulse to the starboard thruster", start=1.5e-3)

    terminals: ClassVar = {"actuators": terminal(port="pulse_port", starboard="pulse_starboard")}

    def _possible(
        self, surge: float, moment: float, most_surge: float, most_moment: float
    ) -> tuple[float, float]:
        """Return what limits (N, N.m) and the thrusters leave of a demand, moment first."""
        ahead, astern = self.thrust_ahead, self.thrust_astern
        largest = min(most_moment, 2.0 * self.half_beam * min(ahead, astern))
        moment = min(max(moment, -largest), largest)
        used = abs(moment) / (2.0 * self.half_beam)
        most = min(most_surge, 2.0 * (ahead - used))
        least = -min(most_surge, 2.0 * (astern - used))
        return min(max(surge, least), most), moment

    def _drive(self, surge: float, moment: float) -> None:
        """Publish the pulses of a demand that the thrusters can give."""
        turning = moment / (2.0 * self.half_beam)
        self.pulse_port = self.pulse_of(0.5 * surge + turning)
        self.pulse_starboard = self.pulse_of(0.5 * surge - turning)
