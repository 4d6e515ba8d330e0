"""Trials: rig, duration, events, criteria (``harness/trials/*.toml``)."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from ...errors import InputError, unknown
from ...model.component import seconds
from ...shipped import available
from ...system.fault_entry import FaultEntry
from ...system.files import Source, find_file, read_toml, validated
from ...system.flattening import load_rig
from ...system.isolation import KEY_END, isolated_in, isolating
from ...system.packages import is_package, read_package
from ...system.references.values import Setting
from ...system.rig import RIG_TABLES, Isolated, Rig, duration_ns
from ...system.system import System
from ..criteria.criteria import Criterion, parse
from .fault_keys import CHOICES, PREFIX, choices_in, is_choice, with_fault_keys
from .scenario import Acted, Scenario, events_of, read_scenario
from .seabed_entry import set_seabed, water_depth
from .surroundings import GROUPS, SeaEntry, set_surroundings
from .trial_file import EventEntry, RealTimeEntry, TrialFile
from .utc import instant_of, set_start_time

_LEVELS = ("all", "trial", "criteria")


@dataclass(frozen=True)
class Event:
    """An event with its time in ns."""

    at_ns: int
    key: str
    written: Any


@dataclass(frozen=True)
class Trial:
    """A trial file, read, with its rig and its criteria parsed."""

    file: TrialFile
    read_from: Source
    rig: Rig
    criteria: tuple[tuple[str, Criterion], ...]
    rig_changes: Mapping[str, Any] = field(default_factory=dict)
    """Keys of the rig's file that were replaced."""
    overrides: tuple[tuple[str, Any, str], ...] = ()
    """Settings from outside the file: (component.port, what was written, who says so)."""
    scales: tuple[tuple[str, float, str], ...] = ()
    """Parameters to multiply after all settings: (component.port, factor, who says so)."""
    isolated: Mapping[str, Isolated] = field(default_factory=dict)
    """Components, by path, that were said to run in processes of their own, or not to."""
    notes: tuple[str, ...] = ()
    """What was met in a package of another tool and is not used."""
    scenario: Scenario | None = None
    called: Mapping[str, str] = field(default_factory=dict)
    """Components by the names that a package of another tool gives them."""
    figures: tuple[str, ...] = ()
    """Signals of which a table of runs has the least, the greatest and the last value."""

    @property
    def name(self) -> str:
        """Name of the trial."""
        return self.read_from.name

    @property
    def start_ns(self) -> int:
        """Start time, ns."""
        return duration_ns(self.file.start, f"{self.read_from.path}: start")

    @property
    def stop_ns(self) -> int:
        """Stop time, ns."""
        return duration_ns(self.file.stop, f"{self.read_from.path}: stop")

    @property
    def steps(self) -> int:
        """Number of communication steps."""
        return (self.stop_ns - self.start_ns) // self.rig.step_ns

    @property
    def record_every(self) -> int:
        """Steps between recorded rows."""
        written = self.file.record.every
        if written is None:
            return 1
        where = f"{self.read_from.path}: record.every"
        return _multiple(duration_ns(written, where), self.rig.step_ns, where, written)

    def dated(self, system: System) -> Trial:
        """Give a system the trial's date and time, and return the trial with the instant it is.

        Raises InputError.
        """
        if self.file.utc is None:
            return self
        where = f"{self.read_from.path}: utc"
        utc = instant_of(self.file.utc, self.file.real_time is not None, where)
        set_start_time(system, utc, where)
        return replace(self, file=self.file.model_copy(update={"utc": utc}))

    def surround(self, system: System) -> None:
        """Give a system the trial's seabed, sea, current and wind. Raises InputError."""
        path, seabed = self.read_from.path, self.file.seabed
        if seabed is not None:
            set_seabed(system, seabed, f"{path}: seabed", path.parent)
        for group in GROUPS:
            entry = getattr(self.file, group)
            if seabed is not None and isinstance(entry, SeaEntry):
                depth = water_depth(system, entry.depth, seabed, f"{path}: seabed")
                entry = entry.model_copy(update={"depth": depth})
            if entry is not None:
                set_surroundings(system, group, entry, f"{path}: {group}")

    def settings(self) -> list[Setting]:
        """Return what the trial sets, by component.port."""
        path = self.read_from.path
        own = [Setting(k, v, f"{path}: set", path.parent) for k, v in self.file.set.items()]
        return [*own, *(Setting(*override) for override in self.overrides)]

    def events(self) -> list[Event]:
        """Return all events in time order, as written where times are equal."""
        events = []
        for index, entry in enumerate(self.file.events):
            where = f"{self.read_from.path}: events.{index}.at"
            at_ns = duration_ns(entry.at, where)
            if not self.start_ns <= at_ns <= self.stop_ns:
                raise InputError(f"{where}: {entry.at!r} is outside the trial's time")
            _multiple(at_ns - self.start_ns, self.rig.step_ns, where, entry.at)
            events += [Event(at_ns, k, v) for k, v in entry.set.items()]
        return sorted(events, key=lambda event: event.at_ns)

    def scheduled(self, system: System) -> Trial:
        """Return the trial with events and faults of its scenario among its own.

        Raises InputError.
        """
        if self.scenario is None:
            return self
        step_ns = self.rig.step_ns
        found = events_of(self.scenario, system, self.called, step_ns, self.steps)
        system.notes += found.notes

        def at(acted: Acted) -> str:
            return f"{seconds(self.start_ns + acted.step * step_ns)!r} s"

        events = [
            EventEntry(at=at(acted), set={acted.key: acted.value})
            for acted in found.acted
            if acted.kind == "set"
        ]
        faults = []
        for begin, end in found.spans():
            lasts = (
                {} if end is None else {"for": f"{seconds((end.step - begin.step) * step_ns)!r} s"}
            )
            written = {"what": begin.kind, "where": begin.key, "value": begin.value}
            if begin.kind == "bias" and isinstance(begin.value, bool):
                written["value"] = int(begin.value)  # whether it or the bias is true
            faults.append(FaultEntry.model_validate({**written, "at": at(begin), **lasts}))
        return self.with_faults(faults, events)

    def with_faults(self, faults: Sequence[FaultEntry], events: Sequence[EventEntry] = ()) -> Trial:
        """Return the trial with more faults, and events, after its own."""
        more = {"faults": [*self.file.faults, *faults], "events": [*self.file.events, *events]}
        return replace(self, file=self.file.model_copy(update=more))

    def failing(self, written: Sequence[Mapping[str, Any]], origin: str) -> Trial:
        """Return the trial with more faults, as a file would have them. Raises InputError."""
        faults = [
            validated(FaultEntry, one, Path(f"{origin}.{i}")) for i, one in enumerate(written)
        ]
        return self.with_faults(faults)

    def recording(self, level: str, origin: str) -> Trial:
        """Return the trial with other signals recorded: "all" outputs, or what "criteria" need.

        The latter are those that criteria and plots read; "trial" leaves what the file says.
        Raises InputError for another level, and if there is nothing that criteria need.
        """
        if level not in _LEVELS:
            raise InputError(f"{origin}: {unknown('level', level, _LEVELS)}")
        needed = {signal for _, criterion in self.criteria for signal in criterion.signals}
        needed |= {signal for plot in self.file.plots for signal in plot.signals}
        if level == "criteria" and not needed:
            raise InputError(f"{origin}: {self.name} has neither criteria nor plots")
        signals = {"all": ["*"], "criteria": sorted(needed), "trial": None}[level]
        if signals is None:
            return self
        record = self.file.record.model_copy(update={"signals": signals})
        return replace(self, file=self.file.model_copy(update={"record": record}))

    def scaled(self, key: str, factor: float, origin: str) -> Trial:
        """Return the trial with the number ``component.port`` multiplied by ``factor``."""
        return replace(self, scales=(*self.scales, (key, factor, origin)))

    def in_real_time(self, given: Mapping[str, Any], origin: str) -> Trial:
        """Return the trial with keys of ``real_time`` replaced. Raises InputError."""
        before = self.file.real_time
        content = {**(before.model_dump() if before else {}), **given}
        entry = validated(RealTimeEntry, content, Path(origin))
        return replace(self, file=self.file.model_copy(update={"real_time": entry}))

    def limited(self, given: Mapping[str, Any], origin: str) -> Trial:
        """Return the trial with limits of its run replaced. Raises InputError."""
        limit = self.file.limit.with_(given, origin)
        return replace(self, file=self.file.model_copy(update={"limit": limit}))

    def changed(self, changes: Mapping[str, Any], origin: str) -> Trial:
        """Return the trial with settings changed: ``component.port``, or a key of the trial.

        Keys of the trial are variant, seed, start, stop, utc, scenario, ``choices.NAME``, those of
        its faults such as ``faults.0.at``, and those of its sea, current, wind and seabed such as
        ``sea.height``, unless a component has that name; of its rig, step, algorithm,
        ``iteration.KEY``, ``ecco.KEY`` and ``component.isolated``. Raises InputError.
        """
        keys = ("variant", "seed", "start", "stop", "utc", "scenario")
        rig_keys = ("step", "algorithm")
        own, of_rig, overrides = dict[str, Any](), dict(self.rig_changes), list(self.overrides)
        choices = {**self.file.choices, **choices_in(changes, origin)}
        of_processes, of_faults = dict[str, Any](), dict[str, Any]()
        for key, value in changes.items():
            if is_choice(key):
                own["choices"] = choices
            elif key.endswith(KEY_END):
                of_processes[key] = value
            elif key.startswith(PREFIX) and not self._has_component(key):
                of_faults[key] = value
            elif (group := self._group_in(key, RIG_TABLES)) is not None:
                of_rig[group] = {**of_rig.get(group, {}), key.partition(".")[2]: value}
            elif (group := self._group_in(key, _TABLES)) is not None:
                before = own.get(group, self.file.model_dump(exclude_none=True).get(group, {}))
                own[group] = {**before, key.partition(".")[2]: value}
            elif "." in key:
                overrides.append((key, value, origin))
            elif key in keys:
                here = key == "scenario" and isinstance(value, str)
                own[key] = str(Path.cwd() / value) if here else value
            elif key in rig_keys:
                of_rig[key] = value
            else:
                known = (*keys, *rig_keys, *_PATTERNS)
                raise InputError(f"{origin}: {unknown('key', key, known)}, or component.port")
        content = {**self.file.model_dump(exclude_unset=True), **own}
        if of_faults:
            content["faults"] = with_fault_keys(
                [fault.written for fault in self.file.faults], of_faults, origin
            )
        if changes:
            content["criteria"] = [_unexpected(entry) for entry in content.get("criteria", [])]
        file = validated(TrialFile, content, self.read_from.path)
        rig = self.rig
        if choices != self.file.choices:
            rig = _rig(file, self.read_from.path)
        if of_rig:
            rig = rig.changed(of_rig)
        isolated = {**self.isolated, **isolated_in(of_processes, origin)}
        rig = isolating(rig, isolated, origin)
        scenario = None
        if file.scenario is not None:
            scenario = read_scenario(self.read_from.path.parent / file.scenario)
        changed = replace(
            self, file=file, rig=rig, rig_changes=of_rig, isolated=isolated, scenario=scenario
        )
        return _checked(replace(changed, overrides=tuple(overrides)))

    def _group_in(self, key: str, tables: Collection[str]) -> str | None:
        """Return the one of some tables that a key is of, if no component has its name."""
        group, dot, _ = key.partition(".")
        return group if dot and group in tables and not self._has_component(key) else None

    def _has_component(self, key: str) -> bool:
        """Say if a component of the rig has the name that a key begins with."""
        first = key.partition(".")[0]
        return any(path.partition(".")[0] == first for path in self.rig.components)


