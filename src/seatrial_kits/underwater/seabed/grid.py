"""Seabed as a grid of depths, bilinear between its points."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from seatrial.errors import InputError, unknown

from .vectors import Vector, unit

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Grid:
    """Depths at points ``north`` x ``east``, m, both rising, at least two of each.

    ``depth[i, j]`` is that at north[i], east[j], m, positive down. Between points it is bilinear;
    beyond the edge the depth is that of the nearest point of the edge.
    """

    north: Array
    east: Array
    depth: Array

    def depth_at(self, north: float, east: float) -> float:
        """Return the depth, m."""
        (i, u), (j, v) = _cell(self.north, north), _cell(self.east, east)
        d = self.depth
        low = (1.0 - v) * d[i, j] + v * d[i, j + 1]
        high = (1.0 - v) * d[i + 1, j] + v * d[i + 1, j + 1]
        return float((1.0 - u) * low + u * high)

    def normal_at(self, north: float, east: float) -> Vector:
        """Return the unit normal into the water, {n}; on a grid line that of the cell beyond."""
        (i, u), (j, v) = _cell(self.north, north), _cell(self.east, east)
        d = self.depth
        to_north = (1.0 - v) * (d[i + 1, j] - d[i, j]) + v * (d[i + 1, j + 1] - d[i, j + 1])
        to_east = (1.0 - u) * (d[i, j + 1] - d[i, j]) + u * (d[i + 1, j + 1] - d[i + 1, j])
        to_north *= _slope(self.north, i, north)
        to_east *= _slope(self.east, j, east)
        return unit((float(to_north), float(to_east), -1.0))

    def ray(self, origin: Sequence[float], direction: Sequence[float], reach: float) -> float:
        """Return the distance, m, along a unit vector; inf if it is beyond ``reach``.

        Exact to rounding: along a ray the height over a bilinear cell is a quadratic, so that
        the first of its roots is the first hit.
        """
        if origin[2] >= self.depth_at(origin[0], origin[1]):
            return 0.0
        begin, end = self._possible(origin[2], direction[2], reach)
        if begin >= end:
            return math.inf
        places = self._crossings(origin, direction, begin, end)
        ends = self._below(origin, direction, places)
        middles = self._below(origin, direction, 0.5 * (places[:-1] + places[1:]))
        share = _first_root(ends[:-1], middles, ends[1:])
        hits = np.flatnonzero(np.isfinite(share))
        if not hits.size:
            return math.inf
        k = hits[0]
        return float(places[k] + share[k] * (places[k + 1] - places[k]))

    def _possible(self, down: float, dive: float, reach: float) -> tuple[float, float]:
        """Return between which distances a ray is between the least and the greatest depth."""
        least, greatest = float(self.depth.min()), float(self.depth.max())
        if dive == 0.0:
            return (0.0, reach) if least <= down else (math.inf, 0.0)
        if dive < 0.0:
            return 0.0, min(reach, (least - down) / dive)
        margin = 1e-9 * (1.0 + abs(greatest - down) / dive)  # what rounding takes off
        return max(0.0, (least - down) / dive), min(reach, (greatest - down) / dive + margin)

    def _crossings(
        self, origin: Sequence[float], direction: Sequence[float], begin: float, end: float
    ) -> Array:
        """Return the distances, rising, at which a ray crosses lines of the grid, and the ends."""
        parts = []
        for lines, start, step in zip((self.north, self.east), origin, direction, strict=False):
            if step:
                with np.errstate(over="ignore"):
                    at = (lines - start) / step
                parts.append(at[(at > begin) & (at < end)])
        inside = np.sort(np.concatenate([np.empty(0), *parts]))
        if end == math.inf:  # a level ray beyond the last line goes on at one height
            end = 1.0 + (inside[-1] if inside.size else begin)
        return np.concatenate([[begin], inside, [end]])

    def _below(self, origin: Sequence[float], direction: Sequence[float], places: Array) -> Array:
        """Return how far a ray is below the seabed at these distances, m."""
        north, east = (origin[k] + direction[k] * places for k in (0, 1))
        i, u = _cells(self.north, north)
        j, v = _cells(self.east, east)
        d = self.depth
        low = (1.0 - v) * d[i, j] + v * d[i, j + 1]
        high = (1.0 - v) * d[i + 1, j] + v * d[i + 1, j + 1]
        below: Array = origin[2] + direction[2] * places - ((1.0 - u) * low + u * high)
        return below


def _cell(lines: Array, place: float) -> tuple[int, float]:
    """Return the index of the cell with ``place`` and the share of it, held at the edges."""
    i = min(max(bisect_right(lines, place) - 1, 0), len(lines) - 2)
    share = (place - float(lines[i])) / float(lines[i + 1] - lines[i])
    return i, min(max(share, 0.0), 1.0)


def _cells(lines: Array, places: Array) -> tuple[Any, Array]:
    i = np.clip(np.searchsorted(lines, places, "right") - 1, 0, len(lines) - 2)
    return i, np.clip((places - lines[i]) / (lines[i + 1] - lines[i]), 0.0, 1.0)


def _slope(lines: Array, i: int, place: float) -> float:
    """Return one over the width of cell ``i``, 0 beyond the edge."""
    beyond = not lines[0] <= place <= lines[-1]
    return 0.0 if beyond else 1.0 / float(lines[i + 1] - lines[i])


def _first_root(first: Array, middle: Array, last: Array) -> Array:
    """Return the least root in [0, 1] of quadratics by three values of each; inf for none."""
    square = 2.0 * (first + last) - 4.0 * middle
    linear = 4.0 * middle - 3.0 * first - last
    with np.errstate(divide="ignore", invalid="ignore"):
        root = np.sqrt(linear**2 - 4.0 * square * first)  # nan for none
        product = -0.5 * (linear + np.copysign(root, linear))
        both = np.stack([product / square, first / product])
    both[~((both >= 0.0) & (both <= 1.0))] = np.inf
    least: Array = both.min(axis=0)
    least[(last >= 0.0) & ~np.isfinite(least)] = 1.0  # rounding put the root just outside
    return least


LARGEST = 64 * 2**20
"""Most bytes of a file."""
_HEAD = ("ncols", "nrows", "xllcorner", "yllcorner", "xllcenter", "yllcenter", "cellsize")
_NODATA = "nodata_value"
_COLUMNS = ("north", "east", "depth")


def read_grid(path: Path) -> Grid:
    """Return the grid of a file, by its ending.

    ``.asc`` is an ESRI ASCII grid of elevations, m, positive up, as bathymetry is published:
    below the water they are negative. x is east and y north of the run's origin, m. ``.csv`` has
    the columns north, east, depth, m, depth positive down, and a line for each point, in any
    order. Raises InputError naming file and line.
    """
    readers = {".asc": _asc, ".csv": _csv}
    reader = readers.get(path.suffix.lower())
    if reader is None:
        raise InputError(f"{path}: {unknown('kind of grid file', path.suffix, readers)}")
    try:
        if path.stat().st_size > LARGEST:
            raise InputError(f"{path}: larger than {LARGEST >> 20} MiB")
        text = path.read_text("ascii")
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}") from None
    except UnicodeDecodeError:
        raise InputError(f"{path}: not a text of ASCII characters") from None
    return reader(path, text)


def _asc(path: Path, text: str) -> Grid:
    lines = text.splitlines()
    head: dict[str, float] = {}
    for number, line in enumerate(lines, 1):
        words = line.split()
        if not words or not words[0][0].isalpha() or words[0].lower() in ("nan", "inf"):
            break
        where, key = f"{path}, line {number}", words[0].lower()
        if key not in (*_HEAD, _NODATA) or key in head or len(words) != 2:
            raise InputError(f"{where}: {line.strip()!r} is none of {', '.join(_HEAD)}, {_NODATA}")
        head[key] = _number(words[1], where)
    rows, columns = _count(head, "nrows", path), _count(head, "ncols", path)
    if not head.get("cellsize", 0.0) > 0.0:
        raise InputError(f"{path}: cellsize is {head.get('cellsize')}, above 0 m is needed")
    values = _asc_values(path, lines[len(head) :], len(head), head.get(_NODATA))
    if len(values) != rows * columns:
        raise InputError(f"{path}: {len(values)} values, {rows} rows of {columns} are needed")
    size = head["cellsize"]
    east: Array = _first(head, "x", path) + size * np.arange(columns, dtype=np.float64)
    north: Array = _first(head, "y", path) + size * np.arange(rows, dtype=np.float64)
    if not (np.diff(east) > 0.0).all() or not (np.diff(north) > 0.0).all():
        raise InputError(f"{path}: cellsize is {size}, too small beside the corner's coordinates")
    elevation = np.array(values).reshape(rows, columns)[::-1]  # the first row is the northern one
    return Grid(north, east, 0.0 - elevation)


def _asc_values(path: Path, lines: list[str], above: int, missing: float | None) -> list[float]:
    values = []
    for number, line in enumerate(lines, above + 1):
        where = f"{path}, line {number}"
        for word in line.split():
            value = _number(word, where)
            if value == missing:
                raise InputError(f"{where}: a point without data ({word}): the grid must be full")
            values.append(value)
    return values


def _count(head: dict[str, float], key: str, path: Path) -> int:
    value = head.get(key, 0.0)
    if value < 2.0 or value % 1.0:
        raise InputError(f"{path}: {key} is {head.get(key)}, a whole number from 2 is needed")
    return int(value)


def _first(head: dict[str, float], axis: str, path: Path) -> float:
    """Return the coordinate of the first point: centre of the cell in the corner."""
    corner, centre = f"{axis}llcorner", f"{axis}llcenter"
    if (corner in head) == (centre in head):
        raise InputError(f"{path}: one of {corner} and {centre} is needed")
    return head[centre] if centre in head else head[corner] + 0.5 * head["cellsize"]


def _csv(path: Path, text: str) -> Grid:
    points: dict[tuple[float, float], float] = {}
    for number, cells in _rows(path, text):
        where = f"{path}, line {number}"
        if len(cells) != len(_COLUMNS):
            raise InputError(f"{where}: {len(cells)} values, {', '.join(_COLUMNS)} are needed")
        north, east, depth = (_number(cell, where) for cell in cells)
        if (north, east) in points:
            raise InputError(f"{where}: a second depth at north {north!r}, east {east!r}")
        points[north, east] = depth
    norths, easts = sorted({n for n, _ in points}), sorted({e for _, e in points})
    if len(norths) < 2 or len(easts) < 2:
        raise InputError(f"{path}: points at two norths and two easts at least are needed")
    if len(points) != len(norths) * len(easts):
        absent = next((n, e) for n in norths for e in easts if (n, e) not in points)
        raise InputError(f"{path}: no depth at north {absent[0]!r}, east {absent[1]!r}")
    depth_rows = [[points[n, e] for e in easts] for n in norths]
    return Grid(np.array(norths), np.array(easts), np.array(depth_rows))


def _rows(path: Path, text: str) -> Iterator[tuple[int, list[str]]]:
    head, *lines = text.splitlines() or [""]
    if tuple(cell.strip() for cell in head.split(",")) != _COLUMNS:
        raise InputError(f"{path}, line 1: {head!r}, the head must be {','.join(_COLUMNS)}")
    for number, line in enumerate(lines, 2):
        if line.strip():
            yield number, line.split(",")


def _number(word: str, where: str) -> float:
    try:
        value = float(word)
    except ValueError:
        value = math.nan
    if not abs(value) < 1e9:
        raise InputError(f"{where}: {word.strip()!r} is not a number (below 1e9)")
    return value
