"""Values for ports as a person writes them, resolved to scalars in the port's own unit."""

from __future__ import annotations

import base64
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

from ...errors import InputError, unknown
from ...fmi.instance import Value, Variable, Variables
from ...model.ports import Scalar
from ...model.serialisation import is_c_text
from ...model.units import Unit, conversion, quantity
from .derived import measures
from .entries import Computed, Resolved


@dataclass(frozen=True)
class Given:
    """A scalar's value and where it comes from."""

    value: Value
    origin: str
    source: str = ""
    mark: str = ""
    expression: str = ""
    """Of which it is the value, if a file has one in its place."""


class Setting(NamedTuple):
    """What a person sets: a port by its path."""

    key: str
    written: Any
    origin: str
    folder: Path | None = None
    """Of the file that says it: names of files are relative to it, or to where we are."""


def placed(written: Any, scalars: Sequence[Variable], folder: Path | None) -> Any:
    """Return the name of a file as it is from here, if ``written`` is that of one in ``folder``.

    Else ``written``: the name of a file may also be relative to where the run begins.
    """
    if folder is None or not isinstance(written, str) or scalars[0].role != "file":
        return written
    beside = folder / written
    return str(beside) if written and beside.exists() else written


def storable(value: Value) -> Scalar:
    """Return a value as files hold it: bytes as base64 text, as they are written in a rig."""
    return base64.b64encode(value).decode() if isinstance(value, bytes) else value


def port_scalars(variables: Variables, name: str) -> list[Variable]:
    """Return the scalars of a port (``force``: ``force.x`` ...), or the one scalar ``name``.

    A port is also an array (``x``: ``x[1]`` ...). Empty if there is no such port.
    """
    if name in variables:
        return [variables[name]]
    return variables.ports.get(name, [])


def port_names(variables: Variables) -> list[str]:
    """Return the names of all ports and scalars, for messages."""
    return sorted({*variables.ports, *variables})


def from_entry(
    entry: Resolved, scalars: Sequence[Variable], origin: str, folder: Path | None = None
) -> dict[str, Given]:
    """Return a parameter file's entry as scalars; ``folder`` is that of the file.

    Raises InputError naming ``origin``.
    """
    said = placed(entry.value, scalars, folder)
    values = said if isinstance(said, list) else [said] * len(scalars)
    _check_count(len(values), scalars, origin)
    units = measures(entry, len(scalars))
    _check_count(len(units), scalars, f"{origin}: units")
    expression = entry.expression if isinstance(entry, Computed) else ""
    given = {}
    for variable, value, unit in zip(scalars, values, units, strict=True):
        named = unit.text if isinstance(unit, Unit) else unit
        if variable.type is not float and named != "1":
            raise InputError(f"{origin}: {variable.name} has no unit, found {named!r}")
        if variable.type is float and not isinstance(value, str):
            where = f"{origin}: {variable.name}"
            resolved: Value = _converted(float(value), unit, variable, where)
        elif variable.type is float:
            resolved = _text(variable, value, origin)
        else:
            resolved = _scalar(variable, value, origin)
        check_limits(variable, resolved, origin)
        given[variable.name] = Given(resolved, origin, entry.source, entry.mark, expression)
    return given


def from_written(
    written: Any, scalars: Sequence[Variable], presets: Mapping[str, Resolved], origin: str
) -> dict[str, Given]:
    """Return what a rig, a trial or the command line says of a port, as scalars.

    Numbers are in the port's unit; text is a quantity (``"10 deg"``), the name of a preset, or
    the value of a text, enumeration or binary port; a list has one element per axis. An entry is
    what an expression amounts to. Raises InputError.
    """
    if isinstance(written, Resolved):
        return from_entry(written, scalars, origin)
    if isinstance(written, str) and scalars[0].type is not str:
        if written in presets:
            return from_entry(presets[written], scalars, f"{origin}, preset {written!r}")
        if scalars[0].type is float and not any(c.isdigit() for c in written):
            names = list(presets)
            hint = unknown("preset", written, names) if names else f"{written!r} is not a quantity"
            raise InputError(f"{origin}: {hint}")
    values = written if isinstance(written, list) else [written] * len(scalars)
    _check_count(len(values), scalars, origin)
    given = {}
    for variable, value in zip(scalars, values, strict=True):
        if isinstance(value, Resolved):
            given.update(from_entry(value, [variable], origin))
            continue
        resolved = _scalar(variable, value, origin)
        check_limits(variable, resolved, origin)
        given[variable.name] = Given(resolved, origin)
    return given


