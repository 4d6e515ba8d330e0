"""Status of ESCs and actuators on the bus, from measured values and back."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from .channels import Channel
from .codec import equipment
from .commands import RPM

EscStatus: Any = equipment.esc.Status
ActuatorStatus: Any = equipment.actuator.Status

QUANTITIES = {
    "voltage": "V",
    "current": "A",
    "temperature": "K",
    "speed": "1",
    "position": "1",
    "force": "1",
}
"""What a status may have, and its unit; an actuator's depends on whether it turns or slides."""


def status(channel: Channel, measured: Mapping[str, float], demand: float) -> Any:
    """Return the status of a channel; what is not measured is NaN, or 0 for an ESC's speed.

    ``demand`` is the share of full power, 0 to 1.
    """
    if channel.is_esc:
        return EscStatus(
            voltage=measured.get("voltage", math.nan),
            current=measured.get("current", math.nan),
            temperature=measured.get("temperature", math.nan),
            rpm=round(measured.get("speed", 0.0) / RPM),
            power_rating_pct=round(100.0 * demand),
            esc_index=channel.number,
        )
    return ActuatorStatus(
        actuator_id=channel.number,
        position=measured.get("position", math.nan),
        force=measured.get("force", math.nan),
        speed=measured.get("speed", math.nan),
        power_rating_pct=ActuatorStatus().POWER_RATING_PCT_UNKNOWN,
    )


def is_status_of(channel: Channel, message: Any) -> bool:
    """Return whether a message is the status of a channel."""
    if message._type is EscStatus:
        return channel.is_esc and channel.number == message.esc_index
    return (
        message._type is ActuatorStatus
        and not channel.is_esc
        and channel.number == message.actuator_id
    )


def reported(message: Any) -> dict[str, float]:
    """Return the values of a status, without what is unknown."""
    if message._type is EscStatus:
        found = {
            "voltage": message.voltage,
            "current": message.current,
            "temperature": message.temperature,
            "speed": message.rpm * RPM,
        }
    else:
        found = {"position": message.position, "force": message.force, "speed": message.speed}
    return {name: value for name, value in found.items() if math.isfinite(value)}
