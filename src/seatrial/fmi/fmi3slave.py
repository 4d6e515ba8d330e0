"""FMI 3.0: co-simulation, with early returns and event mode."""

from __future__ import annotations

import ctypes
import math
from collections.abc import Callable, Sequence
from typing import Any, ClassVar

from fmpy import fmi3

from ..errors import SimulationError
from .fmi3 import Fmi3Access
from .instance import Variable
from .loaded import LoadedFmu
from .messages import ACCEPTED

_MOST_RETURNS = 10_000
"""Early returns from one step."""


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
        self._never_back = not self.rolls_back

    def initialise(self, start_time: float, stop_time: float) -> None:
        """Start at ``start_time``."""
        self._now = start_time
        self._enter_initialisation(None, start_time, stop_time)

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
        end, returns = t + h, 0
        while self._now != end and self.ended_at is None:
            stop = self._stop(end)
            self._do_step(self._now, h if (self._now, stop) == (t, end) else stop - self._now)
            if not self._early.value or not self._reached.value < stop - 2 * math.ulp(stop):
                self._now = stop
            else:
                self._now = max(self._now, self._reached.value)
                returns += 1
            if (self._event.value and self._has_events) or self._is_due():
                self._in_event([])
            if returns == _MOST_RETURNS:
                raise SimulationError(
                    f"{self.name}: fmi3DoStep(t = {t!r} s, h = {h!r} s) returned early "
                    f"{_MOST_RETURNS} times and got no further than {self._now!r} s"
                )
        if self._messages:
            self._messages.forward()

    # ------------------------------------------------------------------ inside

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

    def _do_step(self, t: float, h: float) -> None:
        status = self._functions["DoStep"](
            self._c, t, h, self._never_back,
            ctypes.byref(self._event), ctypes.byref(self._end),
            ctypes.byref(self._early), ctypes.byref(self._reached),
        )  # fmt: skip
        if status not in ACCEPTED:
            self._refuse(f"DoStep(t = {t!r} s, h = {h!r} s)", status)
        if self._end.value:
            self.ended_at = self._reached.value

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
