"""FMI 1.0: co-simulation, and what it has in common with model exchange."""

from __future__ import annotations

import ctypes
import math
from collections.abc import Sequence
from typing import Any, ClassVar

from fmpy import fmi1

from ..instance import Reader, Variable, Writer
from ..messages import ACCEPTED, listening_callbacks1, stop_listening1
from .eventful import MOST_UPDATES
from .loaded import LoadedFmu
from .modelexchange import ModelInstance
from .typed import TypedAccess

TRUE, FALSE = fmi1.fmi1True, fmi1.fmi1False
_STANDALONE = "application/x-fmu-sharedlibrary"


class Fmi1Access(TypedAccess):
    """What both interfaces of FMI 1.0 have in common."""

    _boolean: ClassVar[type] = ctypes.c_ubyte  # FMI's is a char, of which ctypes makes bytes

    _prefix: ClassVar[str] = "fmi1"

    def free(self) -> None:
        """Release the instance."""
        super().free()
        stop_listening1(self._messages)

    # ------------------------------------------------------------------ inside

    def _opened(self, identifier: str) -> Any:
        opened = super()._opened(identifier)
        for name, function in opened._functions.items():
            if function.restype is ctypes.c_char_p and "Version" not in name:
                function.restype = ctypes.c_int  # FMPy takes some statuses for texts
        return opened

    def _argument(self, values: Any, kind: type) -> Any:
        is_boolean = kind is bool
        return ctypes.cast(values, ctypes.POINTER(ctypes.c_char)) if is_boolean else values

    def _getter(self, variables: list[Variable], kind: Any) -> Reader:
        read, signs = super()._getter(variables, kind), _signs(variables, kind)
        if not signs:
            return read
        return lambda: [sign * value for sign, value in zip(signs, read(), strict=True)]

    def _setter(self, variables: list[Variable], kind: Any) -> Writer:
        write, signs = super()._setter(variables, kind), _signs(variables, kind)
        if not signs:
            return write
        return lambda values: write([sign * v for sign, v in zip(signs, values, strict=True)])


class Fmi1Slave(Fmi1Access):
    """An instance of an FMI 1.0 FMU in co-simulation.

    FMI 1.0 initialises in one call, before any input of another component can be known.
    """

    _library: ClassVar[type[Any]] = fmi1.FMU1Slave
    _free_word: ClassVar[str] = "FreeSlaveInstance"
    _terminate_word: ClassVar[str] = "TerminateSlave"

    def __init__(self, fmu: LoadedFmu, name: str) -> None:
        super().__init__(fmu, name)
        self._do_step = self._functions["DoStep"]

    def initialise(self, start_time: float, stop_time: float) -> None:
        """Start at ``start_time``."""
        stops = math.isfinite(stop_time)
        flag, stop = (TRUE, stop_time) if stops else (FALSE, 0.0)
        self._call("InitializeSlave", start_time, flag, stop)
        self._messages.forward()

    def begin(self) -> None:
        """End the initialisation, which is over already."""

    def step(self, t: float, h: float) -> None:
        """Advance from ``t`` to ``t + h``, s."""
        status = self._do_step(self._c, t, h, TRUE)
        if status not in ACCEPTED:
            self._refuse(f"DoStep(t = {t!r} s, h = {h!r} s)", status)
        if self._messages:
            self._messages.forward()

    # ------------------------------------------------------------------ inside

    def _instantiate(self) -> None:
        model = self.fmu.model.root.find("Implementation/CoSimulation_Tool/Model")
        mime = _STANDALONE if model is None else model.get("type") or _STANDALONE
        self._slave.instantiate(
            mimeType=mime, functions=listening_callbacks1(self._messages), loggingOn=True
        )
        if not self._slave.component:
            raise RuntimeError("no instance was returned")


def _signs(variables: Sequence[Variable], kind: type) -> list[int]:
    """Return the sign of each variable against its value reference; none if all are positive."""
    if kind not in (float, int) or not any(v.negated for v in variables):
        return []
    return [-1 if v.negated else 1 for v in variables]


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
