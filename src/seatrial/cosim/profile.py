"""Profiles: one vehicle's electronics (``hil_profiles/*.toml``), for simulated and real boards.

A profile says who the vehicle is on a link, where it starts, which output channel drives which
port with which pulses, and what each sensor's data sheet says. Every value that has a unit is
written with it (``"1100 us"``, ``"0.3 deg"``) and read into SI.
"""

from __future__ import annotations

import datetime
import math
import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, create_model
from pydantic_core import PydanticCustomError

from ..component import Component
from ..devices.ahrs import Ahrs
from ..devices.anemometer import Anemometer
from ..devices.compass import Compass
from ..devices.depth import Depth
from ..devices.gnss import Gnss
from ..devices.imu import Imu
from ..errors import InputError, unknown
from ..ports import Parameter
from ..units import quantity, unit
from .files import FileModel, Source, find_file, read_toml, validated

SENSORS: dict[str, type[Component]] = {
    "ahrs": Ahrs,
    "anemometer": Anemometer,
    "compass": Compass,
    "depth": Depth,
    "gnss": Gnss,
    "imu": Imu,
}
"""Kinds of sensors, and the component whose parameters a sensor of that kind gives."""

VEHICLE_TYPES = ("generic", "ground_rover", "submarine", "surface_boat")
"""MAVLink's MAV_TYPE, in lower case."""
AUTOPILOT_TYPES = ("ardupilotmega", "generic", "px4")
"""MAVLink's MAV_AUTOPILOT, in lower case."""

_VERSION = re.compile(r"\d+\.\d+\.\d+(-(dev|alpha|beta|rc))?")
_PORT = re.compile(r"[A-Za-z_]\w*(\.[A-Za-z_]\w*){1,2}")


def _refused(message: str) -> PydanticCustomError:
    # Braces would be taken for the template's own.
    return PydanticCustomError("refused", "{message}", {"message": message})


def _in_si(written: Any, target: str, low: float | None, high: float | None) -> float:
    try:
        if unit(target).exponents and not isinstance(written, str):
            raise InputError(f"a quantity with its unit is needed, such as '1 {target}'")
        value = quantity(written, target)
    except InputError as error:
        raise _refused(str(error)) from None
    if low is not None and value < low:
        raise _refused(f"at least {low:g} {target} needed")
    if high is not None and value > high:
        raise _refused(f"at most {high:g} {target} needed")
    return value


def _unit(target: str, low: float | None = None, high: float | None = None) -> BeforeValidator:
    """Read a quantity into ``target``, within limits."""
    return BeforeValidator(lambda written: _in_si(written, target, low, high))


def _one_of(what: str, allowed: tuple[str, ...]) -> BeforeValidator:
    def check(written: Any) -> Any:
        if written not in allowed:
            raise _refused(unknown(what, written, allowed))
        return written

    return BeforeValidator(check)


def _like(pattern: re.Pattern[str], example: str) -> BeforeValidator:
    def check(written: Any) -> Any:
        if not isinstance(written, str) or not pattern.fullmatch(written):
            raise _refused(f"something like {example!r} is needed")
        return written

    return BeforeValidator(check)


_Pulse = Annotated[float, _unit("s", 0.5e-3, 2.5e-3)]


class Identity(FileModel):
    """Who the vehicle is on a MAVLink network."""

    system_id: int = Field(ge=1, le=255)
    component_id: int = Field(ge=1, le=255)
    vehicle_type: Annotated[str, _one_of("vehicle type", VEHICLE_TYPES)]
    autopilot_type: Annotated[str, _one_of("autopilot type", AUTOPILOT_TYPES)]
    firmware_version: Annotated[str, _like(_VERSION, "4.5.0-dev")]
    uid: int = Field(ge=1, le=2**64 - 1)


class Home(FileModel):
    """Where and when the origin of north-east-down is: WGS 84, rad and m; a calendar day."""

    latitude: Annotated[float, _unit("rad", -math.pi / 2, math.pi / 2)]
    longitude: Annotated[float, _unit("rad", -math.pi, math.pi)]
    altitude: Annotated[float, _unit("m")]
    date: datetime.date
    source: str


class Actuator(FileModel):
    """One output channel: pulse widths in s, and the port that it drives."""

    channel: int = Field(ge=1, le=32)
    port: Annotated[str, _like(_PORT, "port_thruster.pulse")]
    pulse_min: _Pulse
    pulse_neutral: _Pulse
    pulse_max: _Pulse
    reversed: bool = False
    source: str


class ProfileFile(FileModel):
    """The content of a profile; ``sensors`` has one entry per sensor, by its name."""

    title: str
    identity: Identity
    home: Home
    actuators: dict[str, Actuator] = Field(default_factory=dict)
    sensors: Any = None


