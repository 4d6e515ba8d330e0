"""Variables of FMI 1.0 and 2.0: one get and one set per type, in arrays allocated once."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from typing import Any, ClassVar

from ..instance import Reader, Variable, Writer
from ..messages import ACCEPTED, OK, WARNING
from .fmuinstance import FmuInstance

_NAMES = {float: "Real", int: "Integer", bool: "Boolean", str: "String"}


class TypedAccess(FmuInstance):
    """An instance whose functions are one get and one set for each of four types."""

    _boolean: ClassVar[type] = ctypes.c_int
    """FMI's Boolean in C."""

    def _array(self, kind: type, count: int) -> Any:
        types: dict[type, Any] = {
            float: ctypes.c_double,
            int: ctypes.c_int,
            bool: self._boolean,
            str: ctypes.c_char_p,
        }
        return (types[kind] * count)()

    def _argument(self, values: Any, kind: type) -> Any:
        """Return an array as what FMPy's functions take."""
        return values

    def answered(self, function: str, status: int) -> None:
        """Take what a get or a set returned. Raises SimulationError."""
        if status not in ACCEPTED:
            self._refuse(function, status)
        self._refuse_logged_errors(function)

    def _getter(self, variables: list[Variable], kind: Any) -> Reader:
        count = len(variables)
        vr = (ctypes.c_uint * count)(*(v.reference for v in variables))
        values = self._array(kind, count)
        function = f"Get{_NAMES[kind]}"
        get, c, said = self._functions[function], self._c, self._messages.kept
        argument = self._argument(values, kind)
        number = kind is float or kind is int

        def read() -> list[Any]:
            status = get(c, vr, count, argument)
            if status > WARNING or status < OK or said:
                self.answered(function, status)
            if number:
                plain: list[Any] = values[:]
                return plain
            if kind is bool:
                return [bool(v) for v in values]
            return [(v or b"").decode("utf-8", "replace") for v in values]

        return read

    def _setter(self, variables: list[Variable], kind: Any) -> Writer:
        count = len(variables)
        vr = (ctypes.c_uint * count)(*(v.reference for v in variables))
        own = self._array(kind, count)
        function = f"Set{_NAMES[kind]}"
        put, c, said = self._functions[function], self._c, self._messages.kept
        argument = self._argument(own, kind)
        may_unfit = kind is int or kind is str

        def write(values: Sequence[Any]) -> None:
            if may_unfit:
                self._refuse_unfit(variables, kind, values)
            own[:] = [v.encode() for v in values] if kind is str else values
            status = put(c, vr, count, argument)
            if status > WARNING or status < OK or said:
                self.answered(function, status)

        return write
