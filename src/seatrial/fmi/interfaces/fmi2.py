"""FMI 2.0: co-simulation, and what it has in common with model exchange."""

from __future__ import annotations

import ctypes
import math
from collections.abc import Sequence
from typing import Any, ClassVar

from fmpy import fmi2

from ..files.lenient import Missing
from ..instance import Variable
from ..messages import ACCEPTED, DISCARD, OK, listening_callbacks, stop_listening
from .eventful import MOST_UPDATES
from .loaded import LoadedFmu
from .modelexchange import ModelInstance
from .typed import TypedAccess

_LAST_SUCCESSFUL_TIME, _TERMINATED = 2, 3
"""Of fmi2StatusKind."""


class Fmi2Access(TypedAccess):
    """What both interfaces of FMI 2.0 have in common."""

    _prefix: ClassVar[str] = "fmi2"
    _state_word: ClassVar[str] = "FMUstate"

    def free(self) -> None:
        """Release the instance."""
        super().free()
        stop_listening(self._callbacks)

    # ------------------------------------------------------------------ inside

    def _instantiate(self) -> None:
        self._callbacks = listening_callbacks(self._messages)
        self._slave.instantiate(callbacks=self._callbacks, loggingOn=True)

    def _enter_initialisation(self, tolerance: float | None, start: float, stop: float) -> None:
        """Set up the experiment, of which an infinite ``stop`` is none."""
        stops = math.isfinite(stop)
        self._call(
            "SetupExperiment", int(tolerance is not None), tolerance or 0.0,
            start, int(stops), stop if stops else 0.0,
        )  # fmt: skip
        self._call("EnterInitializationMode")
        self._refuse_logged_errors("EnterInitializationMode")


class Fmi2Slave(Fmi2Access):
    """An instance of an FMI 2.0 FMU in co-simulation."""

    _library: ClassVar[type[Any]] = fmi2.FMU2Slave

    def __init__(self, fmu: LoadedFmu, name: str) -> None:
        super().__init__(fmu, name)
        self._do_step, self._said_so_far = self._functions["DoStep"], self._messages.kept
        self.restarts = True
        self.is_native = not fmu.simulation.needsExecutionTool
        """Whether it is C that may be called from C: others may need Python's interpreter."""
        tool = fmu.description.generationTool or ""
        self._is_pythonfmu = tool.startswith(("seatrial", "PythonFMU"))

    def initialise(self, start_time: float, stop_time: float) -> None:
        """Start at ``start_time``."""
        self._enter_initialisation(self.fmu.tolerance, start_time, stop_time)

    def begin(self) -> None:
        """End the initialisation."""
        self._call("ExitInitializationMode")
        self._refuse_logged_errors("ExitInitializationMode")

    def step(self, t: float, h: float) -> None:
        """Advance from ``t`` to ``t + h``, s, or to where the FMU asks to end the simulation."""
        if self.ended_at is not None:
            return
        status = self._do_step(self._c, t, h, self.never_back)
        if status not in ACCEPTED or self._said_so_far:
            self.stepped(t, h, status)

    def stepped(self, t: float, h: float, status: int) -> None:
        """Take what a step returned. Raises SimulationError."""
        if status not in ACCEPTED and not (status == DISCARD and self._ends(t)):
            self._refuse(f"DoStep(t = {t!r} s, h = {h!r} s)", status)
        self._messages.forward()

    def references(self, variables: Sequence[Variable]) -> list[int]:
        """Return the value references of variables, as its functions take them."""
        return [variable.reference for variable in variables]

    def _ends(self, t: float) -> bool:
        """Say if a discarded step is the FMU's end, which it may have in the midst of a step.

        pythonfmu's binary says so of every discarded step, which may do in smaller ones.
        """
        ends, reached = ctypes.c_int(), ctypes.c_double()
        truth, number = (self._functions[f"Get{kind}Status"] for kind in ("Boolean", "Real"))
        if isinstance(truth, Missing) or isinstance(number, Missing):
            return False
        statuses = [
            truth(self._c, _TERMINATED, ctypes.byref(ends)),
            number(self._c, _LAST_SUCCESSFUL_TIME, ctypes.byref(reached)),
        ]
        if statuses != [OK, OK] or not ends.value or self._is_pythonfmu:
            return False
        self.ended_at = reached.value
        return True


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
