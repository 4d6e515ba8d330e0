"""Values of signals at the communication points of a block of steps."""

from __future__ import annotations

import ctypes
from array import array
from collections.abc import Callable, Sequence
from operator import itemgetter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .structures import Master


class Rows:
    """The signals at ``places``, at every point that is a multiple of ``every`` steps."""

    def __init__(self, places: Sequence[int], every: int) -> None:
        self.places, self.every = list(places), every
        self._places = (ctypes.c_int64 * max(1, len(places)))(*places)
        self._table = np.empty((0, len(places)))
        self._begun, self._master = 0, Master()
        self._noted = array("d")

    def attach(self, master: Master, count: int) -> None:
        """Let the next ``count`` steps of a master leave their points here."""
        if len(self._table) < count:
            self._table = np.empty((count, max(1, len(self.places))))
        master.rows = self._table.ctypes.data_as(ctypes.POINTER(ctypes.c_double))
        master.row_places, master.row_count = self._places, len(self.places)
        master.row_every, master.rows_kept = self.every, 0
        self._begun, self._master = master.steps, master

    def keeping(self, begun: int, signals: Sequence[Any]) -> Callable[[int], None]:
        """Return what leaves a point here after a step that Python took, of those from ``begun``.

        It is called with the number of steps, after each.
        """
        self._begun, every, keep = begun, self.every, self._noted.extend
        values = _values(self.places)

        def noted(steps: int) -> None:
            if steps % every == 0:
                keep(values(signals))

        return noted

    def taken(self) -> tuple[int, NDArray[np.float64]]:
        """Return the steps at the first row, and the rows; they are gone from here then."""
        kept, self._master.rows_kept = self._master.rows_kept, 0
        first = (self._begun // self.every + 1) * self.every
        if not self._noted:
            return first, self._table[:kept, : len(self.places)]
        table = np.array(self._noted).reshape(-1, len(self.places))
        del self._noted[:]
        return first, table


def _values(places: Sequence[int]) -> Callable[[Sequence[Any]], Sequence[Any]]:
    """Return what returns the signals at places."""
    if len(places) > 1:
        return itemgetter(*places)
    return lambda signals: [signals[place] for place in places]
