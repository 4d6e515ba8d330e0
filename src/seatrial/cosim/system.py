"""A rig assembled: instances of its FMUs with their parameters, and its wires."""

from __future__ import annotations

import zlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Literal

from ..component import Noise, seconds
from ..errors import InputError, unknown
from ..fmi.bundle_name import bundle_name
from ..fmi.direct import DirectInstance
from ..fmi.instance import Instance, Variable, Variables
from ..fmi.source import find_source
from ..units import conversion
from .parameters import ParameterSet, load_vehicle, split_reference
from .profile import Profile, Profiles
from .rig import ComponentEntry, Rig, WireEntry, duration_ns
from .values import Given, from_entry, from_written, port_names, port_scalars

Engine = Literal["fmu", "direct"]

_TIMEOUT_S = 60.0
"""Longest wall time of a call of an isolated component, where the rig says nothing else."""


@dataclass
class Part:
    """One component of an assembled rig."""

    name: str
    fmu: str
    instance: Instance
    sha256: str
    """Of the FMU file; empty in process."""
    code: str
    """Name and hash of the code, equal in both carriers; empty for a file of somebody else."""
    every: int
    """It steps once in so many communication steps."""
    given: dict[str, Given] = field(default_factory=dict)
    """Values set by the rig's user, by variable name; the others keep the FMU's start values."""
    presets: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)


@dataclass(frozen=True)
class Wire:
    """One scalar connection; the target gets factor * value + offset."""

    source: tuple[str, str]
    target: tuple[str, str]
    factor: float = 1.0
    offset: float = 0.0
    to_real: bool = False
    """An Integer output feeds a Real input."""

    @property
    def converts(self) -> bool:
        """Say if a value changes on its way."""
        return self.to_real or (self.factor, self.offset) != (1.0, 0.0)


@dataclass
class System:
    """An assembled rig: what the master steps."""

    rig: Rig
    engine: Engine
    seed: int
    variant: str | None
    parts: dict[str, Part]
    wires: list[Wire]

    def set(self, key: str, written: Any, origin: str) -> None:
        """Set ``component.port`` to what a person wrote, before the run.

        Raises InputError for an unknown component or port, or a value that does not fit.
        """
        part, scalars = self._settable(key, origin)
        for variable in scalars:
            self.refuse_wired(part.name, variable.name, origin)
        presets = part.presets.get(key.partition(".")[2], {})
        part.given.update(from_written(written, scalars, presets, f"{origin}: {key}"))

    def scale(self, key: str, factor: float, origin: str) -> None:
        """Multiply the number ``component.port``, as set so far, by ``factor``.

        Raises InputError for an unknown component or port, or one that holds no number.
        """
        part, scalars = self._settable(key, origin)
        for variable in scalars:
            given = part.given.get(variable.name)
            value = variable.start if given is None else given.value
            if not isinstance(value, float):
                raise InputError(f"{origin}: {key} is not a real number and cannot be scaled")
            before = "start value of the FMU" if given is None else given.origin
            part.given[variable.name] = Given(
                value * factor, f"{origin}: {factor!r} times {before}"
            )

    def refuse_wired(self, component: str, variable: str, origin: str) -> None:
        """Raise InputError if a wire feeds the input, so that a value set would do nothing."""
        for wire in self.wires:
            if wire.target == (component, variable):
                feeder = ".".join(wire.source)
                raise InputError(
                    f"{origin}: {component}.{variable} is fed by {feeder}; override it in an event"
                )

    def _settable(self, key: str, origin: str) -> tuple[Part, list[Variable]]:
        name, _, port = key.partition(".")
        if name not in self.parts:
            raise InputError(f"{origin}: {unknown('component', name, self.parts)}")
        part = self.parts[name]
        return part, settable(part.instance.variables, port, f"{origin}: {name}")

    def feeders(self, component: str) -> dict[str, str]:
        """Return which outputs feed the inputs and parameters of a component, by their names."""
        return {w.target[1]: ".".join(w.source) for w in self.wires if w.target[0] == component}

    def unconnected_inputs(self) -> list[str]:
        """Return the inputs that no wire reaches and nobody set; whole ports by their name.

        Optional ones are not among them.
        """
        wired = {wire.target for wire in self.wires}
        found: dict[str, None] = {}
        for name, part in self.parts.items():
            variables = part.instance.variables
            inputs = {n for n, v in variables.items() if v.causality == "input"}
            reached = {n for n in inputs if (name, n) in wired or n in part.given}
            loose = {n for n in inputs - reached if not variables[n].optional}
            whole = {}
            for variable in (n for n in variables if n in loose):
                port = variables.port_of(variable)
                if port not in whole:
                    siblings = inputs.intersection(v.name for v in variables.ports.get(port, ()))
                    whole[port] = bool(siblings) and siblings <= loose
                found[f"{name}.{port if whole[port] else variable}"] = None
        return list(found)

    def free(self) -> None:
        """Release all instances."""
        for part in self.parts.values():
            part.instance.free()


