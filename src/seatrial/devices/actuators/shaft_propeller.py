"""Propeller on a shaft whose speed follows its command."""

from __future__ import annotations

import math
from typing import ClassVar

from ...model.component import Input, Output, Parameter
from .actuator import Actuator


class ShaftPropeller(Actuator):
    """Propeller with a thrust quadratic in its shaft speed, which follows a command with a lag.

        T n' = n_c - n,   n_c = clip(beta, 1) times n_ahead for beta > 0, else n_astern
        thrust = k n |n|,   k = k_ahead for n > 0, else k_astern

    beta is the ``command``, a share of full speed from -1 to 1; n_ahead and n_astern are
    ``speed_ahead`` and ``speed_astern``, both positive. Exact for a command that is held:
    n(t + h) = n_c + (n - n_c) exp(-h / T), T = ``time_constant``. The shaft starts at
    ``speed_start``. ``thrust`` is along the axis, N, positive ahead; it never reacts to the command
    at the same instant.

    The law of Fossen's models of small craft (Handbook of Marine Craft Hydrodynamics and Motion
    Control, 2nd ed., 2021), with coefficients from bollard pulls.

    Failures are those of `Actuator`.

    Not modelled: loss of thrust with the speed of the water through the propeller, moment of the
    shaft, ventilation, current drawn.
    """

    exercised: ClassVar = {"speed_start": 20.0}

    thrust_coefficient_ahead = Parameter(0.01, "N.s2/rad2", "k_ahead, of one propeller", min=0.0)
    thrust_coefficient_astern = Parameter(0.01, "N.s2/rad2", "k_astern, of one propeller", min=0.0)
    speed_ahead = Parameter(100.0, "rad/s", "shaft speed at command 1", min=0.0)
    speed_astern = Parameter(100.0, "rad/s", "shaft speed at command -1, positive", min=0.0)
    time_constant = Parameter(0.1, "s", "time constant of the shaft speed", min=1e-6)
    speed_start = Parameter(0.0, "rad/s", "shaft speed at the start, positive ahead")

    command = Input("1", "share of full shaft speed, -1 to 1, positive ahead", role="command")
    thrust = Output("N", "thrust along the axis, positive ahead")
    speed = Output("rad/s", "shaft speed, positive ahead")

    def start(self, t: float) -> None:
        """Start at ``speed_start``."""
        self._speed: float = self.speed_start
        self._left = 1.0
        self.begin_at(0.0)

    def step(self, t: float, h: float) -> None:
        """Follow the command as it is."""
        received = self.take(t, [self.command], [-1.0], [1.0])
        self._left = self.effect
        wanted = 0.0 if received is None else self._speed_of(received[0])
        kept = math.exp(-h / (self.slowness * self.time_constant))
        self._speed = wanted + (self._speed - wanted) * kept

    def outputs(self, t: float) -> None:
        """Publish thrust and shaft speed."""
        n = self._speed
        k = self.thrust_coefficient_ahead if n > 0.0 else self.thrust_coefficient_astern
        self.thrust, self.speed = self._left * k * n * abs(n), n

    def _speed_of(self, command: float) -> float:
        share = min(max(command, -1.0), 1.0)
        return float(share * (self.speed_ahead if share > 0.0 else self.speed_astern))
