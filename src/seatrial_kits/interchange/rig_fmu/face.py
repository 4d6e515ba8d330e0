"""Variables and terminals that a rig has as one FMU: what its components have and nothing feeds."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

from seatrial.fmi.instance import Variable, Variables
from seatrial.model.ports import BYTES
from seatrial.model.terminals import Terminal
from seatrial.sim.network import Name, sources_by_target
from seatrial.system.joining import End, Group, Resolver
from seatrial.system.system import System

_KEPT_ROLES = ("seed", "wall-clock", "address", "run-folder", "exceeded", *BYTES)
"""Roles that mean the same for one component and for several in one."""


@dataclass(frozen=True)
class Face:
    """What a host sees of a rig: ``component.port``, value references from zero on."""

    variables: Variables
    targets: Mapping[str, tuple[Name, ...]]
    """Of each variable, the components' own: inputs that the rig shows as one are one here."""
    terminals: Mapping[str, Terminal]
    """Those that the rig shows, of what is open."""
    through: Mapping[str, list[str]]
    """Of each output, the inputs that act on it at the same instant."""


def face_of(system: System, *, at_once: bool = True) -> Face:
    """Return the face of an assembled rig whose parameters are given.

    ``at_once``: outputs follow inputs at the same instant, with all but plain Jacobi.
    """
    fed = {one.target for one in (*system.connections, *system.initial)}
    shown = dict(Resolver(system.parts, system.rig.top).shown())
    joined = _joined(system, shown, fed)
    variables, targets = Variables(), dict[str, tuple[Name, ...]]()
    taken = {name for names in joined.values() for name in names[1:]}
    for component, part in system.parts.items():
        for name, variable in part.instance.variables.items():
            own = component, name
            if own in fed or own in taken or variable.causality not in _SEEN:
                continue
            whole = ".".join(own)
            targets[whole] = joined.get(own, (own,))
            variables[whole] = _seen(variable, whole, component, len(variables), part.given)
    terminals = {name: _terminal(group, variables) for name, group in shown.items()}
    through = _through(system, targets) if at_once else {}
    open_ones = {name: one for name, one in terminals.items() if one.members}
    return Face(variables, targets, open_ones, through)


_SEEN = ("parameter", "input", "output")


def _seen(
    variable: Variable, name: str, component: str, reference: int, given: Mapping[str, object]
) -> Variable:
    start = variable.start
    if variable.causality != "output" and variable.name in given:
        start = given[variable.name].value  # type: ignore[attr-defined]
    return replace(
        variable,
        name=name,
        reference=reference,
        start=start,
        role=variable.role if variable.role in _KEPT_ROLES else "",
        term_of=f"{component}.{variable.term_of}" if variable.term_of else "",
    )


def _joined(
    system: System, shown: Mapping[str, Group], fed: set[Name]
) -> dict[Name, tuple[Name, ...]]:
    """Return, by the first of them, inputs that the rig shows as one and that start alike."""
    joined: dict[Name, tuple[Name, ...]] = {}
    seen: set[Name] = set()
    for group in shown.values():
        for ends in group.members.values():
            if len(ends) < 2 or any(end.sum_of for end in ends):
                continue
            of_ends = [_scalars(system, end) for end in ends]
            if len({len(scalars) for scalars in of_ends}) != 1:
                continue
            for scalars in zip(*of_ends, strict=True):
                names = tuple(name for name, _ in scalars)
                if not (seen.isdisjoint(names) and fed.isdisjoint(names)):
                    continue
                if len({_start_of(system, *one) for one in scalars}) == 1:
                    joined[names[0]] = names
                    seen.update(names)
    return joined


def _scalars(system: System, end: End) -> list[tuple[Name, Variable]]:
    found = Resolver(system.parts, system.rig.top).variables(end)
    return [((end.component, v.name), v) for v in found if v.causality == "input"]


def _start_of(system: System, name: Name, variable: Variable) -> tuple[object, ...]:
    given = system.parts[name[0]].given.get(name[1])
    return variable.type, variable.unit, variable.start if given is None else given.value


def _terminal(group: Group, variables: Variables) -> Terminal:
    """Return a terminal of what a host can reach of a group; of a port, none."""
    if group.is_port:
        return Terminal()
    members = {
        member: ends[0].name
        for member, ends in group.members.items()
        if any(ends[0].name in known for known in (variables, variables.ports, variables.terms))
    }
    return Terminal(members, group.rule)


def _through(system: System, targets: Mapping[str, tuple[Name, ...]]) -> dict[str, list[str]]:
    """Return which inputs of the rig act on each output at once, through all components."""
    source_of = sources_by_target(system)
    known = {name: whole for whole, names in targets.items() for name in names}

    def reached(output: Name) -> Iterator[str]:
        waiting, seen = [output], {output}
        while waiting:
            component, name = waiting.pop()
            for own in system.parts[component].instance.feedthrough.get(name, ()):
                source = source_of.get((component, own))
                if source is None and (component, own) in known:
                    yield known[component, own]
                elif source is not None and source not in seen:
                    seen.add(source)
                    waiting.append(source)

    place = {name: i for i, name in enumerate(targets)}
    outputs = [
        (component, variable.name)
        for component, part in system.parts.items()
        for variable in part.instance.variables.values()
        if variable.causality == "output"
    ]
    return {
        ".".join(output): sorted(set(reached(output)), key=place.__getitem__) for output in outputs
    }
