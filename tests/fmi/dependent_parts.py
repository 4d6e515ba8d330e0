"""Components whose outputs follow from inputs in many ways; ``truth`` says which from which.

``more`` has what is taken as dependent besides, ``unknown`` marks those of which a text cannot
say it: there everything is.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any, ClassVar, NamedTuple

import numpy as np

from seatrial.model.component import Component, Input, Output, Parameter, Terms
from seatrial.model.sampled import Sampled

SHELF: dict[str, Any] = {}


class Two(Component):
    """Two inputs and two outputs."""

    truth: ClassVar[dict[str, str]] = {}
    more: ClassVar[dict[str, str]] = {}
    unknown: ClassVar[bool] = False

    a = Input("1", "one")
    b = Input("1", "another")
    y = Output("1", "one")
    z = Output("1", "another")


def helped(part: Two) -> float:
    return part.b * 2.0


def scaled(part: Two, *factors: float) -> float:
    return part.a * math.prod(factors)


class Pair(NamedTuple):
    first: float
    second: float = 0.0


@dataclass
class Record:
    first: float
    second: float


class Memory:
    """An object that remembers what it was given."""

    def __init__(self, owner: Any = None) -> None:
        self.kept = 0.0
        self.owner = owner

    def put(self, value: float) -> None:
        self.kept = value

    def get(self) -> float:
        return self.kept

    def owned(self) -> float:
        return 0.0 if self.owner is None else float(self.owner.b)


class Plain(Two):
    truth: ClassVar = {"y": "a", "z": "b"}

    def outputs(self, t: float) -> None:
        self.y, self.z = 2.0 * self.a, self.b


class Stored(Two):
    truth: ClassVar = {"y": "", "z": "b"}

    def start(self, t: float) -> None:
        self._kept = 0.0

    def step(self, t: float, h: float) -> None:
        self._kept = self.a

    def outputs(self, t: float) -> None:
        self.y, self.z = self._kept, self.b


class SetInStep(Two):
    truth: ClassVar = {"y": "", "z": ""}

    def step(self, t: float, h: float) -> None:
        self.y, self.z = self.a, self.b


class Through(Two):
    truth: ClassVar = {"y": "a", "z": "a"}

    def outputs(self, t: float) -> None:
        self._seen = self.a
        self.y = self._seen
        self.z = self.y + 1.0


class Helper(Two):
    truth: ClassVar = {"y": "b", "z": "a"}

    def outputs(self, t: float) -> None:
        self.y = helped(self)
        self.z = scaled(self, 2.0, 3.0)


class Deep(Two):
    truth: ClassVar = {"y": "a", "z": "b"}

    def outputs(self, t: float) -> None:
        self._first(self.a)
        self._second()

    def _first(self, value: float) -> None:
        self.y = value

    def _second(self) -> None:
        for _ in range(2):
            self.z = self._third()

    def _third(self) -> float:
        return self.b


class Branch(Two):
    truth: ClassVar = {"y": "a", "z": "a b"}

    def outputs(self, t: float) -> None:
        self.y = 1.0 if self.a > 0.0 else -1.0
        if self.a > 0.5:
            self.z = 1.0
        elif self.b > 0.0:
            self.z = 2.0
        else:
            self.z = 3.0


class Early(Two):
    truth: ClassVar = {"y": "", "z": "a"}

    def outputs(self, t: float) -> None:
        self.y = 1.0
        self.z = 0.0
        if self.a > 0.0:
            return
        self.z = 1.0


class Broken(Two):
    truth: ClassVar = {"y": "a", "z": "a b"}

    def outputs(self, t: float) -> None:
        count = 0
        while count < 10:
            if self.a > 0.1 * count:
                break
            count += 1
        self.y = count
        self.z = 0.0
        for limit in np.linspace(-1.0, 1.0, 5):
            if self.a > limit:
                continue
            self.z = self.b + limit


class Named(Two):
    truth: ClassVar = {"y": "a", "z": "b"}

    def outputs(self, t: float) -> None:
        for output, name in (("y", "a"), ("z", "b")):
            setattr(self, output, getattr(self, name))


class Got(Two):
    truth: ClassVar = {"y": "b", "z": "a"}

    def outputs(self, t: float) -> None:
        self.y = self.get_b()
        self.set_z(self.a)

    def get_b(self) -> float:
        return float(getattr(self, "b", 0.0))

    def set_z(self, value: float) -> None:
        setattr(self, f"{'z'}", value)


class Dictionary(Two):
    truth: ClassVar = {"y": "a b", "z": "b"}
    more: ClassVar = {"z": "a"}

    def outputs(self, t: float) -> None:
        found = {"a": self.a}
        found["b"] = self.b
        self.y = sum(found.values())
        self.z = found["b"]


class Growing(Two):
    truth: ClassVar = {"y": "a", "z": "b"}

    def outputs(self, t: float) -> None:
        rows: list[float] = []
        same = rows
        rows.append(self.a)
        self.y = same[0]
        self._rows = [0.0] * 2
        others = self._rows
        others[1] = self.b
        self.z = self._rows[1]


class Items(Two):
    truth: ClassVar = {"y": "a", "z": "b"}

    def outputs(self, t: float) -> None:
        (first, *_), second = (self.a, 0.0, 1.0), [self.b, 2.0]
        pair = Pair(first, second=second[0])
        record = Record(pair.first, pair.second)
        self.y = [x for x, _ in zip((record.first, 0.0), (1, 2), strict=True)][-2]
        self.z = record.second


class Closure(Two):
    truth: ClassVar = {"y": "a", "z": "b"}

    def outputs(self, t: float) -> None:
        def first() -> float:
            return self.a

        shift = 1.0
        second = lambda: self.b + shift  # noqa: E731
        shift = 2.0
        self.y, self.z = first(), second()


class Sorting(Two):
    truth: ClassVar = {"y": "a", "z": "b"}

    def outputs(self, t: float) -> None:
        self.y = min((1.0, 2.0), key=lambda one: abs(one - self.a))
        self.z = next(iter(map(self._twice, (1.0,))))

    def _twice(self, one: float) -> float:
        return one * self.b


class Property(Two):
    truth: ClassVar = {"y": "a", "z": "b"}

    @property
    def doubled(self) -> float:
        return 2.0 * self.a

    @property
    def out(self) -> float:
        return self.z

    @out.setter
    def out(self, value: float) -> None:
        self.z = value

    @cached_property
    def fixed(self) -> float:
        return 1.0

    @staticmethod
    def half(x: float) -> float:
        return x / 2.0

    @classmethod
    def quarter(cls, x: float) -> float:
        return cls.half(cls.half(x))

    def outputs(self, t: float) -> None:
        self.y = self.doubled * self.fixed
        self.out = self.half(self.b) + self.quarter(self.b)


class Inherits(Plain):
    truth: ClassVar = {"y": "a b", "z": "b"}

    def outputs(self, t: float) -> None:
        super().outputs(t)
        self.y = self.y + self.b


class Ancestor(Plain):
    truth: ClassVar = {"y": "b", "z": "b"}
    more: ClassVar = {"y": "a"}

    def outputs(self, t: float) -> None:
        Plain.outputs(self, t)
        self.y = self.b


class Object(Two):
    truth: ClassVar = {"y": "a", "z": ""}

    def start(self, t: float) -> None:
        self._memory, self._still = Memory(), Memory()

    def outputs(self, t: float) -> None:
        self._memory.put(self.a)
        self.y = self._memory.get()
        self.z = self._still.get()


class Owner(Two):
    truth: ClassVar = {"y": "b", "z": ""}
    unknown = True

    def start(self, t: float) -> None:
        self._memory = Memory(self)

    def outputs(self, t: float) -> None:
        self.y = self._memory.owned()


class OwnerByName(Two):
    truth: ClassVar = {"y": "b", "z": ""}
    unknown = True

    def start(self, t: float) -> None:
        me = self
        memory = Memory(owner=me)
        self._memory = memory

    def outputs(self, t: float) -> None:
        self.y = self._memory.owned()


class Law(Two):
    truth: ClassVar = {"y": "a", "z": ""}
    unknown = True
    _law: Callable[[], float]

    def start(self, t: float) -> None:
        self._law = lambda: self.a

    def outputs(self, t: float) -> None:
        self.y = self._law()


class Method(Two):
    truth: ClassVar = {"y": "a", "z": ""}
    unknown = True

    def start(self, t: float) -> None:
        self._laws = [self._first]

    def _first(self) -> float:
        return self.a

    def outputs(self, t: float) -> None:
        self.y = self._laws[0]()


class Partial(Two):
    truth: ClassVar = {"y": "a", "z": ""}
    unknown = True

    def outputs(self, t: float) -> None:
        self.y = partial(scaled, self, 2.0)()


class Everything(Two):
    truth: ClassVar = {"y": "a", "z": ""}
    unknown = True

    def outputs(self, t: float) -> None:
        self.y = self.values[self.ports["a"].offset]


class Computed(Two):
    truth: ClassVar = {"y": "a", "z": ""}
    unknown = True

    def outputs(self, t: float) -> None:
        self.y = getattr(self, chr(97))


class Evaluated(Two):
    truth: ClassVar = {"y": "a", "z": ""}
    unknown = True

    def outputs(self, t: float) -> None:
        self.y = eval("self.a")


class Elsewhere(Two):
    truth: ClassVar = {"y": "a", "z": "b"}

    def start(self, t: float) -> None:
        self._memory, self._buffer = Memory(), np.zeros(2)

    def outputs(self, t: float) -> None:
        self._memory.kept = self.a
        self.y = self._memory.kept
        np.add(self.b, 1.0, out=self._buffer[:1])
        self.z = float(self._buffer[0])


class Nested(Two):
    truth: ClassVar = {"y": "a", "z": "a b"}

    def outputs(self, t: float) -> None:
        table = [[0.0, 0.0] for _ in range(2)]
        for i, row in enumerate(table):
            row[i] = self.a * (i + 1)
        self.y = sum(map(sum, table))
        for name, value in {"one": self.a, "two": self.b}.items():
            if name == "two" or value > 1.0:
                self.z = value
                break
        else:
            self.z = -9.0


class Shelved(Two):
    truth: ClassVar = {"y": "a", "z": ""}

    def outputs(self, t: float) -> None:
        SHELF["a"] = self.a
        self.y = SHELF["a"]


class Tried(Two):
    truth: ClassVar = {"y": "a", "z": "b"}

    def outputs(self, t: float) -> None:
        try:
            self.y = math.sqrt(self.a)
        except ValueError:
            self.y = -1.0
        self.z = 0.0
        with suppress(ZeroDivisionError):
            self.z = 1.0 / (self.b > 0.0)


class Walrus(Two):
    truth: ClassVar = {"y": "a", "z": "b"}

    def outputs(self, t: float) -> None:
        self.y = 1.0 if (found := self.a) > 0.0 else found
        match self.b > 0.0:
            case True:
                self.z = 1.0
            case other:
                self.z = -float(other) - 2.0


class Generates(Two):
    truth: ClassVar = {"y": "a", "z": "b"}

    def outputs(self, t: float) -> None:
        self.y = sum(self._each())
        self.z = sum(x for x in [self.b] if x > 0.0)

    def _each(self) -> Iterator[float]:
        yield 1.0
        yield self.a


class Recursive(Two):
    truth: ClassVar = {"y": "a", "z": "b"}

    def outputs(self, t: float) -> None:
        self.y = self._power(3)
        self.z = self.b

    def _power(self, n: int) -> float:
        return 1.0 if n == 0 else self.a * self._power(n - 1)


class Augmented(Two):
    truth: ClassVar = {"y": "a b", "z": "b"}

    def outputs(self, t: float) -> None:
        total = np.zeros(2)
        total += self.a
        total[1] -= self.b
        self.y = float(total.sum())
        self.z = 0.0
        self.z += self.b


class Sums(Component):
    truth: ClassVar = {"y": "force_1 force_2", "z": "place", "word": "order"}
    more: ClassVar[dict[str, str]] = {}
    unknown = False

    force = Terms(2, "N", "forces")
    place = Input("m", "where", axes="xyz")
    order = Input("1", "what to do", type=str)
    y = Output("N", "sum")
    z = Output("m", "place", axes="xyz")
    word = Output("1", "answer", type=str)

    def outputs(self, t: float) -> None:
        self.y = self.force
        self.z = [2.0 * x for x in self.place]
        self.word = f"done {self.order}"


class Samples(Sampled):
    truth: ClassVar = {"y": "a", "z": ""}
    more: ClassVar[dict[str, str]] = {}
    unknown = False

    gain = Parameter(2.0, "1", "gain")
    a = Input("1", "one")
    b = Input("1", "another")
    y = Output("1", "one")
    z = Output("1", "another")

    def reset(self, t: float) -> None:
        self._last = 0.0

    def sample(self, t: float, k: int) -> None:
        self.y, self.z = self.gain * self.a, self._last

    def update(self, t: float, k: int) -> None:
        self._last = self.b
