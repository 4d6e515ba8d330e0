"""Thruster drive: limits, slew, dead band and power, as the memory has them.

The map has names and scales only; what they do is ours:

- the sum of target and auto loop is clipped to -1 to 1 and to the power that is available;
- it changes per loop by the slew rate at most, or by that per millisecond or second;
- duty = sign (dead band + |it| (max limit - dead band)), 0 for 0: so the firmware jumps over
  the part of the duty in which a brushed motor does not turn. Without that compensation
  duty = max limit |it|, 0 below the dead band.

A motor turns from a duty of its own on: share of thrust = (|duty| - band) / (1 - band).
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from .node import RovNode

THRUSTERS = ("port", "starboard", "vertical")
SLEW_UNITS = {"per-loop": 0.0, "per-millisecond": 1000.0, "per-second": 1.0}
"""Slew rates of each unit: times in a second, 0 for once a loop."""


class Drive:
    """The three thrusters' commands from loop to loop."""

    def __init__(self, loop_period: float, slew_unit: str, compensates: bool) -> None:
        per_second = SLEW_UNITS[slew_unit]
        self._slews = per_second * loop_period if per_second else 1.0
        self._compensates = compensates
        self.commands = [0.0] * len(THRUSTERS)

    def run(self, node: RovNode, autos: Sequence[float]) -> list[float]:
        """Return the duties of this loop, -1 to 1; ``autos`` are added to the targets."""
        power = node.value("total_power")
        duties = []
        for number, (name, auto) in enumerate(zip(THRUSTERS, autos, strict=True)):
            target = min(max(node.value(f"{name}_target"), -1.0), 1.0) + auto
            wanted = min(max(target, -power), power)
            most = node.value(f"{name}_slew_rate") * self._slews
            before = self.commands[number]
            self.commands[number] = before + min(max(wanted - before, -most), most)
            duties.append(self._duty(node, name, self.commands[number]))
        return duties

    def stop(self) -> list[float]:
        """Stop at once; return the duties."""
        self.commands = [0.0] * len(THRUSTERS)
        return [0.0] * len(THRUSTERS)

    def _duty(self, node: RovNode, name: str, command: float) -> float:
        band = min(node.value(f"{name}_dead_band"), 1.0)
        limit = min(node.value(f"{name}_max_limit"), 1.0)
        size = abs(command)
        if self._compensates:
            size = min(band + size * (limit - band), limit) if size else 0.0
        else:
            size = limit * size if limit * size >= band else 0.0
        return math.copysign(max(size, 0.0), command)


def share_of_thrust(duty: float, band: float) -> float:
    """Return the share of full thrust of a motor that turns from a duty of ``band`` on."""
    size = (abs(duty) - band) / (1.0 - band) if band < 1.0 else 0.0
    return math.copysign(max(size, 0.0), duty)
