"""Dependencies of each output of a class at the same instant: declared, or found."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from weakref import WeakKeyDictionary

from ...errors import InputError
from ...model.component import Component
from ...model.plant import Plant
from .equations import equations_depend
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
