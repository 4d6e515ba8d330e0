"""Names in a rig's connections: ports, terminals, and what rigs inside it show."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from ..errors import InputError, unknown
from ..fmi.instance import Variable, Variables
from ..model.terminals import Rule
from .part import Part
from .paths import joined
from .references.values import port_names, port_scalars
from .rig import Scope, Shown

_PLUGS = ("actuators", "wrench")
"""Terminals put together in a rig whose inputs must all be met."""


@dataclass(frozen=True)
class End:
    """A port, a scalar of one, or the sum of several inputs, of one component."""

    component: str
    port: str
    sum_of: tuple[str, ...] = ()
    """Of a sum, the inputs that are its terms."""

    @property
    def name(self) -> str:
        """``component.port``."""
        return f"{self.component}.{self.port}"


@dataclass
class Group:
    """What a name in a rig stands for: a port (one member without a name) or a terminal."""

    members: dict[str, list[End]] = field(default_factory=dict)
    rule: Rule = "bus"

    @property
    def is_port(self) -> bool:
        """Say if it is a port, or several that are used as one."""
        return "" in self.members

    @property
    def ends(self) -> list[End]:
        """All ports of all members."""
        return [end for ends in self.members.values() for end in ends]

    def add(self, other: Group) -> None:
        """Add the members of another group."""
        for member, ends in other.members.items():
            self.members.setdefault(member, []).extend(ends)
        self.rule = "plug" if "plug" in (self.rule, other.rule) else "bus"


class Resolver:
    """Says what names mean, in the rig at the top and in those inside it.

    Raises InputError, which begins with the ``where`` of each call, for a name that is none.
    """

    def __init__(self, parts: Mapping[str, Part], top: Scope) -> None:
        self._parts, self._top = parts, top

    def named(
        self, scope: Scope, written: str, where: str, wanted: Sequence[str] = ()
    ) -> Group | None:
        """Return what ``written`` means in the file of ``scope``.

        None for a name that ends in ``?`` and that a component or rig does not have. ``wanted``
        are the kinds of ports that a message about an unknown one offers.
        """
        name, optional = written.removesuffix("?"), written.endswith("?")
        head, _, rest = name.partition(".")
        if head in scope.inner and scope.inner[head].is_open:
            return self.named(scope.inner[head], rest, where, wanted)
        if head in scope.inner:
            return self._shown(scope.inner[head], head, rest, optional, where)
        if head in scope.file.components:
            return self._of_component(joined(scope.path, head), rest, optional, where, wanted)
        inside = f" in {scope.path}, the rig {scope.read_from.name}" if scope.path else ""
        raise InputError(f"{where}: {unknown('component', head, scope.file.components)}{inside}")

    def anywhere(self, written: str, where: str) -> Group:
        """Return what a path means, seen from outside: a port at any depth, or what is shown."""
        scope, rest = self._top, written
        while True:
            head, _, behind = rest.partition(".")
            if head not in scope.inner or behind.partition(".")[0] in scope.inner[head].file.shows:
                break
            scope, rest = scope.inner[head], behind
        group = self.named(scope, rest, where)
        assert group is not None
        return group

    def shown_outside(self) -> Iterator[End]:
        """Yield the ports that the rig at the top shows, of what it has with its choices."""
        for _, group in self.shown():
            yield from group.ends

    def shown(self) -> Iterator[tuple[str, Group]]:
        """Yield what the rig at the top shows, by name, of what it has with its choices."""
        for name, written in self._top.file.shows.items():
            where = f"{self._top.read_from.where}: shows.{name}"
            group = self._put_together(self._top, name, written, where)
            if group is not None:
                yield name, group

    def variables(self, end: End) -> list[Variable]:
        """Return the scalars of a end; of a sum, those of its first term."""
        variables = self._parts[end.component].instance.variables
        return port_scalars(variables, end.sum_of[0] if end.sum_of else end.port)

    def _shown(
        self, scope: Scope, name: str, written: str, optional: bool, where: str
    ) -> Group | None:
        """Return what a rig inside shows under a name, or a part of that."""
        shown, _, member = written.partition(".")
        shows = scope.file.shows
        if shown not in shows:
            if optional:
                return None
            found = unknown("name", shown, shows) if shows else "it shows nothing"
            raise InputError(f"{where}: {name} does not show {shown!r}: {found}")
        inside = f"{scope.read_from.where}: shows.{shown}"
        group = self._put_together(scope, shown, shows[shown], inside)
        if group is None and not optional:
            raise InputError(f"{where}: {name} does not show {shown!r} with these choices")
        return group if group is None or not member else self._part(group, member, where)

    def _put_together(self, scope: Scope, shown: str, written: Shown, where: str) -> Group | None:
        if isinstance(written, str):
            return self.named(scope, written, where)
        group = Group()
        if isinstance(written, list):
            for each in written:
                found = self._put_together(scope, shown, each, where)
                if found is not None:
                    group.add(found)
            return group if group.members else None
        for member, each in written.items():
            found = self.named(scope, each, f"{where}.{member}")
            if found is None:
                continue
            if not found.is_port:
                raise InputError(f"{where}.{member}: {each} is a terminal, a port is needed")
            group.members[member] = found.members[""]
        group.rule = "plug" if shown in _PLUGS else "bus"
        return group

    def _part(self, group: Group, written: str, where: str) -> Group:
        """Return a member of a terminal, or a scalar of a port."""
        member, axis = ("", written) if group.is_port else written.partition(".")[::2]
        if member not in group.members:
            raise InputError(f"{where}: {unknown('member', member, group.members)}")
        ends = group.members[member]
        if axis:
            ends = [End(p.component, f"{p.port}.{axis}") for p in ends]
            for end in ends:
                if not self.variables(end):
                    names = [v.name for v in self.variables(End(end.component, end.port))]
                    raise InputError(f"{where}: {unknown('scalar', end.port, names)}")
        return Group({"": ends})

    def _of_component(
        self, path: str, rest: str, optional: bool, where: str, wanted: Sequence[str]
    ) -> Group | None:
        instance = self._parts[path].instance
        name, _, member = rest.partition(".")
        scalars = port_scalars(instance.variables, rest)
        # A terminal may have the name of what nothing is connected to: a fixed parameter, or what
        # FMUs say of their networks beside the data and clocks that are the terminal's.
        members = instance.terminals[name].members if name in instance.terminals else {}
        made = any(
            instance.variables[m].is_made for m in members.values() if m in instance.variables
        )
        other = scalars and (made or kind_of(scalars[0]) == "fixed parameter")
        if (scalars and not (members and other)) or rest in instance.variables.terms:
            return Group({"": [self._end(path, rest)]})
        if name in instance.terminals:
            terminal = instance.terminals[name]
            ends = {m: [self._end(path, port)] for m, port in terminal.members.items()}
            group = Group(ends, terminal.rule)
            return self._part(group, member, where) if member else group
        if optional:
            return None
        variables = instance.variables
        fitting = {n: v for n, v in variables.items() if not wanted or kind_of(v) in wanted}
        known = [*port_names(Variables(fitting)), *variables.terms, *instance.terminals]
        raise InputError(f"{where}: {path}: {unknown(' or '.join(wanted) or 'port', rest, known)}")

    def _end(self, path: str, port: str) -> End:
        variables: Variables = self._parts[path].instance.variables
        return End(path, port, tuple(variables.terms.get(port, ())))


def kind_of(variable: Variable) -> str:
    """Return a variable's causality; of a parameter, its variability too."""
    if variable.causality != "parameter":
        return variable.causality
    return f"{variable.variability} parameter"
