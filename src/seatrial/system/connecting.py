"""Connections of a rig: from ports and terminals as written to scalars, with units converted."""

from __future__ import annotations

from dataclasses import dataclass, field

from ..errors import InputError
from ..fmi.instance import Variable
from ..model.ports import FRAMES
from ..model.units import conversion
from .joining import End, Group, Resolver, kind_of
from .references.values import port_scalars
from .rig import ConnectionEntry, Feed, Scope
from .system import Connection, Joint, System

_SOURCES = ("output",)
_TARGETS = ("input", "tunable parameter")


def connect(system: System) -> None:
    """Make the connections of a system's rig, port by port and scalar by scalar.

    Those from outside its file come first, and leave out what their targets are fed by in it.
    Raises InputError for names that are none, ports that do not fit, inputs with two sources,
    terminals that have nothing in common, and inputs of a plug that are not met.
    """
    making = _Making(system, Resolver(system.parts, system.rig.top))
    for feed in system.rig.feeds:
        making.feed(feed)
    for scope in system.rig.top.all():
        for written, entry in scope.connections():
            making.connect(scope, written, entry)


@dataclass
class _Making:
    """Connections made so far."""

    system: System
    resolver: Resolver
    feeders: dict[tuple[str, str], str] = field(default_factory=dict)
    """What feeds a scalar, by component and name."""
    outside: set[tuple[str, str]] = field(default_factory=set)
    """Scalars that are fed from outside the rig's file."""

    def feed(self, feed: Feed) -> None:
        """Make a connection from outside the rig's file."""
        source, target = (
            self.resolver.anywhere(name, feed.where) for name in (feed.source, feed.target)
        )
        if not (source.is_port and target.is_port):
            raise InputError(f"{feed.where}: {feed.target} is a terminal, a port is needed")
        for end in target.members[""]:
            one = _one(source.members[""], feed.source, feed.where)
            self._feed(one, end, ConnectionEntry(to=feed.target), feed.where)
        self.outside.update(self.feeders)

    def connect(self, scope: Scope, written: str, entry: ConnectionEntry) -> None:
        """Make one connection as written in the file of ``scope``."""
        where = f'{scope.read_from.where}: connections."{written}"'
        # A mark on one side makes both optional: not every autopilot has what a vehicle shows.
        names = written.removesuffix("?"), entry.to.removesuffix("?")
        mark = "" if names == (written, entry.to) else "?"
        source = self.resolver.named(scope, names[0] + mark, where, _SOURCES)
        target = self.resolver.named(scope, names[1] + mark, where, _TARGETS)
        if source is None or target is None:
            missing = [n for n, of in zip(names, (source, target), strict=True) if of is None]
            self._leave_open(scope, written, entry, f"there is no {' and no '.join(missing)}")
        elif source.is_port and target.is_port:
            for end in target.members[""]:
                self._feed(_one(source.members[""], written, where), end, entry, where)
        elif source.is_port or target.is_port:
            port, terminal = (written, entry.to) if source.is_port else (entry.to, written)
            raise InputError(f"{where}: {port} is a port and {terminal} a terminal")
        elif not self._join(source, target, written, entry, where):
            sides = f"{written} {self._directions(source)}; {entry.to} {self._directions(target)}"
            if not mark:
                raise InputError(f"{where}: nothing joins: {sides}")
            self._leave_open(scope, written, entry, f"nothing joins: {sides}")

    def _leave_open(self, scope: Scope, written: str, entry: ConnectionEntry, why: str) -> None:
        inside = f"in {scope.path}, " if scope.path else ""
        self.system.open.append(f'{inside}"{written}" = "{entry.to}": {why}')

    def _join(self, a: Group, b: Group, written: str, entry: ConnectionEntry, where: str) -> bool:
        """Connect two terminals, each member from its output to its inputs; say if any was."""
        if (entry.factor, entry.offset, entry.convert) != (1.0, 0.0, True) or entry.mapping:
            raise InputError(f"{where}: terminals take no factor, offset, convert or mapping")
        met: set[str] = set()
        for member in (m for m in a.members if m in b.members):
            for here, there in ((a, b), (b, a)):
                sources = self._of_kind(here.members[member], _SOURCES)
                for target in self._of_kind(there.members[member], _TARGETS):
                    if sources:
                        source = _one(sources, f"{written}.{member}", where)
                        met.add(target.name)
                        if not self._is_fed_so(source, target):
                            self._feed(source, target, entry, f"{where}, {member}")
        for name, group in ((written, a), (entry.to, b)):
            if met and group.rule == "plug":
                self._refuse_open(name, group, met, where)
        return bool(met)

    def _is_fed_so(self, source: End, target: End) -> bool:
        """Say if another member made the same connection: ``heel`` is in ``roll_pitch`` too."""
        if target.sum_of:
            return False
        ones, others = self.resolver.variables(source), self.resolver.variables(target)
        return len(ones) == len(others) and all(
            self.feeders.get((target.component, other.name)) == f"{source.component}.{one.name}"
            for one, other in zip(ones, others, strict=True)
        )

    def _refuse_open(self, name: str, group: Group, met: set[str], where: str) -> None:
        for member, ends in group.members.items():
            for end in self._of_kind(ends, ("input",)):
                if end.name not in met:
                    raise InputError(f"{where}: nothing gives {name} its {member} ({end.name})")

    def _directions(self, group: Group) -> str:
        """Return what a terminal gives and takes, for a message."""
        kinds = {"gives": _SOURCES, "takes": _TARGETS}
        named = {
            verb: [m for m, ends in group.members.items() if self._of_kind(ends, kind)]
            for verb, kind in kinds.items()
        }
        return " and ".join(f"{verb} {', '.join(names)}" for verb, names in named.items() if names)

    def _of_kind(self, ends: list[End], wanted: tuple[str, ...]) -> list[End]:
        return [end for end in ends if kind_of(self.resolver.variables(end)[0]) in wanted]

    def _feed(self, source: End, target: End, entry: ConnectionEntry, where: str) -> None:
        """Connect two ports, scalar by scalar; of a sum, the first term that is free."""
        if target.sum_of:
            target = self._free_term(target, where)
        sources = self._scalars(source, _SOURCES, where, "calculatedParameter")
        # A fixed parameter takes what has its value before the run.
        fixed = "fixed parameter" if all(map(_is_initial, sources)) else ""
        targets = self._scalars(target, _TARGETS, where, fixed)
        if len(sources) != len(targets):
            raise InputError(
                f"{where}: {source.name} has {len(sources)} scalars, "
                f"{target.name} has {len(targets)}"
            )
        ends = [
            (one, other)
            for one, other in zip(sources, targets, strict=True)
            if (target.component, other.name) not in self.outside
        ]
        if not ends:
            return
        mapping = tuple(map(tuple, entry.mapping))
        joint = Joint(source.name, target.name, entry.factor, entry.offset, mapping)
        self.system.joints.append(joint)
        for one, other in ends:
            place = (target.component, other.name)
            if place in self.feeders:
                raise InputError(
                    f"{where}: {'.'.join(place)} is already fed by {self.feeders[place]}; "
                    "an input takes one connection"
                )
            self.feeders[place] = f"{source.component}.{one.name}"
            made = _scalar(source, one, target, other, entry, where)
            # An output that never changes may still be overridden during the run.
            once = one.causality != "output" or kind_of(other) == "fixed parameter"
            (self.system.initial if once else self.system.connections).append(made)

    def _free_term(self, target: End, where: str) -> End:
        variables = self.system.parts[target.component].instance.variables
        feeders = []
        for term in target.sum_of:
            names = [(target.component, v.name) for v in port_scalars(variables, term)]
            feeding = [self.feeders[name] for name in names if name in self.feeders]
            if not feeding:
                return End(target.component, term)
            feeders.append(feeding[0])
        raise InputError(
            f"{where}: all {len(feeders)} terms of {target.name} are fed, by "
            f"{', '.join(feeders)}; it takes no more"
        )

    def _scalars(
        self, end: End, wanted: tuple[str, ...], where: str, also: str = ""
    ) -> list[Variable]:
        scalars = self.resolver.variables(end)
        for variable in scalars:
            if kind_of(variable) not in (*wanted, also):
                needed = " or ".join(wanted)
                raise InputError(f"{where}: {end.name} is {kind_of(variable)}, {needed} is needed")
        return scalars


