"""The content of a profile's file: identity, home, output channels; sensors and links by name."""

from __future__ import annotations

import datetime
import math
import re
from typing import Annotated, Any

from pydantic import BeforeValidator, Field

from ...errors import unknown
from ..files import FileModel
from .kinds import NAME, in_si, refused

VEHICLE_TYPES = ("ground_rover", "submarine", "surface_boat")
"""MAVLink's MAV_TYPE, in lower case."""
AUTOPILOT_TYPES = ("ardupilotmega", "px4")
"""MAVLink's MAV_AUTOPILOT, in lower case."""

_VERSION = re.compile(r"\d+\.\d+\.\d+(-(dev|alpha|beta|rc))?")
_PORT = re.compile(r"[A-Za-z_]\w*(\.[A-Za-z_]\w*){1,2}")


def _unit(target: str, low: float | None = None, high: float | None = None) -> BeforeValidator:
    """Read a quantity into ``target``, within limits."""
    return BeforeValidator(lambda written: in_si(written, target, low, high))


def _one_of(what: str, allowed: tuple[str, ...]) -> BeforeValidator:
    def check(written: Any) -> Any:
        if written not in allowed:
            raise refused(unknown(what, written, allowed))
        return written

    return BeforeValidator(check)


def _like(pattern: re.Pattern[str], example: str) -> BeforeValidator:
    def check(written: Any) -> Any:
        if not isinstance(written, str) or not pattern.fullmatch(written):
            raise refused(f"something like {example!r} is needed")
        return written

    return BeforeValidator(check)


def _listed(names: tuple[str, ...]) -> str:
    return ", ".join(f"`{name}`" for name in names)


_Pulse = Annotated[float, _unit("s", 0.5e-3, 2.5e-3)]
_PULSE = "0.5 to 2.5 ms"


class Identity(FileModel):
    """Who the vehicle is on a MAVLink network; the defaults are those of the link's component."""

    system_id: int = Field(default=1, ge=1, le=255, title="1 to 255", description="MAVLink system")
    component_id: int = Field(
        default=1, ge=1, le=255, title="1 to 255", description="MAVLink component"
    )
    vehicle_type: Annotated[str, _one_of("vehicle type", VEHICLE_TYPES)] = Field(
        default="surface_boat", title=_listed(VEHICLE_TYPES), description="MAV_TYPE"
    )
    autopilot_type: Annotated[str, _one_of("autopilot type", AUTOPILOT_TYPES)] = Field(
        default="ardupilotmega", title=_listed(AUTOPILOT_TYPES), description="MAV_AUTOPILOT"
    )
    firmware_version: Annotated[str, _like(_VERSION, "4.5.0-dev")] = Field(
        default="0.1.0-dev",
        title="like `4.5.0` or `4.5.0-dev` (`dev`, `alpha`, `beta`, `rc`)",
        description="version of the vehicle's own, which it reports beside that of its firmware",
    )
    uid: int = Field(
        default=1,
        ge=1,
        le=2**64 - 1,
        title="1 to 2^64 - 1",
        description="serial number of the hardware",
    )


class Home(FileModel):
    """Where and when the origin of north-east-down is: WGS 84, rad and m; a calendar day.

    The defaults are those of the links' components.
    """

    latitude: Annotated[float, _unit("rad", -math.pi / 2, math.pi / 2)] = Field(
        default=0.0, title="angle, -90 to 90 deg", description="WGS 84"
    )
    longitude: Annotated[float, _unit("rad", -math.pi, math.pi)] = Field(
        default=0.0, title="angle, -180 to 180 deg", description="WGS 84"
    )
    altitude: Annotated[float, _unit("m")] = Field(
        default=0.0, title="length", description="WGS 84"
    )
    date: datetime.date = Field(
        default=datetime.date(2026, 1, 1),
        title="calendar day, without quotes",
        description="day of the run",
    )
    source: str = Field(default="", title="text", description="where this is from")


class Actuator(FileModel):
    """One output channel: pulse widths in s, and the port that it drives.

    The defaults are those of speed controllers' and servos' components.
    """

    channel: int = Field(
        ge=1, le=32, title="1 to 32", description="output channel, one per actuator"
    )
    port: Annotated[str, _like(_PORT, "port_thruster.pulse")] = Field(
        title="`component.port`", description="the port that the channel drives, one per actuator"
    )
    pulse_min: _Pulse = Field(default=1.1e-3, title=_PULSE, description="pulse of one end")
    pulse_neutral: _Pulse = Field(
        default=1.5e-3, title=_PULSE, description="pulse that stops it, or of the middle"
    )
    pulse_max: _Pulse = Field(
        default=1.9e-3, title=_PULSE, description="pulse of the other end; the three must rise"
    )
    reversed: bool = Field(False, title="`true` or `false`", description="it acts the other way")
    source: str = Field("", title="text", description="data sheet, or that it is assumed")


class ProfileFile(FileModel):
    """The content of a profile; ``sensors`` and ``links`` have one entry each, by name."""

    title: str = Field(title="text", description="for listings")
    identity: Identity = Field(
        default=Identity(), title="table", description="who the vehicle is on a MAVLink network"
    )
    home: Home = Field(
        default=Home(), title="table", description="where and when the origin of north-east-down is"
    )
    actuators: dict[Annotated[str, _like(NAME, "port")], Actuator] = Field(
        default_factory=dict, title="table per output channel", description="by name"
    )
    sensors: dict[str, dict[str, Any]] = Field(
        default_factory=dict, title="table per sensor", description="by name"
    )
    links: dict[str, dict[str, Any]] = Field(
        default_factory=dict, title="table per link", description="by name"
    )
