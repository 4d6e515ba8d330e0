"""A failing case made the smallest change from nominal that still fails."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from .searches import Value
from .space import Space

First = Literal["keys", "distance"]
_PARTS = 8
"""Points between two ends that are looked at together; the stretch is then a ninth."""
_ROUNDS = 4
_PROJECTIONS = 8
_GAIN = 0.995
"""A step is worth while that leaves less than this share of the distance."""
_DIGITS = (3, 4, 5, 6, 8)


@dataclass
class Shrinking:
    """Shrinks points of the unit cube towards ``nominal``; ``value`` <= 0 where one fails.

    The distance of a point is the Euclidean norm of its changes, each as a share of its range.
    """

    value: Value
    nominal: np.ndarray

    def distance(self, point: np.ndarray) -> float:
        """Return the distance of a point from nominal."""
        return float(np.linalg.norm(point - self.nominal))

    def shrunk(self, point: np.ndarray, first: First) -> np.ndarray:
        """Return a point that fails and is near nominal, from one that fails.

        With ``first`` "keys" it changes few keys: one after the other goes back to nominal while
        it still fails. Then the distance is made less: along the line to nominal, by sections; and
        by steps to the nearest point of the linearised boundary ([Hasofer1974], [Rackwitz1978])
        that are brought back to the boundary by sections.
        """
        if first == "keys":
            point = self._fewer_keys(point)
        point = self._nearest_on(self.nominal, point)
        for _ in range(_PROJECTIONS):
            projected = self._projected(point)
            if projected is None:
                break
            nearer = self._failing_beyond(projected, self.distance(point))
            if nearer is None or self.distance(nearer) > _GAIN * self.distance(point):
                break
            point = nearer
        return self._fewer_keys(point) if first == "keys" else point

    def _fewer_keys(self, point: np.ndarray) -> np.ndarray:
        while len(changed := np.flatnonzero(point != self.nominal)) > 1:
            candidates = np.repeat(point[None], len(changed), axis=0)
            candidates[range(len(changed)), changed] = self.nominal[changed]
            values = self.value(candidates)
            if not (values <= 0).any():
                break
            point = candidates[int(np.argmin(values))]
        return point

    def _nearest_on(self, good: np.ndarray, bad: np.ndarray) -> np.ndarray:
        """Return the point nearest to ``good`` that was found to fail on the line to ``bad``."""
        low, high = 0.0, 1.0
        for _ in range(_ROUNDS):
            shares = low + (high - low) * np.arange(1, _PARTS + 1) / (_PARTS + 1)
            fails = self.value(good + shares[:, None] * (bad - good)) <= 0
            if fails.any():
                place = int(np.argmax(fails))
                low, high = (shares[place - 1] if place else low), float(shares[place])
            else:
                low = float(shares[-1])
        result: np.ndarray = good + high * (bad - good)
        result[bad == good] = good[bad == good]  # a key that does not change is as it was
        return result

    def _projected(self, point: np.ndarray, step: float = 1e-3) -> np.ndarray | None:
        """Return the point of the linearised boundary that is nearest to nominal."""
        changed = np.flatnonzero(point != self.nominal)
        if len(changed) < 2:
            return None
        ahead = np.repeat(point[None], len(changed) + 1, axis=0)
        steps = np.where(point[changed] > 0.5, -step, step)
        ahead[range(len(changed)), changed] += steps
        values = self.value(ahead)
        slope = np.zeros_like(point)
        slope[changed] = (values[:-1] - values[-1]) / steps
        size = float(slope @ slope)
        if not (math.isfinite(size) and size > 0.0):
            return None
        along = slope @ (point - self.nominal) - values[-1]
        projected: np.ndarray = np.clip(self.nominal + slope * along / size, 0.0, 1.0)
        return projected

    def _failing_beyond(self, point: np.ndarray, most: float) -> np.ndarray | None:
        """Return a point that fails on the ray through ``point``, nearer than ``most``."""
        reach = self.distance(point)
        if reach == 0.0:
            return None
        shares = np.linspace(1.0 / _PARTS, 1.0, _PARTS) * most / reach
        ray = np.clip(self.nominal + shares[:, None] * (point - self.nominal), 0.0, 1.0)
        fails = self.value(ray) <= 0
        if not fails.any():
            return None
        place = int(np.argmax(fails))
        return self._nearest_on(ray[place - 1] if place else self.nominal, ray[place])


def rounded(numbers: np.ndarray, nominal: np.ndarray, space: Space, value: Value) -> np.ndarray:
    """Return values with as few digits as still fail, rounded away from nominal."""
    candidates = np.array([_rounded(numbers, nominal, space, digits) for digits in _DIGITS])
    failing = np.flatnonzero(value(candidates) <= 0)
    return candidates[failing[0]] if len(failing) else numbers


def _rounded(numbers: np.ndarray, nominal: np.ndarray, space: Space, digits: int) -> list[float]:
    found = []
    parts = zip(numbers, nominal, space.ends, space.laws, strict=True)
    for number, origin, (low, high), law in parts:
        if number == origin or number == 0.0 or law.is_whole:
            found.append(float(number))
            continue
        unit = 10.0 ** (math.floor(math.log10(abs(number))) + 1 - digits)
        steps = math.ceil(number / unit) if number > origin else math.floor(number / unit)
        found.append(min(max(float(f"{steps * unit:.{digits}g}"), low), high))
    return found
