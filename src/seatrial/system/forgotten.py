"""Forces and commands that nothing feeds: a forgotten connection, in all likelihood."""

from __future__ import annotations

import re
from collections.abc import Container, Iterable

from ..errors import InputError
from ..fmi.instance import Variable
from ..model.units import unit
from .fitted_parts import uncommanded
from .paths import split_path
from .system import System

_ENERGY = re.compile("J|W")
_FORCES = (unit("N").exponents, unit("N.m").exponents)


def forgotten(system: System, moved: Container[str] = ()) -> dict[str, str]:
    """Return notes on the forces, moments and commands that nothing feeds, by their inputs.

    A force or moment is known by its unit, a command by its role. A sum of forces is meant where
    no force reaches its component. The parts of a craft are as `uncommanded` says. Inputs that are
    ``moved`` otherwise are left out.
    """
    notes = {}
    for path in system.unconnected_inputs():
        component, port = split_path(system.parts, path)
        variables = system.parts[component].instance.variables
        one = variables.get(port) or variables.ports[port][0]
        if path not in moved and (what := _what(one)) is not None:
            start = "its start" if one.start is None else _shown(one)
            notes[path] = f"nothing feeds the {what} {path}: it stays at {start}"
    notes |= uncommanded(system, moved)
    for path, what in _empty_sums(system):
        notes[path] = f"nothing feeds the {what} {path}: none of its terms is connected"
    return notes


def _empty_sums(system: System) -> Iterable[tuple[str, str]]:
    """Yield the sums of forces of components that no force and no command reaches at all."""
    open_ones = {*system.unconnected_inputs(optional=True), *system.unconnected_inputs()}
    for name, part in system.parts.items():
        variables = part.instance.variables
        inputs = {
            variables.port_of(v.name) or v.name: v
            for v in variables.values()
            if v.causality == "input"
        }
        driving = {f"{name}.{port}" for port, one in inputs.items() if _what(one) is not None}
        if not driving <= open_ones:
            continue
        for total, terms in variables.terms.items():
            if (what := _what(inputs[terms[0]])) is not None:
                yield f"{name}.{total}", what


def _what(variable: Variable) -> str | None:
    if variable.role == "command":
        return "command"
    if variable.type is not float or not variable.unit or _ENERGY.search(variable.unit):
        return None
    measure = variable.measure  # of a unit of its own, an FMU's definition
    try:
        exponents = (unit(measure) if isinstance(measure, str) else measure).exponents
    except InputError:
        return None
    return None if exponents not in _FORCES else ("force", "moment")[_FORCES.index(exponents)]


def _shown(variable: Variable) -> str:
    return f"{variable.start!r} {'' if variable.unit == '1' else variable.unit}".rstrip()
