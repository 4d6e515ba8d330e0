"""Propulsors, foils and ballast of a craft: those whose thrust, or whose command, is not there."""

from __future__ import annotations

import re
from collections.abc import Container, Iterable, Iterator

from ...errors import InputError
from ...fmi.instance import Variable
from ...model.units import unit
from ..part import Part
from ..paths import split_path
from ..system import System

_COMMANDS = {
    "propulsors": (("propulsor_order", "p"), ("propulsor_angle", "p")),
    "foils": (("foil_angle", "f"),),
    "ballasts": (("ballast_order", "b"),),
}
"""Inputs of each sort of parts, and the letter of their axes."""
_BY_LAW = ("thruster", "azimuth", "outboard", "tunnel", "jet")
"""Kinds whose largest thrust is a parameter, and follows from nothing else."""


def require_thrusts(system: System) -> None:
    """Raise InputError for a propulsor of a craft whose largest thrust nobody gave."""
    for part in system.parts.values():
        if "propulsors" not in part.given or not _is_craft(part, "propulsors"):
            continue
        for number, kind in enumerate(_kinds(part, "propulsors"), 1):
            if kind in _BY_LAW and f"propulsor_thrust_{number}.ahead" not in part.given:
                raise InputError(
                    f"{part.given['propulsors'].origin}: propulsors: part {number}, {kind}, has no "
                    'thrust: give its largest ahead and astern, as in thrust = ["50 N", "40 N"]'
                )


def uncommanded(system: System, moved: Container[str] = ()) -> dict[str, str]:
    """Return notes on the parts that no connection and no setting moves, by their inputs.

    Inputs that are ``moved`` otherwise are left out; of angles those of parts that do not turn.
    """
    fed = _fed(system)
    notes = {}
    for name, part, sort, number, kind in _parts(system):
        for port, letter in _COMMANDS[sort]:
            scalar = f"{port}.{letter}{number}"
            path = f"{name}.{scalar}"
            others = path in moved or f"{name}.{port}" in moved or scalar in part.given
            if (name, scalar) in fed or others or not _moves(part, port, number):
                continue
            origin = part.given[sort].origin if sort in part.given else name
            notes[path] = (
                f"nothing feeds the command {path}: {sort}, part {number}, {kind}, rests ({origin})"
            )
    return notes


def vacant(system: System) -> set[str]:
    """Return the inputs of parts that a craft does not have; whole ports where it has none."""
    found = set()
    for name, part in system.parts.items():
        for sort in _COMMANDS:
            if not _is_craft(part, sort):
                continue
            count = len(_kinds(part, sort))
            for port, _ in _COMMANDS[sort]:
                scalars = part.instance.variables.ports.get(port, [])[count:]
                found |= {f"{name}.{scalar.name}" for scalar in scalars}
                found |= set() if count else {f"{name}.{port}"}
    return found


def _parts(system: System) -> Iterator[tuple[str, Part, str, int, str]]:
    """Yield component, sort, number and kind of the parts of all craft."""
    for name, part in system.parts.items():
        for sort in _COMMANDS:
            if _is_craft(part, sort):
                for number, kind in enumerate(_kinds(part, sort), 1):
                    yield name, part, sort, number, kind


def _is_craft(part: Part, sort: str) -> bool:
    """Return whether a component takes the orders of a sort of parts, and does not give them."""
    port, letter = _COMMANDS[sort][0]
    first = part.instance.variables.get(f"{port}.{letter}1")
    return first is not None and first.causality == "input"


def _kinds(part: Part, sort: str) -> list[str]:
    given = part.given.get(sort)
    return str(part.instance.variables[sort].start if given is None else given.value).split()


def _moves(part: Part, port: str, number: int) -> bool:
    """Return whether an input has an effect: an angle has one where the range of it has a width."""
    if port != "propulsor_angle":
        return True
    ends = [f"propulsor_angle_limit_{number}.{end}" for end in ("from", "to")]
    least, most = (part.given[end].value if end in part.given else 0.0 for end in ends)
    return least != most


def _fed(system: System) -> set[tuple[str, str]]:
    return {connection.target for connection in (*system.connections, *system.initial)}


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
