"""Electric thruster behind a speed controller, driven by a servo pulse."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Sequence

from ...model.component import Input, Output, Parameter
from .actuator import Actuator
from .pulse_range import PulseRange
from .t200 import CURRENT, FORCE, PULSE, SPEED

SHORTEST_SIGNAL, LONGEST_SIGNAL = 0.8e-3, 2.2e-3
"""Pulses outside these, s, are not a signal to a speed controller (assumed, BLHeli-like)."""


class Thruster(PulseRange, Actuator):
    """Blue Robotics T200 with a Basic ESC: pulse width in, thrust, current and speed out.

    Steady state, from the published bollard table at 16 V (`devices.actuators.t200`), linear in the
    pulse between its rows, at supply voltage V:

        thrust = F(pulse) (V / 16 V)^1.15,    current = I(pulse) (V / 16 V)^1.15
        speed = n(pulse) (V / 16 V)^(1.15 / 2)

    and all follow it with a first-order lag, solved exactly for the pulse held over a step:
    y(t + h) = y_inf + (y(t) - y_inf) exp(-h / time_constant). So no output reacts to an input at
    the same instant. The power is V times the current. The speed is for telemetry: its exponent is
    the thrust's with the thrust of a propeller going by the square of its speed, and while it
    changes that square is not kept.

    **Signal.** Dead band of the table: 1472 to 1528 us gives nothing. Beyond ``pulse_min`` and
    ``pulse_max`` the controller is at full power. A width of 0, or outside 800 to 2200 us, is
    no signal: target zero at once. A real Basic ESC (BLHeli_S) also stops when its signal
    fails, but after some tenths of a second, and then wants a neutral pulse before it runs
    again; neither the wait nor the rearming is modelled. A controller calibrated to another
    range (``pulse_min``, ``pulse_neutral``, ``pulse_max``) has the table stretched to it on
    either side of neutral, dead band included.

    **Supply.** The exponent is fitted to full-throttle thrust published for 12 to 20 V: within
    2 % ahead and 5 % astern. (A pure V^2 law, right for a motor without resistance, would
    lose 20 % too much at 12 V.) Unverified at part throttle and outside 12 to 20 V; the dead
    band is that of 16 V. A voltage of 0 or less is no supply.

    **Not modelled:** loss of thrust with the speed of the water through the propeller, with
    ventilation near the surface, inrush current.

    ``thrust`` is along the thruster's axis, N, positive ahead. ``reversed`` = 1 is a motor with
    two leads swapped: the pulse acts mirrored about neutral. ``time_constant`` is assumed:
    0.1 to 0.2 s is usual for this class of thruster; no source gives it for the T200.

    Failures are those of `Actuator`: a wrong one has half of its thrust, and draws its current all
    the same.

    Raises InputError at the start if the pulses do not rise.
    """

    time_constant = Parameter(0.15, "s", "time constant of thrust and current", min=1e-6)

    pulse = Input("s", "width of the servo pulse, 0 for none", start=1.5e-3, role="command")
    supply_voltage = Input("V", "voltage at the speed controller", start=16.0, optional=True)
    thrust = Output("N", "thrust along the axis, positive ahead")
    current = Output("A", "supply current")
    power = Output("W", "power drawn from the supply")
    speed = Output("rad/s", "angular velocity of the propeller, positive ahead")

    def start(self, t: float) -> None:
        """Start at rest; raises InputError if the pulses do not rise."""
        self.check_pulses()
        self._thrust = self._current = self._speed = self._power = 0.0
        self.begin_at(self.pulse_neutral)

    def step(self, t: float, h: float) -> None:
        """Follow the table's values for the pulse and voltage as they are."""
        received = self.take(t, [self.pulse], [self.pulse_min], [self.pulse_max])
        pulse = self._table_pulse(0.0 if received is None else received[0])
        supply = (max(self.supply_voltage, 0.0) / 16.0) ** 1.15
        kept = math.exp(-h / (self.slowness * self.time_constant))
        thrust = self.effect * supply * interpolate(pulse, FORCE)
        current = supply * interpolate(pulse, CURRENT)
        speed = math.sqrt(supply) * interpolate(pulse, SPEED)
        self._thrust = thrust + (self._thrust - thrust) * kept
        self._current = current + (self._current - current) * kept
        self._speed = speed + (self._speed - speed) * kept
        self._power = max(self.supply_voltage, 0.0) * self._current

    def outputs(self, t: float) -> None:
        """Publish thrust, current, power and speed."""
        self.thrust, self.current, self.speed = self._thrust, self._current, self._speed
        self.power = self._power

    def _table_pulse(self, pulse: float) -> float:
        """Return the pulse that has the same effect in the table's calibration, s."""
        neutral: float = self.pulse_neutral
        if not SHORTEST_SIGNAL <= pulse <= LONGEST_SIGNAL:
            return 1.5e-3
        span: float = (self.pulse_max if pulse > neutral else self.pulse_min) - neutral
        away = math.copysign(0.4e-3 * (pulse - neutral) / span, pulse - neutral)
        return 1.5e-3 - away if self.reversed else 1.5e-3 + away


def interpolate(pulse: float, values: Sequence[float]) -> float:
    """Return ``values``, given at the table's pulses, at ``pulse`` (s), held beyond the ends."""
    right = bisect_right(PULSE, pulse)
    if right == 0:
        return values[0]
    if right == len(PULSE):
        return values[-1]
    left = right - 1
    share = (pulse - PULSE[left]) / (PULSE[right] - PULSE[left])
    return values[left] + share * (values[right] - values[left])
