"""FMI 3.0: model exchange."""

from __future__ import annotations

import ctypes
from typing import Any, ClassVar

from fmpy import fmi3

from .fmi3 import Fmi3Access
from .modelexchange import ModelInstance


class Fmi3Model(ModelInstance, Fmi3Access):
    """An instance of an FMI 3.0 FMU in model exchange, with a solver."""

    _library: ClassVar[type[Any]] = fmi3.FMU3Model
    _derivatives_word: ClassVar[str] = "GetContinuousStateDerivatives"

    def initialise(self, start_time: float, stop_time: float) -> None:
        """Start at ``start_time``."""
        self._now = start_time
        self._enter_initialisation(self._tolerance, start_time, stop_time)

    def begin(self) -> None:
        """End the initialisation."""
        self._call("ExitInitializationMode")
        self._messages.forward()
        self._update()
        self._begin_integration()

    # ------------------------------------------------------------------ inside

    def _instantiate(self) -> None:
        self._slave.instantiate(
            loggingOn=True,
            logMessage=lambda _, status, category, message: self._messages.keep(status, message),
        )

    def _sizes(self) -> tuple[int, int]:
        states, indicators = ctypes.c_size_t(), ctypes.c_size_t()
        self._call("GetNumberOfContinuousStates", ctypes.byref(states))
        self._call("GetNumberOfEventIndicators", ctypes.byref(indicators))
        return states.value, indicators.value

    def _enter_events(self) -> None:
        self._call("EnterEventMode")

    def _enter_continuous_time(self) -> None:
        self._call("EnterContinuousTimeMode")

    def _update(self) -> None:
        ends, at = self._update_discrete_states()
        if ends:
            self._end()
        self._next_event = at

    def _wants_event(self) -> bool:
        wants, ends = ctypes.c_bool(), ctypes.c_bool()
        self._call(
            "CompletedIntegratorStep", bool(self.never_back),
            ctypes.byref(wants), ctypes.byref(ends),
        )  # fmt: skip
        if ends.value:
            self._end()
        return wants.value
