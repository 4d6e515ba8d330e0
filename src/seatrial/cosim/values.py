"""Values for ports as a person writes them, resolved to scalars in the port's own unit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from ..errors import InputError, unknown
from ..fmi.instance import Variable
from ..ports import Scalar
from ..units import conversion, quantity
from .parameters import Entry


@dataclass(frozen=True)
class Given:
    """A scalar's value and where it comes from."""

    value: Scalar
    origin: str
    source: str = ""
    mark: str = ""


def port_scalars(variables: Mapping[str, Variable], name: str) -> list[Variable]:
    """Return the scalars of a port (``force``: ``force.x`` ...), or the one scalar ``name``.

    Empty if there is no such port.
    """
    if name in variables:
        return [variables[name]]
    return [v for n, v in variables.items() if n.startswith(f"{name}.")]


def port_names(variables: Mapping[str, Variable]) -> list[str]:
    """Return the names of all ports and scalars, for messages."""
    return sorted({n.rpartition(".")[0] for n in variables if "." in n} | set(variables))


def from_entry(entry: Entry, scalars: Sequence[Variable], origin: str) -> dict[str, Given]:
    """Return a parameter file's entry as scalars. Raises InputError naming ``origin``."""
    values = entry.value if isinstance(entry.value, list) else [entry.value] * len(scalars)
    _check_count(len(values), scalars, origin)
    given = {}
    for variable, value in zip(scalars, values, strict=True):
        if variable.type is str or isinstance(value, str):
            resolved: Scalar = _text(variable, value, origin)
        else:
            resolved = _converted(float(value), entry.unit, variable, origin)
        _check_limits(variable, resolved, origin)
        given[variable.name] = Given(resolved, origin, entry.source, entry.mark)
    return given


def from_written(
    written: Any,
    scalars: Sequence[Variable],
    presets: Mapping[str, Entry],
    origin: str,
) -> dict[str, Given]:
    """Return what a rig, a trial or the command line says of a port, as scalars.

    Numbers are in the port's unit; text is a quantity (``"10 deg"``), the name of a preset, or
    the value of a text port; a list has one element per axis. Raises InputError.
    """
    if isinstance(written, str) and scalars[0].type is not str:
        if written in presets:
            return from_entry(presets[written], scalars, f"{origin}, preset {written!r}")
        if not any(c.isdigit() for c in written):
            names = list(presets)
            hint = unknown("preset", written, names) if names else f"{written!r} is not a quantity"
            raise InputError(f"{origin}: {hint}")
    values = written if isinstance(written, list) else [written] * len(scalars)
    _check_count(len(values), scalars, origin)
    given = {}
    for variable, value in zip(scalars, values, strict=True):
        resolved = _scalar(variable, value, origin)
        _check_limits(variable, resolved, origin)
        given[variable.name] = Given(resolved, origin)
    return given


def _scalar(variable: Variable, value: Any, origin: str) -> Scalar:
    if variable.type is str:
        return _text(variable, value, origin)
    if variable.type is bool:
        if not isinstance(value, bool):
            raise InputError(f"{origin}: true or false is needed, found {value!r}")
        return value
    try:
        number = quantity(value, variable.unit or "1")
    except InputError as error:
        raise InputError(f"{origin}: {error}") from None
    if variable.type is int:
        if number != int(number) or not -(2**31) <= number < 2**31:
            raise InputError(f"{origin}: a whole number of 32 bits is needed, found {value!r}")
        return int(number)
    return number


def _text(variable: Variable, value: Any, origin: str) -> str:
    if variable.type is not str:
        raise InputError(f"{origin}: a number in {variable.unit or '1'} is needed, found {value!r}")
    if not isinstance(value, str):
        raise InputError(f"{origin}: a text is needed, found {value!r}")
    return value


def _converted(value: float, unit: str, variable: Variable, origin: str) -> float:
    try:
        factor, offset = conversion(unit, variable.unit or "1")
    except InputError as error:
        raise InputError(f"{origin}: {error}") from None
    return value if (factor, offset) == (1.0, 0.0) else value * factor + offset


def _check_limits(variable: Variable, value: Scalar, origin: str) -> None:
    """Raise InputError for a parameter outside what its FMU allows."""
    low, high = variable.minimum, variable.maximum
    if variable.causality != "parameter" or not isinstance(value, float):
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
