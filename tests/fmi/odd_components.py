"""Components whose Python is legal and unusual: their C does the same, or there is none."""

from __future__ import annotations

import functools
import math
import random
from dataclasses import dataclass
from typing import Any, NamedTuple

from seatrial.model.component import Component, Input, Output

COUNT = 0
NOTED: list[float] = []
TABLE = {"a": 1.0}


def counted() -> int:
    global COUNT
    COUNT += 1
    return COUNT


def noted(x: float) -> float:
    NOTED.append(x)
    return float(len(NOTED))


def doubled(function: Any) -> Any:
    @functools.wraps(function)
    def inner(*arguments: Any) -> Any:
        return 2.0 * function(*arguments)

    return inner


@doubled
def half(x: float) -> float:
    return x / 2.0


@functools.lru_cache
def cached(x: float) -> float:
    return x + 0.0


def late(x: float, seen: list[float] = []) -> float:  # noqa: B006
    seen.append(x)
    return float(len(seen))


class Signed(NamedTuple):
    value: float

    def __bool__(self) -> bool:
        return self.value > 2.0


@dataclass(frozen=True)
class Loose:
    value: float

    def __eq__(self, other: object) -> bool:
        return True


class Base(Component):
    """Adds up what `work` returns."""

    u = Input("1", "in", start=0.5)
    mode = Input("1", "word", type=str, start="one", choices=("one", "two"))
    y = Output("1", "out")

    def start(self, t: float) -> None:
        self._k, self._v = 0, 0.0

    def step(self, t: float, h: float) -> None:
        self._k += 1
        self._v += float(self.work(t, h))

    def work(self, t: float, h: float) -> float:
        return 0.0

    def outputs(self, t: float) -> None:
        self.y = self._v


class WhileElse(Base):
    def work(self, t: float, h: float) -> float:
        n, found = 2, 0.0
        while n > 0:
            n -= 1
        else:
            found = 10.0
        return found


class IsTrue(Base):
    def work(self, t: float, h: float) -> float:
        return 1.0 if (self._k > 2) is True else 0.5


class Random(Base):
    def start(self, t: float) -> None:
        super().start(t)
        random.seed(4)

    def work(self, t: float, h: float) -> float:
        return random.random()


class ModuleState(Base):
    def start(self, t: float) -> None:
        global COUNT
        COUNT = 0
        super().start(t)

    def work(self, t: float, h: float) -> float:
        return float(counted())


class ModuleList(Base):
    def start(self, t: float) -> None:
        NOTED.clear()
        super().start(t)

    def work(self, t: float, h: float) -> float:
        return noted(self.u)


class ModuleTable(Base):
    def work(self, t: float, h: float) -> float:
        return TABLE["a"]


class Setter(Base):
    @property
    def gain(self) -> float:
        return self._g

    @gain.setter
    def gain(self, value: float) -> None:
        self._g = 2.0 * value

    def start(self, t: float) -> None:
        super().start(t)
        self.gain = 1.0

    def work(self, t: float, h: float) -> float:
        return self.gain


class Mangled(Base):
    def start(self, t: float) -> None:
        super().start(t)
        self.__own = 1.0

    def work(self, t: float, h: float) -> float:
        return self.__own


class MangledTwice(Mangled):
    def work(self, t: float, h: float) -> float:
        self.__own = 3.0
        return super().work(t, h)


class ClassMemory(Base):
    total = 5.0

    def work(self, t: float, h: float) -> float:
        self.total += 1.0
        return self.total


class ClassCount(Base):
    made = 0.0

    def work(self, t: float, h: float) -> float:
        ClassCount.made += 0.0
        return ClassCount.made


class Constructed(Base):
    def __init__(self, name: str = "component") -> None:
        super().__init__(name)
        self._held = 7.0

    def work(self, t: float, h: float) -> float:
        return self._held


class Decorated(Base):
    def work(self, t: float, h: float) -> float:
        return half(self.u)


class Cached(Base):
    def work(self, t: float, h: float) -> float:
        return math.copysign(1.0, cached(0.0)) + math.copysign(1.0, cached(-0.0 * self.u))


class Default(Base):
    def work(self, t: float, h: float) -> float:
        return late(self.u)


class LateLambda(Base):
    def work(self, t: float, h: float) -> float:
        return [lambda: i for i in range(3)][-3]()  # noqa: B023


class Used(Base):
    def work(self, t: float, h: float) -> float:
        one = (i for i in range(4))
        return float(sum(one) + sum(one))


class UsedZip(Base):
    def work(self, t: float, h: float) -> float:
        pairs = zip((1.0, 2.0), (3.0, self.u), strict=True)
        return sum(a * b for a, b in pairs) + len(list(pairs))


class SetOfHalves(Base):
    def work(self, t: float, h: float) -> float:
        return float(len({i % 2 for i in range(6)}))


class Large(Base):
    def work(self, t: float, h: float) -> float:
        n = 1 + self._k * 0
        for _ in range(70):
            n *= 2
        return n % 1000 + math.log(n)


class Exact(Base):
    def work(self, t: float, h: float) -> float:
        return 1.0 if 9007199254740993 + 0 * self._k == 9007199254740992.0 else 2.0


class Absent(Base):
    def work(self, t: float, h: float) -> float:
        return getattr(self, "absent", 2.5)


class Rounded(Base):
    def work(self, t: float, h: float) -> float:
        return round(self.u * 1.2345, 2) + min(3.0, -2.0 * self.u, key=abs) + math.log(8.0, 2)


class Lists(Base):
    def work(self, t: float, h: float) -> float:
        return 1.0 if (1.0, self.u) == [1.0, self.u] else 2.0


class NotANumber(Base):
    def work(self, t: float, h: float) -> float:
        nan = self.u * math.inf * 0.0
        return 1.0 if (nan, 1.0) == (nan, 1.0) else 2.0


class Chained(Base):
    def more(self) -> float:
        self._v += 1.0
        return self._v

    def work(self, t: float, h: float) -> float:
        return 1.0 if 1.0 < self.u < self.more() else 0.0


class Named(Base):
    def work(self, t: float, h: float) -> float:
        return float(len(self.name)) + (1.0 if self.name.startswith("x") else 0.0)


class Words(Base):
    def work(self, t: float, h: float) -> float:
        return 1.0 if self.mode.startswith("t") else 0.0


class Alias(Base):
    def start(self, t: float) -> None:
        super().start(t)
        self._row = [1.0, 2.0]

    def work(self, t: float, h: float) -> float:
        row = self._row
        self._row[0] += 1.0
        return row[0]


class Inner(Base):
    def work(self, t: float, h: float) -> float:
        row = [1.0, self.u]

        def change() -> float:
            row[0] = 5.0
            return 0.0

        return change() + row[0]


class MinusZero(Base):
    def work(self, t: float, h: float) -> float:
        zero = 0 if self._k % 2 else -1.5
        return math.atan2(-zero * 0, -1.0)


class Divided(Base):
    def work(self, t: float, h: float) -> float:
        return math.fmod(self.u * math.inf, 1.0)


class Signs(Base):
    def work(self, t: float, h: float) -> float:
        return 1.0 if Signed(self.u) else 2.0


class Equals(Base):
    def work(self, t: float, h: float) -> float:
        return 1.0 if Loose(self.u) == Loose(2.0) else 2.0


class Shadowed(Base):
    def work(self, t: float, h: float) -> float:
        if self._k > 100:
            COUNT = 3.0
        return COUNT