def is_trial(name: str) -> bool:
    """Say if ``name`` is a trial or a package, not a rig; where both share it, it is the trial.

    Raises InputError for a name that is neither. A name with a folder, ``vehicles/hydrone``, is
    a rig's.
    """
    if name.endswith(".toml"):
        return "rig" in read_toml(find_file("harness/trials", name))[0]
    trials, rigs = available("harness/trials"), available("harness/rigs")
    if is_package(name):
        return True
    if "/" in name:
        find_file("harness/rigs", name)
        return False
    if name not in {**trials, **rigs}:
        raise InputError(unknown("trial or rig", name, {**trials, **rigs}))
    return name not in rigs or name in trials


def load_trial(
    name: str,
    relative_to: Path | None = None,
    changes: Mapping[str, Any] | None = None,
    origin: str = "",
) -> Trial:
    """Read the trial ``name`` (shipped, in ``harness/trials``, or a path) and its rig.

    ``x.ssp`` is an SSP package: its default experiment, without criteria; ``x.xml``, or a folder
    with an OspSystemStructure.xml, one of OSP-IS. ``changes`` are as for `Trial.changed`. Raises
    InputError for anything wrong in a file, or in a criterion.
    """
    changes = changes or {}
    read = _package if is_package(name, relative_to) else _trial
    return read(name, relative_to, changes, origin).changed(changes, origin)


