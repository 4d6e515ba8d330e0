"""Sums in the compiled master: to C they are FMUs like others, whose functions `master.c` has."""

from __future__ import annotations

import ctypes
from typing import ClassVar

from ..sums import SumInstance
from .library import library


class Sum(ctypes.Structure):
    """The structure of `master.c`, field by field."""

    _fields_: ClassVar = [
        ("inputs", ctypes.POINTER(ctypes.c_double)),
        ("count", ctypes.c_int64),
        ("terms", ctypes.c_int64),
    ]


class CompiledSum:
    """What `program` asks of an FMU's instance, of a sum."""

    _FUNCTIONS: ClassVar = {"SetReal": "sum_set", "GetReal": "sum_get", "DoStep": "sum_step"}

    never_back = 0

    def __init__(self, instance: SumInstance) -> None:
        self.name = instance.name
        inputs = ctypes.cast(instance.inputs, ctypes.POINTER(ctypes.c_double))
        self._sum = Sum(inputs=inputs, count=len(instance.inputs), terms=instance.terms)
        self.component = ctypes.addressof(self._sum)

    def address(self, function: str) -> int:
        """Return where a function is, 0 if there is none of that name."""
        found = library()
        if found is None or function not in self._FUNCTIONS:
            return 0
        own = getattr(found, self._FUNCTIONS[function])
        return ctypes.cast(own, ctypes.c_void_p).value or 0

    def answered(self, function: str, status: int) -> None:
        """Take what a call returned: nothing is ever refused."""

    def stepped(self, t: float, h: float, status: int) -> None:
        """Take what a step returned: nothing is ever refused."""

    def forward(self) -> None:
        """Log what it has said: nothing."""
