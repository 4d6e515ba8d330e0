"""A plot in characters: a signal and its limit around one moment."""

from __future__ import annotations

import numpy as np

from ..model.readable import number
from ..trial.criteria.course import Course

WIDTH, HEIGHT = 64, 9
_SHARE = 0.1
"""Of the record, before the limit is broken and after the moment."""
_LEAST_ROWS = 8


def plot(of: Course) -> list[str]:
    """Return the lines of a plot: ``*`` the signal, ``-`` its limit, ``^`` the moment."""
    reach = max(int(_SHARE * len(of.time)), _LEAST_ROWS)
    rows = slice(max(of.first - reach, 0), of.row + reach + 1)
    time, values, bound = of.time[rows], of.values[rows], of.bound[rows]
    finite = np.isfinite(values)
    if not finite.any():
        return []
    both = np.concatenate([values[finite], bound[np.isfinite(bound)]])
    low, high = float(both.min()), float(both.max())
    if high == low:
        low, high = low - 1.0, high + 1.0
    canvas = [[" "] * WIDTH for _ in range(HEIGHT)]
    span = float(time[-1] - time[0]) or 1.0
    # Of many rows in a column the farthest from the limit is drawn, of few all columns between.
    columns = np.minimum(((time - time[0]) / span * WIDTH).astype(int), WIDTH - 1)
    for mark, course in (("-", bound), ("*", values)):
        for column in range(WIDTH):
            inside = columns == column
            at = time[0] + (column + 0.5) / WIDTH * span
            drawn = course[inside] if inside.any() else np.array([np.interp(at, time, course)])
            for value in (np.min(drawn), np.max(drawn)):
                if np.isfinite(value):
                    line = round((high - float(value)) / (high - low) * (HEIGHT - 1))
                    canvas[line][column] = mark
    labels = [number(high), *[""] * (HEIGHT - 2), number(low)]
    width = max(map(len, labels))
    moment = int(columns[min(of.row - rows.start, len(columns) - 1)])
    unit = f", {of.unit}" if of.unit not in ("", "1") else ""
    axis = f"{number(time[0], 6)} s".ljust(WIDTH - 12) + f"{number(time[-1], 6)} s".rjust(12)
    return [
        f"{of.name}{unit} (*), limit (-), {number(of.time[of.row], 6)} s (^)",
        *(f"{label:>{width}} |{''.join(line)}" for label, line in zip(labels, canvas, strict=True)),
        f"{'':>{width}} +{'-' * moment}^{'-' * (WIDTH - moment - 1)}",
        f"{'':>{width}}  {axis}",
    ]
