"""A signal of a run beside the same in a log: residual, lag and coherence."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.errors import InputError
from seatrial.model.readable import number
from seatrial.model.units import conversion
from seatrial.trial.logs.channels import Array

from .resampling import Trace, turn_of

LONGEST_LAG = 10.0
"""s; a tenth of the record, if that is shorter."""
_LEAST = 16
_MOST_LAGGED = 2**17
"""Rows of a comparison from which lag and coherence are estimated; more are thinned."""
_EQUAL = 1e-9
"""Share of the log's variance below which a residual is rounding."""
_GAIN = 0.01
"""Share of the variance that a lag has to explain to be one."""


@dataclass(frozen=True, eq=False)
class Residual:
    """One signal of a run minus the same in a log, in the signal's unit: arrays (n,)."""

    signal: str
    channel: str
    unit: str
    time: Array
    """Instants of whichever of the two has fewer."""
    run: Array
    log: Array
    period: float
    """Usual time from an instant to the next, s."""
    interpolated: str
    """Which of the two is interpolated at the instants of the other: run or log."""
    lag: float | None
    """s by which the log is later than the run; None where none explains the residual."""
    rms_without_lag: float | None
    """Of the residual without its mean, were the log earlier by the lag."""
    coherence: float | None
    """Mean magnitude-squared coherence, 0 to 1, weighted by the log's power; None: too few rows."""

    @property
    def residual(self) -> Array:
        """Run minus log; of an angle, the shorter way round."""
        return _difference(self.run, self.log, self.unit)

    @property
    def bias(self) -> float:
        """Mean of the residual."""
        return float(np.mean(self.residual))

    @property
    def rms(self) -> float:
        """Root mean square of the residual."""
        return float(np.sqrt(np.mean(self.residual**2)))

    @property
    def worst(self) -> float:
        """The residual of the greatest magnitude."""
        return float(self.residual[self.worst_row])

    @property
    def worst_row(self) -> int:
        """The row of `worst`."""
        return int(np.argmax(np.abs(self.residual)))

    @property
    def fit(self) -> float | None:
        """1 - |run - log| / |log - mean|, at most 1; None for a log that does not change."""
        spread = float(np.sqrt(np.mean((self.log - np.mean(self.log)) ** 2)))
        return None if spread == 0.0 else 1.0 - self.rms / spread

    def figures(self) -> dict[str, float | str | None]:
        """Return the figures by name, in the signal's unit and s."""
        return {
            "signal": self.signal,
            "channel": self.channel,
            "unit": self.unit,
            "rows": len(self.time),
            "bias": self.bias,
            "rms": self.rms,
            "worst": self.worst,
            "worst_at": float(self.time[self.worst_row]),
            "fit": self.fit,
            "lag": self.lag,
            "rms_without_lag": self.rms_without_lag,
            "coherence": self.coherence,
            "period": self.period,
            "interpolated": self.interpolated,
        }

    def cells(self) -> tuple[str, ...]:
        """Return the cells of `HEADINGS`."""
        return (
            f"{self.signal} / {self.channel}",
            number(self.bias, 3),
            number(self.rms, 3),
            f"{number(self.worst, 3)} at {number(self.time[self.worst_row], 5)} s",
            "–" if self.fit is None else f"{100.0 * self.fit:.0f} %",
            "–" if self.lag is None else f"{self.lag:+.3g}",
            "–" if self.coherence is None else f"{self.coherence:.2f}",
            self.unit,
        )


HEADINGS = ("run / log", "bias", "RMS", "worst", "fit", "lag, s", "coherence", "unit")


def residual_of(signal: Trace, channel: Trace) -> Residual:
    """Return how a signal of a run and a channel of a log differ, in the unit of the signal.

    The one of the lower rate is taken at its own instants, the other interpolated there; instants
    in gaps of either are left out. Lag and coherence as `_lag` and `_coherence`. Raises InputError
    for units that do not measure the same, and for less than 2 common instants.
    """
    try:
        factor, offset = conversion(channel.unit, signal.unit)
    except InputError as error:
        raise InputError(f"{signal.name} and the log's {channel.name}: {error}") from None
    sparse, dense = sorted((signal, channel), key=lambda each: -each.usual)
    times = sparse.time
    found, known = dense.at(times)
    own, of_run = sparse.values[known], found[known]
    run, log = (own, of_run) if sparse is signal else (of_run, own)
    log, time = factor * log + offset, times[known]
    if len(time) < 2:
        raise InputError(
            f"{signal.name} ({_span(signal)}) and the log's {channel.name} ({_span(channel)}) have "
            "no time in common"
        )
    lag, without = _lag(time, run, log, signal.unit)
    return Residual(
        signal=signal.name,
        channel=channel.name,
        unit=signal.unit,
        time=time,
        run=run,
        log=log,
        period=float(np.median(np.diff(time))),
        interpolated="log" if sparse is signal else "run",
        lag=lag,
        rms_without_lag=without,
        coherence=_coherence(time, run, log),
    )


