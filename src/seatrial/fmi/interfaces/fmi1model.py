"""FMI 1.0: model exchange."""

from __future__ import annotations

import ctypes
from typing import Any, ClassVar

from fmpy import fmi1

from ..messages import listening_callbacks1
from .eventful import MOST_UPDATES
from .fmi1 import FALSE, TRUE, Fmi1Access
from .modelexchange import ModelInstance


class Fmi1Model(ModelInstance, Fmi1Access):
    """An instance of an FMI 1.0 FMU in model exchange, with a solver."""

    _library: ClassVar[type[Any]] = fmi1.FMU1Model
    _free_word: ClassVar[str] = "FreeModelInstance"
    _nominals_word: ClassVar[str] = "GetNominalContinuousStates"

    def initialise(self, start_time: float, stop_time: float) -> None:
        """Start at ``start_time``."""
        self._now = start_time
        self.set_time(start_time)
        info = fmi1.fmi1EventInfo()
        self._call("Initialize", TRUE, self._tolerance, ctypes.byref(info))
        self._messages.forward()
        self._take(info)

    def begin(self) -> None:
        """End the initialisation."""
        self._begin_integration()

    # ------------------------------------------------------------------ inside

    def _instantiate(self) -> None:
        self._slave.instantiate(functions=listening_callbacks1(self._messages), loggingOn=True)

    def _sizes(self) -> tuple[int, int]:
        description = self.fmu.description
        return description.numberOfContinuousStates, description.numberOfEventIndicators

    def _enter_events(self) -> None:
        """Do nothing: FMI 1.0 has no modes."""

    def _enter_continuous_time(self) -> None:
        """Do nothing: FMI 1.0 has no modes."""

    def _update(self) -> None:
        info = fmi1.fmi1EventInfo()
        for _ in range(MOST_UPDATES):
            self._call("EventUpdate", FALSE, ctypes.byref(info))
            if info.terminateSimulation != FALSE or info.iterationConverged != FALSE:
                self._take(info)
                return
        raise self._endless("EventUpdate")

    def _take(self, info: Any) -> None:
        """Take what an event says of the next one, and of the end."""
        self._next_event = info.nextEventTime if info.upcomingTimeEvent != FALSE else None
        if info.terminateSimulation != FALSE:
            self._end()

    def _wants_event(self) -> bool:
        wants = ctypes.c_char()
        self._call("CompletedIntegratorStep", ctypes.byref(wants))
        return bool(wants.value != FALSE)
