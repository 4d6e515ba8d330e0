"""Inputs that sum: one input for each source, added by the component in their order."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

from .ports import Input


class Terms:
    """``count`` optional inputs NAME_1 ... NAME_count whose sum acts: forces on a body, say.

    As a class attribute it declares the inputs; reading it from a component gives their sum, a
    float or a tuple by axis. Each connection to NAME takes the next free term, so that every
    input has one source in FMI, in SSP and in the compiled master too. The order of addition
    is that of the terms; a term that nothing feeds is zero.
    """

    kind = "input"

    def __init__(self, count: int, unit: str, description: str, **options: Any) -> None:
        self.name = ""
        self.inputs = tuple(
            Input(unit, f"{description} (term {term})", optional=True, **options)
            for term in range(1, count + 1)
        )

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name
        for term, port in enumerate(self.inputs, 1):
            port.term_of = name
            port.__set_name__(owner, f"{name}_{term}")
            setattr(owner, port.name, port)

    def __get__(self, component: Any, owner: type | None = None) -> Any:
        return self if component is None else self.total(component)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the inputs, in the order of addition."""
        return tuple(port.name for port in self.inputs)

    def total(self, values: SimpleNamespace | Any) -> Any:
        """Return the sum of the terms in ``values``: a component, or a plant's symbols.

        Tuples are added by axis.
        """
        first, *others = (getattr(values, name) for name in self.names)
        for other in others:
            if isinstance(first, tuple):
                first = tuple(a + b for a, b in zip(first, other, strict=True))
            else:
                first = first + other
        return first
