"""FMI 3.0: what an FMU says of the intervals of its time-based clocks."""

from __future__ import annotations

import ctypes
import math
from collections.abc import Callable
from fractions import Fraction
from typing import Any

from ...errors import InputError, SimulationError
from ..clocks import Clock, refuse_unfit

_NOT_YET_KNOWN, _UNCHANGED, _CHANGED = range(3)


class Intervals:
    """Asks an FMU, exactly where it has fractions. All times are in s.

    Everything raises SimulationError, with the instance's ``name``, for what is no interval.
    """

    def __init__(self, name: str, call: Callable[..., None]) -> None:
        self._name, self._call = name, call

    def period(self, clock: Clock) -> tuple[Fraction, Fraction]:
        """Return interval and shift of a periodic clock, in initialisation mode."""
        interval, _ = self._interval(clock)
        shift = self._fit(clock, "shift", self._asked("GetShift", clock), periodic=False)
        return interval, shift

    def new(self, clock: Clock) -> Fraction | None:
        """Return the time from now to a clock's next tick; None: nothing new is known of it."""
        interval, qualifier = self._interval(clock)
        # A changing clock is asked only when it has ticked: what it says is of the next tick.
        is_new = qualifier == _CHANGED or (qualifier == _UNCHANGED and clock.kind == "changing")
        return interval if is_new else None

    def _interval(self, clock: Clock) -> tuple[Fraction, int]:
        qualifier = ctypes.c_int()
        time = self._asked("GetInterval", clock, ctypes.byref(qualifier))
        if qualifier.value == _NOT_YET_KNOWN and clock.kind == "countdown":
            return Fraction(0), _NOT_YET_KNOWN
        if qualifier.value not in (_UNCHANGED, _CHANGED):
            raise SimulationError(
                f"{self._name}: the {clock.kind} clock {clock.name} has the interval qualifier "
                f"{qualifier.value}; {_UNCHANGED} (unchanged) or {_CHANGED} (changed) is needed"
            )
        return self._fit(clock, "interval", time, clock.is_periodic), qualifier.value

    def _asked(self, function: str, clock: Clock, *more: Any) -> Fraction | None:
        """Return what a function says of a clock; None: it is no time."""
        reference = (ctypes.c_uint * 1)(clock.reference)
        if clock.has_fractions:
            counter, resolution = ctypes.c_uint64(), ctypes.c_uint64()
            parts = ctypes.byref(counter), ctypes.byref(resolution)
            self._call(f"{function}Fraction", reference, 1, *parts, *more)
            return Fraction(counter.value, resolution.value) if resolution.value else None
        time = ctypes.c_double()
        self._call(f"{function}Decimal", reference, 1, ctypes.byref(time), *more)
        return Fraction(repr(time.value)) if math.isfinite(time.value) else None

    def _fit(self, clock: Clock, what: str, time: Fraction | None, periodic: bool) -> Fraction:
        try:
            if time is None:
                raise InputError("it is no number")
            refuse_unfit(time, periodic=periodic)
        except InputError as error:
            raise SimulationError(
                f"{self._name}: {what} of the {clock.kind} clock {clock.name}: {error}"
            ) from None
        return time
