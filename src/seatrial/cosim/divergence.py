"""Divergence of the coupling: signals that swing from step to step, more and more.

An explicit coupling of light and heavy, or of added mass and mass, goes unstable at the scale
of the communication step: values overshoot by a factor above one at each exchange. That looks
like nothing else: an oscillation of less than six steps per period whose amplitude grows
geometrically. Motion that a step resolves is smooth on that scale, noise does not grow.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..component import NS
from ..errors import SimulationError
from .network import Network

_BLOCK = 16
_LOOKED_AT = 4
_GROWTH = 100.0
_BLOCKS = 3
_NOISE = 1e-6


class DivergenceWatch:
    """Looks at four consecutive values of every continuous wire in each block of sixteen steps."""

    def __init__(self, network: Network) -> None:
        self._network = network
        writes = [writes for node in network.nodes.values() for writes in node.writes]
        sources = {one.wires[i].source for one in writes for i in one.continuous}
        self._places = sorted(network.places[source] for source in sources)
        self._rows: list[list[Any]] = []
        self._last: NDArray[np.float64] = np.zeros(len(self._places))
        """Swing of each wire in the block before."""
        self._first = np.zeros(len(self._places))
        """Swing of each wire when it began to grow."""
        self._growing = np.zeros(len(self._places), int)
        """Blocks in a row in which it grew."""

    def look(self, steps: int) -> None:
        """Look at the signals after a communication step. Raises SimulationError."""
        turn = steps % _BLOCK
        if turn >= _LOOKED_AT or not self._places:
            return
        if turn == 0:
            self._rows = []
        signals = self._network.signals
        self._rows.append([signals[place] for place in self._places])
        if len(self._rows) == _LOOKED_AT:
            self._judge(np.array(self._rows, float))

    def _judge(self, rows: NDArray[np.float64]) -> None:
        with np.errstate(all="ignore"):
            change = np.abs(np.diff(rows, axis=0)).max(axis=0)
            swing = np.abs(np.diff(rows, 2, axis=0)).max(axis=0)
            size = np.abs(rows).max(axis=0)
            rough = (swing >= change) & (swing > _NOISE * np.maximum(1.0, size))
            grows = rough & (swing > self._last) & (self._last > 0.0)
        self._first = np.where(grows & (self._growing > 0), self._first, self._last)
        self._growing = np.where(grows, self._growing + 1, 0)
        self._last = np.where(rough, swing, 0.0)
        bad = (self._growing >= _BLOCKS) & (swing > _GROWTH * self._first)
        if bad.any():
            worst = int(np.argmax(np.where(bad, swing / np.maximum(self._first, 1e-300), 0.0)))
            self._refuse(worst, rows[-1, worst])

    def _refuse(self, index: int, value: float) -> None:
        source = self._network.names[self._places[index]]
        raise SimulationError(
            f"the coupling diverges at t = {self._network.time_ns / NS!r} s: "
            f"{self._network.targets(source)} swings from step to step, more than "
            f"{_GROWTH:g} times as much as {_BLOCK * int(self._growing[index])} steps before, "
            f"and carries {value:.6g} now; a smaller step, another algorithm or another cut of "
            "the system is needed (added mass belongs with its rigid body)"
        )
