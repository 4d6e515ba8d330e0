"""Parameters of a rig's components: seed, vehicle, profile and the rig's own, in that order."""

from __future__ import annotations

import zlib
from dataclasses import replace

from ..errors import InputError
from .parameters import ParameterSet, load_vehicle, split_reference
from .profile import Profile, Profiles
from .rig import ComponentEntry
from .system import Part, System, settable
from .values import Given, from_entry, from_written


def give_parameters(system: System, part: Part, profiles: Profiles) -> None:
    """Give a component what the rig says, the later before the earlier.

    These are the seed derived from the system's, the vehicle's parameter set, the section of an
    electronics profile, and the rig's own ``set``. Raises InputError.
    """
    entry = system.rig.file.components[part.name]
    where = f"{system.rig.read_from.path}: components.{part.name}"
    _give_seed(part, system.seed)
    if entry.parameters is not None:
        _give_parameter_set(part, _parameter_set(system, entry, where))
    if entry.profile is not None:
        profile, section = profiles.find(entry.profile, f"{where}.profile")
        _give_profile(part, section, profile, f"{where}.profile")
    for port, written in entry.set.items():
        system.set(f"{part.name}.{port}", written, f"{where}.set")


def _give_seed(part: Part, seed: int) -> None:
    """Give each instance noise of its own, yet the same in every tool and run."""
    for name in part.instance.variables.of_role("seed"):
        own = zlib.crc32(f"{seed}/{part.name}".encode())
        part.given[name] = Given(float(own), f"derived from seed {seed}")


def _give_parameter_set(part: Part, values: ParameterSet) -> None:
    part.presets, part.outline = values.presets, values.outline
    for port, value in values.values.items():
        scalars = settable(part.instance.variables, port, values.origin)
        part.given.update(from_entry(value, scalars, values.origin))


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