def _is_initial(source: Variable) -> bool:
    """Say if a source has its value once the system is initialised, and keeps it."""
    return source.causality == "calculatedParameter" or source.variability in ("constant", "fixed")


def _one(ends: list[End], written: str, where: str) -> End:
    if len(ends) > 1:
        raise InputError(
            f"{where}: {written} is {' and '.join(p.name for p in ends)}: one is needed"
        )
    return ends[0]


def _scalar(
    source: End, one: Variable, target: End, other: Variable, entry: ConnectionEntry, where: str
) -> Connection:
    """Return the connection of two scalars."""
    factor, offset = _converting(one, other, entry, where)
    if (entry.factor, entry.offset) != (1.0, 0.0):
        factor, offset = entry.factor * factor, entry.factor * offset + entry.offset
    if (factor, offset) != (1.0, 0.0) and other.type is not float:
        raise InputError(f"{where}: {target.name} is no real number to transform")
    to_real = (one.type, other.type) == (int, float)
    ends = (source.component, one.name), (target.component, other.name)
    return Connection(*ends, factor, offset, to_real, _mapping(one, entry, where))


def _mapping(source: Variable, entry: ConnectionEntry, where: str) -> dict[bool | int, bool | int]:
    """Return what values of an integer or a switch become. Raises InputError."""
    found: dict[bool | int, bool | int] = {}
    for pair in entry.mapping:
        if len(pair) != 2 or not all(type(value) is source.type for value in pair):
            kind = {int: "integers", bool: "switches"}.get(source.type, "nothing: it is a number")
            raise InputError(f"{where}: mapping: pairs of {kind} are needed, found {pair!r}")
        if pair[0] in found:
            raise InputError(f"{where}: mapping: {pair[0]!r} is mapped twice")
        found[pair[0]] = pair[1]
    return found


def _converting(
    source: Variable, target: Variable, entry: ConnectionEntry, where: str
) -> tuple[float, float]:
    """Return the factor and offset between two ends; raise InputError if they do not fit."""
    if source.type is not target.type and (source.type, target.type) != (int, float):
        raise InputError(
            f"{where}: {source.name} is {source.type.__name__}, "
            f"{target.name} is {target.type.__name__}"
        )
    if source.frame and target.frame and source.frame != target.frame:
        raise InputError(f"{where}: {_frames(source, target)}")
    if not (entry.convert and source.unit and target.unit and target.type is float):
        return 1.0, 0.0
    try:
        return conversion(source.measure, target.measure)
    except InputError as error:
        raise InputError(f"{where}: {source.name} to {target.name}: {error}") from None


def _frames(source: Variable, target: Variable) -> str:
    """Return what is wrong between two frames, and what would be right."""
    one, other = FRAMES[source.frame], FRAMES[target.frame]
    return (
        f"{source.name} is in {one}; {target.name} in {other}. Connect an output in the same "
        "frame (sensors give position_n and velocity_n, craft attachment_velocity in {n}), or "
        "a component between that turns it by the attitude"
    )
