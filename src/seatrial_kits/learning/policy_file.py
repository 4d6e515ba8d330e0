"""Files that say what a trained network means: its inputs and outputs, in the rig's terms."""

from __future__ import annotations

import json
import keyword
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from pydantic import Field

from seatrial.errors import InputError, unknown
from seatrial.model.ports import FRAMES
from seatrial.model.units import Unit, quantity, unit
from seatrial.system.files import FileModel, read_toml, validated
from seatrial.system.rig import duration_ns
from seatrial.trial.criteria import expressions as ex

from .network import Steps
from .network_file import read_network
from .observation import Program
from .policy import RESERVED

Written = str | float | int


class PortEntry(FileModel):
    """An input or output."""

    unit: str | list[str]
    """One for all elements, or one for each axis."""
    axes: list[str] | None = Field(default=None, min_length=1)
    frame: str = ""
    description: str = ""


class ObserveEntry(FileModel):
    """A number that the network takes: an expression of inputs."""

    value: str
    range: list[Written] | None = Field(default=None, min_length=2, max_length=2)
    """What becomes -1 and 1."""
    trained: list[Written] | None = Field(default=None, min_length=2, max_length=2)
    """Lowest and highest value in training; as ``range``, if that is given."""


class ActEntry(FileModel):
    """A number that the network gives: the output that it is."""

    to: str
    range: list[Written] | None = Field(default=None, min_length=2, max_length=2)
    """What -1 and 1 become."""


class PolicyFile(FileModel):
    """The content of a policy's file."""

    title: str = ""
    network: str
    network_output: str | None = None
    period: str | None = None
    """Time from one action to the next; without one the outputs follow the inputs at once."""
    inputs: dict[str, str | PortEntry] = Field(min_length=1)
    outputs: dict[str, str | PortEntry] = Field(min_length=1)
    terminals: dict[str, list[str]] = Field(default_factory=dict)
    """Inputs and outputs that are connected together, by their names."""
    observe: list[ObserveEntry] = Field(default_factory=list)
    act: list[ActEntry] = Field(default_factory=list)


def frozen_policy(path: Path) -> str:
    """Return a policy and its network as the text that `policy.policy_component` takes.

    Raises InputError naming the file and the key for what does not fit, the network's file among
    them.
    """
    return _Policy(path, _read(path)).text()


@dataclass(frozen=True)
class Meaning:
    """What a policy's file says of a network that need not be there yet."""

    network: Path
    inputs: dict[str, str]
    """Units by element."""
    outputs: dict[str, str]
    observed: list[ex.Expression]
    """What the network takes, of the inputs in SI by `observation.pointed`."""
    acted: list[str]
    """The elements of the outputs, in the order in which the network gives them."""


def meaning(path: Path) -> Meaning:
    """Return what the file says, for a network that is to be trained.

    Raises InputError naming the file and the key for what does not fit, and for ranges: they
    follow from the training.
    """
    policy = _Policy(path, _read(path))
    inputs, outputs = (
        _units(policy.ports(key, ports))
        for key, ports in (("inputs", policy.file.inputs), ("outputs", policy.file.outputs))
    )
    for key, entries in (("observe", policy.file.observe), ("act", policy.file.act)):
        for number, entry in enumerate(entries):
            for name in ("range", "trained"):
                if getattr(entry, name, None) is not None:
                    raise InputError(
                        f"{path}: {key}.{number}.{name}: ranges follow from the training: leave "
                        "them out"
                    )
    program, acts = Program(inputs), policy.acts(outputs)
    for number, each in enumerate(policy.file.observe or [ObserveEntry(value=n) for n in inputs]):
        with at(f"{path}: observe.{number}.value"):
            program.add(each.value)
    network = path.parent / policy.file.network
    return Meaning(network, inputs, outputs, program.nodes, [entry.to for entry in acts])


def _read(path: Path) -> PolicyFile:
    content, _ = read_toml(path)
    if "components" in content:
        raise InputError(f'{path}: it is a rig, no policy: rig = "..." puts it in place of fmu')
    return validated(PolicyFile, content, path)


