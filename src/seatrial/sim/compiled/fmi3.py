"""FMUs of FMI 3.0 in the compiled master, which calls them through `fmi3.c`."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from typing import ClassVar

from ...fmi.instance import Variable
from ...fmi.interfaces.fmi3slave import Fmi3Slave
from .library import function_address

RETURNED = 100
"""What `fmi3.c` returns for a step that ended early, with an event or for good."""


class Fmi3(ctypes.Structure):
    """The structure of `fmi3.c`, field by field."""

    _fields_: ClassVar = [
        ("component", ctypes.c_void_p),
        *(
            (f"{act}_{kind}", ctypes.c_void_p)
            for kind in ("float64", "int32", "boolean")
            for act in ("get", "set")
        ),
        ("do_step", ctypes.c_void_p),
        ("truths", ctypes.POINTER(ctypes.c_bool)),
        ("event", ctypes.POINTER(ctypes.c_bool)),
        ("end", ctypes.POINTER(ctypes.c_bool)),
        ("early", ctypes.POINTER(ctypes.c_bool)),
        ("reached", ctypes.POINTER(ctypes.c_double)),
    ]


class CompiledFmi3:
    """What `program` asks of an FMU's instance, of one of FMI 3.0."""

    _FUNCTIONS: ClassVar = {
        "GetReal": ("fmi3_get_real", "GetFloat64"),
        "SetReal": ("fmi3_set_real", "SetFloat64"),
        "GetInteger": ("fmi3_get_integer", "GetInt32"),
        "SetInteger": ("fmi3_set_integer", "SetInt32"),
        "GetBoolean": ("fmi3_get_boolean", "GetBoolean"),
        "SetBoolean": ("fmi3_set_boolean", "SetBoolean"),
        "DoStep": ("fmi3_step", "DoStep"),
    }

    def __init__(self, instance: Fmi3Slave) -> None:
        self.name, self._instance = instance.name, instance
        event, end, early, reached = instance.left
        self._own = Fmi3(
            component=instance.component,
            do_step=instance.address("DoStep"),
            truths=(ctypes.c_bool * max(1, len(instance.variables)))(),
            event=ctypes.pointer(event),
            end=ctypes.pointer(end),
            early=ctypes.pointer(early),
            reached=ctypes.pointer(reached),
        )
        for kind in ("Float64", "Int32", "Boolean"):
            for act in ("Get", "Set"):
                field = f"{act}_{kind}".lower()
                setattr(self._own, field, instance.address(f"{act}{kind}"))
        self.component = ctypes.addressof(self._own)

    def references(self, variables: Sequence[Variable]) -> list[int]:
        """Return what its functions take as references: their number first."""
        found = list(dict.fromkeys(variable.reference for variable in variables))
        return [len(found), *found]

    def address(self, function: str) -> int:
        """Return where a function is, 0 if there is none of that name."""
        ours, theirs = self._FUNCTIONS[function]
        return function_address(ours) if self._instance.address(theirs) else 0

    def answered(self, function: str, status: int) -> None:
        """Take what a get or a set returned. Raises SimulationError."""
        self._instance.answered(self._FUNCTIONS[function][1], status)

    def stepped(self, t: float, h: float, status: int) -> None:
        """Take what a step returned, and go on to its end. Raises SimulationError."""
        self._instance.stepped(t, h, 0 if status == RETURNED else status)

    @property
    def never_back(self) -> int:
        """Whether no state of before a step will be restored."""
        return self._instance.never_back

    @property
    def ended_at(self) -> float | None:
        """Where the FMU has asked for the end, s."""
        return self._instance.ended_at

    def forward(self) -> None:
        """Log what the FMU has said since."""
        self._instance.forward()
