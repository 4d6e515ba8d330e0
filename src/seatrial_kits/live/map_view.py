"""The map from above: tracks, legs, marks and craft as a drawing in the page's panel."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from seatrial.links.geodesy import Origin
from seatrial.trial.criteria.expressions import FloatArray
from seatrial.trial.records.scene import waypoints

from .motion import Frame, Motion
from .scene import TRACKS

_SIDE = 320
"""Of the drawing, px."""
_POINTS = 400


class Map:
    """A map of a run whose frame is that of its tracks and marks."""

    def __init__(self, motion: Motion, size: float) -> None:
        self._motion, self._size = motion, size
        self._routes = [np.array(p, dtype=float)[:, :2] for _, p in waypoints(motion.run) if p]
        self._fit([craft.position[:, :2] for craft in motion.crafts])

    def html(self, frame: Frame, tracks: Sequence[FloatArray] | None = None) -> str:
        """Return the drawing of a frame; ``tracks`` (east, north) are the record's by default."""
        if tracks is None:
            tracks = [c.position[: frame.row + 1, :2] for c in self._motion.crafts]
        else:
            tracks = [track[:, :2] for track in tracks]
            self._fit(tracks)
        parts = [self._grid()]
        for route in self._routes:
            parts.append(self._line(route, "#d79a00", 'stroke-dasharray="4 3"'))
            for number, place in enumerate(route, 1):
                x, y = self._place(place)
                parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3" fill="#d79a00"/>')
                parts.append(f'<text x="{x + 5:.1f}" y="{y - 4:.1f}" class="q">{number}</text>')
        for number, track in enumerate(tracks):
            colour = "#{:02x}{:02x}{:02x}".format(*TRACKS[number % len(TRACKS)])
            parts.append(self._line(track, colour))
            parts.append(self._craft(frame, number, colour))
        drawn = "".join(parts)
        return (
            '<div style="padding:0 .6em"><svg class="map" width="100%" '
            f'viewBox="0 0 {_SIDE} {_SIDE}" style="background:#dcebf3;border-radius:6px" '
            'font-family="sans-serif" font-size="10" fill="#33424d">'
            f"{drawn}</svg>{self._where(frame)}</div>"
        )

    # ------------------------------------------------------------------ inside

    def _fit(self, tracks: Sequence[FloatArray]) -> None:
        points = np.concatenate([*tracks, *self._routes, np.zeros((0, 2))])
        if not len(points):
            points = np.zeros((1, 2))
        low, high = points.min(axis=0), points.max(axis=0)
        self._span = 1.15 * max(float((high - low).max()), 6.0 * self._size)
        self._centre = 0.5 * (low + high)

    def _place(self, point: Any) -> tuple[float, float]:
        east, north = (np.asarray(point, dtype=float) - self._centre) / self._span
        return (0.5 + east) * _SIDE, (0.5 - north) * _SIDE

    def _line(self, points: FloatArray, colour: str, more: str = "") -> str:
        points = points[:: -(-len(points) // _POINTS) or 1]
        placed = ((points - self._centre) / self._span * [1.0, -1.0] + 0.5) * _SIDE
        text = " ".join(f"{x:.1f},{y:.1f}" for x, y in placed.tolist())
        return (
            f'<polyline points="{text}" fill="none" stroke="{colour}" stroke-width="1.6" {more}/>'
        )

    def _grid(self) -> str:
        step = 10.0 ** math.floor(math.log10(self._span / 2.0))
        step = next(step * k for k in (1.0, 2.0, 5.0, 10.0) if self._span / (step * k) < 8.0)
        lines = []
        for axis in (0, 1):
            first = math.ceil((self._centre[axis] - 0.5 * self._span) / step)
            last = math.floor((self._centre[axis] + 0.5 * self._span) / step)
            for number in range(first, last + 1):
                share = (number * step - self._centre[axis]) / self._span
                at = (0.5 + share if axis == 0 else 0.5 - share) * _SIDE
                ends = (at, 0, at, _SIDE) if axis == 0 else (0, at, _SIDE, at)
                x1, y1, x2, y2 = (f"{value:.1f}" for value in ends)
                lines.append(f'<path d="M{x1} {y1}L{x2} {y2}" stroke="#b9d0dd" stroke-width=".7"/>')
        scale = f'<text x="6" y="{_SIDE - 6}">grid {step:g} m</text>'
        north = f'<text x="{_SIDE - 16}" y="14" font-weight="bold">N &#8593;</text>'
        return "".join(lines) + scale + north

    def _craft(self, frame: Frame, number: int, colour: str) -> str:
        pose = frame.pose(number)
        x, y = self._place(pose.position[:2])
        turn = math.degrees(math.atan2(pose.ahead[0], pose.ahead[1]))
        return (
            f'<path d="M0 -9L5 7L0 4L-5 7Z" fill="{colour}" stroke="#fff" '
            f'transform="translate({x:.1f} {y:.1f}) rotate({turn:.1f})"/>'
        )

    def _where(self, frame: Frame) -> str:
        """Return place and heading of the first craft, with latitude and longitude at a home."""
        if not self._motion.crafts:
            return ""
        craft, pose = self._motion.crafts[0], frame.pose(0)
        east, north, up = pose.position.tolist()
        heading = math.degrees(math.atan2(pose.ahead[0], pose.ahead[1])) % 360.0
        text = f"north {north:.1f} m, east {east:.1f} m, depth {-up:.1f} m, heading {heading:.0f}°"
        home = self._motion.run.manifest["components"][craft.component].get("home")
        if home:
            latitude, longitude, _ = Origin(*home).geodetic((north, east, -up))
            text += f"<br>{latitude:.6f}°, {longitude:.6f}°"
        return f'<div style="font-size:.75em;opacity:.75">{text}</div>'
