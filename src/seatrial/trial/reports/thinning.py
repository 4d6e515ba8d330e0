"""Rows of a long record that its figures show."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from itertools import pairwise

import numpy as np

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
    columns = run.signals
    if len(run.time) <= most or any(isinstance(each, list) for each in columns.values()):
        return run
    rows = _extremes(columns.values(), len(run.time), max((most - 2) // (2 * len(columns)), 1))
    kept = {name: values[rows] for name, values in columns.items()}
    return replace(run, time=run.time[rows], signals=kept)


def _extremes(columns: Collection[FloatArray], count: int, stretches: int) -> FloatArray:
    found = [np.array([0, count - 1])]
    edges = np.linspace(0, count, stretches + 1).astype(int)
    for first, last in pairwise(edges):
        for values in columns:
            part = values[first:last]
            known = np.flatnonzero(~np.isnan(part))
            if len(known):
                found.append(first + known[[part[known].argmin(), part[known].argmax()]])
    return np.unique(np.concatenate(found))
