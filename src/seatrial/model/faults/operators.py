"""Faults of signals: the value y of one scalar as a function of its value x and of time.

An operator has no state of its own. If y depends on the past, `Operator.first` and `Operator.after`
return a memory, plain data that never changes. The caller keeps the memory, so that a step can be
repeated.
"""

from __future__ import annotations

import math
import zlib
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..component import NS

Draw = Callable[[int], np.random.Generator]
"""The generator of an interval, by its number since the fault began."""


@dataclass(frozen=True)
class Moment:
    """An instant of a fault."""

    t_ns: int
    """Simulated time."""
    begun_ns: int
    grows_ns: int = 0
    """Duration of the growth, from the begin."""
    ended_ns: int | None = None
    """Time of the end; None while the fault acts."""

    @property
    def since_ns(self) -> int:
        """Time since the begin."""
        return self.t_ns - self.begun_ns

    @property
    def since(self) -> float:
        """Time since the begin, s."""
        return self.since_ns / NS

    @property
    def share(self) -> float:
        """Growth of the fault, 0 to 1."""
        return self.share_at(self.t_ns)

    def share_at(self, t_ns: int) -> float:
        """Return the share at a time, 0 before the begin and after the end."""
        if t_ns < self.begun_ns or (self.ended_ns is not None and t_ns >= self.ended_ns):
            return 0.0
        return min(1.0, (t_ns - self.begun_ns) / self.grows_ns) if self.grows_ns else 1.0


def drawing(seed: int, name: str) -> Draw:
    """Return the random numbers of the fault ``name``: Philox 4x64 by seed, name and interval."""
    key = [seed, zlib.crc32(name.encode())]

    def draw(interval: int) -> np.random.Generator:
        return np.random.Generator(np.random.Philox(key=key, counter=[0, 0, 0, interval]))

    return draw


class Operator(ABC):
    """Value y that a fault makes of the value x of one signal at a moment."""

    def first(self, x: Any, moment: Moment) -> Any:
        """Return the memory as the fault begins with the value ``x``."""
        return None

    def after(self, memory: Any, x: Any, moment: Moment, h_ns: int) -> Any:
        """Return the memory ``h_ns`` later, ``x`` being the value at ``moment``."""
        return memory

    @abstractmethod
    def value(self, memory: Any, x: Any, moment: Moment) -> Any:
        """Return y at ``moment``."""


@dataclass(frozen=True)
class Fixed(Operator):
    """y = x + s (value - x); y = value for texts."""

    level: Any

    def value(self, memory: Any, x: Any, moment: Moment) -> Any:
        """Return y."""
        if moment.share == 1.0 or isinstance(x, (str, bytes)):
            return self.level
        return x + moment.share * (self.level - x)


@dataclass(frozen=True)
class Bias(Operator):
    """y = x + s value."""

    level: float

    def value(self, memory: Any, x: Any, moment: Moment) -> Any:
        """Return y."""
        return x + (self.level if moment.share == 1.0 else moment.share * self.level)


@dataclass(frozen=True)
class Drift(Operator):
    """y = x + rate (t - at)."""

    rate: float

    def value(self, memory: Any, x: Any, moment: Moment) -> Any:
        """Return y."""
        return x + self.rate * moment.since


@dataclass(frozen=True)
class Scale(Operator):
    """y = x (1 + s (factor - 1))."""

    factor: float

    def value(self, memory: Any, x: Any, moment: Moment) -> Any:
        """Return y."""
        return x * (1.0 + moment.share * (self.factor - 1.0))


@dataclass(frozen=True)
class Limit(Operator):
    """y = min(max(x, low), high)."""

    low: float
    high: float

    def value(self, memory: Any, x: Any, moment: Moment) -> Any:
        """Return y."""
        return min(max(x, self.low), self.high)


@dataclass(frozen=True)
class Deviation(Operator):
    """y = x + s (A + B sin x + C cos x + D sin 2x + E cos 2x)."""

    coefficients: tuple[float, ...]

    def value(self, memory: Any, x: Any, moment: Moment) -> Any:
        """Return y."""
        a, b, c, d, e = self.coefficients
        once = a + b * math.sin(x) + c * math.cos(x)
        return x + moment.share * (once + d * math.sin(2.0 * x) + e * math.cos(2.0 * x))


