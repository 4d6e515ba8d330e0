"""The signals of a model description: scalars by name, what outputs depend on, views."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeGuard

from fmpy.model_description import ModelDescription

from ...errors import InputError, unknown
from ...model.ports import VIEWS
from ..clocks import Clock, Clocks
from ..instance import Variable, Variables
from .modelfile import ModelFile
from .options import DEFAULTS, FmuOptions
from .scalars import MOST_SCALARS, Entry, ScalarReader, elements, ticking

Dependencies = Mapping[str, Sequence[str]]
"""By the name of an output, the names of inputs."""


@dataclass(frozen=True, slots=True)
class Array:
    """What one value reference of FMI 3 stands for; a scalar is an array of one element."""

    fmi_type: str
    elements: tuple[Variable, ...]

    @property
    def start(self) -> list[Any] | None:
        """The start values of all elements; None if the FMU gives none."""
        values = [variable.start for variable in self.elements]
        return None if None in values else values


@dataclass(frozen=True)
class Described:
    """All signals of a model description."""

    variables: Variables
    arrays: dict[int, Array]
    """By value reference, in FMI 3.0."""
    feedthrough: dict[str, Sequence[str]]
    others: frozenset[str]
    """Names that it has besides: variables that are no signals here."""
    notes: tuple[str, ...]
    """What this FMU has that cannot be used here, or that FMI does not allow."""
    clocks: Clocks


def described(
    model: ModelFile, header: ModelDescription, options: FmuOptions = DEFAULTS
) -> Described:
    """Return the signals of ``model``, of which ``header`` is all but the variables.

    ``options`` has structural parameters that are to differ from their start values, local
    variables that are to be outputs, and the interface: clocks are used in co-simulation with
    event mode only. Raises InputError, without the file's name, for a variable that cannot be
    used.
    """
    reading = _Reading(model, header, options.structure)
    reading.show(options.locals)
    simulation = header.coSimulation
    has_events = simulation is not None and bool(simulation.hasEventMode)
    clocks = reading.clocks() if has_events and options.interface != "model exchange" else {}
    idle = reading.idle(clocks)
    variables = reading.variables(clocks, idle)
    return Described(
        variables,
        reading.arrays,
        reading.feedthrough(),
        frozenset(one.name for one in reading.entries if one.name not in variables),
        _notes(idle, reading.ambiguous, reading.unusual),
        _clocks(reading.entries, clocks, variables),
    )


def _clocks(
    entries: Sequence[Variable | Entry], clocks: Mapping[int, Clock], variables: Variables
) -> Clocks:
    signals: dict[str, int] = {}
    clocked: dict[str, tuple[int, ...]] = {}
    for entry in entries:
        if not _is_clocked(entry):
            continue
        for scalar in entry.elements:
            if scalar.name not in variables:
                continue
            if entry.clock is not None:
                signals[scalar.name] = scalar.reference
            else:
                clocked[scalar.name] = entry.clocks
    return Clocks(clocks, signals, clocked)


class _Reading:
    """All variables of a model description, in the order of the file, aliases behind them."""

    def __init__(
        self, model: ModelFile, header: ModelDescription, structure: Mapping[str, int]
    ) -> None:
        self._model, self._structure = model, structure
        self.entries: list[Variable | Entry] = []
        self.arrays: dict[int, Array] = {}
        self._parameters: dict[int, Variable] = {}
        """Structural parameters by value reference."""
        self._direct: dict[str, list[str]] = {}
        """What outputs of FMI 1.0 depend on."""
        self._version = int(header.fmiMajorVersion)
        reader = ScalarReader(header, model.root)
        aliases = [alias for element in model.variables() for alias in self._add(reader, element)]
        self._aliased = {alias.name: base.name for base, alias in aliases}
        self._written = len(self.entries)
        self.entries += [alias for _, alias in aliases]
        self.ambiguous = _ambiguous_names(self.entries)
        self.unusual = reader.unusual

    def _add(
        self, reader: ScalarReader, element: Any
    ) -> list[tuple[Variable | Entry, Variable | Entry]]:
        """Add a variable; return it with each of its aliases."""
        entry, fmi_type = reader.read(element)
        if isinstance(entry, Variable):
            if entry.causality == "structuralParameter":
                self._parameters[entry.reference] = entry
            if entry.name in self._structure:
                entry = replace(entry, start=self._structure[entry.name])
            if self._version == 3:
                self.arrays.setdefault(entry.reference, Array(fmi_type, (entry,)))
        self.entries.append(entry)
        if self._version == 1:
            through = element.find("DirectDependency")
            if through is not None:
                self._direct[entry.name] = [name.text for name in through.iterfind("Name")]
        return [(entry, _alias(entry, alias)) for alias in element.iterfind("Alias")]

    def show(self, names: Iterable[str]) -> None:
        """Make local variables outputs; an array as a whole, if an element is named."""
        hidden = {e.name: i for i, e in enumerate(self.entries) if e.causality == "local"}
        hidden = {name: i for name, i in hidden.items() if name not in self.ambiguous}
        for name in names:
            place = hidden.get(name, hidden.get(name.rpartition("[")[0]))
            if place is None:
                raise InputError(f"locals: {unknown('local variable', name, hidden)}")
            entry = self.entries[place]
            like = replace(_like(entry), causality="output")
            self.entries[place] = replace(entry, like=like) if isinstance(entry, Entry) else like

    def clocks(self) -> dict[int, Clock]:
        """Return the clocks by value reference, without local ones: nothing waits for those."""
        found: dict[int, Clock] = {}
        for entry in self.entries:
            if isinstance(entry, Entry) and entry.causality != "local":
                clock = ticking(entry)
                if clock is not None:
                    found.setdefault(clock.reference, clock)
        return found

    def idle(self, clocks: Mapping[int, Clock]) -> list[str]:
        """Return the variables that are none of ``clocks`` and belong to none of them."""
        return [
            entry.name
            for entry in self.entries
            if _is_clocked(entry)
            and clocks.keys().isdisjoint(
                entry.clocks if entry.clock is None else (entry.like.reference,)
            )
        ]

    def variables(self, clocks: Mapping[int, Clock], idle: Collection[str]) -> Variables:
        """Return the scalars by name, without those that are ``idle`` and time-based clocks."""
        found, left_out = Variables(), {*self.ambiguous, *idle}
        left_out |= {clock.name for clock in clocks.values() if clock.is_timed}
        for entry in self.entries:
            if entry.name in left_out:
                continue
            if isinstance(entry, Entry):
                entry.elements = elements(entry, self._parameters, self._structure)
                array = Array(entry.fmi_type, tuple(entry.elements))
                self.arrays.setdefault(entry.like.reference, array)
            for scalar in _scalars(entry):
                if scalar.name in found:
                    raise InputError(f"two variables are called {scalar.name!r}")
                found[scalar.name] = scalar
            if len(found) > MOST_SCALARS:
                raise InputError(f"more than {MOST_SCALARS} scalar variables")
        return found

    def feedthrough(self) -> dict[str, Sequence[str]]:
        """Return the inputs each output depends on; on all, where the FMU says nothing."""
        inputs = [one for one in self.entries if one.causality == "input"]
        every = self._names(inputs)
        said = self._said()
        result: dict[str, Sequence[str]] = {}
        for entry in self.entries:
            if entry.causality != "output":
                continue
            names = said.get(self._aliased.get(entry.name, entry.name), every)
            if names:
                result.update(dict.fromkeys(self._names([entry]), names))
        return result

    def _names(self, entries: Iterable[Variable | Entry]) -> list[str]:
        # What belongs to a clock passes nothing at once: it has its value when that is active.
        usable = (e for e in entries if e.name not in self.ambiguous and not _is_clocked(e))
        return [scalar.name for one in usable for scalar in _scalars(one)]

    def _said(self) -> dict[str, list[str]]:
        """Return what outputs depend on, of those of which the FMU says it."""
        by_number: Mapping[int, Variable | Entry]
        if self._version == 1:
            by_name = {one.name: one for one in self.entries if one.name in self._direct}
            inputs = {one.name: one for one in self.entries if one.causality == "input"}
            return {
                name: self._names(inputs[one] for one in self._direct[name] if one in inputs)
                for name in by_name
            }
        written = self.entries[: self._written]
        if self._version == 2:
            by_number = dict(enumerate(written, start=1))
        else:
            by_number = {_like(one).reference: one for one in written}
        said = {}
        for number, dependencies in self._model.dependencies.items():
            unknown = [n for n in (number, *(dependencies or ())) if n not in by_number]
            if unknown:
                raise InputError(f"ModelStructure: there is no variable {unknown[0]}")
            if dependencies is not None:
                known = [by_number[n] for n in dependencies]
                inputs_ = [one for one in known if one.causality == "input"]
                said[by_number[number].name] = self._names(inputs_)
        return said


def _like(entry: Variable | Entry) -> Variable:
    return entry.like if isinstance(entry, Entry) else entry


def _scalars(entry: Variable | Entry) -> Sequence[Variable]:
    return entry.elements if isinstance(entry, Entry) else (entry,)


def _is_clocked(entry: Variable | Entry) -> TypeGuard[Entry]:
    """Say if a variable is a clock or belongs to some."""
    return isinstance(entry, Entry) and (entry.clock is not None or bool(entry.clocks))


def _alias(entry: Variable | Entry, alias: Any) -> Variable | Entry:
    """Return a variable under another name."""
    like = _like(entry)
    changed = replace(
        like, name=alias.get("name") or "", description=alias.get("description") or like.description
    )
    if not changed.name:
        raise InputError(f"an alias of {like.name!r} has no name")
    return replace(entry, like=changed) if isinstance(entry, Entry) else changed


def _ambiguous_names(entries: Sequence[Variable | Entry]) -> dict[str, None]:
    """Return names of several local variables each: FMI forbids them, tools write them.

    Raises InputError for a name that a signal or a parameter shares.
    """
    if len({entry.name for entry in entries}) == len(entries):
        return {}
    counts = Counter(entry.name for entry in entries)
    for entry in entries:
        if counts[entry.name] > 1 and entry.causality != "local":
            raise InputError(f"two variables are called {entry.name!r}")
    return {name: None for name, count in counts.items() if count > 1}


def _notes(idle: list[str], ambiguous: Iterable[str], unusual: list[str]) -> tuple[str, ...]:
    notes = []
    if idle:
        notes.append(
            "clocks that are local, or of an FMU without event mode in co-simulation, and "
            f"variables that belong to them, are no signals: {_shown(idle)}"
        )
    if ambiguous:
        notes.append(
            "local variables that share a name with another are left out: " + _shown([*ambiguous])
        )
    if unusual:
        notes.append(
            "FMI does not allow these causalities and variabilities together: " + _shown(unusual)
        )
    return tuple(notes)


def _shown(names: list[str]) -> str:
    return ", ".join(names[:10]) + (", ..." if len(names) > 10 else "")


def views_of(root: Any) -> dict[str, dict[str, str]]:
    """Return the views that a model description declares, without those unknown here."""
    found = {}
    places = (
        "VendorAnnotations/Tool[@name='seatrial']",
        "Annotations/Annotation[@type='seatrial']",
    )
    for element in (view for place in places for view in root.iterfind(f"{place}/views/view")):
        ports = {str(key): str(value) for key, value in element.attrib.items()}
        kind = ports.pop("kind", "")
        if set(ports) == set(VIEWS.get(kind, ())):
            found[kind] = ports
    return found
