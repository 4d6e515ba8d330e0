"""A fault of signals: coarse resolution."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from seatrial.model.faults.catalogue import Kind, Setting
from seatrial.model.faults.operators import Draw, Moment, Operator
from seatrial.sim.fault_settings import Settings


@dataclass(frozen=True)
class Coarse(Operator):
    """y is x rounded to whole steps."""

    step: float

    def value(self, memory: Any, x: Any, moment: Moment) -> Any:
        """Return the rounded value."""
        return self.step * round(x / self.step)


def made(settings: Settings, index: int, draw: Draw) -> Coarse:
    """Return the operator of one scalar. Raises InputError for a step that is not positive."""
    step = settings.level("value", index)
    if step <= 0.0:
        raise settings.refused("value", f"a step above 0 is needed, found {step:g}")
    return Coarse(step)


COARSE = Kind(
    "a display with few digits",
    ("signal",),
    "y = value round(x / value)",
    {"value": Setting("value", "the step")},
    make=made,
)
