"""Power bonds: pairs of connections, there and back between two components, that carry a power."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from ...errors import InputError, unknown
from ...fmi.instance import Variables
from ..paths import joined
from ..references.values import port_names, port_scalars
from ..system import Bond, Connection, System


@dataclass(frozen=True)
class _End:
    """One input of a bond as written, with the connections of its scalars."""

    written: str
    connections: tuple[Connection, ...]

    @property
    def ways(self) -> set[tuple[str, str]]:
        """The components that feed and that are fed."""
        return {(one.source[0], one.target[0]) for one in self.connections}

    def __str__(self) -> str:
        ways = ", ".join(f"{source} -> {target}" for source, target in sorted(self.ways))
        return f"{self.written} ({ways})"


def bonds_of(system: System) -> list[Bond]:
    """Return the power bonds of a connected system, those of rigs inside too.

    A file names a bond by the two inputs that its connections feed. Raises InputError, with file
    and key, for an input that does not exist or that nothing feeds, and for two that are not there
    and back between two components.
    """
    by_target = {connection.target: connection for connection in system.connections}
    found: list[Bond] = []
    taken: dict[tuple[str, str], str] = {}
    for scope in system.rig.top.all():
        for name, inputs in scope.file.bonds.items():
            where = f"{scope.read_from.where}: bonds.{name}"
            flow, effort = (
                _end(system, by_target, joined(scope.path, written), where) for written in inputs
            )
            _refuse_unlike(system, flow, effort, where)
            bond = joined(scope.path, name)
            for connection in (*flow.connections, *effort.connections):
                other = taken.setdefault(connection.target, bond)
                if other != bond:
                    raise InputError(f"{where}: {'.'.join(connection.target)} is in {other} too")
            pairs = zip(flow.connections, effort.connections, strict=True)
            found.append(Bond(bond, tuple((one.target, other.target) for one, other in pairs)))
    return found


def _end(
    system: System, by_target: Mapping[tuple[str, str], Connection], written: str, where: str
) -> _End:
    connections = []
    for part, port in system.located(written, where):
        variables = part.instance.variables
        scalars = port_scalars(variables, port)
        if not scalars:
            inputs = [n for n in port_names(variables) if _is_input(variables, n)]
            raise InputError(f"{where}: {part.name}: {unknown('input', port, inputs)}")
        for variable in scalars:
            name = f"{part.name}.{variable.name}"
            if variable.causality != "input":
                raise InputError(
                    f"{where}: {name} is {variable.causality}; a bond names the two inputs that "
                    "its connections feed"
                )
            connection = by_target.get((part.name, variable.name))
            if connection is None:
                raise InputError(f"{where}: {name}: no connection feeds it")
            source = system.parts[connection.source[0]]
            if source.is_sum:
                raise InputError(
                    f"{where}: {name} is fed by the sum {source.name}; a bond is between two "
                    "components"
                )
            fed_by = source.instance.variables[connection.source[1]]
            if not variable.type is fed_by.type is float:
                raise InputError(f"{where}: {name}: a power is a product of real numbers")
            connections.append(connection)
    return _End(written, tuple(connections))


def _is_input(variables: Variables, name: str) -> bool:
    scalars = port_scalars(variables, name)
    return bool(scalars) and scalars[0].causality == "input"


def _refuse_unlike(system: System, flow: _End, effort: _End, where: str) -> None:
    """Raise InputError if two inputs are no pair."""
    there, back = flow.ways, {(target, source) for source, target in effort.ways}
    if len(there) != 1 or there != back or any(one == other for one, other in there):
        raise InputError(
            f"{where}: a bond is one connection there and one back between two components, found "
            f"{flow} and {effort}"
        )
    if len(flow.connections) != len(effort.connections):
        raise InputError(
            f"{where}: {flow.written} has {len(flow.connections)} scalars, {effort.written} has "
            f"{len(effort.connections)}"
        )