class _Policy:
    def __init__(self, path: Path, file: PolicyFile) -> None:
        self.path, self.file = path, file

    @cached_property
    def network(self) -> Steps:
        return read_network(self.path.parent / self.file.network, self.file.network_output)

    def text(self) -> str:
        """Return all of it. Raises InputError."""
        file = self.file
        inputs, outputs = self.ports("inputs", file.inputs), self.ports("outputs", file.outputs)
        if twice := sorted({*file.inputs} & {*file.outputs}):
            raise InputError(f"{self.path}: {twice[0]!r} is an input and an output")
        self._check_terminals([*file.inputs, *file.outputs])
        program, scaled, trained = self._observed(_units(inputs))
        acted, places = self._acted(_units(outputs))
        for port in outputs:
            port["places"] = [places[name] for name in _scalars(port)]
        return json.dumps(
            {
                "file": self.path.name,
                "title": file.title,
                "period": self._period(),
                "inputs": inputs,
                "outputs": outputs,
                "terminals": file.terminals,
                "program": program.operations,
                "observed": program.observed,
                "scaled": scaled,
                "trained": trained,
                "steps": self.network.steps,
                "acted": acted,
            },
            separators=(",", ":"),
        )

    def _period(self) -> float | None:
        if self.file.period is None:
            return None
        found = duration_ns(self.file.period, f"{self.path}: period")
        if found < 1000:
            raise InputError(f"{self.path}: period: {self.file.period!r}, at least 1 us is needed")
        return found / 1e9

    # ------------------------------------------------------------------ ports

    def ports(self, key: str, entries: Mapping[str, str | PortEntry]) -> list[dict[str, Any]]:
        found = []
        for name, written in entries.items():
            where = f"{self.path}: {key}.{name}"
            entry = PortEntry(unit=written) if isinstance(written, str) else written
            if not name.isidentifier() or keyword.iskeyword(name) or name.startswith("_"):
                raise InputError(f"{where}: a name has letters, digits and _, and a letter first")
            if has_meaning(name):
                raise InputError(
                    f"{where}: that name means something else (a unit, an attribute of "
                    "components): rename it"
                )
            self._check_port(entry, where)
            found.append({"name": name, **entry.model_dump()})
        return found

    def _check_port(self, entry: PortEntry, where: str) -> None:
        units = entry.unit if isinstance(entry.unit, list) else [entry.unit]
        for each in units:
            with at(f"{where}.unit"):
                unit(each)
        if isinstance(entry.unit, list) and len(entry.unit) != len(entry.axes or ()):
            raise InputError(f"{where}.unit: one for each axis is needed, found {len(entry.unit)}")
        if entry.frame and (entry.frame not in FRAMES or entry.axes is None):
            allowed = " or ".join(FRAMES)
            raise InputError(f"{where}.frame: {entry.frame!r}; {allowed}, of a port with axes")
        for axis in entry.axes or ():
            if not axis.isidentifier() or entry.axes.count(axis) > 1:  # type: ignore[union-attr]
                raise InputError(f"{where}.axes: {axis!r} is no identifier, or there twice")

    def _check_terminals(self, ports: list[str]) -> None:
        for name, members in self.file.terminals.items():
            where = f"{self.path}: terminals.{name}"
            if not name.isidentifier() or name in ports:
                raise InputError(f"{where}: letters, digits and _ are needed, and no port's name")
            for member in members:
                if member not in ports or members.count(member) > 1:
                    raise InputError(f"{where}: {unknown('port, or twice:', member, ports)}")

    # ------------------------------------------------------------------ observations and actions

    def _observed(
        self, units: Mapping[str, str]
    ) -> tuple[Program, list[list[float]], list[list[float]]]:
        """Return what computes the observations, their ranges, and those of training."""
        program, network = Program(units), self.network
        entries = self.file.observe or [ObserveEntry(value=name) for name in units]
        if len(entries) != network.inputs:
            what = "observe" if self.file.observe else "inputs"
            raise InputError(
                f"{self.path}: {what}: {len(entries)} elements, and {self.file.network} takes "
                f"{network.inputs}"
            )
        scaled, trained = [], []
        for number, entry in enumerate(entries):
            where = f"{self.path}: observe.{number}"
            with at(f"{where}.value"):
                measured = program.add(entry.value)
            scaled.append(self._range(entry.range, measured, f"{where}.range", si=True))
            own = self._range(entry.trained, measured, f"{where}.trained", si=True) or scaled[-1]
            if network.low is not None and network.high is not None:
                if own:
                    raise InputError(
                        f"{where}: {self.file.network} has input_low and input_high; ranges are to "
                        "be given here or there"
                    )
                own = [float(network.low[number]), float(network.high[number])]
            trained.append(own)
        return program, scaled, trained

    def _acted(self, units: Mapping[str, str]) -> tuple[list[list[float]], dict[str, int]]:
        """Return the ranges of the actions, and by output which action it is."""
        entries = self.acts(units)
        acted = [
            self._range(entry.range, units[entry.to], f"{self.path}: act.{number}.range")
            for number, entry in enumerate(entries)
        ]
        if len(entries) != self.network.outputs:
            what = "act" if self.file.act else "outputs"
            raise InputError(
                f"{self.path}: {what}: {len(entries)} elements, and {self.file.network} gives "
                f"{self.network.outputs}"
            )
        return acted, {entry.to: number for number, entry in enumerate(entries)}

    def acts(self, units: Mapping[str, str]) -> list[ActEntry]:
        """Return an entry for each element of the outputs. Raises InputError."""
        entries = self.file.act or [ActEntry(to=name) for name in units]
        seen: set[str] = set()
        for number, entry in enumerate(entries):
            where = f"{self.path}: act.{number}"
            if entry.to not in units:
                raise InputError(f"{where}.to: {unknown('output', entry.to, units)}")
            if entry.to in seen:
                raise InputError(f"{where}.to: {entry.to!r} is an earlier action already")
            seen.add(entry.to)
        if left := [name for name in units if name not in seen]:
            raise InputError(f"{self.path}: act: no action is output {left[0]!r}")
        return entries

    def _range(
        self, written: list[Written] | None, measured: str, where: str, *, si: bool = False
    ) -> list[float]:
        """Return low and high in the unit ``measured``, or in SI, which bare numbers are then."""
        if written is None:
            return []
        with at(where):
            low, high = (_number(each, unit(measured), si=si) for each in written)
            if not low < high:
                raise InputError(f"low below high is needed, found {written}")
        return [low, high]


def _number(written: Written, measured: Unit, *, si: bool) -> float:
    value = quantity(written, measured)
    if si and isinstance(written, str):
        return value * measured.factor + measured.offset
    return value


def _scalars(port: Mapping[str, Any]) -> list[str]:
    return [f"{port['name']}.{axis}" for axis in port["axes"]] if port["axes"] else [port["name"]]


def _units(ports: list[dict[str, Any]]) -> dict[str, str]:
    """Return the units of scalars, by name, in their order."""
    found: dict[str, str] = {}
    for port in ports:
        names, own = _scalars(port), port["unit"]
        units = own if isinstance(own, list) else [own] * len(names)
        found.update(zip(names, units, strict=True))
    return found


def has_meaning(name: str) -> bool:
    """Return whether a name means something else, so that no port can have it."""
    try:
        unit(name)
    except InputError:
        return name in RESERVED
    return True


class at:  # noqa: N801  reads as a preposition
    """Says where a mistake stands."""

    def __init__(self, where: str) -> None:
        self._where = where

    def __enter__(self) -> None: ...

    def __exit__(self, _kind: object, error: BaseException | None, _trace: object) -> None:
        if isinstance(error, InputError):
            raise InputError(f"{self._where}: {error}") from None
