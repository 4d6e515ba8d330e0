"""Commands that excite a vehicle, to identify it: one axis, or surge, sway and yaw together."""

from __future__ import annotations

from types import MappingProxyType
from typing import ClassVar

from numpy.random import Generator

from seatrial.model.component import Noise, Output, Parameter
from seatrial.model.sampled import Sampled

_LEVELS = 100
_MOTORS = MappingProxyType(
    {"surge": (1.0, 1.0, 0.0), "yaw": (1.0, -1.0, 0.0), "heave": (0.0, 0.0, 1.0)}
)
"""Port, starboard and vertical motor for a positive command along the axis."""
_PLANAR = "planar"


class Excitation(Noise, Sampled):
    """Random amplitudes, each held for a ``period``: [Paulino2015], section 5.2.

    At instant k a whole number from -100 to 100, all equally likely, divided by 100 and
    multiplied by ``amplitude``: the autocorrelation over instants is that of white noise. Source
    [Paulino2015] holds for 1 s, 0.2 s where surge and yaw are excited together, with amplitudes of
    0.2 to 1.

    ``command`` is positive ahead, to starboard about z, and down. The motors get it with the
    same sign (``axis`` = "surge": both horizontal ones), with opposite signs ("yaw": port ahead),
    or the vertical one alone ("heave"). With "planar" each horizontal motor gets its own
    ([Paulino2015], section 5.3), and ``command`` is the port one's.

    Until ``rest`` has passed all commands are 0.
    """

    exercised: ClassVar = {"rest": 0.1}

    period = Parameter(1.0, "s", "how long each amplitude is held", min=1e-6)
    amplitude = Parameter(0.3, "1", "largest command", min=0.0, max=1.0)
    rest = Parameter(0.0, "s", "time before the first command", min=0.0)
    axis = Parameter("surge", "1", "which motors get it", choices=(*_MOTORS, _PLANAR))

    command = Output("1", "command along the axis, -1 to 1")
    port = Output("1", "command of the port motor, -1 to 1, positive ahead")
    starboard = Output("1", "command of the starboard motor, -1 to 1, positive ahead")
    vertical = Output("1", "command of the vertical motor, -1 to 1, positive down")

    def reset(self, t: float) -> None:
        """Be at rest."""
        self._first = t + self.rest

    def sample(self, t: float, k: int) -> None:
        """Draw an amplitude; for both horizontal motors, two."""
        generator = self.generator(k)
        self.command = self._amplitude(t, generator)
        if self.axis == _PLANAR:
            starboard = self._amplitude(t, generator)
            self.port, self.starboard, self.vertical = self.command, starboard, 0.0
            return
        self.port, self.starboard, self.vertical = (
            sign * self.command + 0.0 for sign in _MOTORS[self.axis]
        )

    def _amplitude(self, t: float, generator: Generator) -> float:
        level = int(generator.integers(-_LEVELS, _LEVELS + 1)) if t >= self._first else 0
        amplitude: float = self.amplitude * level / _LEVELS
        return amplitude
