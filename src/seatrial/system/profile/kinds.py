"""Tables of a profile that have a kind: sensors and links, each with its component's parameters."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import cache
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, create_model
from pydantic_core import PydanticCustomError

from ...errors import InputError, unknown
from ...fmi.components.index import component_class, components
from ...kits import kits
from ...model.ports import Parameter
from ...model.units import quantity, unit
from ..files import FileModel
from ..tunables import TunableEntry

GROUPS = ("sensors", "links")
"""Groups of tables whose ``kind`` is a component of the index (`fmi.components.index`)."""

SHARED = (
    *("system_id", "component_id", "vehicle_type", "autopilot_type", "firmware_version", "uid"),
    *("latitude", "longitude", "altitude", "date", "actuators", "instruments"),
)
"""Parameters of links that the rest of the profile gives: identity, home, actuators, sensors."""

NAME = re.compile(r"[A-Za-z][\w-]*", re.ASCII)


def keys(group: str, kind: str) -> dict[str, Parameter]:
    """Return the parameters that a table of a kind may give, by name."""
    shared = SHARED if group == "links" else ()
    return {
        name: port
        for name, port in component_class(kind).ports.items()
        if isinstance(port, Parameter)
        # A seed belongs to an instance and a run, not to a data sheet.
        and port.role not in ("seed", "run-folder", "shape", "verdicts")
        and name not in shared
    }


def of_a_kind(group: str, written: Any) -> tuple[dict[str, Any], list[str], dict[str, str]]:
    """Return the tables of a group whose kind is known, mistakes, and strange links by section.

    A link of an unknown kind may be one of a kit that is not here: a rig may do without it.
    """
    what, kinds = group.removesuffix("s"), components().names()
    if not isinstance(written, dict):
        return {}, [f"{group}: a table per {what} is needed, found {written!r}"], {}
    good: dict[str, Any] = {}
    mistakes: list[str] = []
    strange: dict[str, str] = {}
    for name, table in written.items():
        kind = table.get("kind") if isinstance(table, dict) else None
        if not NAME.fullmatch(name) or hasattr(FileModel, name):
            mistakes.append(f"{group}: {name!r} cannot be a {what}'s name")
            continue
        if isinstance(kind, str) and kind in kinds:
            good[name] = table
            continue
        message = unknown(f"kind of {what}", kind, kinds) if kind else "this key is missing"
        message = f"{group}.{name}.kind: {message}"
        if group == "links" and isinstance(kind, str):
            strange[f"{group}.{name}"] = message + kits().hint()
        else:
            mistakes.append(message)
    return good, mistakes, strange


def section_model(group: str, name: str, kind: str) -> type[FileModel]:
    """Return the schema of a file with one table, whose keys are its kind's parameters."""
    table: dict[str, Any] = {name: (_table_model(group, kind), ...)}
    tables = create_model(group.capitalize(), __base__=FileModel, **table)
    content: dict[str, Any] = {group: (tables, ...)}
    return create_model("Section", __base__=FileModel, **content)


@cache
def _table_model(group: str, kind: str) -> type[FileModel]:
    fields: dict[str, Any] = {"kind": (Literal[kind], ...), "source": (str, "")}
    for name, port in keys(group, kind).items():
        if port.role == "tunables":
            fields[name] = (Annotated[dict[str, TunableEntry], BeforeValidator(_table)], {})
        else:
            fields[name] = (Annotated[Any, BeforeValidator(_reader(port))], None)
    return create_model(kind, __base__=FileModel, **fields)


def _table(written: Any) -> Any:
    if not isinstance(written, dict):
        raise refused("a table with an entry for each is needed")
    return written


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
