"""Files of depths: ESRI ASCII grids and tables of north, east and depth."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from ...errors import InputError, unknown
from .grid import Array, Grid

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
