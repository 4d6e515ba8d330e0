"""Dependencies of a plant's outputs, by the sparsity of its expressions."""

from __future__ import annotations

import itertools
import math

from ...model.plant import Plant
from ...model.ports import Parameter
from .values import UndecidedError

_MOST_CHOICES = 64


def equations_depend(cls: type[Plant]) -> dict[str, tuple[str, ...]]:
    """Return the inputs that act on each output beside the states, with any choice of texts.

    Raises UndecidedError where a text parameter that chooses between equations may be anything.
    """
    found: dict[str, set[str]] = {port.name: set() for port in cls.output_ports}
    if not found or not cls.input_ports:
        return dict.fromkeys(found, ())
    texts = [port for port in map(cls.ports.get, cls._texts) if isinstance(port, Parameter)]
    open_ones = [port.name for port in texts if not port.choices]
    several = [port.choices or (port.start[0],) for port in texts]
    if open_ones or math.prod(map(len, several)) > _MOST_CHOICES:
        which = ", ".join(open_ones) or "text parameters"
        raise UndecidedError(f"{which} may choose any equations")
    for choice in itertools.product(*several):
        for output, given in cls.coupled(dict(zip(cls._texts, choice, strict=True))):
            found[output].add(given)
    return {name: tuple(sorted(inputs)) for name, inputs in found.items()}
