"""Scenario files of libcosim, JSON or YAML, as events of a trial."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

from pydantic import Field

from ...errors import InputError, unknown
from ...files.reading import json_content, yaml_content
from ...fmi.instance import Value, Variable
from ...model.component import NS
from ...sim.actions import action
from ...system.files import FileModel, Source, validated
from ...system.rig import LONGEST_S
from ...system.system import System

ACTIONS = ("override", "bias", "reset")

Kind = Literal["set", "fixed", "bias", "release"]
"""What is done to a variable: set, given a fault of the catalogue until the next, released."""

_Written = str | int | float | bool


class ScenarioDefaults(FileModel):
    """What holds for events that say nothing else."""

    model: str | None = None
    variable: str | None = None
    action: str | None = None


class ScenarioEntry(ScenarioDefaults):
    """One event as written."""

    description: str = ""
    time: _Written
    value: _Written | None = None


class ScenarioFile(FileModel):
    """The content of a scenario file."""

    description: str = ""
    defaults: ScenarioDefaults = Field(default_factory=ScenarioDefaults)
    events: list[ScenarioEntry] = Field(default_factory=list)
    end: _Written | None = None


@dataclass(frozen=True)
class ScenarioEvent:
    """One event as the file has it, with its defaults."""

    where: str
    after_ns: int
    """Time since the start."""
    model: str
    variable: str
    action: str
    value: Any


@dataclass(frozen=True)
class Scenario:
    """A scenario file, read."""

    read_from: Source
    events: tuple[ScenarioEvent, ...]
    end_ns: int
    """Since the start; 0 without an end."""


@dataclass(frozen=True)
class Acted:
    """What a scenario does to a variable."""

    begins: int
    """The communication step that it begins with."""
    step: int
    """When it acts: an output changes when the step ends."""
    kind: Kind
    key: str
    value: Any


@dataclass
class Events:
    """What a scenario does in one run, and what the user should know of it."""

    acted: list[Acted] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    def spans(self) -> Iterator[tuple[Acted, Acted | None]]:
        """Yield each fault with what is done next to its variable, None if nothing.

        One whose successor acts at the same instant has no effect.
        """
        for index, begin in enumerate(self.acted):
            if begin.kind in ("fixed", "bias"):
                later = (one for one in self.acted[index + 1 :] if one.key == begin.key)
                end = next(later, None)
                if end is None or end.step > begin.step:
                    yield begin, end


def read_scenario(path: Path) -> Scenario:
    """Read the scenario file at ``path``: JSON if it is called so, else YAML.

    Raises InputError, with the file and the key, for whatever does not fit.
    """
    try:
        data = path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}") from None
    content = (json_content if path.suffix == ".json" else yaml_content)(data, str(path))
    file = validated(ScenarioFile, content, path)
    source = Source(path.stem, path, hashlib.sha256(data).hexdigest())
    events = [
        _event(entry, file.defaults, f"{path}: events.{index}")
        for index, entry in enumerate(file.events)
    ]
    end = 0 if file.end is None else _time_ns(file.end, f"{path}: end")
    return Scenario(source, tuple(events), end)


def _event(entry: ScenarioEntry, defaults: ScenarioDefaults, where: str) -> ScenarioEvent:
    found = {
        key: getattr(entry, key) or getattr(defaults, key) for key in ScenarioDefaults.model_fields
    }
    for key, text in found.items():
        if not text:
            raise InputError(f"{where}.{key}: this key is missing, and defaults.{key} too")
    if found["action"] not in ACTIONS:
        raise InputError(f"{where}.action: {unknown('action', found['action'], ACTIONS)}")
    if found["action"] != "reset" and entry.value is None:
        raise InputError(f"{where}.value: this key is missing")
    return ScenarioEvent(where, _time_ns(entry.time, f"{where}.time"), value=entry.value, **found)


def _time_ns(written: _Written, where: str) -> int:
    value = _number(written, where)
    if abs(value) > LONGEST_S:
        raise InputError(f"{where}: {value!r} s is beyond {LONGEST_S:g} s")
    return int(value * NS)  # the digits behind are cut off, as libcosim does it


def _number(written: _Written, where: str) -> float:
    try:
        if isinstance(written, bool) or (isinstance(written, str) and "_" in written):
            raise ValueError
        value = float(written)
        if not math.isfinite(value):
            raise ValueError
    except (ValueError, OverflowError):
        raise InputError(f"{where}: a finite number is needed, found {written!r}") from None
    return value


def events_of(
    scenario: Scenario, system: System, names: Mapping[str, str], step_ns: int, steps: int
) -> Events:
    """Return what a scenario does in a run of ``steps`` steps, in the order in which it does.

    ``names`` has components by the names of their models, where these differ. As in libcosim,
    an event acts with the first step that begins at its time or later: on an input at once, on
    an output when the step ends. When all events have acted and the end has come, at the
    earliest one step after the last event, all that they did is reset. Raises InputError for
    models, variables and values that do not fit, and for two events at once on one variable.
    """
    found, seen, last = Events(), dict[tuple[str, int], str](), 0
    timed = [(max(0, -(-event.after_ns // step_ns)), event) for event in scenario.events]
    changed: dict[str, _Target] = {}
    late = 0
    for step, event in sorted(timed, key=lambda each: each[0]):
        target = _target(system, names, event)
        if (target.key, step) in seen:
            raise InputError(
                f"{event.where}: acts on {target.key} at once with {seen[target.key, step]}: "
                "libcosim does not say which of them is the last"
            )
        seen[target.key, step] = event.where
        acted = target.acted(step, event)
        if acted.kind == "set":
            action(system, "set", acted.key, acted.value, event.where)
        found.acted.append(acted)
        changed[target.key], last = target, step
        late += step >= steps
    cleared = max(last + 1, -(-scenario.end_ns // step_ns))
    found.acted += [target.reset(cleared) for target in changed.values()]
    found.acted = [acted for acted in found.acted if acted.begins < steps]
    if late:
        found.notes.append(
            f"{scenario.read_from.path.name}: {late} of {len(timed)} events come after the last "
            "step begins"
        )
    return found


@dataclass(frozen=True)
class _Target:
    """A variable that a scenario acts on."""

    key: str
    variable: Variable
    every: int
    """Communication steps between two steps of its component."""
    connected: bool
    start: Value
    """What an input or parameter that nothing feeds has without the scenario."""

    def acted(self, step: int, event: ScenarioEvent) -> Acted:
        """Return what an event does. Raises InputError."""
        if event.action == "reset":
            return self.reset(step)
        value = _value(event, self.variable)
        if self._settable:
            if event.action == "bias":
                value = _sum(self.start, value)
            return self._acts(step, "set", value)
        return self._acts(step, "bias" if event.action == "bias" else "fixed", value)

    def reset(self, step: int) -> Acted:
        """Return what takes back what was done."""
        if self._settable:
            return self._acts(step, "set", self.start)
        return self._acts(step, "release", None)

    @property
    def _settable(self) -> bool:
        return self.variable.causality != "output" and not self.connected

    def _acts(self, step: int, kind: Kind, value: Any) -> Acted:
        """Return an action with the component's next step, on outputs at its end."""
        begins = -(-step // self.every) * self.every
        at = begins + self.every if self.variable.causality == "output" else begins
        return Acted(begins, at, kind, self.key, value)


def _target(system: System, names: Mapping[str, str], event: ScenarioEvent) -> _Target:
    called = names.get(event.model, event.model)
    if called not in system.parts:
        known = [*names, *(name for name in system.parts if name not in names.values())]
        raise InputError(f"{event.where}.model: {unknown('model', event.model, known)}")
    part = system.parts[called]
    variables = part.instance.variables
    if event.variable not in variables:
        raise InputError(
            f"{event.where}.variable: {called}: {unknown('variable', event.variable, variables)}"
        )
    variable, given = variables[event.variable], part.given.get(event.variable)
    return _Target(
        f"{called}.{event.variable}",
        variable,
        part.every,
        event.variable in system.feeders(called),
        _start(variable) if given is None else given.value,
    )


def _sum(start: Any, bias: Any) -> Value:
    """Return a value with a bias, of the value's type: of truth values, whether one is true."""
    found: Value = type(start)(start + bias)
    return found


def _start(variable: Variable) -> Value:
    value: Value = variable.type() if variable.start is None else variable.start
    return value


def _value(event: ScenarioEvent, variable: Variable) -> Value:
    """Return the value in the variable's type; YAML has texts alone."""
    where, written, kind = f"{event.where}.value", event.value, variable.type
    if kind is str:
        if event.action == "bias":
            raise InputError(f"{where}: nothing can be added to the text {event.variable}")
        if not isinstance(written, str):
            raise InputError(f"{where}: a text is needed, found {written!r}")
        return written
    if kind is bool:
        truth = {"true": True, "false": False}.get(str(written).lower())
        if truth is None:
            raise InputError(f"{where}: true or false is needed, found {written!r}")
        return truth
    if kind not in (float, int):
        raise InputError(f"{where}: {event.variable} is neither number, truth value nor text")
    number = _number(written, where)
    if kind is float:
        return number
    if number != int(number):
        raise InputError(f"{where}: a whole number is needed, found {written!r}")
    return int(number)
