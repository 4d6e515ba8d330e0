"""One call of a function whose text is run."""

from __future__ import annotations

from dataclasses import dataclass, field

from .values import NONE, Callee, Inputs, Value


@dataclass
class Frame:
    """One call of a function."""

    names: dict[str, Value]
    code: Callee
    left: Inputs = NONE
    """What it follows from that the rest of the function runs at all."""
    returned: Value | None = None
    broken: list[list[dict[str, Value]]] = field(default_factory=list)
    """Names as they are where the loops around are left early."""
