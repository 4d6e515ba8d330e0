"""MA3-P12 and MA3-P10: encoders whose angle is a pulse width. US Digital, MA3 data sheet."""

from __future__ import annotations

import math

from seatrial.errors import InputError

from ..part import PinPart

_BITS = {1: 12, 12: 12, 10: 10}
"""By the number in ``wires``; without one it is 1."""


class Ma3(PinPart):
    """A PWM wind vane: where the wind comes from, by ``wind_angle``, clockwise from the bow.

    Of 12 bits a pulse of 1 to 4097 us every 4098 us; position = 4098 t_on / (t_on + t_off) - 1, of
    4096. Of 10 bits, number 10 in ``wires``, 1 to 1025 us every 1026 us. Raises InputError for
    other numbers.
    """

    ports = ("wind_angle",)

    def reset(self) -> None:
        """Take the bits of its number."""
        if self.number not in _BITS:
            raise InputError(f"wires: ma3 {self.number}: 12 or 10 bits are needed")
        self._counts = 1 << _BITS[self.number]

    def measure(self) -> None:
        """Have the width of the next pulses."""
        turn = (self.inputs["wind_angle"] + math.pi) / math.tau % 1.0
        position = round(turn * self._counts) % self._counts
        # The last position has a pulse that is one microsecond wider than its count says.
        width = position + 1 if position < self._counts - 1 else self._counts + 1
        self.pulse(self.places[0], width * 1e-6, (self._counts + 2) * 1e-6)