_TABLES = (*GROUPS, "seabed")
_PATTERNS = (
    f"{CHOICES}NAME",
    f"{PREFIX}N.KEY",
    *(f"{group}.KEY" for group in (*_TABLES, *RIG_TABLES)),
)


def _unexpected(criterion: dict[str, Any]) -> dict[str, Any]:
    """Return a criterion of a file without what is expected of it."""
    return {key: value for key, value in criterion.items() if key not in ("expect", "why")}


def _rig(file: TrialFile, path: Path) -> Rig:
    try:
        return load_rig(file.rig, path.parent, file.choices)
    except InputError as error:
        raise InputError(f"{path}: rig: {error}") from None


def _package(name: str, relative_to: Path | None, changes: Mapping[str, Any], origin: str) -> Trial:
    path = ((relative_to or Path.cwd()) / name).resolve()
    for choice in choices_in(changes, origin):
        raise InputError(f"{origin}: {CHOICES}{choice}: a package has no choices")
    package = read_package(path, changes)
    stop = package.stop or changes.get("stop")
    if stop is None:
        raise InputError(f'{path}: the package names no stop time; give one: --set stop="20 s"')
    content = {"title": package.title, "rig": name, "stop": stop}
    if package.start is not None:
        content["start"] = package.start
    file = validated(TrialFile, content, path)
    rig = package.rig
    return Trial(file, rig.read_from, rig, (), notes=package.notes, called=package.called)


