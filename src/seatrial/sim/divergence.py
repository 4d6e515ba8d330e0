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

from ..errors import SimulationError
from ..model.component import NS
from .network import Network

_BLOCK = 17  # no multiple of the half periods that people choose
_LOOKED_AT = 8
_GROWTH = 100.0
_BLOCKS = 3
_NOISE = 1e-6
_TURNS = 2
"""Least changes of direction among eight values; one jump of a value that is held has none."""


class DivergenceWatch:
    """Looks at eight consecutive values of each continuous connection per seventeen steps.

    Eight, because near its peak even a smooth oscillation looks rough for four. The values of a
    component with a step of its own come at that step: blocks of its connections are counted in it.
    What grows in one block alone, as noise that is switched on does, has not grown geometrically.
    """

    def __init__(self, network: Network) -> None:
        writes = [writes for node in network.nodes.values() for writes in node.writes]
        sources = {one.connections[i].source for one in writes for i in one.continuous}
        places: dict[int, list[int]] = {}
        for source in sources:
            places.setdefault(network.nodes[source[0]].every, []).append(network.places[source])
        self.paces = [Pace(network, every, sorted(of)) for every, of in sorted(places.items())]

    def look(self, steps: int) -> None:
        """Look at the signals after a communication step. Raises SimulationError."""
        for pace in self.paces:
            if steps % pace.every == 0:
                pace.look(steps // pace.every)

    def save(self) -> list[Any]:
        """Return what it has seen, for `restore`."""
        return [pace.save() for pace in self.paces]

    def restore(self, memory: list[Any]) -> None:
        """Restore what `memory` returned."""
        for pace, seen in zip(self.paces, memory, strict=True):
            pace.restore(seen)


class Pace:
    """The connections whose values come every so many communication steps."""

    def __init__(self, network: Network, every: int, places: list[int]) -> None:
        self.every = every
        self._network, self.places = network, places
        self.rows = np.zeros((_LOOKED_AT, len(places)))
        self.seen = np.zeros(1, np.int64)
        """How many rows there are."""
        self.last: NDArray[np.float64] = np.zeros(len(places))
        """Swing of each connection in the block before."""
        self.first = np.zeros(len(places))
        """Swing of each connection when it began to grow."""
        self.jump = np.ones(len(places))
        """Largest factor by which it grew from one block to the next since then."""
        self.growing = np.zeros(len(places), np.int64)
        """Blocks in a row in which it grew."""
        self._all = (self.rows, self.seen, self.last, self.first, self.jump, self.growing)
        # They stay where they are in memory: the compiled master looks there too.

    def look(self, steps: int) -> None:
        """Look at the signals after a step of these connections. Raises SimulationError."""
        turn = steps % _BLOCK
        if turn >= _LOOKED_AT:
            return
        if turn == 0:
            self.seen[0] = 0
        signals = self._network.signals
        self.rows[self.seen[0]] = [signals[place] for place in self.places]
        self.seen[0] += 1
        if self.seen[0] == _LOOKED_AT:
            self._evaluate(self.rows)

    def save(self) -> Any:
        """Return a copy of what it has seen."""
        return [one.copy() for one in self._all]

    def restore(self, memory: Any) -> None:
        """Restore what `memory` returned."""
        for own, one in zip(self._all, memory, strict=True):
            own[...] = one

    def _evaluate(self, rows: NDArray[np.float64]) -> None:
        with np.errstate(all="ignore"):
            change = np.abs(np.diff(rows, axis=0)).max(axis=0)
            swing = np.abs(np.diff(rows, 2, axis=0)).max(axis=0)
            size = np.abs(rows).max(axis=0)
            rough = (swing >= change) & (swing > _NOISE * np.maximum(1.0, size))
            rough &= _turns(np.sign(np.diff(rows, axis=0))) >= _TURNS
            grows = rough & (swing > self.last) & (self.last > 0.0)
            factor = np.where(grows, swing / self.last, 1.0)
        going_on = grows & (self.growing > 0)
        self.first[:] = np.where(going_on, self.first, self.last)
        self.jump[:] = np.where(going_on, np.maximum(self.jump, factor), factor)
        self.growing[:] = np.where(grows, self.growing + 1, 0)
        self.last[:] = np.where(rough, swing, 0.0)
        with np.errstate(all="ignore"):
            growth = swing / self.first / self.jump
        bad = (self.growing >= _BLOCKS) & (growth > _GROWTH)
        if bad.any():
            self.refuse(int(np.argmax(np.where(bad, growth, 0.0))))

    def refuse(self, index: int) -> None:
        """Raise SimulationError for the connection ``index``."""
        value, source = self.rows[-1, index], self._network.names[self.places[index]]
        before = _BLOCK * self.every * int(self.growing[index])
        raise SimulationError(
            f"the coupling diverges at t = {self._network.time_ns / NS!r} s: "
            f"{self._network.targets(source)} swings from step to step, more than "
            f"{_GROWTH:g} times as much as {before} steps before, "
            f"and carries {value:.6g} now; a smaller step, another algorithm or another cut of "
            "the system is needed (added mass belongs with its rigid body)"
        )


def _turns(directions: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return how often each column changes its sign, zeros left out."""
    found, last = np.zeros(directions.shape[1], int), directions[0]
    for direction in directions[1:]:
        found += direction * last < 0
        last = np.where(direction, direction, last)
    return found
