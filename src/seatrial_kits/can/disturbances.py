"""Disturbances of a bus: bit errors by chance, faults on purpose."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from .frame import Frame
from .simulated_bus import Disturbance

Generator = Callable[[int], np.random.Generator]
"""Of the number of an attempt: what draws its random numbers."""


class Disturbances:
    """Bit errors and broken transmitters; each attempt to send draws numbers of its own.

    With ``bit_error_rate`` p each bit is wrong for all nodes with probability p: a frame of n
    bits is hit with probability 1 - (1 - p)^n, first at bit floor(ln(1 - x) / ln(1 - p)) with x
    uniform. With ``receive_error_rate`` of a node it alone sees a wrong bit. A node among
    ``defective`` breaks each of its own frames where its data begin: at bit 19 or 39.
    """

    def __init__(self, generator: Generator, nodes: int) -> None:
        self._generator = generator
        self.bit_error_rate = 0.0
        self.receive_error_rate = [0.0] * nodes
        self.defective: list[int] = []

    def saved(self) -> list[Any]:
        """Return what is set, as plain data."""
        return [self.bit_error_rate, list(self.receive_error_rate), list(self.defective)]

    def restore(self, state: list[Any]) -> None:
        """Bring back what `saved` returned."""
        self.bit_error_rate = state[0]
        self.receive_error_rate, self.defective = list(state[1]), list(state[2])

    def __call__(self, attempt: int, node: int, frame: Frame, bits: int) -> Disturbance | None:
        """Return what goes wrong with a frame, or None."""
        if node in self.defective:
            return Disturbance(39 if frame.extended else 19)
        if not self.bit_error_rate and not any(self.receive_error_rate):
            return None
        draws = self._generator(attempt).random(1 + len(self.receive_error_rate)).tolist()
        bit = _first_wrong(draws[0], self.bit_error_rate)
        if bit < bits:
            return Disturbance(bit)
        for receiver, rate in enumerate(self.receive_error_rate):
            bit = _first_wrong(draws[1 + receiver], rate)
            if bit < bits and receiver != node:
                return Disturbance(bit, receiver)
        return None


def _first_wrong(draw: float, rate: float) -> int:
    """Return the first wrong bit, counted from 0."""
    if rate <= 0.0:
        return 1 << 30
    if rate >= 1.0:
        return 0
    return min(int(math.log1p(-draw) / math.log1p(-rate)), 1 << 30)
