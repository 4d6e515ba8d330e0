"""Motion of a raft that follows a long-crested sea, averaged over its length and breadth."""

from __future__ import annotations

import ast
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import InputError
from ..sea.numbers import Array
from ..sea.spectra import Jonswap

STEEPNESS = 0.04
"""2 pi Hs / (g Tp^2) of a sea whose period is not given."""
_GRAVITY = 9.81
_BINS = 60
_LOWEST, _HIGHEST = 0.5, 4.0
_LARGEST = 10_000_000
_KEYS = {
    "omega [rad/s]": "omega",
    "amplitude [m]": "amplitude",
    "phase [rad]": "phase",
    "heave per amplitude": "heave",
    "slope north per amplitude [1/m]": "slope_north",
    "slope east per amplitude [1/m]": "slope_east",
    "surge north per amplitude": "surge_north",
    "surge east per amplitude": "surge_east",
}


@dataclass(frozen=True)
class Follower:
    """Components of the sea (rad/s, m, rad) and what one metre of each makes of the raft.

    heave, upwards, goes with cos(omega t + phase), the others with sin(omega t + phase): slopes to
    north and east, and surge to north and east, which has the sign of the slope, as a raft
    slides down the face of a wave.
    """

    omega: Array
    amplitude: Array
    phase: Array
    heave: Array
    slope_north: Array
    slope_east: Array
    surge_north: Array
    surge_east: Array
    period: float
    pad_height: float

    def moved(self, t: float) -> tuple[list[float], list[float]]:
        """Return heave, slopes north and east, surges north and east at ``t``; their rates."""
        angle = self.omega * t + self.phase
        sin, cos = self.amplitude * np.sin(angle), self.amplitude * np.cos(angle)
        along = self.slope_north, self.slope_east, self.surge_north, self.surge_east
        values = [self.heave @ cos, *(row @ sin for row in along)]
        rates = [-(self.heave * self.omega) @ sin, *((row * self.omega) @ cos for row in along)]
        return [float(v) for v in values], [float(v) for v in rates]


def period_of(height: float) -> float:
    """Return the peak period, s, of a sea of significant ``height``, m, with `STEEPNESS`."""
    return math.sqrt(2.0 * math.pi * height / (_GRAVITY * STEEPNESS))


def drawn(
    size: Sequence[float],
    height: float,
    period: float,
    direction: float,
    pad: float,
    draw: np.random.Generator,
) -> Follower:
    """Return a raft of ``size`` (length, breadth, draught), m, in a JONSWAP sea, gamma 3.3.

    ``height`` m and ``period`` s of the sea; ``direction``, rad from the bow, that the waves run
    to; ``pad`` the pad's height, m. One frequency uniformly in each of 60 bins from 0.5 to 4 times
    that of the peak, amplitudes scaled to (Hs / 4)^2; with k = omega^2 / g, X = k L cos / 2,
    Y = k B sin / 2, S(x) = sin x / x and M(x) = 3 (sin x - x cos x) / x^3, the slope of the best
    straight line through a sine:

        heave          exp(-k d) S(X) S(Y)
        slope north    exp(-k d) k cos M(X) S(Y),     east   exp(-k d) k sin S(X) M(Y)
        surge north    exp(-k d) cos S(X) S(Y),       east   exp(-k d) sin S(X) S(Y)
    """
    if not height:
        return _at_rest(period, pad)
    peak = 2.0 * math.pi / period
    edges = np.linspace(_LOWEST * peak, _HIGHEST * peak, _BINS + 1)
    omega = edges[:-1] + draw.random(_BINS) * np.diff(edges)
    density = Jonswap(height, period, 3.3).density(omega)
    amplitude = np.sqrt(2.0 * density * np.diff(edges))
    amplitude *= math.sqrt((height / 4.0) ** 2 / (0.5 * float(amplitude @ amplitude)))
    length, breadth, draught = size
    k, north, east = omega**2 / _GRAVITY, math.cos(direction), math.sin(direction)
    X, Y = 0.5 * k * length * north, 0.5 * k * breadth * east
    decayed, mean = np.exp(-k * draught), _mean(X) * _mean(Y)
    return Follower(
        omega,
        amplitude,
        2.0 * math.pi * draw.random(_BINS),
        decayed * mean,
        decayed * k * north * _tilt(X) * _mean(Y),
        decayed * k * east * _mean(X) * _tilt(Y),
        decayed * north * mean,
        decayed * east * mean,
        period,
        pad,
    )


def read(file: Path, called: str) -> Follower:
    """Return the raft of a JSON file; raises InputError, which begins with ``called``.

    The file is one flat object of numbers and lists of numbers, under the keys of `_KEYS`, with
    "Tp [s]" and "pad height [m]".
    """
    content = _object(file, called)
    lists = {name: _list(content, key, called, file) for key, name in _KEYS.items()}
    sizes = {key: len(lists[name]) for key, name in _KEYS.items()}
    if len(set(sizes.values())) > 1:
        counted = ", ".join(f"{key!r} {size}" for key, size in sizes.items())
        raise InputError(f"{called}: {file}: lists must have one length, and have {counted}")
    period = _number(content, "Tp [s]", called, file)
    if period <= 0.0:
        raise InputError(f"{called}: {file}: 'Tp [s]' is {period!r}, above 0 is needed")
    pad = _number(content, "pad height [m]", called, file)
    return Follower(**lists, period=period, pad_height=pad)


def _at_rest(period: float, pad: float) -> Follower:
    none = np.zeros(1)
    return Follower(none, none, none, none, none, none, none, none, period, pad)


def _mean(x: Array) -> Array:
    return np.asarray(np.sinc(x / math.pi))


def _tilt(x: Array) -> Array:
    small = np.abs(x) < 1e-3
    safe = np.where(small, 1.0, x)
    exact = 3.0 * (np.sin(safe) - safe * np.cos(safe)) / safe**3
    return np.where(small, 1.0 - x * x / 10.0, exact)


def _object(file: Path, called: str) -> Mapping[str, Any]:
    try:
        if file.stat().st_size > _LARGEST:
            raise InputError(f"{called}: {file} is larger than {_LARGEST} bytes")
        text = file.read_text(encoding="utf-8")
    except OSError as error:
        raise InputError(f"{called}: {file}: {error.strerror or error}") from None
    except UnicodeDecodeError:
        raise InputError(f"{called}: {file} is no text in UTF-8") from None
    try:
        # A flat JSON object of numbers and lists is a literal of Python's too; NaN is none.
        content = ast.literal_eval(text.strip())
    except (ValueError, SyntaxError, RecursionError, MemoryError, TypeError):
        raise InputError(
            f"{called}: {file} is no JSON object of finite numbers, texts and lists of numbers"
        ) from None
    if not isinstance(content, dict):
        raise InputError(f"{called}: {file} holds no JSON object")
    return content


def _number(content: Mapping[str, Any], key: str, called: str, file: Path) -> float:
    value = content.get(key)
    if not _is_number(value):
        raise InputError(f"{called}: {file}: {key!r} is {value!r}, a finite number is needed")
    return float(value)  # type: ignore[arg-type]


def _list(content: Mapping[str, Any], key: str, called: str, file: Path) -> Array:
    values = content.get(key)
    if not isinstance(values, list) or not values:
        raise InputError(f"{called}: {file}: {key!r} is missing or no list of numbers")
    for place, value in enumerate(values):
        if not _is_number(value):
            raise InputError(
                f"{called}: {file}: {key!r}[{place}] is {value!r}, a finite number is needed"
            )
    return np.array(values, dtype=float)


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)