@dataclass(frozen=True)
class Profile:
    """A profile as read, everything in SI."""

    file: ProfileFile
    read_from: Source

    def sections(self) -> list[str]:
        """Return what `parameters` can be asked for: ``actuators.NAME``, ``sensors.NAME``."""
        sensors = type(self.file.sensors).model_fields
        return [f"actuators.{n}" for n in self.file.actuators] + [f"sensors.{n}" for n in sensors]

    def parameters(self, section: str) -> dict[str, float | list[float]]:
        """Return a section's values by name of the component's parameter, in the port's unit.

        A list has one value per axis. An actuator gives ``pulse_min``, ``pulse_neutral``,
        ``pulse_max`` (s) and ``reversed`` (0 or 1). Raises InputError for an unknown section.
        """
        entry = self._section(section)
        if not isinstance(entry, Actuator):
            values: dict[str, float | list[float]] = entry.model_dump(
                exclude={"kind", "source"}, exclude_unset=True
            )
            return values
        pulses = ("pulse_min", "pulse_neutral", "pulse_max")
        return {**{p: getattr(entry, p) for p in pulses}, "reversed": float(entry.reversed)}

    def source(self, section: str) -> str:
        """Return where a section's values come from. Raises InputError as `parameters`."""
        return str(self._section(section).source)

    def _section(self, section: str) -> Any:
        if section not in self.sections():
            path = self.read_from.path
            raise InputError(f"{path}: {unknown('section', section, self.sections())}")
        kind, _, name = section.partition(".")
        if kind == "sensors":
            return getattr(self.file.sensors, name)
        return self.file.actuators[name]


def load_profile(name: str | Path, relative_to: Path | None = None) -> Profile:
    """Read the profile ``name`` (shipped, in ``hil_profiles``, or a path ending in .toml).

    Raises InputError naming the file, the key, what was found and what is allowed.
    """
    path = find_file("hil_profiles", str(name), relative_to)
    content, read_from = read_toml(path)
    model = _file_model(content.get("sensors", {}), path)
    profile = Profile(validated(model, {"sensors": {}, **content}, path), read_from)
    _check_channels(profile)
    return profile


def _check_channels(profile: Profile) -> None:
    path = profile.read_from.path
    channels: dict[int, str] = {}
    ports: dict[str, str] = {}
    for name, actuator in profile.file.actuators.items():
        where = f"{path}: actuators.{name}"
        if not actuator.pulse_min < actuator.pulse_neutral < actuator.pulse_max:
            raise InputError(
                f"{where}: pulse_min, pulse_neutral and pulse_max must rise, found "
                f"{actuator.pulse_min:g}, {actuator.pulse_neutral:g}, {actuator.pulse_max:g} s"
            )
        if actuator.channel in channels:
            other = channels[actuator.channel]
            raise InputError(f"{where}.channel: {actuator.channel} is already actuators.{other}'s")
        if actuator.port in ports:
            other = ports[actuator.port]
            raise InputError(f"{where}.port: {actuator.port!r} is already driven by {other}")
        channels[actuator.channel], ports[actuator.port] = name, f"actuators.{name}"


# ------------------------------------------------------------------ schema of the sensors


def _file_model(sensors: Any, path: Path) -> type[ProfileFile]:
    """Return the schema for a file with these sensors: each has its kind's parameters as keys."""
    if not isinstance(sensors, dict):
        raise InputError(f"{path}: sensors: a table per sensor is needed, found {sensors!r}")
    models: dict[str, Any] = {}
    for name, table in sensors.items():
        kind = table.get("kind") if isinstance(table, dict) else None
        if kind not in SENSORS:
            message = unknown("kind of sensor", kind, SENSORS) if kind else "this key is missing"
            raise InputError(f"{path}: sensors.{name}.kind: {message}")
        models[name] = (_sensor_model(kind), ...)
    entries = create_model("Sensors", __base__=FileModel, **models)
    return create_model("ProfileFile", __base__=ProfileFile, sensors=(entries, ...))


@cache
def _sensor_model(kind: str) -> type[FileModel]:
    fields: dict[str, Any] = {"kind": (Literal[kind], ...), "source": (str, ...)}
    for name, port in SENSORS[kind].ports.items():
        # A seed belongs to an instance and a run, not to a data sheet.
        if isinstance(port, Parameter) and name != "seed":
            value = Annotated[float | list[float], BeforeValidator(_reader(port))]
            fields[name] = (value, 0.0)
    return create_model(kind, __base__=FileModel, **fields)


def _reader(port: Parameter) -> Callable[[Any], float | list[float]]:
    """Return what reads a parameter as written: a quantity, or a list of one per axis."""

    def read(written: Any) -> float | list[float]:
        if not isinstance(written, list):
            return _in_si(written, port.unit_of(0), port.limit("min", 0), port.limit("max", 0))
        if port.axes is None or len(written) != port.size:
            axes = (
                f"one value, or {port.size} ({', '.join(port.axes)})" if port.axes else "one value"
            )
            raise _refused(f"{axes} needed")
        return [
            _in_si(value, port.unit_of(i), port.limit("min", i), port.limit("max", i))
            for i, value in enumerate(written)
        ]

    return read
