"""Clocks of FMI 3.0: what a model description says of them, and when time-based ones tick."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any, NamedTuple

from ..errors import InputError, unknown
from ..model.component import NS
from .instance import Variable

PERIODIC = ("constant", "fixed", "tunable")
KINDS = (*PERIODIC, "changing", "countdown", "triggered")
"""FMI's interval variabilities."""


@dataclass(frozen=True)
class Clock:
    """One clock, as the model description has it."""

    name: str
    reference: int
    causality: str
    kind: str
    """One of `KINDS`."""
    interval: Fraction | None
    """Of a periodic one, s; None: the FMU says it when it is asked."""
    shift: Fraction
    """Of the first tick of a periodic one, s."""
    has_fractions: bool
    """Whether the FMU is asked for counters and resolutions."""
    clocks: tuple[int, ...] = ()
    """What an output says, and when a countdown ends, is known only if one of these is active."""

    @property
    def is_timed(self) -> bool:
        """Whether the importer has to activate it at its time."""
        return self.kind != "triggered"

    @property
    def is_periodic(self) -> bool:
        """Whether it ticks until its interval changes."""
        return self.kind in PERIODIC

    def __str__(self) -> str:
        """Say when it ticks."""
        if self.interval is None:
            return f"clock {self.name}: {self.kind}"
        times = f"every {float(self.interval)!r} s from {float(self.shift)!r} s"
        return f"clock {self.name}: {self.kind}, {times}"


@dataclass(frozen=True)
class Clocks:
    """All clocks of an FMU that are used, and what belongs to them."""

    by_reference: Mapping[int, Clock] = field(default_factory=dict)
    signals: Mapping[str, int] = field(default_factory=dict)
    """Triggered clocks, which are signals, by name."""
    clocked: Mapping[str, tuple[int, ...]] = field(default_factory=dict)
    """The clocks of each variable that belongs to some, by its name."""


def clock_types(root: Any) -> dict[str, Mapping[str, str]]:
    """Return the attributes of each ClockType, which FMPy does not read, by its name."""
    types = root.iterfind("TypeDefinitions/ClockType")
    return {one.get("name"): dict(one.attrib) for one in types}


def read_clock(variable: Variable, said: Mapping[str, str], clocks: tuple[int, ...]) -> Clock:
    """Return what is ``said`` of a clock by its XML element and its type.

    ``clocks`` are those that it belongs to. Raises InputError for one that FMI does not have or
    that cannot be used.
    """
    kind = said.get("intervalVariability", "")
    if kind not in KINDS:
        raise InputError(unknown("intervalVariability", kind, KINDS))
    if variable.causality != "input" and kind != "triggered":
        raise InputError(
            f"a clock of causality {variable.causality} is triggered, found {kind!r}; inputs are "
            f"{', '.join(KINDS)}"
        )
    if clocks and variable.causality == "input" and kind != "countdown":
        raise InputError(
            f"an input clock that belongs to another clock is a countdown, found {kind!r}: others "
            "cannot be used here"
        )
    interval, shift = _periods(said) if kind in PERIODIC else (None, Fraction(0))
    if interval is None and kind == "constant":
        raise InputError("a constant clock needs an intervalDecimal")
    return Clock(
        variable.name,
        variable.reference,
        variable.causality,
        kind,
        interval,
        shift,
        has_fractions=said.get("supportsFraction") in ("true", "1"),
        clocks=clocks,
    )


def _periods(said: Mapping[str, str]) -> tuple[Fraction | None, Fraction]:
    """Return interval and shift, from counters where they are given: those are exact."""
    resolution = said.get("resolution")
    found: list[Fraction | None] = []
    for what in ("interval", "shift"):
        counter, decimal = said.get(f"{what}Counter"), said.get(f"{what}Decimal")
        try:
            if counter is not None and resolution is not None:
                found.append(Fraction(int(counter), int(resolution)))
            else:
                # As a float first: a fraction of 1e999999999 has that many digits.
                found.append(None if decimal is None else Fraction(repr(float(decimal))))
        except (ValueError, ZeroDivisionError):
            raise InputError(
                f"{what}: {counter or decimal!r} / {resolution or 1} is no time"
            ) from None
    interval, shift = found
    if interval is not None:
        refuse_unfit(interval, periodic=True)
    if shift is not None:
        refuse_unfit(shift, periodic=False)
    return interval, shift or Fraction(0)


def refuse_unfit(time: Fraction, *, periodic: bool) -> None:
    """Raise InputError for an interval in which time does not go on, s."""
    least = Fraction(1, NS) if periodic else Fraction(0)
    if time < least:
        raise InputError(f"an interval of {float(time)!r} s; {float(least)!r} s at least is needed")


class Ticks(NamedTuple):
    """Ticks of a clock, exactly: the next one is ``first + passed * interval``, s."""

    first: Fraction
    interval: Fraction
    """Zero: there is one tick only."""
    passed: int = 0

    @property
    def next_ns(self) -> int:
        """Return the instant of the next one."""
        return round((self.first + self.passed * self.interval) * NS)


class Timetable:
    """The next ticks of time-based clocks, at whole nanoseconds that do not drift."""

    def __init__(self) -> None:
        self._next: dict[int, Ticks] = {}

    def set(self, reference: int, first: Fraction, interval: Fraction = Fraction(0)) -> None:
        """Let a clock tick at ``first``, and every ``interval`` after that; in s."""
        self._next[reference] = Ticks(first, interval)

    def next_ns(self) -> int | None:
        """Return the instant of the next tick; None if none is known."""
        return min((ticks.next_ns for ticks in self._next.values()), default=None)

    def take(self, now_ns: int) -> list[int]:
        """Return the clocks that tick now or should have; each is set to its next tick."""
        due = [one for one, ticks in self._next.items() if ticks.next_ns <= now_ns]
        for reference in due:
            ticks = self._next.pop(reference)
            if ticks.interval:
                self._next[reference] = ticks._replace(passed=ticks.passed + 1)
        return due

    def memory(self) -> Any:
        """Return what `recall` takes back."""
        return dict(self._next)

    def recall(self, memory: Any) -> None:
        """Take back what `memory` returned."""
        self._next = dict(memory)
