"""Tables of a profile that have a kind: sensors and links, each with its component's parameters."""

from __future__ import annotations

import importlib
import re
from collections.abc import Callable
from functools import cache
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, create_model
from pydantic_core import PydanticCustomError

from ..component import Component
from ..errors import InputError, unknown
from ..ports import Parameter
from ..units import quantity, unit
from .files import FileModel

# Named, not imported: a profile without links needs none of their libraries.
KINDS: dict[str, dict[str, str]] = {
    "sensors": {
        "ahrs": "devices.ahrs:Ahrs",
        "anemometer": "devices.anemometer:Anemometer",
        "compass": "devices.compass:Compass",
        "depth": "devices.depth:Depth",
        "gnss": "devices.gnss:Gnss",
        "imu": "devices.imu:Imu",
    },
    "links": {
        "arduino": "links.arduino.component:Arduino",
        "can-gateway": "links.can.component_gateway:CanGateway",
        "can-signals": "links.can_signals.component:CanSignals",
        "canbus": "links.can.component:CanBus",
        "dronecan-autopilot": "links.dronecan.autopilot:DroneCanAutopilot",
        "dronecan-peripheral": "links.dronecan.peripheral:DroneCanPeripheral",
        "mavlink": "links.mavlink.component:Mavlink",
        "pro4-rov": "links.videoray.rov:Pro4Rov",
        "pro4-topside": "links.videoray.topside:Pro4Topside",
        "serial-gateway": "links.serial_gateway:SerialGateway",
        "nmea0183": "links.nmea0183.component:Nmea0183",
        "nmea2000": "links.nmea2000.component:Nmea2000",
    },
}
"""Groups of tables, their kinds, and the component whose parameters a table of a kind gives."""

SHARED = (
    *("system_id", "component_id", "vehicle_type", "autopilot_type", "firmware_version", "uid"),
    *("latitude", "longitude", "altitude", "date", "actuators"),
)
"""Parameters of links that the rest of the profile gives: identity, home and actuators."""

FILES = {"arduino": ("sketch", "firmware"), "can-signals": ("database",)}
"""Parameters that name a file, relative to the profile, by the kind of the link."""

NAME = re.compile(r"[A-Za-z][\w-]*", re.ASCII)


@cache
def component_of(group: str, kind: str) -> type[Component]:
    """Return the component whose parameters a table of a kind gives."""
    module, _, name = KINDS[group][kind].partition(":")
    root = __package__.rpartition(".")[0]
    found: type[Component] = getattr(importlib.import_module(f"{root}.{module}"), name)
    return found


def keys(group: str, kind: str) -> dict[str, Parameter]:
    """Return the parameters that a table of a kind may give, by name."""
    # A seed belongs to an instance and a run, not to a data sheet.
    others = {"seed", "run_folder", *(SHARED if group == "links" else ())}
    return {
        name: port
        for name, port in component_of(group, kind).ports.items()
        if isinstance(port, Parameter) and name not in others
    }


def of_a_kind(group: str, written: Any) -> tuple[dict[str, Any], list[str]]:
    """Return the tables of a group whose kind is known, and what is wrong with the others."""
    what, kinds = group.removesuffix("s"), KINDS[group]
    if not isinstance(written, dict):
        return {}, [f"{group}: a table per {what} is needed, found {written!r}"]
    good, mistakes = {}, []
    for name, table in written.items():
        kind = table.get("kind") if isinstance(table, dict) else None
        if not NAME.fullmatch(name) or hasattr(FileModel, name):
            mistakes.append(f"{group}: {name!r} cannot be a {what}'s name")
            continue
        if isinstance(kind, str) and kind in kinds:
            good[name] = table
            continue
        message = unknown(f"kind of {what}", kind, kinds) if kind else "this key is missing"
        mistakes.append(f"{group}.{name}.kind: {message}")
    return good, mistakes


def group_model(group: str, tables: dict[str, Any]) -> type[FileModel]:
    """Return the schema of a group with these tables: each has its kind's parameters as keys."""
    models: dict[str, Any] = {
        name: (_table_model(group, table["kind"]), ...) for name, table in tables.items()
    }
    return create_model(group.capitalize(), __base__=FileModel, **models)


@cache
def _table_model(group: str, kind: str) -> type[FileModel]:
    fields: dict[str, Any] = {"kind": (Literal[kind], ...)}
    fields["source"] = (str, ...) if group == "sensors" else (str, "")
    for name, port in keys(group, kind).items():
        fields[name] = (Annotated[Any, BeforeValidator(_reader(port))], None)
    return create_model(kind, __base__=FileModel, **fields)


def _reader(port: Parameter) -> Callable[[Any], Any]:
    """Return what reads a parameter as written: text, a quantity, or a list of one per axis."""

    def read(written: Any) -> Any:
        if not isinstance(written, list):
            return _scalar(port, written, 0)
        if port.axes is None or len(written) != port.size:
            axes = (
                f"one value, or {port.size} ({', '.join(port.axes)})" if port.axes else "one value"
            )
            raise refused(f"{axes} needed")
        return [_scalar(port, value, i) for i, value in enumerate(written)]

    return read


def _scalar(port: Parameter, written: Any, index: int) -> float | str:
    if port.type is str:
        return _text(port, written)
    low, high = port.limit("min", index), port.limit("max", index)
    return in_si(written, port.unit_of(index), low, high)


def _text(port: Parameter, written: Any) -> str:
    if not isinstance(written, str):
        raise refused("a text is needed")
    try:
        port.check_text(written)
    except InputError as error:
        raise refused(str(error)) from None
    return written


def refused(message: str) -> PydanticCustomError:
    """Return what a validator raises for a value that it refuses."""
    # Braces would be taken for the template's own.
    return PydanticCustomError("refused", "{message}", {"message": message})


def in_si(written: Any, target: str, low: float | None, high: float | None) -> float:
    """Return a quantity as written in the unit ``target``, within limits."""
    try:
        if unit(target).exponents and not isinstance(written, str):
            raise InputError(f"a quantity with its unit is needed, such as '1 {target}'")
        value = quantity(written, target)
    except InputError as error:
        raise refused(str(error)) from None
    if low is not None and value < low:
        raise refused(f"at least {low:g} {target} needed")
    if high is not None and value > high:
        raise refused(f"at most {high:g} {target} needed")
    return value
