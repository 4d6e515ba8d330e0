"""Dependencies of each output of a class at the same instant: declared, or found."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping
from dataclasses import dataclass
from weakref import WeakKeyDictionary

from ...errors import InputError
from ...model.component import Component
from ...model.plant import Plant
from ...model.ports import Parameter
from .interpreter import Interpreter
from .values import UndecidedError

Through = Mapping[str, tuple[str, ...]]
"""Inputs by output, ports both."""


@dataclass(frozen=True)
class Found:
    """What the equations and the text of a class say."""

    through: Through
    undecided: str = ""
    """Why it is unknown; then every output depends on every input."""


_KNOWN: WeakKeyDictionary[type[Component], Found] = WeakKeyDictionary()


def found(cls: type[Component]) -> Found:
    """Return what outputs depend on, whatever is declared but of a plant's equations.

    Those are checked against what is declared when they are compiled.
    """
    if cls not in _KNOWN:
        _KNOWN[cls] = _find(cls)
    return _KNOWN[cls]


def _find(cls: type[Component]) -> Found:
    inputs = [name for name, port in cls.ports.items() if port.kind == "input"]
    outputs = [name for name, port in cls.ports.items() if port.kind == "output"]
    if not inputs or not outputs:
        return Found(dict.fromkeys(outputs, ()))
    try:
        interpreter = Interpreter(cls)
        if issubclass(cls, Plant):
            plant = cls
            interpreter.publishes = lambda: _equations(plant)
        depends = interpreter.run()
    except InputError:  # of equations that are wrong
        raise
    except Exception as error:  # the text of a user may be anything
        why = (
            str(error) if isinstance(error, UndecidedError) else f"{type(error).__name__}: {error}"
        )
        return Found(dict.fromkeys(outputs, tuple(inputs)), why)
    return Found({name: tuple(i for i in inputs if i in depends[name]) for name in outputs})


def _equations(cls: type[Plant]) -> Through:
    names = [port.name for port in cls.output_ports]
    if all(name in cls.feedthrough for name in names):
        return {name: tuple(cls.feedthrough[name]) for name in names}
    declared = {name: tuple(inputs) for name, inputs in cls.feedthrough.items()}
    return equations_depend(cls) | declared


def feedthrough_of(cls: type[Component]) -> Through:
    """Return the inputs that act on each output at the same instant.

    A declaration stands for what is found of the outputs that it names.
    """
    outputs = [name for name, port in cls.ports.items() if port.kind == "output"]
    if all(name in cls.feedthrough for name in outputs):
        return {name: tuple(cls.feedthrough[name]) for name in outputs}
    through = found(cls).through
    return {name: tuple(cls.feedthrough.get(name, through[name])) for name in outputs}


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
