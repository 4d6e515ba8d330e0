"""Profiles: one vehicle's electronics (``hil_profiles/*.toml``), for simulated and real boards.

A profile says who the vehicle is on a link, where it starts, which output channel drives which
port with which pulses, what each sensor's data sheet says, and which links it has. Every value
that has a unit is written with it (``"1100 us"``, ``"0.3 deg"``) and read into SI.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ...errors import InputError, unknown
from ...fmi.components.index import component_class, components
from ...model.ports import Parameter
from ..files import FileModel, Source, find_file, read_toml, validated
from ..tunables import Tunable, TunableEntry, read_tunables
from .data_sheets import with_data_sheets
from .file import Actuator, ProfileFile
from .kinds import GROUPS, keys, of_a_kind, section_model

NO_SOURCE = "no source given"
"""Source of what the profile gives without one."""


@dataclass(frozen=True)
class Profile:
    """A profile as read. A section of sensors or links is checked, and its class imported, when
    somebody asks for its values.
    """

    file: ProfileFile
    read_from: Source
    strange: Mapping[str, str] = field(default_factory=dict)
    """Links of unknown kinds, by section: the mistake that whoever asks for one is given."""
    _checked: dict[str, FileModel] = field(default_factory=dict, compare=False, repr=False)

    def sections(self) -> list[str]:
        """Return what `parameters` can be asked for: actuators.NAME, sensors.NAME, links.NAME."""
        named = [f"{group}.{name}" for group in GROUPS for name in self.tables(group)]
        return [*(f"actuators.{name}" for name in self.file.actuators), *named]

    def tables(self, group: str) -> dict[str, dict[str, Any]]:
        """Return the tables of ``sensors`` or ``links`` as written, by name."""
        written: dict[str, dict[str, Any]] = getattr(self.file, group)
        return written

    def parameters(self, section: str) -> dict[str, Any]:
        """Return a section's values by name of the component's parameter, in the port's unit.

        A list has one value per axis; a file is where the profile says, relative to itself. An
        actuator gives ``pulse_min``, ``pulse_neutral``,
        ``pulse_max`` (s) and ``reversed`` (0 or 1). A link also gives those of identity, home
        and, as text, ``actuators`` that its component has. Raises InputError for an unknown
        section, and with a line for each mistake in it.
        """
        entry = self._section(section)
        if isinstance(entry, Actuator):
            pulses = ("pulse_min", "pulse_neutral", "pulse_max")
            return {**{p: getattr(entry, p) for p in pulses}, "reversed": float(entry.reversed)}
        group, _, name = section.partition(".")
        kind = self.tables(group)[name]["kind"]
        values: dict[str, Any] = entry.model_dump(exclude={"kind", "source"}, exclude_unset=True)
        for key, port in keys(group, kind).items():
            if port.role == "file" and values.get(key):
                values[key] = str(self.read_from.path.parent / values[key])
            if port.role == "tunables":  # they start with what they set: see `tunables`
                values.pop(key, None)
        if group == "links":
            ports = component_class(kind).ports
            shared = {name: value for name, value in self._shared().items() if name in ports}
            if "instruments" in ports:
                shared["instruments"] = self._instruments()
            return {**shared, **values}
        return values

    def tunables(self, section: str) -> tuple[Tunable, ...]:
        """Return what a link of a rig tunes in other components, in the order of its outputs.

        Empty for a section that has none. Raises InputError as `parameters`.
        """
        entry = self._section(section)
        group, _, name = section.partition(".")
        if isinstance(entry, Actuator):
            return ()
        ports = keys(group, self.tables(group)[name]["kind"])
        found = [(getattr(entry, k), p) for k, p in ports.items() if p.role == "tunables"]
        return tuple(each for table, port in found for each in read_tunables(table, port))

    def assume(self, section: str) -> None:
        """Add a link ``links.KIND`` that the profile lacks, with its kind's own values."""
        kind = section.removeprefix("links.")
        if section.startswith("links.") and kind in components().names():
            self.file.links.setdefault(kind, {"kind": kind})

    def source(self, section: str) -> str:
        """Return where a section's values come from, of a link without a source those of home.

        Raises InputError as `parameters`.
        """
        source = str(getattr(self._section(section), "source", ""))
        if not source and section.startswith("links."):
            source = self.file.home.source
        return source or NO_SOURCE

    def notes(self, section: str) -> list[str]:
        """Return what a section takes by default and a user should know.

        Raises InputError as `parameters`.
        """
        entry, where = self._section(section), f"profile {self.read_from.name}: {section}"
        group, _, name = section.partition(".")
        if group != "links":
            return [] if entry.source else [f"{where} has no source"]
        ports = component_class(self.tables(group)[name]["kind"]).ports
        shared = self._shared()
        absent = [
            f"{key} = {shared[key]}"
            for table in (self.file.identity, self.file.home)
            for key in type(table).model_fields
            if key in ports and key in shared and key not in table.model_fields_set
        ]
        said = f"{where} has defaults for what [identity] and [home] do not say: "
        return [said + ", ".join(absent)] if absent else []

    def lacks(self, section: str) -> str:
        """Return why a section cannot be had that `sections` does not have."""
        why = self.strange.get(section) or unknown("section", section, self.sections())
        return f"{self.read_from.path}: {why}"

    def _shared(self) -> dict[str, Any]:
        identity, home = self.file.identity, self.file.home
        return {
            "system_id": float(identity.system_id),
            "component_id": float(identity.component_id),
            "vehicle_type": identity.vehicle_type,
            "autopilot_type": identity.autopilot_type,
            "firmware_version": identity.firmware_version,
            "uid": str(identity.uid),  # more digits than a Real has
            "latitude": home.latitude,
            "longitude": home.longitude,
            "altitude": home.altitude,
            "date": home.date.isoformat(),
            "actuators": "; ".join(
                f"{each.channel} {name} {each.pulse_min * 1e6:g} {each.pulse_neutral * 1e6:g} "
                f"{each.pulse_max * 1e6:g}{' reversed' if each.reversed else ''}"
                for name, each in self.file.actuators.items()
            ),
        }

    def _instruments(self) -> str:
        """Return all sensors as JSON: kind and parameters, SI; of the kind where none is given."""
        found = {}
        for name, table in self.tables("sensors").items():
            ports = keys("sensors", table["kind"])
            starts = {key: port.start for key, port in ports.items()}
            found[name] = {"kind": table["kind"], **starts, **self.parameters(f"sensors.{name}")}
        return json.dumps(found)

    def _section(self, section: str) -> Any:
        if section not in self.sections():
            raise InputError(self.lacks(section))
        group, _, name = section.partition(".")
        if group == "actuators":
            return self.file.actuators[name]
        if section not in self._checked:
            table = self.tables(group)[name]
            self._checked[section] = _read_section(self.read_from.path, group, name, table)
        return self._checked[section]