def _scalar(variable: Variable, value: Any, origin: str) -> Value:
    if variable.type is str:
        return _text(variable, value, origin)
    if variable.type is bytes:
        return _binary(value, origin)
    if variable.type is bool:
        if not isinstance(value, bool):
            raise InputError(f"{origin}: true or false is needed, found {value!r}")
        return value
    if variable.items:
        return _item(variable, value, origin)
    if variable.type is int:
        return _whole(variable, value, origin)
    return _quantity(variable, value, origin)


def _quantity(variable: Variable, value: Any, origin: str) -> float:
    try:
        return quantity(value, variable.measure)
    except InputError as error:
        raise InputError(f"{origin}: {error}") from None


def _whole(variable: Variable, value: Any, origin: str) -> int:
    # A double does not hold every integer of 64 bits, the file's own integer does.
    exact = isinstance(value, int) and not isinstance(value, bool)
    number = value if exact else _quantity(variable, value, origin)
    low, high = variable.integers
    if number != int(number) or not low <= number <= high:
        raise InputError(
            f"{origin}: a whole number from {low} to {high} is needed, found {value!r}"
        )
    return int(number)


def _item(variable: Variable, value: Any, origin: str) -> int:
    """Return the value of an enumeration, written as its name or number."""
    if isinstance(value, str) and value in variable.items:
        return variable.items[value]
    if isinstance(value, int) and not isinstance(value, bool) and value in variable.items.values():
        return value
    allowed = ", ".join(f"{name} ({number})" for name, number in variable.items.items())
    raise InputError(f"{origin}: one of {allowed} is needed, found {value!r}")


def _binary(value: Any, origin: str) -> bytes:
    try:
        return base64.b64decode(value, validate=True)
    except (TypeError, ValueError):
        raise InputError(f"{origin}: bytes as base64 text are needed, found {value!r}") from None


def _text(variable: Variable, value: Any, origin: str) -> str:
    if variable.type is not str:
        raise InputError(f"{origin}: a number in {variable.unit or '1'} is needed, found {value!r}")
    if not isinstance(value, str):
        raise InputError(f"{origin}: a text is needed, found {value!r}")
    if not is_c_text(value):
        raise InputError(f"{origin}: FMI cannot carry the text {value!r}")
    return value


def _converted(value: float, unit: str | Unit, variable: Variable, origin: str) -> float:
    try:
        factor, offset = conversion(unit, variable.measure)
    except InputError as error:
        raise InputError(f"{origin}: {error}") from None
    return value if (factor, offset) == (1.0, 0.0) else value * factor + offset


def check_limits(variable: Variable, value: Value, origin: str) -> None:
    """Raise InputError for a parameter outside what its FMU allows."""
    low, high = variable.minimum, variable.maximum
    if variable.causality not in ("parameter", "structuralParameter") or not isinstance(
        value, (int, float)
    ):
        return
    if (low is not None and value < low) or (high is not None and value > high):
        least, most = "" if low is None else f"{low!r} <= ", "" if high is None else f" <= {high!r}"
        raise InputError(
            f"{origin}: {variable.name} = {value!r} {variable.unit} is not in its range "
            f"{least}{variable.name}{most}"
        )


def _check_count(count: int, scalars: Sequence[Variable], origin: str) -> None:
    if count != len(scalars):
        names = ", ".join(v.name for v in scalars)
        raise InputError(f"{origin}: {len(scalars)} values are needed ({names}), found {count}")
