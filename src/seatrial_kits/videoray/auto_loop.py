"""The ROV's own loops, auto depth and auto heading, with the gains of its memory.

The map names P, I, D and an output multiplier K for each, and their terms; the rest is ours:

    output = K (P e + I sum(e) + D (e - e_before)),  clipped to -1 to 1

once per loop, e = target - measurement in mbar or degrees. The sums are per loop, not per second:
so the captured gains make sense (I/P is a fiftieth for depth, D/P 13 for heading). By the
signs of the captured gains, ahead of the vertical thruster is upwards: its P is negative.
"""

from __future__ import annotations

from typing import Any

from .node import RovNode
from .registers import OFF


class AutoLoop:
    """One loop; ``name`` is auto_depth or auto_heading, ``turn`` the measure's full circle or 0.

    D acts on the measurement alone, so that a new target is no jump. The sum stops where the
    output is clipped and would grow further. It begins anew when the target was off.
    """

    def __init__(self, name: str, measured: str, turn: float = 0.0) -> None:
        self._name, self._measured, self._turn = name, measured, turn
        self._sum = 0.0
        self._before: float | None = None

    def run(self, node: RovNode) -> float:
        """Return the output of this loop, 0 if it is off; note its terms."""
        target = node.value(f"{self._name}_target")
        if target == OFF:
            self.rest(node)
            return 0.0
        measured = node.value(self._measured)
        before = measured if self._before is None else self._before
        self._before = measured
        error = self._nearest(target - measured)
        p_gain, i_gain, d_gain, k = (node.value(f"{self._name}_{part}") for part in "pidk")
        p = p_gain * error
        d = -d_gain * self._nearest(measured - before)
        total = self._sum + error
        raw = k * (p + i_gain * total + d)
        if abs(raw) <= 1.0 or raw * k * i_gain * error < 0.0:
            self._sum = total
        i = i_gain * self._sum
        self._note(node, p, i, d, p + i + d)
        return min(max(k * (p + i + d), -1.0), 1.0)

    def rest(self, node: RovNode) -> None:
        """Forget what was before."""
        if self._before is not None:
            self._note(node, 0.0, 0.0, 0.0, 0.0)
        self._sum, self._before = 0.0, None

    def saved(self) -> list[Any]:
        """Return its state as plain data."""
        return [self._sum, self._before]

    def restore(self, saved: list[Any]) -> None:
        """Restore what `saved` returned."""
        self._sum, self._before = saved

    def _nearest(self, difference: float) -> float:
        if not self._turn:
            return difference
        return (difference + self._turn / 2.0) % self._turn - self._turn / 2.0

    def _note(self, node: RovNode, *terms: float) -> None:
        for part, term in zip(("p_term", "i_term", "d_term", "output"), terms, strict=True):
            node.measure(f"{self._name}_{part}", term)
