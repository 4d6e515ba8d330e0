"""Quantities that users of logs ask for, and the channels that serve them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError, unknown
from ...model.units import conversion
from .channels import Array, Channel, Integers, Log


@dataclass(frozen=True)
class Quantity:
    """A quantity of a moving vessel."""

    sense: str
    unit: str
    share: bool = False
    """Whether a share from -1 to 1 may stand for it."""
    wraps: bool = False
    """Whether it is an angle that starts anew after a turn."""
    held: bool = False
    """Whether a value stands until the next, as an order does."""
    most: float = math.inf
    """Largest magnitude that there can be."""


QUANTITIES: Mapping[str, Quantity] = {
    "time": Quantity("of a table's rows", "s"),
    "north": Quantity("of any origin", "m"),
    "east": Quantity("of any origin", "m"),
    "latitude": Quantity("north, WGS 84", "rad", most=math.pi / 2),
    "longitude": Quantity("east, WGS 84", "rad", wraps=True, most=math.tau),
    "heading": Quantity("clockwise from true north", "rad", wraps=True),
    "course": Quantity("over ground, clockwise from true north", "rad", wraps=True),
    "speed": Quantity("over ground", "m/s"),
    "water_speed": Quantity("through the water", "m/s"),
    "helm": Quantity("positive to turn to starboard, an angle or a share of full helm", "rad",
                     share=True),
    "roll": Quantity("starboard side down", "rad", most=math.pi),
    "pitch": Quantity("bow up", "rad", most=math.pi / 2),
    "yaw_rate": Quantity("to starboard", "rad/s"),
    "depth": Quantity("of the vessel below the surface, positive down", "m"),
    "water_depth": Quantity("below the transducer", "m"),
    "power": Quantity("consumed", "W"),
    "command": Quantity("share of full thrust", "1", held=True),
    "port": Quantity("share of full thrust, port", "1", held=True),
    "starboard": Quantity("share of full thrust, starboard", "1", held=True),
    "acceleration": Quantity("along an axis", "m/s2"),
    "acceleration_x": Quantity("ahead", "m/s2"),
    "acceleration_y": Quantity("to starboard", "m/s2"),
}  # fmt: skip
"""By name; units are those of `Series`."""


@dataclass(frozen=True)
class Column:
    """A channel as a user names it: ``-NAME`` for one of opposite sign; the unit of its values."""

    name: str
    unit: str | None = None


@dataclass(frozen=True, eq=False)
class Series:
    """A quantity over time: arrays (n,), in the unit of `QUANTITIES`."""

    quantity: Quantity
    what: str
    log: Log
    channel: Channel
    time: Array
    values: Array
    kept: Integers
    """Index of each value in the channel."""

    def place(self, index: int) -> str:
        """Return the place of a value in the file, for messages."""
        return self.log.place(self.channel, int(self.kept[index]))

    def instant(self, index: int) -> str:
        """Return the place of its time."""
        return self.log.instant(self.channel, int(self.kept[index]))

    def at(self, which: NDArray[Any] | slice) -> Series:
        """Return some of the values."""
        return replace(
            self, time=self.time[which], values=self.values[which], kept=self.kept[which]
        )


def read_columns(texts: Sequence[str]) -> dict[str, Column]:
    """Return columns by quantity, from texts ``WHAT=NAME`` or ``WHAT=NAME:UNIT``.

    Several may stand in one text, with commas. Raises InputError for another form, or for a WHAT
    that is none of `QUANTITIES`.
    """
    columns: dict[str, Column] = {}
    for part in (part.strip() for text in texts for part in text.split(",")):
        what, equals, name = part.partition("=")
        name, colon, unit = name.partition(":")
        if not (equals and name) or (colon and not unit):
            raise InputError(f"--columns: WHAT=NAME or WHAT=NAME:UNIT is needed, found {part!r}")
        if what not in QUANTITIES:
            raise InputError(f"--columns: {unknown('quantity', what, QUANTITIES)}")
        columns[what] = Column(name, unit or None)
    return columns


def chosen(
    log: Log, columns: Mapping[str, Column], wanted: Iterable[str], *, units_needed: bool = False
) -> dict[str, Series]:
    """Return the quantities that are wanted and that the log has, with the channels serving them.

    ``columns`` names channels; a quantity without an entry is served by the format's defaults. A
    value without a unit is in that of `QUANTITIES`, or refused where ``units_needed``.

    Raises InputError, with file and channel, for a channel that is missing, a unit of another
    quantity, or another than the log has, text in a table's cell, and values that are beyond their
    limit, as degrees in the place of radians are. Empty cells, and entries that are no number, are
    left out.
    """
    found = {}
    for what in wanted:
        column = columns.get(what) or _default(log, what)
        if column is not None:
            found[what] = series(log, what, column, units_needed=units_needed)
    return found


def defaults(log: Log) -> dict[str, Column]:
    """Return the channel that serves each quantity if the user names none."""
    found = {what: _default(log, what) for what in QUANTITIES if what != "time"}
    return {what: column for what, column in found.items() if column is not None}


def _default(log: Log, what: str) -> Column | None:
    """Return the best channel that can serve a quantity and has a value."""
    for name in log.defaults.get(what, ()):
        served = log.channels.get(_split(log, name)[0])
        if served is not None and np.isfinite(served.values).any():
            return Column(name)
    return None


def series(
    log: Log,
    what: str,
    column: Column,
    quantity: Quantity | None = None,
    *,
    units_needed: bool = False,
) -> Series:
    """Return one quantity, served by a column; see `chosen`.

    ``quantity`` says what is none of `QUANTITIES`, such as an order to an actuator.
    """
    name, sign = _split(log, column.name)
    if name not in log.channels:
        raise InputError(f"{log.path}: {what}: {unknown(log.noun, name, log.channels)}")
    found, quantity = log.channels[name], quantity or QUANTITIES[what]
    factor, offset = _factor(log, found, column.unit, quantity, units_needed)
    if found.wrong:
        first = min(found.wrong)
        raise InputError(
            f"{log.place(found, first)}: a finite number is needed, found {found.wrong[first]!r}"
        )
    known = np.isfinite(found.values) & np.isfinite(found.time)
    kept, time, values = np.flatnonzero(known), found.time, found.values
    if not known.all():
        time, values = time[kept], values[kept]
    if (sign * factor, sign * offset) != (1.0, 0.0):
        values = sign * (values * factor + offset)
    result = Series(quantity, what, log, found, time, values, kept)
    if not len(kept):
        raise InputError(f"{log.path}: {what}: the {log.noun} {name!r} has no value")
    beyond = np.flatnonzero(np.abs(values) > quantity.most * (1.0 + 1e-9))
    if len(beyond):
        raise InputError(
            f"{result.place(int(beyond[0]))}: {what} is {values[beyond[0]]:g} {quantity.unit}, "
            f"beyond {quantity.most:.4g}; is it in degrees? (--columns {what}={name}:deg)"
        )
    return result


def times_of(log: Log, column: Column) -> Array:
    """Return the times of a table's rows, s. Raises InputError for a row without one."""
    found = series(log, "time", column)
    if len(found.values) < len(found.channel.values):
        lacking = int(np.flatnonzero(~np.isfinite(found.channel.values))[0])
        raise InputError(f"{log.place(found.channel, lacking)}: the row has no time")
    return found.values


def _split(log: Log, name: str) -> tuple[str, float]:
    """Return a channel's name and sign."""
    if name.startswith("-") and name not in log.channels:
        return name[1:], -1.0
    return name, 1.0


def _factor(
    log: Log, found: Channel, named: str | None, quantity: Quantity, needed: bool
) -> tuple[float, float]:
    where = f"{log.path}: {log.noun} {found.name!r}"
    if named and found.unit and named != found.unit:
        raise InputError(f"{where}: the file has it in {found.unit}, not {named}")
    unit = found.unit if named is None else named
    if unit is None and needed:
        raise InputError(f"{where}: a unit is needed: the file does not say it")
    if quantity.share and unit in ("", "1", "%"):
        return conversion(unit, "1")
    try:
        return conversion(quantity.unit if unit is None else unit, quantity.unit)
    except InputError as error:
        raise InputError(f"{where}: {error}") from None
