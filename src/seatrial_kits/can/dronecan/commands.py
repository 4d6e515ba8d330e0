"""Commands on the bus: RawCommand, RPMCommand and ArrayCommand, from values and back."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

from .channels import ACTUATOR_TYPES, Channel
from .codec import equipment

RawCommand: Any = equipment.esc.RawCommand
RPMCommand: Any = equipment.esc.RPMCommand
ArrayCommand: Any = equipment.actuator.ArrayCommand
_Command: Any = equipment.actuator.Command

FULL_SCALE = 8191
"""Raw command of full power."""
RPM = math.tau / 60.0
"""One revolution per minute, rad/s."""

_MICROSECOND = 1e-6
_ESC = {
    "esc": (RawCommand, "cmd", 1.0 / FULL_SCALE, FULL_SCALE),
    "rpm": (RPMCommand, "rpm", RPM, 131071),
}
"""Message, its field, the value of one unit and the largest number."""


def messages(channels: Sequence[Channel], values: Sequence[float]) -> Iterator[Any]:
    """Give the messages that set ``channels`` to ``values``.

    An ESC between them that is not among them gets 0: the message has no word for none.
    """
    wanted = list(zip(channels, values, strict=True))
    for kind, (message, field, unit, most) in _ESC.items():
        rows = {channel.number: value / unit for channel, value in wanted if channel.kind == kind}
        if rows:
            whole = [round(rows.get(number, 0.0)) for number in range(max(rows) + 1)]
            yield message(**{field: [max(-most, min(most, each)) for each in whole]})
    actuators = [
        _Command(
            actuator_id=channel.number,
            command_type=ACTUATOR_TYPES.index(channel.kind),
            command_value=value / _unit(channel),
        )
        for channel, value in wanted
        if not channel.is_esc
    ]
    if actuators:
        yield ArrayCommand(commands=actuators)


def commanded(channels: Sequence[Channel], message: Any) -> Iterator[tuple[int, float]]:
    """Give the place in ``channels`` and the value of each that a message commands.

    Actuators are commanded by their own type alone. Values that are no numbers are left out.
    """
    for place, channel in enumerate(channels):
        if channel.is_esc:
            kind, field, unit, most = _ESC[channel.kind]
            if message._type is kind and channel.number < len(getattr(message, field)):
                number = getattr(message, field)[channel.number]
                yield place, max(-most, min(most, number)) * unit
        elif message._type is ArrayCommand:
            for each in message.commands:
                value = each.command_value * _unit(channel)
                what = ACTUATOR_TYPES.index(channel.kind), channel.number
                if (each.command_type, each.actuator_id) == what and math.isfinite(value):
                    yield place, value


def _unit(channel: Channel) -> float:
    return _MICROSECOND if channel.kind == "pwm" else 1.0
