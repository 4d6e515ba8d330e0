"""The sea that is drawn: its surface about a place, with the waves of the trial."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from seatrial.errors import InputError
from seatrial.fmi.components.index import component_class
from seatrial.physics.sea.waves import Waves
from seatrial.trial.criteria.expressions import FloatArray
from seatrial.trial.records.run_folder import Run

from .meshes import IntArray

CELLS = 56
"""Along each side of the surface that is drawn."""
_PER_WAVE = 12
"""Cells along a wave of the mean length, by energy."""


def followed(run: Run) -> Waves | None:
    """Return the waves that a prescribed deck of a run follows, drawn again from its parameters.

    Those of a file are not read: the record has its name alone.
    """
    for component in run.manifest["components"].values():
        if component["fmu"] != "prescribed-deck":
            continue
        given = {name: entry["value"] for name, entry in component["parameters"].items()}
        try:
            # Its kit may lack where only the record is.
            deck: Any = component_class("prescribed-deck")("drawn")
            for name, value in given.items():
                if name in deck.scalar_by_name and value is not None and name != "file":
                    deck.set(name, value)
            deck.start(0.0)
        except InputError:  # of another version
            return None
        followed: Waves | None = None if given.get("file") else deck.sea()
        return followed
    return None


class Water:
    """A square of the surface that goes with a place; waves, cell by cell, so that it stands still.

    Heights are those of `Waves.elevation`: sums of exp(i (w t + e)) exp(-i k north) exp(-i k east),
    so that one product of matrices has all of them.
    """

    def __init__(self, waves: Waves | None, reach: float, cells: int = CELLS) -> None:
        self.waves, self.cells = waves, cells
        self.size = reach / cells
        if waves is not None:
            energy = waves.amplitude**2
            length = math.tau * float(energy @ (1.0 / waves.k)) / float(energy.sum())
            self.size = min(self.size, max(length / _PER_WAVE, reach / cells / 4.0))
            self._north = waves.k * np.cos(waves.direction)
            self._east = waves.k * np.sin(waves.direction)
        self._steps: FloatArray = np.asarray(
            (np.arange(cells + 1) - 0.5 * cells) * self.size, dtype=np.float64
        )

    def faces(self) -> IntArray:
        """Return the triangles of the surface, seen from above."""
        n = self.cells + 1
        grid = np.arange(n * n).reshape(n, n)
        a, b, c, d = grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]
        return np.concatenate([np.stack(t, -1).reshape(-1, 3) for t in ((a, b, c), (a, c, d))])

    def vertices(self, time: float, east: float, north: float) -> FloatArray:
        """Return the corners (east, north, up), m, about a place at a time."""
        if self.waves is not None:
            east, north = (round(place / self.size) * self.size for place in (east, north))
        x: FloatArray = east + self._steps
        y: FloatArray = north + self._steps
        up = self.heights(time, x, y)
        return np.stack([*np.meshgrid(x, y, indexing="ij"), up], -1).reshape(-1, 3)

    def heights(self, time: float, x: FloatArray, y: FloatArray) -> FloatArray:
        """Return the elevation, m, at all places (x, y), east and north, m."""
        if self.waves is None:
            return np.zeros((len(x), len(y)))
        waves = self.waves
        now = waves.amplitude * np.exp(1j * (waves.omega * time + waves.phase))
        along_x = np.exp(-1j * np.outer(x, self._east)) * now
        along_y = np.exp(-1j * np.outer(self._north, y))
        return np.asarray((along_x @ along_y).real)