def resampling_notes(residuals: Sequence[Residual]) -> list[str]:
    """Return sentences that say which of run and log was interpolated where."""
    groups: dict[str, list[str]] = {}
    for each in residuals:
        said = (
            f"the {each.interpolated} is interpolated at {len(each.time)} instants of the "
            f"{'run' if each.interpolated == 'log' else 'log'}, usually {each.period:.4g} s apart"
        )
        groups.setdefault(said, []).append(each.signal)
    return [f"{', '.join(names)}: {said}" for said, names in groups.items()]


def _span(each: Trace) -> str:
    return f"{each.time[0]:g} s to {each.time[-1]:g} s"


def _difference(run: Array, log: Array, unit: str) -> Array:
    turn = turn_of(unit)
    return run - log if turn is None else np.remainder(run - log + turn / 2, turn) - turn / 2


def _evenly(time: Array, *columns: Array) -> tuple[float, list[Array]]:
    """Return the period, s, and columns at even times, linear in between."""
    count = min(len(time), _MOST_LAGGED)
    even = np.linspace(time[0], time[-1], count)
    return float(even[1] - even[0]), [np.interp(even, time, column) for column in columns]


def _lag(time: Array, run: Array, log: Array, unit: str) -> tuple[float | None, float | None]:
    """Return by how much the log is later, s, and the RMS of what is then left but for its mean.

    The lag has the least variance of run(t) - log(t + lag), over at most `LONGEST_LAG` and a tenth
    of the record, refined by a parabola through its neighbours. None where the variance is not
    less by a hundredth than without a lag, and where it still falls at the longest.
    """
    if len(time) < _LEAST:
        return None, None
    period, (run, log) = _evenly(time, run, log)
    log = run - _difference(run, log, unit)
    most = int(min(LONGEST_LAG, (time[-1] - time[0]) / 10.0) / period)
    if most < 1:
        return None, None
    spread = _variances(run, log, most)
    best = int(np.argmin(spread))
    if spread[most] <= _EQUAL * float(np.var(log)):
        return None, None
    if best in (0, 2 * most) or not spread[best] < (1.0 - _GAIN) * spread[most]:
        return None, None
    low, here, high = spread[best - 1 : best + 2]
    bend = low - 2.0 * here + high
    shift = 0.5 * (low - high) / bend if bend > 0.0 else 0.0
    least = here - 0.25 * (low - high) * shift
    return float((best - most + shift) * period), math.sqrt(max(least, 0.0))


def _variances(run: Array, log: Array, most: int) -> Array:
    """Return the variance of run[i] - log[i + k] for k from -most to most, on their common rows."""
    n = len(run)
    run, log = run - run.mean(), log - log.mean()
    size = 1 << (2 * n - 1).bit_length()
    both = np.fft.irfft(np.conj(np.fft.rfft(run, size)) * np.fft.rfft(log, size), size)
    found = []
    sums = [np.concatenate(([0.0], np.cumsum(each))) for each in (run, log, run**2, log**2)]
    for k in range(-most, most + 1):
        first, last = max(0, -k), min(n, n - k)
        a, b, aa, bb = (
            (part[last + s] - part[first + s]) / (last - first)
            for part, s in zip(sums, (0, k, 0, k), strict=True)
        )
        found.append(aa + bb - 2.0 * both[k % size] / (last - first) - (a - b) ** 2)
    return np.array(found)


def _coherence(time: Array, run: Array, log: Array) -> float | None:
    """Return the mean coherence of 8 half overlapping segments, Hann, by Welch's method."""
    if len(time) < 8 * _LEAST or np.ptp(run) == 0.0 or np.ptp(log) == 0.0:
        return None
    from scipy.signal import coherence, welch

    period, (run, log) = _evenly(time, run, log)
    how = {"fs": 1.0 / period, "nperseg": 2 * len(run) // 9, "detrend": "linear"}
    _, shared = coherence(run, log, **how)
    _, power = welch(log, **how)
    usable = np.isfinite(shared)
    total = float(np.sum(power[usable]))
    return float(np.sum(shared[usable] * power[usable]) / total) if total > 0.0 else None
