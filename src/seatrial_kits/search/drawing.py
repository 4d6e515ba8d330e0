"""Drawings of answers, for pages and documents: the same bytes for the same numbers."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from .searching import needed

Axes = Any
"""Of Matplotlib."""
_SIDE_IN = 4.2
_MOST_IN_ROW = 3


@contextmanager
def drawn(folder: Path, name: str, count: int = 1) -> Iterator[list[Axes]]:
    """Yield axes to draw on, and write NAME.svg and NAME.png at the end.

    Raises InputError if Matplotlib is not installed.
    """
    matplotlib = needed("matplotlib")
    figures = needed("matplotlib.figure")
    needed("matplotlib.backends.backend_svg"), needed("matplotlib.backends.backend_agg")
    columns = min(count, _MOST_IN_ROW)
    rows = -(-count // columns)
    style = {"svg.hashsalt": "seatrial", "svg.fonttype": "path", "font.size": 9.0}
    with matplotlib.rc_context(style):
        size = (_SIDE_IN * columns, 0.9 * _SIDE_IN * rows)
        figure = figures.Figure(figsize=size, layout="constrained")
        axes = list(figure.subplots(rows, columns, squeeze=False).flat)
        for one in axes[count:]:
            one.remove()
        yield axes[:count]
        figure.savefig(folder / f"{name}.svg", metadata={"Date": None})
        figure.savefig(folder / f"{name}.png", dpi=150)
