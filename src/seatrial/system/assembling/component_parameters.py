"""Parameters of a rig's components: seed, vehicle, profile and the rig's own, in that order."""

from __future__ import annotations

import json
import zlib
from dataclasses import replace
from typing import Any

from ...errors import InputError
from ...files.vehicle_folders import FOLDERS, VEHICLE
from ...model.units import quantity
from ..parameters import OWN, ParameterSet, Vehicle, load_vehicle, split_reference
from ..part import Part
from ..paths import joined
from ..profile.profile import Profile, Profiles
from ..references.derived import computed
from ..references.entries import Resolved
from ..references.expressions import is_expression, names_in
from ..references.values import Given, from_entry, from_written
from ..rig import Placed, Scope
from ..system import System, settable
from .assumed import give_assumed


def give_parameters(system: System, part: Part, profiles: Profiles) -> None:
    """Give a component what its rig says, the later before the earlier.

    These are the seed derived from the system's, the vehicle's parameter set, the section of an
    electronics profile, the home of the rig around it, and the rig's own ``set``. Raises
    InputError.
    """
    placed = system.rig.components[part.name]
    entry, where = placed.entry, placed.where
    part.home = _home(placed.scope, profiles)
    give_seed(part, system.seed)
    _give_origin(part)
    if entry.parameters:
        values = _parameter_set(system, placed)
        if entry.parameters.endswith(OWN):
            values = values.own(part.instance.variables, part.fmu, f"{where}.parameters")
        _give_parameter_set(part, values)
        _give_shape(system, part, placed)
    if entry.profile is not None:
        profile, section = profiles.find(entry.profile, f"{where}.profile")
        _give_profile(part, section, profile, f"{where}.profile")
        system.notes += [note for note in profile.notes(section) if note not in system.notes]
        if section.startswith("links."):
            _give_home(part, placed.scope)
    for port, said in entry.set.items():
        written = followed(system, placed.scope, said, f"{where}.set: {port}")
        variable = part.instance.variables.get(port)
        if variable is not None and variable.causality == "structuralParameter":
            part.given.update(from_written(written, [variable], {}, f"{where}.set: {port}"))
        else:
            folder = placed.scope.read_from.path.parent
            system.set(f"{part.name}.{port}", written, f"{where}.set", folder)


def vehicles_of(placed: Placed) -> list[Vehicle]:
    """Return the vehicles that give a component parameters, and values that its rig sets."""
    entry, folder = placed.entry, placed.scope.read_from.path.parent
    names: dict[str, None] = {}
    if entry.parameters:
        names.setdefault(split_reference(entry.parameters, entry.fmu)[0])
    for written in entry.set.values():
        for text in written if isinstance(written, list) else [written]:
            if is_expression(text):
                names |= {name.partition(".")[0]: None for name in names_in(text)}
    return [load_vehicle(name, folder) for name in names]


_DERIVED = "derived from seed "


def derived_seeds(part: Part) -> dict[str, str]:
    """Return the component's seeds that follow from the system's: parameters, and whose each is."""
    found = {}
    for name in part.instance.variables.of_role("seed"):
        given = part.given.get(name)
        if given is None or given.origin.startswith(_DERIVED):
            inside = name.rpartition(".")[0]  # of a rig as one FMU: the component's path there
            found[name] = joined(part.name, inside) if inside else part.name
    return found


def seed_of(owner: str, seed: int) -> float:
    """Return the seed of a component in a system with ``seed``."""
    return float(zlib.crc32(f"{seed}/{owner}".encode()))


def give_seed(part: Part, seed: int) -> None:
    """Give each instance noise of its own, yet the same in every tool and run."""
    for name, owner in derived_seeds(part).items():
        part.given[name] = Given(seed_of(owner, seed), f"{_DERIVED}{seed}")


def _give_origin(part: Part) -> None:
    """Give the origin of {n} to whoever places something in the world, as `Part.home` has it."""
    if part.home is None:
        return
    place = dict(zip(("latitude", "longitude", "altitude"), part.home, strict=True))
    for name in part.instance.variables.of_role("home"):
        part.given[name] = Given(place[name.rpartition(".")[2]], "home of the rig")


