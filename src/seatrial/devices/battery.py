"""Battery with an open-circuit voltage by charge and an internal resistance."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import ClassVar

import numpy as np

from ..errors import InputError
from ..model.component import Component, Output, Parameter, Terms, terminal

LOADS, POWERS = 16, 4
_TENTHS = tuple(f"c{tenths}" for tenths in range(11))


class Battery(Component):
    """Cells in series behind one resistance, with loads of given current and of given power.

        E = cells U(q),    V = E - resistance I,    I = sum of load + (sum of power) / V
        dq/dt = -I / capacity

    q is the charge over the ``capacity``, 1 when full; U(q) the open-circuit voltage of a cell,
    ``open_circuit`` at q = 0, 0.1, ... 1, linear in between. ``load`` are currents, A, as thrusters
    report them; ``power`` are loads that keep their power as the voltage falls, W, and
    ``electronics`` is one that is always there. V is the higher solution,

        V = (E' + sqrt(E'^2 - 4 resistance P)) / 2,    E' = E - resistance (sum of load)

    and E' / 2 where the power asked is more than the battery can give. Loads are held over a
    step, in which q takes the midpoint rule; of a constant current it is exact.

    When the voltage falls to ``cut_off``, or the charge to 0, the battery disconnects: voltage
    and current are 0 from then on. A negative load charges, up to q = 1.

    Defaults: Blue Robotics' lithium-ion battery for underwater vehicles, as its maker has it: 4
    cells in series, 18 A.h. Assumed: 0.06 ohm, the curve of a common cell, cut off at 12 V, no
    electronics.

    Not modelled: temperature, ageing, relaxation after a load, cells that differ, self-discharge.

    Raises InputError at the start for open-circuit voltages that fall as the charge rises.
    """

    capacity = Parameter(64800.0, "A.s", "charge when full", min=1e-3)
    cells = Parameter(4.0, "1", "cells in series", min=1.0)
    open_circuit = Parameter(
        (3.0, 3.45, 3.55, 3.6, 3.64, 3.69, 3.77, 3.86, 3.94, 4.05, 4.18),
        "V",
        "open-circuit voltage of a cell at tenths of its charge",
        axes=_TENTHS,
        min=0.0,
    )
    resistance = Parameter(0.06, "ohm", "internal resistance", min=0.0)
    cut_off = Parameter(12.0, "V", "voltage at which it disconnects", min=0.0)
    charge_start = Parameter(1.0, "1", "charge at the start", min=0.0, max=1.0)
    electronics = Parameter(0.0, "W", "power of electronics that are always on", min=0.0)

    load = Terms(LOADS, "A", "current drawn")
    power = Terms(POWERS, "W", "power drawn")

    voltage = Output("V", "voltage at the loads")
    current = Output("A", "current out of the battery")
    charge = Output("1", "charge over the capacity")
    disconnected = Output("1", "whether it has disconnected", type=bool)

    terminals: ClassVar = {"battery": terminal("voltage", "current", "charge")}

    def start(self, t: float) -> None:
        """Start with the charge given; raises InputError for a curve that falls."""
        if any(after < before for before, after in pairwise(self.open_circuit)):
            raise InputError(
                f"{self.name}.open_circuit is {self.open_circuit} V: it must not fall as the "
                "charge rises"
            )
        self._charge = self.charge_start
        self._disconnected = False

    def step(self, t: float, h: float) -> None:
        """Draw the loads as they are, and disconnect an empty battery."""
        if self._disconnected:
            return
        _, current = self._under_load(self._charge)
        middle = self._charge - 0.5 * h * current / self.capacity
        _, current = self._under_load(middle)
        self._charge = min(max(self._charge - h * current / self.capacity, 0.0), 1.0)
        voltage, _ = self._under_load(self._charge)
        self._disconnected = voltage <= self.cut_off or self._charge <= 0.0

    def outputs(self, t: float) -> None:
        """Publish voltage and current under the loads as they are."""
        connected = not self._disconnected
        self.voltage, self.current = self._under_load(self._charge) if connected else (0.0, 0.0)
        self.charge, self.disconnected = self._charge, self._disconnected

    def _under_load(self, charge: float) -> tuple[float, float]:
        """Return voltage, V, and current, A."""
        tenths = 10.0 * min(max(charge, 0.0), 1.0)
        source = self.cells * float(np.interp(tenths, range(11), self.open_circuit))
        drawn, power, R = self.load, self.power + self.electronics, self.resistance
        behind = source - R * drawn
        under = behind * behind - 4.0 * R * power
        voltage = 0.5 * (behind + math.sqrt(max(under, 0.0)))
        if voltage <= 0.0:
            return 0.0, drawn
        return voltage, drawn + power / voltage
