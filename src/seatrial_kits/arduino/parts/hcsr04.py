"""HC-SR04: ultrasonic range finder. ElecFreaks HC-SR04 user guide."""

from __future__ import annotations

from ..part import PinPart

_TRIGGER_S = 10e-6
_BURST_S = 0.45e-3
"""From the trigger to the rise of the echo: eight periods of 40 kHz, and what it takes to begin."""
_NONE_S = 38e-3
"""Width of the echo if nothing comes back."""
_NEAREST, _FARTHEST = 0.02, 4.0


class HcSr04(PinPart):
    """At the pins of trigger and echo: a ``distance`` of the board, m, as the width of the echo.

    width = 2 d / c, with c = 331.3 + 0.606 t, t in deg C of a ``temperature``. Nothing between 2 cm
    and 4 m: 38 ms.
    """

    ports = ("distance", "temperature")
    pins = 2

    def reset(self) -> None:
        """Begin with a quiet echo."""
        self._risen = self._busy = 0.0
        self.drive(self.places[1], [(0.0, 0)])

    def edge(self, level: int) -> None:
        """Answer the end of a trigger of 10 us and more, unless an echo is on its way."""
        if level:
            self._risen = self.time
            return
        if self.time - self._risen < _TRIGGER_S or self.time < self._busy:
            return
        distance = self.inputs["distance"]
        speed = 331.3 + 0.606 * (self.inputs["temperature"] - 273.15)
        echoes = _NEAREST <= distance <= _FARTHEST
        begin = self.time + _BURST_S
        self._busy = begin + (2.0 * distance / speed if echoes else _NONE_S)
        self.drive(self.places[1], [(begin, 1), (self._busy, 0)])
