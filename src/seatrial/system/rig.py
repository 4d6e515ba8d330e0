"""Rigs: which components, with which parameters, connected how (``harness/rigs/*.toml``)."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field

from ..errors import InputError
from ..fmi.files.options import Interface
from ..model.component import NS
from ..model.units import quantity
from .files import FileModel, Source, validated
from .paths import joined
from .references.values import Setting
from .registry import ALGORITHMS

LONGEST_S = 9.0e9
"""Times are counted in ns in 64 bits: 285 years."""
_IDENTIFIER = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")


class IterationEntry(FileModel):
    """How the iterated algorithm repeats a step."""

    tolerance: float = Field(default=1e-6, gt=0.0, allow_inf_nan=False)
    """Of every connection's value, relative to the nominal value of its output."""
    count: int = Field(default=10, ge=1, le=1000)
    """At most so many repetitions."""
    relaxation: float = Field(default=1.0, gt=0.0, le=1.0)
    """Share of each repetition's change that is applied."""


class EccoEntry(FileModel):
    """How the algorithm ecco controls its step; see `ecco.Ecco` for the equations."""

    step: str | None = None
    """The first step, also after an event; a tenth of ``max_step`` without it."""
    min_step: str | None = None
    """A thousandth of ``max_step`` without it."""
    max_step: str | None = None
    """The rig's communication step without it."""
    safety_factor: float = Field(default=0.9, gt=0.0, le=1.0)
    """alpha, which each new step is multiplied by."""
    min_change: float = Field(default=0.2, gt=0.0, le=1.0)
    """At least so many times the step before."""
    max_change: float = Field(default=1.5, ge=1.0, le=1e6)
    """At most so many times the step before."""
    proportional_gain: float = Field(default=0.2, ge=0.0, le=10.0)
    integral_gain: float = Field(default=0.15, ge=0.0, le=10.0)
    relative_tolerance: float = Field(default=1e-6, ge=0.0, le=1e6)
    """Of the greatest energy residual of the bonds."""
    absolute_tolerance: float = Field(default=1e-6, ge=1e-30, le=1e30)
    """Energy residual of a bond in one step, J; in the units of its connections."""

    def lengths(self, step_ns: int, where: str) -> tuple[int, int, int]:
        """Return the shortest, first and longest step, ns; ``step_ns`` is the communication step.

        Raises InputError, saying ``where``, for lengths that do not fit each other.
        """

        def length(key: str, written: str | None, default_ns: int) -> int:
            return default_ns if written is None else duration_ns(written, f"{where}.{key}")

        longest = length("max_step", self.max_step, step_ns)
        shortest = length("min_step", self.min_step, max(1, longest // 1000))
        first = length("step", self.step, max(shortest, longest // 10))
        if not 0 < shortest <= first <= longest:
            raise InputError(
                f"{where}: 0 < min_step <= step <= max_step is needed, found {shortest / NS!r} s, "
                f"{first / NS!r} s and {longest / NS!r} s"
            )
        if shortest > step_ns:
            raise InputError(
                f"{where}.min_step: {shortest / NS!r} s is longer than the communication step of "
                f"{step_ns / NS!r} s, at which steps end"
            )
        return shortest, first, longest


class ConnectionEntry(FileModel):
    """One end of a connection with a linear transformation, after conversion of units."""

    to: str
    factor: float = Field(default=1.0, allow_inf_nan=False)
    offset: float = Field(default=0.0, allow_inf_nan=False)
    convert: bool = True
    """Units are converted, and must measure the same."""
    mapping: list[list[bool | int]] = Field(default_factory=list)
    """Pairs of values, from and to, of integers, enumerations and switches; others stay."""


Isolated = bool | Literal["sandboxed"]
"""Whether a component runs in a process of its own, and whether that is confined."""


class SumEntry(FileModel):
    """A sum of real signals; with a dimension, of vectors."""

    inputs: int = Field(ge=1, le=1000)
    dimension: int | None = Field(default=None, ge=1, le=1000)


class ComponentEntry(FileModel):
    """One component of a rig: an FMU, another rig, or a sum."""

    fmu: str = ""
    rig: str = ""
    """Another rig in the place of an FMU; it takes ``choices``, ``home``, ``variant``, ``set``."""
    sum: SumEntry | None = None
    """A sum in the place of an FMU."""
    choices: dict[str, str] = Field(default_factory=dict)
    home: list[str] | None = Field(default=None, min_length=3, max_length=3)
    """Latitude, longitude and altitude of the origin of all links in it."""
    variant: str | None = None
    parameters: str | None = None
    """A vehicle's parameter set: ``hydrone``, or ``hydrone.TABLE`` for a table of another name."""
    profile: str | None = None
    """A section of the rig's profile, ``sensors.gnss``, or of another, ``gloria:sensors.gnss``."""
    set: dict[str, Any] = Field(default_factory=dict)
    """By port; of a rig, by component.port inside it."""
    step: str | None = None
    """Of a rig, that of all components in it that say none themselves."""
    isolated: Isolated = False
    """It runs in a process of its own; in a sandbox, without network and files of others."""
    timeout: str | None = None
    """Longest wall time of one call of an isolated component."""
    interface: Interface | None = None
    """Of an FMU that has several; co-simulation if it has that."""
    tolerance: float | None = Field(default=None, gt=0.0, le=0.1, allow_inf_nan=False)
    """Relative: of an FMU's own solver in co-simulation, of ours in model exchange."""
    locals: list[str] = Field(default_factory=list)
    """Local variables of an FMU that are outputs in this rig."""

    @property
    def what(self) -> str:
        """What it is: the FMU as written, or a sum."""
        if self.sum is None:
            return self.fmu
        of = "" if self.sum.dimension is None else f" vectors of {self.sum.dimension}"
        return f"sum of {self.sum.inputs}{of}"


Shown = str | dict[str, str] | list[str | dict[str, str]]
"""A port or terminal; a terminal put together, port by member; or the union of several."""


class RigFile(FileModel):
    """The content of a rig file."""

    title: str = ""
    step: str | None = None
    """Communication step; None, or empty, is the shortest of the rigs inside."""
    tolerance: float | None = Field(default=None, gt=0.0, le=0.1, allow_inf_nan=False)
    """Relative tolerance for the FMUs of others in it, and in inner rigs, that say none."""
    algorithm: str = "jacobi"
    """A name of `registry.ALGORITHMS`."""
    iteration: IterationEntry | None = None
    ecco: EccoEntry | None = None
    bonds: dict[str, Annotated[list[str], Field(min_length=2, max_length=2)]] = Field(
        default_factory=dict
    )
    """Power bonds: the two inputs that the connections of each feed."""
    variant: str | None = None
    profile: str | None = None
    choices: dict[str, str] = Field(default_factory=dict)
    """Texts by name, which ``{name}`` stands for in this file and in inner rigs."""
    components: dict[str, ComponentEntry]
    connections: dict[str, str | ConnectionEntry | list[str | ConnectionEntry]] = Field(
        default_factory=dict
    )
    shows: dict[str, Shown] = Field(default_factory=dict)
    """What rigs around this one may connect to."""


@dataclass(frozen=True)
class Scope:
    """A rig's file at its place: the top, or a rig in the place of a component.

    ``choices`` are those of its file and of the rigs around it.
    """

    path: str
    """Names of the components on the way, joined by dots; empty at the top."""
    file: RigFile
    read_from: Source
    folder: Path
    """Where relative paths of its FMUs start."""
    choices: Mapping[str, str]
    inner: Mapping[str, Scope]
    variant: str | None = None
    home: tuple[str, str, str] | None = None
    is_open: bool = False
    """Whatever is inside may be connected to, by its path; otherwise what its file shows."""
    step: tuple[str, str] | None = None
    """Of its components that say none themselves, and where it is written."""
    tolerance: float | None = None
    """Of its FMUs that say none themselves."""

    def all(self) -> Iterator[Scope]:
        """Yield the rigs inside, the innermost first, then this one."""
        for scope in self.inner.values():
            yield from scope.all()
        yield self

    def connections(self) -> list[tuple[str, ConnectionEntry]]:
        """Return (from, where to) pairs of this file alone, as written."""
        pairs = []
        for source, targets in self.file.connections.items():
            for target in targets if isinstance(targets, list) else [targets]:
                entry = ConnectionEntry(to=target) if isinstance(target, str) else target
                pairs.append((source, entry))
        return pairs


@dataclass(frozen=True)
class Placed:
    """A component and the rig that it stands in."""

    entry: ComponentEntry
    scope: Scope
    name: str
    """In that rig."""

    @property
    def where(self) -> str:
        """File and key, for messages."""
        return f"{self.scope.read_from.where}: components.{self.name}"


@dataclass(frozen=True)
class Feed:
    """A connection from outside a rig's file, in the place of the one that its target has.

    Both ends are paths, at any depth, or names that rigs inside show.
    """

    source: str
    target: str
    where: str
    """Who says so, for messages."""


@dataclass(frozen=True)
class Rig:
    """A rig file with the rigs inside it, checked as far as it can be without its FMUs."""

    file: RigFile
    read_from: Source
    top: Scope
    feeds: tuple[Feed, ...] = ()

    @property
    def step_ns(self) -> int:
        """Communication step, ns."""
        where = f"{self.read_from.where}: step"
        if self.file.step is None:
            raise InputError(f"{where}: this key is missing, and no rig inside has one")
        return duration_ns(self.file.step, where)

    def changed(self, changes: Mapping[str, Any]) -> Rig:
        """Return the rig with keys of its own file replaced, ``step`` say. Raises InputError.

        Settings of an algorithm are replaced key by key; those of the file that another algorithm
        does not take are dropped.
        """
        before = self.file.model_dump(exclude_unset=True)
        content = {**before, **changes}
        for table, takes in RIG_TABLES.items():
            if table in changes:
                content[table] = {**(before.get(table) or {}), **changes[table]}
            elif "algorithm" in changes and not _takes(content["algorithm"], takes):
                content.pop(table, None)
        file = validated(RigFile, content, self.read_from.where)
        check_rig_file(file, self.read_from.where)
        return Rig(file, self.read_from, replace(self.top, file=file), self.feeds)

    def fed(self, name: str, entry: ComponentEntry, feeds: Iterable[Feed]) -> Rig:
        """Return the rig with a further component, and with inputs that are fed from outside.

        Raises InputError for a name that is there already.
        """
        if name in self.file.components:
            raise InputError(
                f"{self.read_from.where}: has a component {name!r}; what is fed into the rig has "
                "that name, too: rename the component"
            )
        components = {**self.file.components, name: entry}
        file = self.file.model_copy(update={"components": components})
        return Rig(file, self.read_from, replace(self.top, file=file), (*self.feeds, *feeds))

    def isolating(self, chosen: Mapping[str, Isolated]) -> Rig:
        """Return the rig with its components ``chosen``, by path, in processes of their own or not.

        Raises InputError for one that cannot be.
        """
        top = _isolating(self.top, chosen)
        return Rig(top.file, self.read_from, top, self.feeds)

    @cached_property
    def components(self) -> dict[str, Placed]:
        """Components by path, those of inner rigs in the place of these."""
        return dict(_placed(self.top))

    @property
    def settings(self) -> list[tuple[Scope, Setting]]:
        """What rigs set in the rigs inside them, the inner first."""
        return [
            (scope, Setting(f"{joined(scope.path, name)}.{key}", written, origin, folder))
            for scope in self.top.all()
            for folder in [scope.read_from.path.parent]
            for name, entry in scope.file.components.items()
            for origin in [f"{scope.read_from.where}: components.{name}.set"]
            if entry.rig
            for key, written in entry.set.items()
        ]

    @property
    def sources(self) -> list[Source]:
        """The files of the rigs inside, each once."""
        found = {scope.read_from.path: scope.read_from for scope in self.top.all()}
        return [source for path, source in found.items() if path != self.read_from.path]


def _isolating(scope: Scope, chosen: Mapping[str, Isolated]) -> Scope:
    components = {}
    for name, entry in scope.file.components.items():
        path = joined(scope.path, name)
        if path in chosen:
            entry = entry.model_copy(update={"isolated": chosen[path]})
            _check_component(name, entry, f"{scope.read_from.where}: components.{name}")
        components[name] = entry
    file = scope.file.model_copy(update={"components": components})
    inner = {name: _isolating(each, chosen) for name, each in scope.inner.items()}
    return replace(scope, file=file, inner=inner)


def _placed(scope: Scope) -> Iterator[tuple[str, Placed]]:
    for name, entry in scope.file.components.items():
        if name in scope.inner:
            yield from _placed(scope.inner[name])
        else:
            yield joined(scope.path, name), Placed(entry, scope, name)


def check_rig_file(file: RigFile, where: str) -> None:
    """Raise InputError for what no single key of a rig's file can tell."""
    for name, component in file.components.items():
        _check_component(name, component, f"{where}: components.{name}")
    for name in file.shows:
        if not _IDENTIFIER.fullmatch(name) or name in file.components:
            what = "is a component too" if name in file.components else "is no identifier"
            raise InputError(f"{where}: shows.{name}: {name!r} {what}")
    if file.step and duration_ns(file.step, f"{where}: step") <= 0:
        raise InputError(f"{where}: step: must be positive, found {file.step!r}")
    _check_algorithm(where, file)


_OF_FMUS = ("parameters", "profile", "isolated", "timeout", "interface", "tolerance", "locals")
_OF_RIGS = ("choices", "home", "variant")
_NOT_OF_SUMS = (*_OF_FMUS, *_OF_RIGS, "set", "step")


def _check_component(name: str, component: ComponentEntry, where: str) -> None:
    if not _IDENTIFIER.fullmatch(name):
        raise InputError(
            f"{where}: a component's name has letters, digits and '_' "
            "and starts with a letter or '_'"
        )
    kinds = {"fmu": _OF_RIGS, "rig": _OF_FMUS, "sum": _NOT_OF_SUMS}
    written = [kind for kind in kinds if getattr(component, kind)]
    if len(written) != 1:
        raise InputError(f"{where}: either fmu, rig or sum is needed")
    (kind,) = written
    alien = kinds[kind]
    for key in alien:
        if key in component.model_fields_set:
            raise InputError(f"{where}.{key}: has no effect beside {kind}")
    if component.timeout is not None and not component.isolated:
        raise InputError(f"{where}.timeout: needs isolated = true")


RIG_TABLES = {"iteration": "iterates", "ecco": "bonds"}
"""Tables of a rig's file for algorithms, and which of these takes each."""


def _takes(algorithm: Any, attribute: str) -> bool:
    """Say if an algorithm takes settings; one that does not exist is refused later."""
    try:
        return bool(getattr(ALGORITHMS.load(algorithm), attribute, False))
    except InputError:
        return True


def _check_algorithm(where: str, file: RigFile) -> None:
    try:
        ALGORITHMS.target(file.algorithm)
        # What a package brings is imported at once only where a setting depends on it.
        if file.iteration and not _takes(file.algorithm, RIG_TABLES["iteration"]):
            raise InputError(
                f"iteration has no effect with {file.algorithm!r}, only with one that iterates, "
                'such as "iterated"'
            )
        if file.ecco and not _takes(file.algorithm, RIG_TABLES["ecco"]):
            raise InputError(
                f"ecco has no effect with {file.algorithm!r}, only with one that controls its step "
                'by power bonds, such as "ecco"'
            )
    except InputError as error:
        raise InputError(f"{where}: algorithm: {error}") from None


def duration_ns(text: str, where: str) -> int:
    """Return a duration such as ``"10 ms"`` in whole nanoseconds; InputError says ``where``."""
    try:
        value = _seconds(text)
    except InputError as error:
        raise InputError(f"{where}: {error}") from None
    if abs(value) > LONGEST_S:
        raise InputError(f"{where}: {text!r} is beyond {LONGEST_S:g} s")
    return round(value * NS)


@lru_cache(256)
def _seconds(text: str) -> float:
    return quantity(text, "s")
