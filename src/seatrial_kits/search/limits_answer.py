"""The question of limits: map and table of the boundary that runs have found."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from seatrial.errors import InputError
from seatrial_kits.campaigns.questions import LimitsQuestion
from seatrial_kits.campaigns.results.finding import Finding, Shown

from .asking import Asking
from .drawing import Axes, drawn
from .limits import SURE, Boundary, find_boundary
from .parquet import write_columns
from .searching import needed
from .space import Space, refuse_whole

BOUNDARY = "boundary.parquet"
_LINES = 101
"""Of the grid that a map is drawn on, each way."""
_SLICES = (0.1, 0.3, 0.5, 0.7, 0.9)
"""Shares of the third key's range of which there is a map."""
_STEP = 0.02
"""Between points of the boundary in the table, as a share of the ranges."""
_SAID = 12
"""Points of the boundary that are shown; the table has all."""


def limits_question(entry: LimitsQuestion, asking: Asking) -> Callable[[], Finding]:
    """Return what finds the boundary of the region that passes, in two or three keys, and draws it.

    Raises InputError for another number of keys, and for a criterion that does not exist.
    """
    space = asking.space = asking.space.only(entry.keys, asking.origin)
    for library in ("sklearn", "contourpy", "matplotlib"):
        needed(library)
    if len(space.keys) not in (2, 3):
        raise InputError(
            f"{asking.origin}: a map has two or three keys, and {len(space.keys)} vary "
            f"({', '.join(space.keys)}): say which in keys"
        )
    refuse_whole(space, asking.origin, "a boundary is one of quantities")
    value = asking.robustness(entry.criterion)

    def answer() -> Finding:
        asking.expect(entry.runs)
        boundary = find_boundary(
            lambda shares: value(space.numbers(shares)), len(space.keys), entry.runs, asking.seed
        )
        return _finding(asking, boundary)

    return answer


