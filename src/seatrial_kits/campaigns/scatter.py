"""Scatter diagrams: two keys drawn together from a table of occurrences, such as Hs and Tp."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from pydantic import Field

from seatrial.errors import InputError
from seatrial.system.files import FileModel

from .distributions import Distribution, Law, Written, drawn_cells, read_distribution


class ScatterAxis(FileModel):
    """A key of a scatter diagram, and the limits of its cells."""

    key: str
    bins: list[Written] = Field(min_length=2)


class ScatterEntry(FileModel):
    """A scatter diagram: a cell is drawn in proportion to its occurrences, uniform inside it."""

    rows: ScatterAxis
    columns: ScatterAxis
    occurrences: list[list[float]] = Field(min_length=1)


@dataclass(frozen=True)
class Scatter:
    """A scatter diagram that has been read."""

    laws: dict[str, Law]
    """Of each key by itself, rows first: its cells by the sums of their occurrences."""
    edges: tuple[np.ndarray, np.ndarray]
    occurrences: np.ndarray

    def numbers(self, probabilities: np.ndarray) -> np.ndarray:
        """Return both keys' numbers, a row each, at independent probabilities.

        The first says the row of the diagram and the place in it, the second the cell of that row
        (Rosenblatt's transformation): Latin hypercubes and Sobol's points keep their strata of the
        rows' key.
        """
        rows, columns = self.edges
        places, shares = drawn_cells(self.occurrences.sum(axis=1), probabilities[:, 0])
        found = np.empty_like(probabilities)
        found[:, 0] = rows[places] + np.diff(rows)[places] * shares
        for place in np.unique(places):
            here = places == place
            cells, within = drawn_cells(self.occurrences[place], probabilities[here, 1])
            found[here, 1] = columns[cells] + np.diff(columns)[cells] * within
        return found


def read_scatter(entry: ScatterEntry, origin: str) -> Scatter:
    """Return the scatter diagram that a file says. Raises InputError."""
    if entry.rows.key == entry.columns.key:
        raise InputError(f"{origin}: two keys are needed, found {entry.rows.key} twice")
    shape = (len(entry.rows.bins) - 1, len(entry.columns.bins) - 1)
    counts = entry.occurrences
    if len(counts) != shape[0] or any(len(row) != shape[1] for row in counts):
        sizes = ", ".join(sorted({str(len(row)) for row in counts}))
        raise InputError(
            f"{origin}: occurrences: {shape[0]} rows of {shape[1]} numbers are needed, one less "
            f"than bins, found {len(counts)} of {sizes}"
        )
    if not all(count >= 0.0 and math.isfinite(count) for row in counts for count in row):
        raise InputError(f"{origin}: occurrences: numbers from 0 on are needed")
    occurrences = np.array(counts)
    if not occurrences.any():
        raise InputError(f"{origin}: occurrences: all are 0")
    laws = {}
    for axis, name, sums in (
        (entry.rows, "rows", occurrences.sum(axis=1)),
        (entry.columns, "columns", occurrences.sum(axis=0)),
    ):
        law = Distribution(bins=axis.bins, weights=sums.tolist())
        laws[axis.key] = read_distribution(law, f"{origin}: {name}")
    edges = [law.edges for law in laws.values()]
    return Scatter(laws, (edges[0], edges[1]), occurrences)
