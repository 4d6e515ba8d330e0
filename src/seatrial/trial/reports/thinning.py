"""Rows of a long record that its figures show."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ..criteria.expressions import FloatArray
from ..records.run_folder import Run

MOST_ROWS = 200_000
"""Rows of a record whose figures are drawn of all of them; more than pages show of a line."""


def thinned(run: Run, most: int = MOST_ROWS) -> Run:
    """Return a run of at most ``most`` rows, with the extremes of every signal.

    The rows are cut into stretches of equal numbers; of each the rows with the least and the
    greatest value of each signal stay, and the first and last of all. A run with text stays as it
    is: each change of a text counts.
    """
    count = len(run.time)
    has_text = any(isinstance(run.signals[name], list) for name in run.signals)
    if count <= most or not run.signals or has_text:
        return run
    edges = np.linspace(0, count, max((most - 2) // (2 * len(run.signals)), 1) + 1).astype(int)
    # Signals one by one: those of a long log are not in memory together.
    found = [
        np.array([0, count - 1]),
        *(_extremes(run.signals[name], edges) for name in run.signals),
    ]
    rows = np.unique(np.concatenate(found))
    kept = {name: run.signals[name][rows] for name in run.signals}
    return replace(run, time=run.time[rows], signals=kept)


def _extremes(values: FloatArray, edges: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the rows of the least and the greatest number of each stretch."""
    found = []
    for first, last in pairwise(edges.tolist()):
        known = np.flatnonzero(~np.isnan(values[first:last])) + first
        if len(known):
            part = values[known]
            found += [known[part.argmin()], known[part.argmax()]]
    return np.array(found, np.int64)
