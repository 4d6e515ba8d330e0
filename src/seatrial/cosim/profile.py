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
_NAME = re.compile(r"[A-Za-z][\w-]*", re.ASCII)
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


def _listed(names: tuple[str, ...]) -> str:
    return ", ".join(f"`{name}`" for name in names)


_Pulse = Annotated[float, _unit("s", 0.5e-3, 2.5e-3)]
_PULSE = "0.5 to 2.5 ms"


class Identity(FileModel):
    """Who the vehicle is on a MAVLink network."""

    system_id: int = Field(ge=1, le=255, title="1 to 255", description="MAVLink system")
    component_id: int = Field(ge=1, le=255, title="1 to 255", description="MAVLink component")
    vehicle_type: Annotated[str, _one_of("vehicle type", VEHICLE_TYPES)] = Field(
        title=_listed(VEHICLE_TYPES), description="MAV_TYPE"
    )
    autopilot_type: Annotated[str, _one_of("autopilot type", AUTOPILOT_TYPES)] = Field(
        title=_listed(AUTOPILOT_TYPES), description="MAV_AUTOPILOT"
    )
    firmware_version: Annotated[str, _like(_VERSION, "4.5.0-dev")] = Field(
        title="like `4.5.0` or `4.5.0-dev` (`dev`, `alpha`, `beta`, `rc`)",
        description="version that the vehicle reports",
    )
    uid: int = Field(
        ge=1, le=2**64 - 1, title="1 to 2^64 - 1", description="serial number of the hardware"
    )


class Home(FileModel):
    """Where and when the origin of north-east-down is: WGS 84, rad and m; a calendar day."""

    latitude: Annotated[float, _unit("rad", -math.pi / 2, math.pi / 2)] = Field(
        title="angle, -90 to 90 deg", description="WGS 84"
    )
    longitude: Annotated[float, _unit("rad", -math.pi, math.pi)] = Field(
        title="angle, -180 to 180 deg", description="WGS 84"
    )
    altitude: Annotated[float, _unit("m")] = Field(title="length", description="WGS 84")
    date: datetime.date = Field(title="calendar day, without quotes", description="day of the run")
    source: str = Field(title="text", description="where this is from")


class Actuator(FileModel):
    """One output channel: pulse widths in s, and the port that it drives."""

    channel: int = Field(
        ge=1, le=32, title="1 to 32", description="output channel, one per actuator"
    )
    port: Annotated[str, _like(_PORT, "port_thruster.pulse")] = Field(
        title="`component.port`", description="the port that the channel drives, one per actuator"
    )
    pulse_min: _Pulse = Field(title=_PULSE, description="pulse of one end")
    pulse_neutral: _Pulse = Field(title=_PULSE, description="pulse that stops it, or of the middle")
    pulse_max: _Pulse = Field(
        title=_PULSE, description="pulse of the other end; the three must rise"
    )
    reversed: bool = Field(False, title="`true` or `false`", description="it acts the other way")
    source: str = Field(title="text", description="data sheet, or that it is assumed")


class ProfileFile(FileModel):
    """The content of a profile; ``sensors`` has one entry per sensor, by its name."""

    title: str = Field(title="text", description="for listings")
    identity: Identity = Field(title="table", description="who the vehicle is on a MAVLink network")
    home: Home = Field(title="table", description="where and when the origin of north-east-down is")
    actuators: dict[Annotated[str, _like(_NAME, "port")], Actuator] = Field(
        default_factory=dict, title="table per output channel", description="by name"
    )
    sensors: Any = Field(None, title="table per sensor", description="by name")


@dataclass(frozen=True)
class Profile:
    """A profile as read, everything in SI."""

    file: ProfileFile
    read_from: Source

    def sections(self) -> list[str]:
        """Return what `parameters` can be asked for: actuators.NAME, sensors.NAME, identity."""
        sensors = [f"sensors.{name}" for name in type(self.file.sensors).model_fields]
        return [*(f"actuators.{name}" for name in self.file.actuators), *sensors, "identity"]

    def parameters(self, section: str) -> dict[str, Any]:
        """Return a section's values by name of the component's parameter, in the port's unit.

        A list has one value per axis. An actuator gives ``pulse_min``, ``pulse_neutral``,
        ``pulse_max`` (s) and ``reversed`` (0 or 1); the identity comes with home and,
        as text, ``uid``, ``date`` and all ``actuators``. Raises InputError for an unknown
        section.
        """
        if section == "identity":
            return self._identity()
        entry = self._section(section)
        if not isinstance(entry, Actuator):
            values: dict[str, Any] = entry.model_dump(
                exclude={"kind", "source"}, exclude_unset=True
            )
            return values
        pulses = ("pulse_min", "pulse_neutral", "pulse_max")
        return {**{p: getattr(entry, p) for p in pulses}, "reversed": float(entry.reversed)}

    def source(self, section: str) -> str:
        """Return where a section's values come from. Raises InputError as `parameters`."""
        if section == "identity":
            return self.file.home.source
        return str(self._section(section).source)

    def _identity(self) -> dict[str, Any]:
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

    Raises InputError with a line for each mistake, naming the file, the key, what was found and
    what is allowed.
    """
    path = find_file("hil_profiles", str(name), relative_to)
    content, read_from = read_toml(path)
    sensors, mistakes = _sensors_of_a_kind(content.get("sensors", {}))
    mistakes = [f"{path}: {mistake}" for mistake in mistakes]
    try:
        file = validated(_file_model(sensors), {**content, "sensors": sensors}, path)
    except InputError as error:
        raise InputError("\n".join([*mistakes, str(error)])) from None
    mistakes += [f"{path}: {mistake}" for mistake in _channel_mistakes(file)]
    if mistakes:
        raise InputError("\n".join(mistakes))
    return Profile(file, read_from)


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


# ------------------------------------------------------------------ schema of the sensors


def _sensors_of_a_kind(written: Any) -> tuple[dict[str, Any], list[str]]:
    """Return the sensors whose kind is known, and what is wrong with the others."""
    if not isinstance(written, dict):
        return {}, [f"sensors: a table per sensor is needed, found {written!r}"]
    good, mistakes = {}, []
    for name, table in written.items():
        kind = table.get("kind") if isinstance(table, dict) else None
        if not _NAME.fullmatch(name) or hasattr(FileModel, name):
            mistakes.append(f"sensors: {name!r} cannot be a sensor's name")
            continue
        if isinstance(kind, str) and kind in SENSORS:
            good[name] = table
            continue
        message = unknown("kind of sensor", kind, SENSORS) if kind else "this key is missing"
        mistakes.append(f"sensors.{name}.kind: {message}")
    return good, mistakes


def _file_model(sensors: dict[str, Any]) -> type[ProfileFile]:
    """Return the schema for a file with these sensors: each has its kind's parameters as keys."""
    models: dict[str, Any] = {
        name: (_sensor_model(table["kind"]), ...) for name, table in sensors.items()
    }
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
