"""Settings of an FMU in a rig besides its values: interface, tolerance, sizes, local variables."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any, Literal, get_args

Interface = Literal["co-simulation", "model exchange"]
INTERFACES: tuple[Interface, ...] = get_args(Interface)
"""The first one that an FMU has is used where nobody says which."""


@dataclass(frozen=True)
class FmuOptions:
    """How an FMU is to be used; the defaults are its own."""

    interface: Interface | None = None
    tolerance: float | None = None
    """Relative tolerance: of its own solver in co-simulation, of ours in model exchange."""
    structure: Mapping[str, int] = field(default_factory=dict)
    """Structural parameters of FMI 3.0, by name: sizes of arrays follow from them."""
    locals: Sequence[str] = ()
    """Local variables, or elements of such, that are outputs."""

    def as_json(self) -> dict[str, Any]:
        """Return it as data, from which ``FmuOptions(**data)`` makes the same."""
        return asdict(self)


DEFAULTS = FmuOptions()