@dataclass(frozen=True)
class Random(Operator):
    """Base of what draws new numbers in every interval since the fault began."""

    every_ns: int
    draw: Draw

    def drawn(self, moment: Moment) -> np.random.Generator:
        """Return the generator of the moment's interval."""
        return self.draw(moment.since_ns // self.every_ns)


@dataclass(frozen=True)
class Noise(Random):
    """y = x + s sigma w_i, w_i standard normal in interval i."""

    deviation: float

    def value(self, memory: Any, x: Any, moment: Moment) -> Any:
        """Return y."""
        return x + moment.share * self.deviation * float(self.drawn(moment).standard_normal())


@dataclass(frozen=True)
class Garbage(Random):
    """y uniform between low and high, anew in each interval."""

    low: float
    high: float

    def value(self, memory: Any, x: Any, moment: Moment) -> Any:
        """Return y."""
        return float(self.drawn(moment).uniform(self.low, self.high))


@dataclass(frozen=True)
class Dropout(Random):
    """In each interval, with probability p, y stays what it was before; else y = x."""

    probability: float

    def first(self, x: Any, moment: Moment) -> Any:
        """Return the value before."""
        return x

    def after(self, memory: Any, x: Any, moment: Moment, h_ns: int) -> Any:
        """Return what was passed on last."""
        return self.value(memory, x, moment)

    def value(self, memory: Any, x: Any, moment: Moment) -> Any:
        """Return y."""
        return memory if self.drawn(moment).random() < self.probability * moment.share else x


@dataclass(frozen=True)
class Stuck(Operator):
    """y = x(at)."""

    def first(self, x: Any, moment: Moment) -> Any:
        """Return the value at the beginning."""
        return x

    def value(self, memory: Any, x: Any, moment: Moment) -> Any:
        """Return y."""
        return memory


@dataclass(frozen=True)
class Delay(Operator):
    """y(t) = x(max(at, t - s time))."""

    time_ns: int

    def first(self, x: Any, moment: Moment) -> Any:
        """Return the samples that are not shown yet, the oldest being shown."""
        return ((0, x),)

    def after(self, memory: Any, x: Any, moment: Moment, h_ns: int) -> Any:
        """Return the samples with the one of now, without those that are too old."""
        samples = (*(one for one in memory if one[0] < moment.since_ns), (moment.since_ns, x))
        oldest = moment.since_ns - self.time_ns
        first = max((i for i, one in enumerate(samples) if one[0] <= oldest), default=0)
        return samples[first:]

    def value(self, memory: Any, x: Any, moment: Moment) -> Any:
        """Return y."""
        when = moment.since_ns - round(self.time_ns * moment.share)
        if when >= moment.since_ns:
            return x
        return next((y for t, y in reversed(memory) if t <= when), memory[0][1])


@dataclass(frozen=True)
class Lag(Operator):
    """T dy/dt = x - y, y(at) = x(at), with x held between two communication points."""

    time: float

    def first(self, x: Any, moment: Moment) -> Any:
        """Return y at the beginning."""
        return x

    def after(self, memory: Any, x: Any, moment: Moment, h_ns: int) -> Any:
        """Return y a step later."""
        return memory - (x - memory) * math.expm1(-h_ns / NS / self.time)

    def value(self, memory: Any, x: Any, moment: Moment) -> Any:
        """Return y."""
        return memory


@dataclass(frozen=True)
class Slow(Operator):
    """y follows x at the rate at most, y(at) = x(at), with x held between two points."""

    rate: float

    def first(self, x: Any, moment: Moment) -> Any:
        """Return y at the beginning."""
        return x

    def after(self, memory: Any, x: Any, moment: Moment, h_ns: int) -> Any:
        """Return y a step later."""
        most = self.rate * h_ns / NS
        return memory + min(max(x - memory, -most), most)

    def value(self, memory: Any, x: Any, moment: Moment) -> Any:
        """Return y."""
        return memory


@dataclass(frozen=True)
class Runaway(Operator):
    """y goes from x(at) to the value at the rate, for any x, and stays there."""

    level: float
    rate: float

    def first(self, x: Any, moment: Moment) -> Any:
        """Return y at the beginning."""
        return x

    def value(self, memory: Any, x: Any, moment: Moment) -> Any:
        """Return y."""
        far, gone = self.level - memory, self.rate * moment.since
        return self.level if gone >= abs(far) else memory + math.copysign(gone, far)


@dataclass(frozen=True)
class NotANumber(Operator):
    """y is not a number."""

    def value(self, memory: Any, x: Any, moment: Moment) -> Any:
        """Return NaN."""
        return math.nan


@dataclass(frozen=True)
class Wrapped(Operator):
    """Another operator's y, brought into [low, high) by whole turns of high - low."""

    inner: Operator
    low: float
    high: float

    def first(self, x: Any, moment: Moment) -> Any:
        """Return the memory of the other operator."""
        return self.inner.first(x, moment)

    def after(self, memory: Any, x: Any, moment: Moment, h_ns: int) -> Any:
        """Return the memory of the other operator."""
        return self.inner.after(memory, x, moment, h_ns)

    def value(self, memory: Any, x: Any, moment: Moment) -> Any:
        """Return y."""
        y = self.low + (self.inner.value(memory, x, moment) - self.low) % (self.high - self.low)
        return y if y < self.high else self.low
