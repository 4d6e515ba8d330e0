"""FMI 2.0: model exchange."""

from __future__ import annotations

import ctypes
from typing import Any, ClassVar

from fmpy import fmi2

from .eventful import MOST_UPDATES
from .fmi2 import Fmi2Access
from .modelexchange import ModelInstance


class Fmi2Model(ModelInstance, Fmi2Access):
    """An instance of an FMI 2.0 FMU in model exchange, with a solver."""

    _library: ClassVar[type[Any]] = fmi2.FMU2Model

    def initialise(self, start_time: float, stop_time: float) -> None:
        """Start at ``start_time``."""
        self._now = start_time
        self._enter_initialisation(self._tolerance, start_time, stop_time)

    def begin(self) -> None:
        """End the initialisation."""
        self._call("ExitInitializationMode")
        self._refuse_logged_errors("ExitInitializationMode")
        self._update()
        self._begin_integration()

    # ------------------------------------------------------------------ inside

    def _sizes(self) -> tuple[int, int]:
        description = self.fmu.description
        return description.numberOfContinuousStates, description.numberOfEventIndicators

    def _enter_events(self) -> None:
        self._call("EnterEventMode")

    def _enter_continuous_time(self) -> None:
        self._call("EnterContinuousTimeMode")

    def _update(self) -> None:
        info = fmi2.fmi2EventInfo()
        for _ in range(MOST_UPDATES):
            self._call("NewDiscreteStates", ctypes.byref(info))
            if info.terminateSimulation:
                self._end()
                return
            if not info.newDiscreteStatesNeeded:
                self._next_event = info.nextEventTime if info.nextEventTimeDefined else None
                return
        raise self._endless("NewDiscreteStates")

    def _wants_event(self) -> bool:
        wants, ends = ctypes.c_int(), ctypes.c_int()
        self._call(
            "CompletedIntegratorStep", self.never_back,
            ctypes.byref(wants), ctypes.byref(ends),
        )  # fmt: skip
        if ends.value:
            self._end()
        return bool(wants.value)
