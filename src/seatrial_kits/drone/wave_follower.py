"""Motion of a raft that follows a long-crested sea, averaged over its length and breadth."""

from __future__ import annotations

import ast
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from seatrial.errors import InputError

STEEPNESS = 0.04
"""2 pi Hs / (g Tp^2) of a sea whose period is not given."""
_GRAVITY = 9.81
_GAMMA = 3.3
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
    """Components of a raft's motion, peak period of the sea, s, and height of the pad, m.

    A component has frequency omega, rad/s, amplitude, m, phase, rad, of a wave, and what one
    metre of that wave makes of the raft: heave, upwards, with cos(omega t + phase), and with
    sin(omega t + phase) slopes to north and east, 1/m, and surge to north and east, which has the
    sign of the slope, as a raft slides down the face of a wave.
    """

    components: Sequence[Sequence[float]]
    period: float
    pad_height: float


def moved(components: Iterable[Sequence[float]], t: float) -> tuple[list[float], list[float]]:
    """Return heave, slopes north and east, surges north and east at ``t``; their rates."""
    heave = north = east = ahead = aside = 0.0
    d_heave = d_north = d_east = d_ahead = d_aside = 0.0
    for omega, amplitude, phase, rises, tilts_n, tilts_e, goes_n, goes_e in components:
        angle = omega * t + phase
        sin, cos = amplitude * math.sin(angle), amplitude * math.cos(angle)
        d_sin, d_cos = omega * cos, -omega * sin
        heave, d_heave = heave + rises * cos, d_heave + rises * d_cos
        north, d_north = north + tilts_n * sin, d_north + tilts_n * d_sin
        east, d_east = east + tilts_e * sin, d_east + tilts_e * d_sin
        ahead, d_ahead = ahead + goes_n * sin, d_ahead + goes_n * d_sin
        aside, d_aside = aside + goes_e * sin, d_aside + goes_e * d_sin
    return [heave, north, east, ahead, aside], [d_heave, d_north, d_east, d_ahead, d_aside]


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
    width = (_HIGHEST - _LOWEST) / _BINS
    shares = draw.random(_BINS).tolist()
    ratios = [_LOWEST + width * (i + share) for i, share in enumerate(shares)]
    spectrum = [_density(ratio) for ratio in ratios]
    total = 0.0
    for density in spectrum:
        total += density
    # The variance of the sum of the waves is (Hs / 4)^2.
    variance = 2.0 * (height / 4.0) ** 2 / total
    phases = draw.random(_BINS).tolist()
    components = [
        [
            ratio * 2.0 * math.pi / period,
            math.sqrt(variance * density),
            2.0 * math.pi * phase,
            *_response(size, direction, ratio * 2.0 * math.pi / period),
        ]
        for ratio, density, phase in zip(ratios, spectrum, phases, strict=True)
    ]
    return Follower(components, period, pad)


def _density(ratio: float) -> float:
    """Return JONSWAP's spectrum, gamma 3.3, but for a factor; ``ratio`` is omega over its peak."""
    width = 0.07 if ratio <= 1.0 else 0.09
    peaked = math.exp(-((ratio - 1.0) ** 2) / (2.0 * width**2))
    return math.exp(-1.25 / ratio**4) * math.pow(_GAMMA, peaked) / ratio**5


def _response(size: Sequence[float], direction: float, omega: float) -> list[float]:
    """Return heave, slopes, and surges of the raft for a wave of one metre."""
    length, breadth, draught = size
    k, north, east = omega**2 / _GRAVITY, math.cos(direction), math.sin(direction)
    X, Y = 0.5 * k * length * north, 0.5 * k * breadth * east
    decayed = math.exp(-k * draught)
    mean = decayed * _mean(X) * _mean(Y)
    return [
        mean,
        decayed * k * north * _tilt(X) * _mean(Y),
        decayed * k * east * _mean(X) * _tilt(Y),
        north * mean,
        east * mean,
    ]


def _mean(x: float) -> float:
    return math.sin(x) / x if x else 1.0


def _tilt(x: float) -> float:
    if abs(x) < 1e-3:
        return 1.0 - x * x / 10.0
    return 3.0 * (math.sin(x) - x * math.cos(x)) / x**3


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
    return Follower(list(zip(*lists.values(), strict=True)), period, pad)


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


def _list(content: Mapping[str, Any], key: str, called: str, file: Path) -> list[float]:
    values = content.get(key)
    if not isinstance(values, list) or not values:
        raise InputError(f"{called}: {file}: {key!r} is missing or no list of numbers")
    for place, value in enumerate(values):
        if not _is_number(value):
            raise InputError(
                f"{called}: {file}: {key!r}[{place}] is {value!r}, a finite number is needed"
            )
    return [float(value) for value in values]


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)
