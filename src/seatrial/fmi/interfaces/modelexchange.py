"""Base of instances in model exchange: the FMU's equations and a solver, stepped like a slave."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Sequence
from typing import Any, ClassVar

from ...errors import SimulationError
from ..instance import Variable
from ..messages import ACCEPTED, DISCARD
from .eventful import EventfulInstance
from .loaded import LoadedFmu

TOLERANCE = 1e-8
"""Relative tolerance of the solver where neither the rig nor the FMU says one."""
_HALF_NS = 0.5e-9
"""Times are whole nanoseconds; less than half of one is rounding."""
_MOST_EVENTS = 10_000
_MOST_STEPS = 100_000
"""Events in one communication step, and steps of the solver."""


class ModelInstance(EventfulInstance):
    """An FMU in model exchange, integrated with its inputs held over each communication step.

    Inputs that change are an event, as are times that the FMU has named, zero crossings of its
    event indicators, and steps after which it asks for one. The solver goes on over
    communication points at which nothing jumps. A state that is saved or restored lets it
    restart, so that what comes after is the same each time.
    """

    _derivatives_word: ClassVar[str] = "GetDerivatives"
    _nominals_word: ClassVar[str] = "GetNominalsOfContinuousStates"
    """How this version of FMI calls these functions."""

    def __init__(self, fmu: LoadedFmu, name: str) -> None:
        self._tolerance = fmu.tolerance or TOLERANCE
        self._now = 0.0
        self._next_event: float | None = None
        self._solver: Any = None
        self._jumped = True
        super().__init__(fmu, name)
        self._completes = bool(fmu.simulation.needsCompletedIntegratorStep) or fmu.version == 1

    def step(self, t: float, h: float) -> None:
        """Advance from ``t`` to ``t + h``, s, through all events on the way."""
        self._flush()
        end = t + h
        for _ in range(_MOST_EVENTS):
            if self.ended_at is not None:
                break
            event = self._integrate_to(end)
            if event and self.ended_at is None:
                self._in_event([])
            if self._now > end - _HALF_NS and not self._event_is_due(end):
                break
        else:
            raise SimulationError(
                f"{self.name}: {_MOST_EVENTS} events in the step from t = {t!r} s to {end!r} s; "
                f"the last at {self._now!r} s"
            )
        if self._messages:
            self._messages.forward()

    def get_state(self) -> Any:
        """Return a handle of the whole state."""
        self._jumped = True
        return super().get_state()

    # ------------------------------------------------------------------ of each version

    @abstractmethod
    def _sizes(self) -> tuple[int, int]:
        """Return the numbers of continuous states and of event indicators."""

    @abstractmethod
    def _enter_events(self) -> None:
        """Enter event mode."""

    @abstractmethod
    def _enter_continuous_time(self) -> None:
        """Leave event mode."""

    @abstractmethod
    def _update(self) -> None:
        """Iterate an event until it is over; take the time of the next one, or `_end`."""

    @abstractmethod
    def _wants_event(self) -> bool:
        """Complete a step of the solver; return whether the FMU asks for an event, or `_end`."""

    # ------------------------------------------------------------------ equations of the solver

    def set_time(self, t: float) -> None:
        """Set the time, s."""
        self._call("SetTime", t)

    def get_states(self, x: Any, count: int) -> None:
        """Get the states."""
        self._call("GetContinuousStates", x, count)

    def set_states(self, x: Any, count: int) -> bool:
        """Set the states; False if the FMU discards them."""
        return self._computed("SetContinuousStates", x, count)

    def derivatives(self, dx: Any, count: int) -> bool:
        """Get the derivatives; False if the FMU cannot compute them there."""
        return self._computed(self._derivatives_word, dx, count)

    def indicators(self, z: Any, count: int) -> bool:
        """Get the event indicators; False if the FMU cannot compute them there."""
        return self._computed("GetEventIndicators", z, count)

    def nominals(self, x: Any, count: int) -> None:
        """Get the nominal values of the states."""
        self._call(self._nominals_word, x, count)

    # ------------------------------------------------------------------ inside

    def _begin_integration(self) -> None:
        """Let the solver take over, after the first event."""
        self._stepping = True
        if self.ended_at is not None:
            return
        self._enter_continuous_time()
        from .solver import Solver  # loads SUNDIALS

        states, indicators = self._sizes()
        if states or indicators:
            self._solver = Solver(self, (states, indicators), self._now, self._tolerance)

    def _integrate_to(self, end: float) -> bool:
        """Go on to ``end`` or an event before; return if there is one."""
        until = end
        if self._event_is_due(end):
            assert self._next_event is not None
            until = max(self._now, self._next_event)
        event = False
        if self._solver is None or until - self._now < _HALF_NS:
            self._now = until
            self.set_time(until)
        else:
            event = self._solve_to(until)
        return event or (until != end and not self._now < until) or self._event_is_due(self._now)

    def _event_is_due(self, t: float) -> bool:
        return self._next_event is not None and self._next_event < t + _HALF_NS

    def _solve_to(self, until: float) -> bool:
        """Let the solver take steps to ``until``; return if an event comes before."""
        if self._jumped:
            self._solver.restart(self._now)
            self._jumped = False
        for _ in range(_MOST_STEPS):
            try:
                self._now, crossed = self._solver.advance(until)
            except RuntimeError as error:
                raise SimulationError(
                    f"{self.name}: the solver cannot go on at t = {self._now!r} s: {error}"
                    f"{self._messages.said()}"
                ) from None
            wants = self._completes and self._wants_event()
            if crossed or wants or self.ended_at is not None:
                return True
            if self._now >= until:
                return False
        raise SimulationError(
            f"{self.name}: the solver took {_MOST_STEPS} steps and got no further than t = "
            f"{self._now!r} s of {until!r} s"
        )

    def _waits(self, variable: Variable) -> bool:
        return True

    def _in_event(self, sets: Sequence[Callable[[], None]]) -> None:
        if self.ended_at is not None:
            return
        self._jumped = True
        self._enter_events()
        for put in sets:
            put()
        self._update()
        if self.ended_at is None:
            self._enter_continuous_time()

    def _end(self) -> None:
        self.ended_at = self._now

    def _memory(self) -> Any:
        return super()._memory(), self._now, self._next_event

    def _recall(self, memory: Any) -> None:
        given, self._now, self._next_event = memory
        super()._recall(given)
        self._jumped = True

    def _computed(self, function: str, array: Any, count: int) -> bool:
        status = self._functions[function](self._c, array, count)
        if status in ACCEPTED:
            return True
        if status != DISCARD:
            self._refuse(function, status)
        return False
