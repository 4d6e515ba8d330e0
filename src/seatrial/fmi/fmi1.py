"""FMI 1.0: variables in one get and one set per type, and co-simulation."""

from __future__ import annotations

import ctypes
import math
from collections.abc import Sequence
from typing import Any, ClassVar

import fmpy
from fmpy import fmi1

from .fmuinstance import FmuInstance
from .instance import Reader, Variable, Writer
from .loaded import LoadedFmu
from .messages import ACCEPTED, listening_callbacks1, stop_listening1

TRUE, FALSE = fmi1.fmi1True, fmi1.fmi1False
_CTYPES: dict[type, Any] = {
    float: ctypes.c_double,
    int: ctypes.c_int,
    bool: ctypes.c_ubyte,  # FMI's is a char, of which ctypes makes bytes
    str: ctypes.c_char_p,
}
_NAMES = {float: "Real", int: "Integer", bool: "Boolean", str: "String"}
_STANDALONE = "application/x-fmu-sharedlibrary"


class Fmi1Access(FmuInstance):
    """What both interfaces of FMI 1.0 have in common, in arrays allocated once."""

    _prefix: ClassVar[str] = "fmi1"
    _platform: ClassVar[str] = fmpy.platform

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

    def _getter(self, variables: list[Variable], kind: Any) -> Reader:
        count = len(variables)
        vr = (ctypes.c_uint * count)(*(v.reference for v in variables))
        values = (_CTYPES[kind] * count)()
        function = f"Get{_NAMES[kind]}"
        get, c, messages = self._functions[function], self._c, self._messages
        argument = _pointer(values, kind)

        def read() -> list[Any]:
            status = get(c, vr, count, argument)
            if status not in ACCEPTED:
                self._refuse(function, status)
            if messages:
                messages.forward()
            if kind is bool:
                return [bool(v) for v in values]
            if kind is str:
                return [(v or b"").decode("utf-8", "replace") for v in values]
            plain: list[Any] = values[:]
            return plain

        return _negating(variables, kind, read)

    def _setter(self, variables: list[Variable], kind: Any) -> Writer:
        count = len(variables)
        vr = (ctypes.c_uint * count)(*(v.reference for v in variables))
        own = (_CTYPES[kind] * count)()
        function = f"Set{_NAMES[kind]}"
        put, c, messages = self._functions[function], self._c, self._messages
        argument, signs = _pointer(own, kind), _signs(variables, kind)

        def write(values: Sequence[Any]) -> None:
            self._refuse_unfit(variables, kind, values)
            if signs:
                values = [sign * v for sign, v in zip(signs, values, strict=True)]
            own[:] = [v.encode() for v in values] if kind is str else values
            status = put(c, vr, count, argument)
            if status not in ACCEPTED:
                self._refuse(function, status)
            if messages:
                messages.forward()

        return write


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
        model = self.fmu.root.find("Implementation/CoSimulation_Tool/Model")
        mime = _STANDALONE if model is None else model.get("type") or _STANDALONE
        self._slave.instantiate(
            mimeType=mime, functions=listening_callbacks1(self._messages), loggingOn=True
        )
        if not self._slave.component:
            raise RuntimeError("no instance was returned")


def _pointer(values: Any, kind: type) -> Any:
    """Return an array as what FMPy's functions take."""
    return ctypes.cast(values, ctypes.POINTER(ctypes.c_char)) if kind is bool else values


def _signs(variables: Sequence[Variable], kind: type) -> list[int]:
    """Return the sign of each variable against its value reference; none if all are positive."""
    if kind not in (float, int) or not any(v.negated for v in variables):
        return []
    return [-1 if v.negated else 1 for v in variables]


def _negating(variables: Sequence[Variable], kind: type, read: Reader) -> Reader:
    signs = _signs(variables, kind)
    if not signs:
        return read
    return lambda: [sign * value for sign, value in zip(signs, read(), strict=True)]
