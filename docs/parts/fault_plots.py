"""Small plots as SVG inside a page."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

_WIDTH, _HEIGHT, _LEFT, _BOTTOM, _TOP = 420.0, 110.0, 34.0, 16.0, 16.0
_COLOURS = {True: "#999", False: "#1f77b4"}


@dataclass(frozen=True)
class Line:
    """Points of a line, gaps where a value is None; a faint one is what would have been."""

    points: Sequence[tuple[float, float | None]]
    faint: bool = False


def drawn(title: str, lines: Sequence[Line], shaded: tuple[float, float], stop: float) -> str:
    """Return a plot of lines over time, with the time of the fault shaded."""
    values = [y for line in lines for _, y in line.points if y is not None]
    low, high = min(values), max(values)
    span = (high - low) or 1.0
    right, below = _WIDTH - 6.0, _HEIGHT - _BOTTOM

    def x(t: float) -> str:
        return f"{_LEFT + (right - _LEFT) * t / stop:.1f}"

    def y(value: float) -> str:
        return f"{below - (below - _TOP) * (value - low) / span:.1f}"

    begin, end = (float(x(t)) for t in shaded)
    parts = [
        f'<svg viewBox="0 0 {_WIDTH:g} {_HEIGHT:g}" width="{_WIDTH:g}" role="img" '
        f'font-size="9" fill="currentColor"><title>{title}</title>',
        f'<rect x="{begin:.1f}" y="{_TOP:g}" width="{end - begin:.1f}" '
        f'height="{below - _TOP:g}" fill="#f7b" opacity="0.2"/>',
        f'<text x="{_LEFT:g}" y="10">{title}</text>',
    ]
    for t in (0.0, *shaded, stop):
        parts.append(f'<text x="{x(t)}" y="{_HEIGHT - 4:g}" text-anchor="middle">{t:g}</text>')
    for value in (low, high):
        parts.append(f'<text x="{_LEFT - 4:g}" y="{y(value)}" text-anchor="end">{value:.3g}</text>')
    for line in lines:
        parts += [
            f'<polyline fill="none" stroke="{_COLOURS[line.faint]}" stroke-width="1.2" '
            f'points="{points}"/>'
            for points in _pieces(line, x, y)
        ]
    return "".join([*parts, "</svg>"])


def _pieces(line: Line, x, y) -> list[str]:
    """Return the points of each piece, without those that repeat the one before."""
    pieces: list[list[str]] = [[]]
    last = None
    points = list(line.points)
    for index, (t, value) in enumerate(points):
        if value is None:
            pieces.append([])
            last = None
            continue
        following = points[index + 1][1] if index + 1 < len(points) else None
        if value == last and following == value:
            continue
        pieces[-1].append(f"{x(t)},{y(value)}")
        last = value
    return [" ".join(piece) for piece in pieces if piece]