def settable(variables: Variables, port: str, where: str) -> list[Variable]:
    """Return the scalars of a parameter or input port. Raises InputError."""
    scalars = port_scalars(variables, port)
    if not scalars:
        raise InputError(f"{where}: {unknown('port', port, port_names(variables))}")
    if scalars[0].causality not in ("parameter", "input"):
        kind = scalars[0].causality
        raise InputError(f"{where}.{port} has the causality {kind} and cannot be set")
    return scalars


def assemble(
    rig: Rig,
    engine: Engine = "fmu",
    *,
    variant: str | None = None,
    seed: int = 1,
    progress: Callable[[str], None] = lambda _: None,
) -> System:
    """Load, or build, every FMU of ``rig``, and check its wires.

    ``variant`` replaces the rig's; ``seed`` is what the components' own seeds derive from,
    where a component has one. Raises InputError for anything in the files that does not fit.
    """
    system = System(rig, engine, seed, variant or rig.file.variant, {}, [])
    profiles = Profiles(rig.file.profile, rig.read_from.path.parent)
    once: dict[str, str] = {}
    try:
        for name, entry in rig.file.components.items():
            progress(f"{name} ({entry.fmu})")
            part = _part(rig, name, entry, engine, once)
            system.parts[name] = part
            _give_parameters(system, part, entry, profiles)
        if system.variant and not any(e.parameters for e in rig.file.components.values()):
            raise InputError(
                f"{rig.read_from.path}: variant {system.variant!r}: no component takes parameters "
                "of a vehicle, so there is nothing to vary"
            )
        system.wires = _wires(system)
        fed = {wire.target for wire in system.wires}
        for name, part in system.parts.items():
            # What a vehicle's file says of all its rigs gives way to a wire of this one.
            for variable in [v for v in part.given if part.given[v].mark and (name, v) in fed]:
                del part.given[variable]
            for variable in part.given:
                system.refuse_wired(name, variable, part.given[variable].origin)
    except BaseException:
        system.free()
        raise
    return system


def _part(rig: Rig, name: str, entry: ComponentEntry, engine: Engine, once: dict[str, str]) -> Part:
    where = f"{rig.read_from.path}: components.{name}"
    every = 1
    if entry.step is not None:
        step_ns = duration_ns(entry.step, f"{where}.step")
        every, rest = divmod(step_ns, rig.step_ns)
        if every < 1 or rest:
            raise InputError(
                f"{where}.step: {entry.step!r} is not a multiple of the rig's {rig.file.step!r}"
            )
    timeout_s = _timeout_s(entry, f"{where}.timeout")
    try:
        instance, sha256, code = _instance(entry, name, rig.folder, engine, timeout_s, once)
    except InputError as error:
        raise InputError(f"{where}.fmu: {error}") from None
    return Part(name, entry.fmu, instance, sha256, code, every)


def _timeout_s(entry: ComponentEntry, where: str) -> float:
    """Return the longest wall time of one call of a component, if it is isolated."""
    if entry.timeout is None:
        return _TIMEOUT_S
    timeout_ns = duration_ns(entry.timeout, where)
    if timeout_ns <= 0:
        raise InputError(f"{where}: must be positive, found {entry.timeout!r}")
    return seconds(timeout_ns)


def _instance(
    entry: ComponentEntry,
    name: str,
    folder: Path,
    engine: Engine,
    timeout_s: float,
    once: dict[str, str],
) -> tuple[Instance, str, str]:
    """Return an instance, the hash of its FMU file and the name of its code; see `Part`.

    An isolated component is an FMU with either engine. ``once`` has, by their hashes, the names
    of the components in this process whose FMU allows one instance only.
    """
    source = find_source(entry.fmu, folder)
    in_process = engine == "direct" and not entry.isolated
    code = (
        "" if isinstance(source, Path) else bundle_name(source.stem, source.script, source.folder)
    )
    if in_process:
        if isinstance(source, Path):
            raise InputError(
                f"{source.name} can only run with the engine 'fmu', or with isolated = true"
            )
        return DirectInstance(source.component_class()(name)), "", code
    # A run in process needs neither FMPy nor pythonfmu.
    from ..fmi.export import cached_fmu
    from ..fmi.isolated import IsolatedInstance
    from ..fmi.load import load_fmu, open_instance

    loaded = load_fmu(source if isinstance(source, Path) else cached_fmu(source, code))
    if entry.isolated:
        return IsolatedInstance(loaded, name, timeout_s), loaded.sha256, code
    if loaded.description.coSimulation.canBeInstantiatedOnlyOncePerProcess:
        if loaded.sha256 in once:
            raise InputError(
                f"{loaded.path.name} says that a process can have one instance of it only, and "
                f"{once[loaded.sha256]} is that; isolated = true gives {name} a process of its own"
            )
        once[loaded.sha256] = name
    return open_instance(loaded, name), loaded.sha256, code