def _finding(asking: Asking, boundary: Boundary) -> Finding:
    finding, space = asking.finding(), asking.space
    passed = int((boundary.values > 0).sum())
    finding.lines.append(f"{passed} of {len(boundary.values)} runs pass")
    if not boundary.has_both:
        finding.lines.append("there is no boundary within the ranges")
        finding.values = {"passes": float(passed > 0), "uncertain": 0.0, "boundary": []}
        return finding
    maps = [_Map(boundary, third) for third in (_SLICES if len(space.keys) == 3 else (None,))]
    passes = float(np.mean([_share(each.mean > 0) for each in maps]))
    uncertain = float(np.mean([_share(np.abs(each.mean) < SURE * each.sigma) for each in maps]))
    finding.lines += [
        f"{passes:.1%} of the ranges pass; of {uncertain:.1%} that is not sure (95 %)",
        f"left out one at a time, {boundary.mistaken():.1%} of the runs would be mistaken",
    ]
    rows = [row for each in maps for row in each.boundary()]
    numbers = space.numbers(np.array([row[:-1] for row in rows]))
    columns = {key: numbers[:, i] for i, key in enumerate(space.keys)}
    columns["half-width"] = np.array([row[-1] for row in rows])
    units = dict(zip(space.keys, space.units, strict=True))
    write_columns(asking.folder / BOUNDARY, columns, units)
    table = np.column_stack(list(columns.values())).tolist()
    finding.values = {
        "passes": passes,
        "uncertain": uncertain,
        "mistaken": boundary.mistaken(),
        "boundary": BOUNDARY,
        "keys": units,
    }
    shown = table[:: -(-len(table) // _SAID)]
    title = f"Points of the boundary ({len(shown)} of {len(table)}; {BOUNDARY} has all)"
    half = "half-width (95 %), share of the ranges"
    finding.tables.append(Shown(title, [*space.titles(), half], shown))
    with drawn(asking.folder, "limits", len(maps)) as axes:
        for each, one in zip(maps, axes, strict=True):
            each.draw(one, space, boundary)
    finding.figures.append("limits.svg")
    return finding


def _share(where: np.ndarray) -> float:
    """Return the share of the area in which it is true, by the trapezoidal rule."""
    return float(np.trapezoid(np.trapezoid(where.astype(float)))) / (_LINES - 1) ** 2


class _Map:
    """Mean and standard deviation over two keys, at one share of the third, if there is one."""

    def __init__(self, boundary: Boundary, third: float | None) -> None:
        self.third, self._surrogate = third, boundary.surrogate
        self.line = np.linspace(0.0, 1.0, _LINES)
        first, second = np.meshgrid(self.line, self.line)
        mean, sigma = self._surrogate.at(self._points(first.ravel(), second.ravel()))
        self.mean, self.sigma = mean.reshape(first.shape), sigma.reshape(first.shape)

    def boundary(self) -> Iterator[list[float]]:
        """Yield points where the mean is zero, with the half-width there: 1.96 sigma / |slope|."""
        lines = needed("contourpy").contour_generator(self.line, self.line, self.mean).lines(0.0)
        for line in lines:
            length = np.append(0.0, np.hypot(*np.diff(line, axis=0).T).cumsum())
            places = np.linspace(0.0, length[-1], max(2, int(length[-1] / _STEP) + 1))
            points = self._points(*(np.interp(places, length, axis) for axis in line.T))
            sigma = self._surrogate.at(points)[1]
            slopes = [self._slope(points, axis) for axis in range(points.shape[1])]
            steepness = np.maximum(np.linalg.norm(slopes, axis=0), 1e-12)
            yield from np.column_stack([points, np.minimum(SURE * sigma / steepness, 1.0)]).tolist()

    def draw(self, axes: Axes, space: Space, boundary: Boundary) -> None:
        """Draw the map, with the runs; of a slice those nearest to it."""
        x, y = (low + (high - low) * self.line for low, high in space.ends[:2])
        axes.contourf(x, y, self.mean, [-np.inf, 0.0, np.inf], colors=["#f3cfcb", "#cfe6d8"])
        sure = np.abs(self.mean) - SURE * self.sigma
        axes.contourf(x, y, sure, [-np.inf, 0.0], colors=["#8a94a0"], alpha=0.45)
        axes.contour(x, y, self.mean, [0.0], colors=["#22303c"], linewidths=1.5)
        near = np.ones(len(boundary.points), bool)
        if self.third is not None:
            near = np.abs(boundary.points[:, 2] - self.third) <= 0.1
            value = space.numbers(np.full((1, 3), self.third))[0, 2]
            axes.set_title(f"{space.keys[2]} {value:.4g} {space.units[2]}".strip(), fontsize=9)
        numbers = space.numbers(boundary.points)
        for is_good, colour, mark in ((True, "#1f7a4d", "o"), (False, "#b3261e", "x")):
            here = near & ((boundary.values > 0) == is_good)
            axes.scatter(*numbers[here, :2].T, s=14, c=colour, marker=mark, linewidths=0.9)
        titles = space.titles()
        axes.set_xlabel(titles[0])
        axes.set_ylabel(titles[1])
        axes.set_xlim(*space.ends[0])
        axes.set_ylim(*space.ends[1])

    def _points(self, first: np.ndarray, second: np.ndarray) -> np.ndarray:
        columns = [first, second]
        if self.third is not None:
            columns.append(np.full_like(first, self.third))
        return np.column_stack(columns)

    def _slope(self, points: np.ndarray, axis: int, step: float = 1e-4) -> np.ndarray:
        ahead, behind = points.copy(), points.copy()
        ahead[:, axis] += step
        behind[:, axis] -= step
        both = [self._surrogate.at(each)[0] for each in (ahead, behind)]
        slope: np.ndarray = (both[0] - both[1]) / (2.0 * step)
        return slope