def _trial(name: str, relative_to: Path | None, changes: Mapping[str, Any], origin: str) -> Trial:
    path = find_file("harness/trials", name, relative_to)
    content, read_from = read_toml(path)
    file = validated(TrialFile, content, path)
    choices = {**file.choices, **choices_in(changes, origin)}
    file = file.model_copy(update={"choices": choices})
    rig = _rig(file, path)
    criteria = []
    for index, entry in enumerate(file.criteria):
        try:
            criterion = parse(entry.check)
            if entry.ends and criterion.condition is None and criterion.goal is None:
                raise InputError(
                    f"{entry.check!r} cannot end a run: with ends = true a condition that holds "
                    "at every point is needed, or 'eventually[0 s, ...]' before it"
                )
            criteria.append((entry.name, criterion))
        except InputError as error:
            raise InputError(f"{path}: criteria.{index} ({entry.name}): {error}") from None
    return Trial(file, read_from, rig, tuple(criteria))


def _checked(trial: Trial) -> Trial:
    where = f"{trial.read_from.path}: stop"
    if trial.stop_ns <= trial.start_ns:
        raise InputError(f"{where}: {trial.file.stop!r} is not after the start")
    _multiple(trial.stop_ns - trial.start_ns, trial.rig.step_ns, where, trial.file.stop)
    if trial.record_every > trial.steps:
        raise InputError(
            f"{trial.read_from.path}: record.every: {trial.file.record.every!r} is longer than "
            "the trial"
        )
    trial.events()
    return trial


def _multiple(length_ns: int, step_ns: int, where: str, written: str) -> int:
    count, rest = divmod(length_ns, step_ns)
    if rest or count < 0 or (count == 0 and not where.endswith(".at")):
        raise InputError(
            f"{where}: {written!r} is not a whole number of communication steps of "
            f"{step_ns / 1e6:g} ms"
        )
    return count