def _give_parameter_set(part: Part, values: ParameterSet) -> None:
    part.presets, part.outline = values.presets, values.outline
    part.shape, part.vehicle = values.body, values.vehicle
    for port, value in values.values.items():
        scalars = settable(part.instance.variables, port, values.origin)
        part.given.update(from_entry(value, scalars, values.origin, values.folder))
    give_assumed(part)


def _give_shape(system: System, part: Part, placed: Placed) -> None:
    """Give the shape of all of the vehicle that the rig has to whoever shows it to others."""
    names = list(part.instance.variables.of_role("shape"))
    if not names:
        return
    vehicle, _ = _named(placed)
    every = [p for p in system.rig.components.values() if p.entry.parameters]
    has = {(of.read_from.path, table) for of, table in map(_named, every)}
    shapes = vehicle.file.shape.items()
    drawn = [s for table, shape in shapes if (vehicle.read_from.path, table) in has for s in shape]
    written = json.dumps([each.model_dump(exclude_none=True) for each in drawn])
    for name in names:
        part.given[name] = Given(written, f"shape of {vehicle.read_from.name}")


def _named(placed: Placed) -> tuple[Vehicle, str]:
    """Return the vehicle that gives a component parameters, and the table."""
    assert placed.entry.parameters is not None
    name, table = split_reference(placed.entry.parameters, placed.entry.fmu)
    return load_vehicle(name, placed.scope.read_from.path.parent), table


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


def _home(scope: Scope, profiles: Profiles) -> tuple[float, float, float] | None:
    if scope.home is None:
        return profiles.home()
    latitude, longitude, altitude = scope.home
    return quantity(latitude, "rad"), quantity(longitude, "rad"), quantity(altitude, "m")


def _give_home(part: Part, scope: Scope) -> None:
    """Move a link to the home of the rig that it is in, if that has one of its own."""
    if scope.home is None:
        return
    origin = f"{scope.read_from.path.name}: home of {scope.path}"
    for port, written in zip(("latitude", "longitude", "altitude"), scope.home, strict=True):
        if port in part.instance.variables:
            scalars = settable(part.instance.variables, port, origin)
            part.given.update(from_written(written, scalars, {}, origin))


def _parameter_set(system: System, placed: Placed) -> ParameterSet:
    """Return the vehicle's values, of the system's variant; inside, if the vehicle has that."""
    entry, scope = placed.entry, placed.scope
    assert entry.parameters is not None
    try:
        vehicle, table = _named(placed)
        variant = _variant(system, scope, vehicle)
        _note_idle_rigs(system, vehicle)
        if entry.parameters.endswith("?") and table not in vehicle.tables:
            where = vehicle.read_from.path
            system.notes.append(f"{where} has no table {table}: {placed.name} has its own values")
            return ParameterSet()
        return vehicle.parameter_set(table, variant)
    except InputError as error:
        raise InputError(f"{placed.where}.parameters: {error}") from None


def _note_idle_rigs(system: System, vehicle: Vehicle) -> None:
    path, name = vehicle.read_from.path, vehicle.read_from.name
    note = f"{path}: its rigs have no effect there, but in {FOLDERS}/{name}/{VEHICLE}"
    if vehicle.idle and note not in system.notes:
        system.notes.append(note)


def _variant(system: System, scope: Scope, vehicle: Vehicle) -> str | None:
    """Return the variant of a vehicle: the system's, inside if the vehicle has that."""
    if system.variant is not None and (scope.path == "" or system.variant in vehicle.file.variants):
        return system.variant
    return scope.variant


def followed(system: System, scope: Scope, written: Any, where: str) -> Any:
    """Return what a rig sets with each expression in it as the entry that it amounts to.

    Names begin with that of a vehicle: ``"= otter.marine-craft.mass"``. Raises InputError.
    """
    if isinstance(written, list):
        return [followed(system, scope, each, where) for each in written]
    if not is_expression(written):
        return written

    def look_up(name: str) -> Resolved:
        vehicle_name, _, rest = name.partition(".")
        vehicle = load_vehicle(vehicle_name, scope.read_from.path.parent)
        return vehicle.entries(_variant(system, scope, vehicle)).named(rest)

    try:
        return computed(written, look_up)
    except InputError as error:
        raise InputError(f"{where}: {written!r}: {error}") from None
