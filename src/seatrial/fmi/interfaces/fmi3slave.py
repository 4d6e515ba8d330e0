"""FMI 3.0: co-simulation, with early returns and event mode."""

from __future__ import annotations

import ctypes
import math
from collections.abc import Callable, Sequence
from typing import Any, ClassVar

from fmpy import fmi3

from ...errors import SimulationError
from ..files.arrays import ArrayCall
from ..instance import Variable
from ..messages import ACCEPTED
from .fmi3 import Fmi3Access
from .loaded import LoadedFmu

_MOST_RETURNS = 10_000
"""Early returns from one step."""
_SETTABLE = ("input", "parameter")
_IN_C = {"Float64", "Int32", "Boolean"}


class Fmi3Slave(Fmi3Access):
    """An instance of an FMI 3.0 FMU in co-simulation.

    With event mode, what is not continuous is set in an event, as soon as anything else is
    asked of the FMU: all that changed at one communication point is one event.
    """

    _library: ClassVar[type[Any]] = fmi3.FMU3Slave

    def __init__(self, fmu: LoadedFmu, name: str) -> None:
        self._has_events = bool(fmu.simulation.hasEventMode)
        self._event, self._end, self._early = (ctypes.c_bool() for _ in range(3))
        self._reached = ctypes.c_double()
        self._now = 0.0
        super().__init__(fmu, name)
        self.left = self._event, self._end, self._early, self._reached
        """What the last step left: an event to handle, the end, an early return, and its time."""
        waits = any(self._waits(v) for v in self.variables.values() if v.causality in _SETTABLE)
        self.is_native = not (fmu.simulation.needsExecutionTool or fmu.clocks.by_reference or waits)
        """Whether C may call it: others may need Python's interpreter, or events between steps."""

    def initialise(self, start_time: float, stop_time: float) -> None:
        """Start at ``start_time``."""
        self._now = start_time
        self._enter_initialisation(self.fmu.tolerance, start_time, stop_time)

    def begin(self) -> None:
        """End the initialisation."""
        self._call("ExitInitializationMode")
        if self._has_events:
            self._update()
            self._call("EnterStepMode")
        self._stepping = True
        self._messages.forward()

    def step(self, t: float, h: float) -> None:
        """Advance from ``t`` to ``t + h``, s, through all events on the way."""
        self._now = t
        self._flush()
        if self._is_due():
            self._in_event([])
        self._go_on(t, h, 0)
        if self._messages:
            self._messages.forward()

    def stepped(self, t: float, h: float, status: int) -> None:
        """Take what a step from C returned, and go on to its end. Raises SimulationError."""
        self._now = t
        self._took(t, h, status)
        self._go_on(t, h, self._arrive(t + h))
        self.forward()

    def answered(self, function: str, status: int) -> None:
        """Take what a get or a set that C asked for returned. Raises SimulationError."""
        if status not in ACCEPTED:
            self._refuse(function, status)
        self.forward()

    def in_c(self, variables: Sequence[Variable]) -> bool:
        """Return whether C can read and set variables: numbers as it has them, arrays whole."""
        kinds = {self._type(variable) for variable in variables}
        return not kinds or (
            len(kinds) == 1
            and kinds <= _IN_C
            and ArrayCall(variables, kinds.pop(), self.fmu.arrays).is_whole
        )

    # ------------------------------------------------------------------ inside

    def _go_on(self, t: float, h: float, returns: int) -> None:
        """Step to ``t + h``, after so many early returns."""
        end = t + h
        while self._now != end and self.ended_at is None:
            stop = self._stop(end)
            own = h if (self._now, stop) == (t, end) else stop - self._now
            status = self._functions["DoStep"](
                self._c,
                self._now,
                own,
                bool(self.never_back),
                *(ctypes.byref(one) for one in self.left),
            )
            self._took(self._now, own, status)
            returns += self._arrive(stop)
            if returns == _MOST_RETURNS:
                raise SimulationError(
                    f"{self.name}: fmi3DoStep(t = {t!r} s, h = {h!r} s) returned early "
                    f"{_MOST_RETURNS} times and got no further than {self._now!r} s"
                )

    def _took(self, t: float, h: float, status: int) -> None:
        if status not in ACCEPTED:
            self._refuse(f"DoStep(t = {t!r} s, h = {h!r} s)", status)
        if self._end.value:
            self.ended_at = self._reached.value

    def _arrive(self, stop: float) -> bool:
        """Take in where a step towards ``stop`` ended; return whether that was early."""
        early = self._early.value and self._reached.value < stop - 2 * math.ulp(stop)
        self._now = max(self._now, self._reached.value) if early else stop
        if (self._event.value and self._has_events) or self._is_due():
            self._in_event([])
        return early

    def _instantiate(self) -> None:
        try:
            self._instantiate_with_events(self._has_events)
        except Exception:
            if not self._has_events or self.fmu.clocks.by_reference:
                raise
            # Some promise what their code does not have: without, discrete inputs are set in steps.
            said = self._messages.said()
            self._has_events = False
            self._instantiate_with_events(False)
            self._messages.warn(f"it has no event mode, though its description says so{said}")

    def _instantiate_with_events(self, used: bool) -> None:
        self._slave.instantiate(
            loggingOn=True,
            eventModeUsed=used,
            earlyReturnAllowed=True,
            logMessage=lambda _, status, category, message: self._messages.keep(status, message),
        )

    def _stop(self, end: float) -> float:
        """Return how far it may step now, on its way to ``end``."""
        return end

    def _waits(self, variable: Variable) -> bool:
        return self._has_events and variable.variability != "continuous"

    def _in_event(self, sets: Sequence[Callable[[], None]]) -> None:
        if self.ended_at is not None:
            return
        self._call("EnterEventMode")
        for put in sets:
            put()
        self._update()
        if self.ended_at is None:
            self._call("EnterStepMode")

    def _update(self) -> None:
        """Iterate an event until it is over, or the FMU asks to end the simulation."""
        ends, _ = self._update_discrete_states()
        if ends:
            self.ended_at = self._now
