"""Sums in the compiled master: to C they are FMUs like others, whose functions `master.c` has."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from typing import ClassVar

from ...fmi.instance import Variable
from ...system.sums import SumInstance
from .library import function_address


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
    ended_at = None

    def __init__(self, instance: SumInstance) -> None:
        self.name = instance.name
        inputs = ctypes.cast(instance.inputs, ctypes.POINTER(ctypes.c_double))
        self._sum = Sum(inputs=inputs, count=len(instance.inputs), terms=instance.terms)
        self.component = ctypes.addressof(self._sum)

    def references(self, variables: Sequence[Variable]) -> list[int]:
        """Return the places of variables."""
        return [variable.reference for variable in variables]

    def address(self, function: str) -> int:
        """Return where a function is, 0 if there is none of that name."""
        return function_address(self._FUNCTIONS[function]) if function in self._FUNCTIONS else 0

    def answered(self, function: str, status: int) -> None:
        """Take what a call returned: nothing is ever refused."""

    def stepped(self, t: float, h: float, status: int) -> None:
        """Take what a step returned: nothing is ever refused."""

    def forward(self) -> None:
        """Log what it has said: nothing."""
