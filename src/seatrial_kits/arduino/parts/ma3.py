"""MA3-P12: absolute encoder whose angle is a pulse width. US Digital, MA3 data sheet."""

from __future__ import annotations

import math

from ..part import PinPart

_COUNTS = 4096
_PERIOD_S = 4098e-6


class Ma3(PinPart):
    """A PWM wind vane: where the wind comes from, by ``wind_angle``, clockwise from the bow.

    A pulse of 1 to 4097 us every 4098 us; position = 4098 t_on / (t_on + t_off) - 1, of 4096.
    """

    ports = ("wind_angle",)

    def measure(self) -> None:
        """Have the width of the next pulses."""
        turn = (self.inputs["wind_angle"] + math.pi) / math.tau % 1.0
        position = round(turn * _COUNTS) % _COUNTS
        # Position 4095 has a pulse of 4097 us: 4096 counts are one microsecond wider.
        width = position + 1 if position < _COUNTS - 1 else _COUNTS + 1
        self.pulse(self.places[0], width * 1e-6, _PERIOD_S)
