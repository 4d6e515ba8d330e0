"""Inputs of parts: values of the board's ports, and quantities that follow from these."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from seatrial.errors import InputError
from seatrial.links.earth_field import earth_field
from seatrial.links.parameter_validation import start_us
from seatrial.physics.craft.kinematics import to_body

from .mcus import Mcu
from .part import Part
from .ports import ArduinoPorts
from .wiring import Wire

ATMOSPHERE = 101325.0
GROUPS = ("angle", "distance", "temperature")
"""Ports of which a part has the one of its number."""
DERIVED = ("field", "declination", "pressure")


def measured(board: ArduinoPorts, part: Part, field: Sequence[float]) -> dict[str, Any]:
    """Return the inputs of a part, by name; ``field`` is the earth's, north-east-down, T.

    ``field`` is the magnetic one in body axes by ``attitude``, T; ``declination`` its
    angle east of north, rad; ``pressure`` that at ``depth`` under
    one atmosphere, Pa: p = p0 + rho g z.
    """
    return {name: _value(board, name, part.number, field) for name in part.ports}


def check_ports(board: ArduinoPorts, part: Part, written: str) -> None:
    """Raise InputError for a port of a part that the board has not, or a number too large."""
    for name in part.ports:
        if name not in DERIVED and name not in board.ports:
            known = ", ".join([*DERIVED, *GROUPS])
            raise InputError(
                f"wires: {written}: {type(part).__name__} names the port {name!r}: {known} or "
                "another input is needed"
            )
        if name in GROUPS and not 1 <= part.number <= len(getattr(board, name)):
            most = len(getattr(board, name))
            raise InputError(f"wires: {written}: the number {part.number} is not in 1 to {most}")


def signals(board: ArduinoPorts, wire: Wire, mcu: Mcu) -> list[tuple[tuple[str, int], float]]:
    """Return the records that a wire's signals give: kind and index, value."""
    kind, n = wire.kind, wire.number - 1
    if kind == "voltage":
        return [(("A", mcu.channel(wire.place)), board.voltage[n])]
    if kind == "input":
        return [(("L", wire.place), float(board.level[n]))]
    if kind == "receiver":
        return [(("R", wire.place), board.receiver[n])]
    if kind == "anemometer":
        return [(("F", wire.place), max(0.0, wire.factor * board.wind_speed))]
    if kind == "vane":
        turn = (board.wind_angle + math.pi) / math.tau % 1.0
        return [(("A", mcu.channel(wire.place)), wire.factor * turn)]
    return []


def field_at_home(board: ArduinoPorts) -> Sequence[float]:
    """Return the earth's magnetic field, north-east-down, T: given, or that of home and date."""
    given: Sequence[float] = board.magnetic_field
    if any(given):
        return given
    home = board.latitude, board.longitude, board.altitude
    return earth_field(*home, start_us(board.date) * 1e-6)


def _value(board: ArduinoPorts, name: str, number: int, field: Sequence[float]) -> Any:
    if name == "field":
        return tuple(to_body(board.attitude, field))
    if name == "declination":
        return math.atan2(field[1], field[0])
    if name == "pressure":
        return ATMOSPHERE + board.water_density * board.gravity * board.depth
    value = getattr(board, name)
    if name in GROUPS:
        return value[number - 1]
    return tuple(value) if isinstance(value, list) else value