def _give_parameters(system: System, part: Part, entry: ComponentEntry, profiles: Profiles) -> None:
    path, variables = system.rig.read_from.path, part.instance.variables
    where = f"{path}: components.{part.name}"
    seed_port = variables.get("seed")
    if seed_port is not None and seed_port.description == Noise.seed.description:
        # Each instance has noise of its own, yet the same in every tool and run.
        seed = zlib.crc32(f"{system.seed}/{part.name}".encode())
        part.given["seed"] = Given(float(seed), f"derived from seed {system.seed}")
    if entry.parameters is not None:
        values = _parameter_set(system, entry, where)
        part.presets = values.presets
        for port, value in values.values.items():
            scalars = settable(variables, port, values.origin)
            part.given.update(from_entry(value, scalars, f"{values.origin}"))
    if entry.profile is not None:
        profile, section = profiles.find(entry.profile, f"{where}.profile")
        _give_profile(part, section, profile, f"{where}.profile")
    for port, written in entry.set.items():
        system.set(f"{part.name}.{port}", written, f"{where}.set")


def _give_profile(part: Part, section: str, profile: Profile, where: str) -> None:
    variables = part.instance.variables
    values = profile.parameters(section)
    if section.startswith("actuators."):
        # A channel says what its driver and what its actuator need: each takes its share.
        values = {port: value for port, value in values.items() if port in variables}
        if not values:
            raise InputError(f"{where}: nothing in {section} is a parameter of {part.fmu}")
    origin = f"hil_profiles/{profile.read_from.path.name} [{section}]"
    source = profile.source(section)
    for port, value in values.items():
        scalars = settable(variables, port, f"{where}: {part.name}")
        for name, given in from_written(value, scalars, {}, origin).items():
            part.given[name] = replace(given, source=source)


def _parameter_set(system: System, entry: ComponentEntry, where: str) -> ParameterSet:
    assert entry.parameters is not None
    name, table = split_reference(entry.parameters, entry.fmu)
    try:
        vehicle = load_vehicle(name, system.rig.read_from.path.parent)
        return vehicle.parameter_set(table, system.variant)
    except InputError as error:
        raise InputError(f"{where}.parameters: {error}") from None


def _wires(system: System) -> list[Wire]:
    wires: list[Wire] = []
    taken: dict[tuple[str, str], str] = {}
    for written_source, wire in system.rig.connections():
        written_target = wire.to
        where = f'{system.rig.read_from.path}: connections."{written_source}"'
        sources = _end(system, written_source, ("output",), where)
        targets = _end(system, written_target, ("input", "tunable parameter"), where)
        if len(sources) != len(targets):
            raise InputError(
                f"{where}: {written_source} has {len(sources)} scalars, "
                f"{written_target} has {len(targets)}"
            )
        for source, target in zip(sources, targets, strict=True):
            key = (written_target.partition(".")[0], target.name)
            if key in taken:
                raise InputError(
                    f"{where}: {key[0]}.{key[1]} is already fed by {taken[key]}; "
                    "an input takes one wire"
                )
            taken[key] = written_source
            origin = (written_source.partition(".")[0], source.name)
            to_real = (source.type, target.type) == (int, float)
            factor, offset = _transformed(*_converting(source, target, wire, where), wire)
            if (factor, offset) != (1.0, 0.0) and target.type is not float:
                raise InputError(f"{where}: {written_target} is no real number to transform")
            wires.append(Wire(origin, key, factor, offset, to_real))
    return wires


def _end(system: System, written: str, wanted: tuple[str, ...], where: str) -> list[Variable]:
    """Return the scalars at one end of a wire, which must be of a wanted kind."""
    name, _, port = written.partition(".")
    if name not in system.parts:
        raise InputError(f"{where}: {unknown('component', name, system.parts)}")
    variables = system.parts[name].instance.variables
    scalars, needed = port_scalars(variables, port), " or ".join(wanted)
    if not scalars:
        fitting = Variables({n: v for n, v in variables.items() if _kind(v) in wanted})
        raise InputError(f"{where}: {name}: {unknown(needed, port, port_names(fitting))}")
    for variable in scalars:
        if _kind(variable) not in wanted:
            raise InputError(f"{where}: {written} is {_kind(variable)}, {needed} is needed")
    return scalars


def _kind(variable: Variable) -> str:
    """Return a variable's causality; of a parameter, its variability too."""
    if variable.causality != "parameter":
        return variable.causality
    return f"{variable.variability} parameter"


def _transformed(factor: float, offset: float, wire: WireEntry) -> tuple[float, float]:
    """Return a conversion of units followed by a wire's own linear transformation."""
    if (wire.factor, wire.offset) == (1.0, 0.0):
        return factor, offset
    return wire.factor * factor, wire.factor * offset + wire.offset


def _converting(
    source: Variable, target: Variable, wire: WireEntry, where: str
) -> tuple[float, float]:
    """Return the factor and offset between two ends; raise InputError if they do not fit."""
    if source.type is not target.type and (source.type, target.type) != (int, float):
        raise InputError(
            f"{where}: {source.name} is {source.type.__name__}, "
            f"{target.name} is {target.type.__name__}"
        )
    if not (wire.convert and source.unit and target.unit and target.type is float):
        return 1.0, 0.0
    try:
        return conversion(source.measure, target.measure)
    except InputError as error:
        raise InputError(f"{where}: {source.name} to {target.name}: {error}") from None
