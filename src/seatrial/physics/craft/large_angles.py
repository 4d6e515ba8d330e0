"""Righting arm of hulls at large angles of heel, from their sections, to capsize.

A section is a superellipse below the water line, |2 y / b|^n + (z / T)^n = 1 with the n that gives
its area (Lame; 2 an ellipse, without end a box), and goes straight up to a deck that holds the
water out. Points are (y, z), m, to starboard and down from the water line at rest.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from ...errors import InputError
from ..sea.numbers import Array

HARMONICS = 12
"""Of a righting arm as a series of sines."""
_POINTS = 24
_FULLEST = 0.995
"""Share of beam times draught from which on a section is a box."""
_HOLLOWEST = 0.3
_ANGLES = np.radians(np.arange(0.0, 181.0, 3.0))


class Slice(NamedTuple):
    """A section, and the length of hull that it stands for."""

    outline: Array
    """(points, 2), round."""
    length: float


def outline(beam: float, draught: float, area: float, freeboard: float, aside: float) -> Array:
    """Return a section, m and m2, whose centre plane is ``aside`` to starboard, m."""
    half = beam / 2
    coefficient = max(area / (beam * draught), _HOLLOWEST)
    if coefficient >= _FULLEST:
        below = np.array([[half, 0.0], [half, draught], [-half, draught], [-half, 0.0]])
    else:
        power = 2.0 / _root(lambda n: _fullness(n) - coefficient, 0.3, 1e3)
        t = np.linspace(0.0, math.pi, 2 * _POINTS + 1)
        cos, sin = np.cos(t), np.sin(t)
        y = half * np.sign(cos) * np.abs(cos) ** power
        below = np.column_stack([y, draught * np.abs(sin) ** power])
    deck = [[-half, -freeboard], [half, -freeboard]]
    return np.asarray(np.concatenate([below, deck]) + np.array([aside, 0.0]))


def _root(function: Callable[[float], float], low: float, high: float) -> float:
    from scipy.optimize import brentq  # half a second, of every run if it stood above

    return float(brentq(function, low, high, xtol=1e-12))


def _fullness(n: float) -> float:
    """Return the area of a quarter of a superellipse over that of its box."""
    return math.exp(2 * math.lgamma(1 + 1 / n) - math.lgamma(1 + 2 / n))


def righting_arms(hull: Sequence[Slice], volume: float, GM_T: float, phi: Array) -> Array:
    """Return GZ, m, at angles of heel ``phi``, rad: righting where it has the sign of phi.

    ``volume``, m3, is displaced at every angle, the hull level in pitch and free to sink; the
    centre of gravity is where the metacentric height at rest is ``GM_T``, m. With (y_B, z_B) the
    centre of buoyancy in axes that heel does not turn, GZ = y_B + z_G sin(phi).

    Raises InputError for a hull that does not float: ``volume`` beyond what is below its deck.
    """
    edges = _Edges.of(hull)
    whole = edges.below(edges.start[:, 1].min())[0]
    if not 0.0 < volume < whole:
        raise InputError(
            f"hull and deck enclose {whole:.4g} m3, and {volume:.4g} m3 are displaced: more "
            "hull_freeboard is needed, or other sections"
        )
    small = 1e-4
    # Of a centre of gravity in the water line, z_G = 0: GM at rest.
    level = _buoyancy(edges, volume, small) / small
    return np.array([_buoyancy(edges, volume, a) + (GM_T - level) * math.sin(a) for a in phi])


def _buoyancy(edges: _Edges, volume: float, phi: float) -> float:
    """Return y of the centre of buoyancy, m, about the origin, at an angle of heel."""
    turned = edges.turned(phi)
    depths = turned.start[:, 1]
    surface = _root(lambda s: turned.below(s)[0] - volume, depths.min(), depths.max())
    displaced, moment = turned.below(float(surface))
    return moment / displaced


class _Edges(NamedTuple):
    """Edges of the outlines of all slices."""

    start: Array
    end: Array
    """(edges, 2)."""
    length: Array
    """Of the slice, with the sign that makes what is inside count above 0."""

    @classmethod
    def of(cls, hull: Sequence[Slice]) -> _Edges:
        ends = [np.roll(part.outline, -1, 0) for part in hull]
        lengths = [
            np.full(len(end), part.length * _way_round(part.outline, end))
            for part, end in zip(hull, ends, strict=True)
        ]
        starts = [part.outline for part in hull]
        return cls(np.concatenate(starts), np.concatenate(ends), np.concatenate(lengths))

    def turned(self, phi: float) -> _Edges:
        """Return them heeled to starboard."""
        cos, sin = math.cos(phi), math.sin(phi)
        turn = np.array([[cos, sin], [-sin, cos]])
        return _Edges(self.start @ turn, self.end @ turn, self.length)

    def below(self, surface: float) -> tuple[float, float]:
        """Return the volume with z beyond ``surface``, m3, and its moment of y, m4.

        Green's theorem with z from the surface, so that what closes the outline there is 0.
        """
        (y_0, z_0), (y_1, z_1) = self.start.T, self.end.T
        z_0, z_1 = z_0 - surface, z_1 - surface
        crosses = (z_0 > 0.0) != (z_1 > 0.0)
        share = np.divide(z_0, z_0 - z_1, out=np.zeros_like(z_0), where=crosses)
        cut = y_0 + share * (y_1 - y_0)
        a, b = np.where(z_0 > 0.0, y_0, cut), np.where(z_1 > 0.0, y_1, cut)
        z_0, z_1 = np.maximum(z_0, 0.0), np.maximum(z_1, 0.0)
        along = self.length * (b - a)
        moment = along * (2 * a * z_0 + a * z_1 + b * z_0 + 2 * b * z_1) / 6
        return float(along @ (z_0 + z_1)) / 2, float(moment.sum())


def _way_round(start: Array, end: Array) -> float:
    """Return the sign of the area that the edges enclose by the integral of z over y."""
    return math.copysign(1.0, float((end[:, 0] - start[:, 0]) @ (start[:, 1] + end[:, 1])))


def sine_series(hull: Sequence[Slice], volume: float, GM_T: float) -> Array:
    """Return a of GZ = sum a_k sin(k phi), (HARMONICS,), m, whose slope at 0 is ``GM_T``.

    Least squares over 0 to 180 degrees. Raises InputError as `righting_arms`.
    """
    k = np.arange(1, HARMONICS + 1)
    base = np.sin(np.outer(_ANGLES, k))
    # a_1 = GM - sum over k > 1 of k a_k.
    left = righting_arms(hull, volume, GM_T, _ANGLES) - GM_T * base[:, 0]
    rest = np.linalg.lstsq(base[:, 1:] - np.outer(base[:, 0], k[1:]), left, rcond=None)[0]
    return np.concatenate([[GM_T - k[1:] @ rest], rest])