def load_profile(name: str | Path, relative_to: Path | None = None) -> Profile:
    """Read the profile ``name`` (shipped, in ``hil_profiles``, or a path ending in .toml).

    Raises InputError with a line for each mistake, naming the file, the key, what was found and
    what is allowed.
    """
    path = find_file("hil_profiles", str(name), relative_to)
    content, read_from = read_toml(path)
    file, _, mistakes, strange = _parsed(content, path)
    if file is None or mistakes:
        raise InputError("\n".join(mistakes))
    return Profile(file, read_from, strange)


def check_profile(name: str | Path, relative_to: Path | None = None) -> Profile:
    """Read a profile with all its sections, also those that no rig uses.

    Raises InputError with a line for each mistake, as `load_profile`, in all sections.
    """
    path = find_file("hil_profiles", str(name), relative_to)
    content, read_from = read_toml(path)
    file, groups, mistakes, strange = _parsed(content, path)
    mistakes += [f"{path}: {mistake}" for mistake in strange.values()]
    profile = None if file is None else Profile(file, read_from)
    for group, tables in groups.items():
        for section, table in tables.items():
            try:
                _read_section(path, group, section, table)
                if profile is not None:
                    _check_together(profile, f"{group}.{section}", table["kind"])
            except InputError as error:
                mistakes.append(str(error))
    if profile is None or mistakes:
        raise InputError("\n".join(mistakes))
    return profile


