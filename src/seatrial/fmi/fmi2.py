"""Instances of FMI 2.0 co-simulation FMUs."""

from __future__ import annotations

import ctypes
import math
from collections.abc import Sequence
from typing import Any, ClassVar

import fmpy
from fmpy import fmi2

from .fmuinstance import FmuInstance
from .instance import Reader, Variable, Writer
from .loaded import LoadedFmu
from .messages import ACCEPTED, listening_callbacks, stop_listening

_CTYPES: dict[type, Any] = {
    float: ctypes.c_double,
    int: ctypes.c_int,
    bool: ctypes.c_int,
    str: ctypes.c_char_p,
}
_NAMES = {float: "Real", int: "Integer", bool: "Boolean", str: "String"}


class Fmi2Instance(FmuInstance):
    """An instance of an FMI 2.0 FMU: one get and one set per type, in arrays allocated once."""

    _prefix: ClassVar[str] = "fmi2"
    _state_word: ClassVar[str] = "FMUstate"
    _platform: ClassVar[str] = fmpy.platform
    _library: ClassVar[type[Any]] = fmi2.FMU2Slave

    def __init__(self, fmu: LoadedFmu, name: str) -> None:
        super().__init__(fmu, name)
        self._do_step = self._functions["DoStep"]
        self._never_back = int(not self.rolls_back)

    def initialise(self, start_time: float, stop_time: float) -> None:
        """Start at ``start_time``."""
        stops = math.isfinite(stop_time)
        self._call("SetupExperiment", 0, 0.0, start_time, int(stops), stop_time if stops else 0.0)
        self._call("EnterInitializationMode")
        self._refuse_logged_errors("EnterInitializationMode")

    def begin(self) -> None:
        """End the initialisation."""
        self._call("ExitInitializationMode")
        self._refuse_logged_errors("ExitInitializationMode")

    def step(self, t: float, h: float) -> None:
        """Advance from ``t`` to ``t + h``, s.

        Every discarded step may be tried in smaller ones: pythonfmu's binary says of each that
        the FMU wants to end, so that looks like an error.
        """
        status = self._do_step(self._c, t, h, self._never_back)
        if status not in ACCEPTED:
            self._refuse(f"DoStep(t = {t!r} s, h = {h!r} s)", status)
        if self._messages:
            self._messages.forward()

    def free(self) -> None:
        """Release the instance."""
        super().free()
        stop_listening(self._callbacks)

    # ------------------------------------------------------------------ inside

    def _instantiate(self) -> None:
        self._callbacks = listening_callbacks(self._messages)
        self._slave.instantiate(callbacks=self._callbacks, loggingOn=True)

    def _reader(self, variables: list[Variable], kind: type) -> Reader:
        count = len(variables)
        vr = (ctypes.c_uint * count)(*(v.reference for v in variables))
        values = (_CTYPES[kind] * count)()
        function = f"Get{_NAMES[kind]}"
        get, c, messages = self._functions[function], self._c, self._messages

        def read() -> list[Any]:
            status = get(c, vr, count, values)
            if status not in ACCEPTED:
                self._refuse(function, status)
            if messages:
                self._refuse_logged_errors(function)
            if kind is float or kind is int:
                plain: list[Any] = values[:]
                return plain
            if kind is bool:
                return [bool(v) for v in values]
            return [(v or b"").decode("utf-8", "replace") for v in values]

        return read

    def _writer(self, variables: list[Variable], kind: type) -> Writer:
        count = len(variables)
        vr = (ctypes.c_uint * count)(*(v.reference for v in variables))
        own = (_CTYPES[kind] * count)()
        function = f"Set{_NAMES[kind]}"
        put, c, messages = self._functions[function], self._c, self._messages

        def write(values: Sequence[Any]) -> None:
            if kind is int:
                self._refuse_excess(variables, values)
            own[:] = self._encoded(variables, values) if kind is str else values
            status = put(c, vr, count, own)
            if status not in ACCEPTED:
                self._refuse(function, status)
            if messages:
                self._refuse_logged_errors(function)

        return write