class Profiles:
    """The profiles that a rig's components name, each read once; ``own`` is the rig's.

    Raises InputError as `load_profile`.
    """

    def __init__(self, own: str | None, folder: Path) -> None:
        self._own, self._folder = own, folder
        self._read: dict[str, Profile] = {}
        if self._own is not None:
            self._load(self._own)

    def home(self) -> tuple[float, float, float] | None:
        """Return latitude and longitude, rad, and altitude, m, of the rig's own profile."""
        if self._own is None:
            return None
        home = self._load(self._own).file.home
        return home.latitude, home.longitude, home.altitude

    def find(self, written: str, where: str) -> tuple[Profile, str]:
        """Return the profile and the section of "SECTION" or "PROFILE:SECTION".

        A link ``links.KIND?`` that the profile does not have is one of that kind with its own
        values, and what identity, home, actuators and sensors say.

        Raises InputError, which begins with ``where``, if there is no profile to look in, or no
        such section in it: an autopilot may need what a vehicle's profile lacks.
        """
        name, colon, section = written.rpartition(":")
        if not colon and self._own is None:
            raise InputError(
                f"{where}: the rig names no profile, and {written!r} none of its own, as in "
                f"'hydrone:{written}'"
            )
        profile = self._load(name if colon else str(self._own))
        if section.endswith("?"):
            section = section.removesuffix("?")
            profile.assume(section)
        if section not in profile.sections():
            raise InputError(f"{where}: {profile.lacks(section)}")
        return profile, section

    def _load(self, name: str) -> Profile:
        if name not in self._read:
            self._read[name] = load_profile(name, self._folder)
        return self._read[name]


def _parsed(
    content: dict[str, Any], path: Path
) -> tuple[ProfileFile | None, dict[str, dict[str, Any]], list[str], dict[str, str]]:
    """Return a profile as far as it can be read without its components' classes.

    The file, None if a key of it does not fit; the tables of known kinds, by group; mistakes;
    links of unknown kinds, as `Profile.strange`.
    """
    mistakes: list[str] = []
    groups: dict[str, dict[str, Any]] = {}
    strange: dict[str, str] = {}
    sensors, wrong = with_data_sheets(content.get("sensors", {}), path)
    mistakes += [f"{path}: {mistake}" for mistake in wrong]
    content = {**content, "sensors": sensors}
    for group in GROUPS:
        groups[group], wrong, unknown_kinds = of_a_kind(group, content.get(group, {}))
        mistakes += [f"{path}: {mistake}" for mistake in wrong]
        strange |= unknown_kinds
    try:
        file = validated(ProfileFile, {**content, **groups}, path)
    except InputError as error:
        return None, groups, [*mistakes, str(error)], strange
    mistakes += [f"{path}: {mistake}" for mistake in _channel_mistakes(file)]
    return file, groups, mistakes, strange


def _read_section(path: Path, group: str, name: str, table: dict[str, Any]) -> FileModel:
    """Return a table in SI. Raises InputError with a line for each mistake in it."""
    model = section_model(group, name, table["kind"])
    entry: FileModel = getattr(getattr(validated(model, {group: {name: table}}, path), group), name)
    for key, port in keys(group, table["kind"]).items():
        written = getattr(entry, key)
        if port.role == "file" and written and not (path.parent / written).is_file():
            file = path.parent / written
            raise InputError(f"{path}: {group}.{name}.{key}: there is no file {file}")
        if port.role == "tunables":
            _check_tunables(written, port, f"{path}: {group}.{name}.{key}")
    return entry


def _check_tunables(table: dict[str, TunableEntry], port: Parameter, where: str) -> None:
    """Raise InputError with a line for each mistake, which begins with ``where``."""
    try:
        read_tunables(table, port)
    except InputError as error:
        lines = str(error).splitlines()
        raise InputError("\n".join(f"{where}: {line}" for line in lines)) from None


def _check_together(profile: Profile, section: str, kind: str) -> None:
    """Raise InputError for values that its component refuses together."""
    component = component_class(kind)(section)
    try:
        for key, value in profile.parameters(section).items():
            component.set(key, value)
        component.check_parameters()
    except InputError as error:
        raise InputError(f"{profile.read_from.path}: {error}") from None


def _channel_mistakes(file: ProfileFile) -> list[str]:
    """Return what no single key can tell: the order of pulses, channels and ports used twice."""
    mistakes = []
    channels: dict[int, str] = {}
    ports: dict[str, str] = {}
    for name, actuator in file.actuators.items():
        where = f"actuators.{name}"
        if not actuator.pulse_min < actuator.pulse_neutral < actuator.pulse_max:
            mistakes.append(
                f"{where}: pulse_min, pulse_neutral and pulse_max must rise, found "
                f"{actuator.pulse_min:g}, {actuator.pulse_neutral:g}, {actuator.pulse_max:g} s"
            )
        if actuator.channel in channels:
            other = channels[actuator.channel]
            mistakes.append(f"{where}.channel: {actuator.channel} is already {other}'s")
        if actuator.port in ports:
            other = ports[actuator.port]
            mistakes.append(f"{where}.port: {actuator.port!r} is already driven by {other}")
        channels.setdefault(actuator.channel, where)
        ports.setdefault(actuator.port, where)
    return mistakes
